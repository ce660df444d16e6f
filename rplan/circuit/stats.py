"""What a circuit costs.

Takes: a circuit. Gives: gates, depth, registers, operations of a tick. Leaves alone: seconds; benchmarks measure those.
"""

from __future__ import annotations

from dataclasses import dataclass

from rplan.circuit.circuit import Circuit


@dataclass(frozen=True, slots=True)
class Stats:
    """gates: not, and, or. depth: gates on the longest path. operations: what every tick does, gates and registers."""

    inputs: int
    outputs: int
    registers: int
    gates: int
    depth: int
    operations: int


def stats(circuit: Circuit) -> Stats:
    """The costs of a circuit, the same in every tick."""
    depths: list[int] = []
    for cell in circuit.cells:
        depths.append(1 + max(depths[operand] for operand in cell.operands) if cell.operands else 0)
    gates = sum(1 for cell in circuit.cells if cell.operands)
    ends = [net for _, net in circuit.outputs] + [register.next for register in circuit.registers]
    return Stats(
        inputs=len(circuit.inputs),
        outputs=len(circuit.outputs),
        registers=len(circuit.registers),
        gates=gates,
        depth=max((depths[net] for net in ends), default=0),
        operations=gates + len(circuit.registers),
    )
