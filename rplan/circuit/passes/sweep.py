"""Take away what no output and no register reads.

Takes: a circuit. Gives: one without dead cells; inputs stay, since percepts are the plan's, and registers stay,
since recordings explain by them what was remembered.
Leaves alone: the order of what stays.
"""

from __future__ import annotations

from dataclasses import replace

from rplan.circuit.cell import Cell
from rplan.circuit.circuit import Circuit


def sweep(circuit: Circuit) -> Circuit:
    """The circuit without dead cells."""
    live = _live(circuit)
    if all(live):
        return circuit
    nets = {old: new for new, old in enumerate(net for net in range(len(circuit.cells)) if live[net])}
    cells = (circuit.cells[old] for old in nets)
    return replace(
        circuit,
        cells=tuple(
            Cell(cell.op, tuple([nets[operand] for operand in cell.operands])) if cell.operands else cell
            for cell in cells
        ),
        registers=tuple(replace(register, next=nets[register.next]) for register in circuit.registers),
        outputs=tuple((port, nets[net]) for port, net in circuit.outputs),
    )


def _live(circuit: Circuit) -> list[bool]:
    live = [False] * len(circuit.cells)
    waiting = [net for _, net in circuit.outputs] + [register.next for register in circuit.registers]
    while waiting:
        net = waiting.pop()
        if not live[net]:
            live[net] = True
            waiting.extend(circuit.cells[net].operands)
    return live
