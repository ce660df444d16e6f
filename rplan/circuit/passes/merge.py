"""Nets that are equal, or opposite, in every situation become one; nets that never change become constants.

Takes: a circuit. Gives: one that computes the same outputs and next registers, shared anew. Leaves alone: circuits
that read more than 20 inputs and registers together or are too large to try out, and nets that nobody reads any more.

Every assignment of inputs and registers is tried, as many at a time as a word of `CHUNK` bits holds, and the nets are
parted into classes by what they say; so what is merged is proved equal, not guessed. Registers count as free: what
holds only in reachable states is not used.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from rplan.circuit.cell import Cell, Op
from rplan.circuit.circuit import Circuit
from rplan.circuit.passes.share import share

MOST_VARIABLES = 20
MOST_BITS = 1 << 32
"""Nets times assignments; that takes about half a second."""
CHUNK = 14
"""Variables tried out within one word; the others are constant in it."""

Variable = tuple[Op, int]


def merge(circuit: Circuit) -> Circuit:
    """The circuit with every distinct function of inputs and registers once, up to negation."""
    names = variables(circuit)
    if len(names) > MOST_VARIABLES or len(circuit.cells) << len(names) > MOST_BITS:
        return circuit
    classes, phases = _classes(circuit, names)
    first: dict[int, int] = {classes[0]: -1}
    cells: list[Cell] = []
    now: list[int] = []
    for net, cell in enumerate(circuit.cells):
        known = first.get(classes[net + 1])
        if known is None:
            first[classes[net + 1]] = net
            cells.append(replace(cell, operands=tuple(now[operand] for operand in cell.operands)))
        elif known < 0:
            cells.append(Cell(Op.CONSTANT, (), phases[net + 1]))
        elif phases[known + 1] == phases[net + 1]:
            now.append(now[known])
            continue
        else:
            cells.append(Cell(Op.NOT, (now[known],)))
        now.append(len(cells) - 1)
    merged = replace(
        circuit,
        cells=tuple(cells),
        registers=tuple(replace(register, next=now[register.next]) for register in circuit.registers),
        outputs=tuple((port, now[net]) for port, net in circuit.outputs),
    )
    return share(merged)


def variables(circuit: Circuit) -> list[Variable]:
    """The inputs and registers that some cell reads, in the order of the cells."""
    return list(dict.fromkeys((c.op, c.index) for c in circuit.cells if c.op in (Op.INPUT, Op.REGISTER)))


def tables(circuit: Circuit, names: Sequence[Variable]) -> Iterator[tuple[int, list[int]]]:
    """(mask, the value of every net) for one chunk of all assignments after the other, one bit an assignment."""
    inside = min(len(names), CHUNK)
    mask = (1 << (1 << inside)) - 1
    patterns = {name: mask // ((1 << (1 << n)) + 1) << (1 << n) for n, name in enumerate(names[:inside])}
    for chunk in range(1 << (len(names) - inside)):
        high = {name: mask if chunk >> n & 1 else 0 for n, name in enumerate(names[inside:])}
        yield mask, values(circuit, patterns | high, mask)


def values(circuit: Circuit, assigned: dict[Variable, int], mask: int) -> list[int]:
    """The value of every net, bit by bit."""
    nets: list[int] = []
    for cell in circuit.cells:
        match cell.op:
            case Op.CONSTANT:
                nets.append(mask if cell.index else 0)
            case Op.INPUT | Op.REGISTER:
                nets.append(assigned[cell.op, cell.index])
            case Op.NOT:
                nets.append(nets[cell.operands[0]] ^ mask)
            case Op.AND:
                nets.append(nets[cell.operands[0]] & nets[cell.operands[1]])
            case Op.OR:
                nets.append(nets[cell.operands[0]] | nets[cell.operands[1]])
    return nets


def _classes(circuit: Circuit, names: Sequence[Variable]) -> tuple[list[int], list[int]]:
    """For the constant false and then each net: its class, and whether it is true where all variables are false."""
    classes = [0] * (len(circuit.cells) + 1)
    phases: list[int] = []
    for mask, nets in tables(circuit, names):
        seen = [0, *nets]
        phases = phases or [value & 1 for value in seen]
        index: dict[tuple[int, int], int] = {}
        for number, (value, phase) in enumerate(zip(seen, phases, strict=True)):
            key = classes[number], value ^ mask if phase else value
            classes[number] = index.setdefault(key, len(index))
        if len(index) == len(seen):
            break
    return classes, phases
