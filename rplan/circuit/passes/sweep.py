"""Take away what no output and no register that matters reads.

Takes: a circuit. Gives: one without dead cells and dead registers; inputs stay, since percepts are the plan's.
Leaves alone: the order of what stays.
"""

from __future__ import annotations

from dataclasses import replace

from rplan.circuit.cell import Op
from rplan.circuit.circuit import Circuit


def sweep(circuit: Circuit) -> Circuit:
    """The circuit without dead cells."""
    live = _live(circuit)
    nets = {old: new for new, old in enumerate(net for net in range(len(circuit.cells)) if live[net])}
    kept = [n for n, _ in enumerate(circuit.registers) if _is_read(circuit, n, live)]
    registers = {old: new for new, old in enumerate(kept)}
    cells = tuple(
        replace(
            circuit.cells[old],
            operands=tuple(nets[operand] for operand in circuit.cells[old].operands),
            index=registers[circuit.cells[old].index]
            if circuit.cells[old].op is Op.REGISTER
            else circuit.cells[old].index,
        )
        for old in nets
    )
    return replace(
        circuit,
        cells=cells,
        registers=tuple(replace(circuit.registers[n], next=nets[circuit.registers[n].next]) for n in kept),
        outputs=tuple((port, nets[net]) for port, net in circuit.outputs),
    )


def _live(circuit: Circuit) -> list[bool]:
    live = [False] * len(circuit.cells)
    waiting = [net for _, net in circuit.outputs]
    while waiting:
        net = waiting.pop()
        if not live[net]:
            live[net] = True
            cell = circuit.cells[net]
            waiting.extend(cell.operands)
            if cell.op is Op.REGISTER:
                waiting.append(circuit.registers[cell.index].next)
    return live


def _is_read(circuit: Circuit, register: int, live: list[bool]) -> bool:
    return any(
        live[net] and cell.op is Op.REGISTER and cell.index == register for net, cell in enumerate(circuit.cells)
    )
