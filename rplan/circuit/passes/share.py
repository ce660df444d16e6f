"""Equal gates become one; constants, double negations and equal or opposite operands are folded.

Takes: a circuit. Gives: one that computes the same outputs with every distinct gate once. Leaves alone: nets that
nobody reads any more; sweep.py takes those away.
"""

from __future__ import annotations

from dataclasses import replace

from rplan.circuit.cell import Cell, Op
from rplan.circuit.circuit import Circuit


class _Table:
    """The new cells, each distinct one once."""

    def __init__(self) -> None:
        self.cells: list[Cell] = []
        self.index: dict[Cell, int] = {}

    def put(self, cell: Cell) -> int:
        if cell not in self.index:
            self.index[cell] = len(self.cells)
            self.cells.append(cell)
        return self.index[cell]

    def constant(self, value: bool) -> int:
        return self.put(Cell(Op.CONSTANT, (), int(value)))

    def negation(self, a: int) -> int:
        cell = self.cells[a]
        match cell.op:
            case Op.CONSTANT:
                return self.constant(not cell.index)
            case Op.NOT:
                return cell.operands[0]
            case _:
                return self.put(Cell(Op.NOT, (a,)))

    def junction(self, op: Op, a: int, b: int) -> int:
        """`and` or `or`: an operand equal to `absorbing` decides, one that is its opposite drops out."""
        absorbing = op is Op.OR
        for x, y in ((a, b), (b, a)):
            cell = self.cells[x]
            if cell.op is Op.CONSTANT:
                return x if bool(cell.index) == absorbing else y
            if cell == Cell(Op.NOT, (y,)):
                return self.constant(absorbing)
        return a if a == b else self.put(Cell(op, (min(a, b), max(a, b))))


def share(circuit: Circuit) -> Circuit:
    """The circuit with every distinct gate once."""
    table = _Table()
    now: list[int] = []
    for cell in circuit.cells:
        operands = tuple(now[operand] for operand in cell.operands)
        match cell.op:
            case Op.NOT:
                now.append(table.negation(operands[0]))
            case Op.AND | Op.OR:
                now.append(table.junction(cell.op, *operands))
            case Op.CONSTANT | Op.INPUT | Op.REGISTER:
                now.append(table.put(cell))
    return replace(
        circuit,
        cells=tuple(table.cells),
        registers=tuple(replace(register, next=now[register.next]) for register in circuit.registers),
        outputs=tuple((port, now[net]) for port, net in circuit.outputs),
    )
