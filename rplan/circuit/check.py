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
    arities = {op: op.arity for op in Op}
    limits = {Op.INPUT: len(circuit.inputs), Op.REGISTER: len(circuit.registers), Op.CONSTANT: 2}
    for net, cell in enumerate(circuit.cells):
        operands = cell.operands
        if len(operands) != arities[cell.op]:
            raise InternalError(f"net {net}: {cell.op.value} reads {len(operands)} nets")
        if operands and not 0 <= min(operands) <= max(operands) < net:
            raise InternalError(f"net {net} reads a net that is not smaller: {operands}")
        if not operands and not 0 <= cell.index < limits[cell.op]:
            raise InternalError(f"net {net}: there is no {cell.op.value} {cell.index}")
    nets = [register.next for register in circuit.registers] + [net for _, net in circuit.outputs]
    for net in nets:
        if not 0 <= net < len(circuit.cells):
            raise InternalError(f"there is no net {net}")
