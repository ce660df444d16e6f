"""Whether a circuit is well formed.

Takes: a circuit. Gives: nothing; `InternalError` if an operand is not a smaller net, an arity is wrong, or a port or
register points nowhere. Leaves alone: what the circuit computes.
"""

from __future__ import annotations

from rplan.circuit.cell import Op
from rplan.circuit.circuit import Circuit
from rplan.lang.diagnostic import InternalError


def check(circuit: Circuit) -> None:
    """Raise `InternalError` unless every rule of `Circuit` holds."""
    for net, cell in enumerate(circuit.cells):
        if len(cell.operands) != cell.op.arity:
            raise InternalError(f"net {net}: {cell.op.value} reads {len(cell.operands)} nets")
        if any(not 0 <= operand < net for operand in cell.operands):
            raise InternalError(f"net {net} reads a net that is not smaller: {cell.operands}")
        limit = {Op.INPUT: len(circuit.inputs), Op.REGISTER: len(circuit.registers), Op.CONSTANT: 2}.get(cell.op)
        if limit is not None and not 0 <= cell.index < limit:
            raise InternalError(f"net {net}: there is no {cell.op.value} {cell.index}")
    nets = [register.next for register in circuit.registers] + [net for _, net in circuit.outputs]
    for net in nets:
        if not 0 <= net < len(circuit.cells):
            raise InternalError(f"there is no net {net}")
