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
        self.index: dict[tuple[Op, tuple[int, ...], int], int] = {}

    def put(self, op: Op, operands: tuple[int, ...], index: int = 0) -> int:
        key = op, operands, index
        net = self.index.get(key)
        if net is None:
            net = self.index[key] = len(self.cells)
            self.cells.append(Cell(op, operands, index))
        return net

    def constant(self, value: bool) -> int:
        return self.put(Op.CONSTANT, (), int(value))

    def negation(self, a: int) -> int:
        cell = self.cells[a]
        match cell.op:
            case Op.CONSTANT:
                return self.constant(not cell.index)
            case Op.NOT:
                return cell.operands[0]
            case _:
                return self.put(Op.NOT, (a,))

    def junction(self, op: Op, a: int, b: int) -> int:
        """`and` or `or`: an operand equal to `absorbing` decides, one that is its opposite drops out."""
        absorbing = op is Op.OR
        for x, y in ((a, b), (b, a)):
            cell = self.cells[x]
            if cell.op is Op.CONSTANT:
                return x if bool(cell.index) == absorbing else y
            if cell.op is Op.NOT and cell.operands[0] == y:
                return self.constant(absorbing)
        return a if a == b else self.put(op, (a, b) if a < b else (b, a))


def share(circuit: Circuit) -> Circuit:
    """The circuit with every distinct gate once."""
    table = _Table()
    now: list[int] = []
    for cell in circuit.cells:
        match cell.op:
            case Op.AND | Op.OR:
                now.append(table.junction(cell.op, now[cell.operands[0]], now[cell.operands[1]]))
            case Op.NOT:
                now.append(table.negation(now[cell.operands[0]]))
            case Op.CONSTANT | Op.INPUT | Op.REGISTER:
                now.append(table.put(cell.op, (), cell.index))
    return replace(
        circuit,
        cells=tuple(table.cells),
        registers=tuple(replace(register, next=now[register.next]) for register in circuit.registers),
        outputs=tuple((port, now[net]) for port, net in circuit.outputs),
    )
