"""A circuit as a drawing in SVG.

Takes: a circuit. Gives: an SVG text that needs nothing else: inputs and registers at the left, gates in columns by
depth, outputs and what registers become at the right; places of the plan as tooltips. Leaves alone: circuits of more
than `MOST_GATES` gates, which no one can read (`ValueError`); inspect_circuit_part.py takes a part of them, in which
each gate and each source stands as far right as what reads it lets it.

The layout is that of Sugiyama, Tagawa and Toda (1981): columns by depth, a wire that skips columns has a bend in each
of them, and every column is sorted and spaced by the mean of its neighbours, to and fro.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from html import escape

from rplan.apps.drawing.inspect_words import register_words
from rplan.circuit.cell import Cell, Op
from rplan.circuit.circuit import Circuit, Port

MOST_GATES = 1000
COLUMN, ROW, BEND = 62.0, 26.0, 11.0
"""Pixels from column to column, between two gates of a column, and between a wire and what is beside it."""
MARGIN, LETTER, LONGEST_NAME, LONGEST_END = 24.0, 6.3, 60, 160
"""Letters of a name at the left and of one at the right, where nothing is beside it."""
LONGEST_INSIDE = 32
"""Of a name between gates."""
SWEEPS, PULL = 24, 0.97

STYLE = """
text { font: 11px Helvetica, Arial, sans-serif; fill: #1c2733; }
.head { font-size: 15px; font-weight: bold; }
.wire { fill: none; stroke-width: 1.2; opacity: .75; }
g:hover > .wire { stroke-width: 3; opacity: 1; }
.gate { stroke: #1c2733; stroke-width: 1.2; }
.and { fill: #d7e6f5; } .or { fill: #fbe3c4; } .not { fill: #ffffff; }
.register { fill: #e3d7f2; } .port { fill: #e4efe0; } .constant { fill: #eceff1; }
""".strip()
COLOURS = ("#3b6ea5", "#a5563b", "#4d8a4d", "#7a5aa0", "#9a7d1e", "#2f8c8c", "#b04a7a", "#5c6770")


@dataclass(slots=True)
class _Node:
    """Something in a column, or the bend of a wire. before, after: neighbours in the columns beside it."""

    column: int
    room: float
    y: float = 0.0
    before: list[_Node] = field(default_factory=list)
    after: list[_Node] = field(default_factory=list)


def svg(circuit: Circuit, numbers: Sequence[int] = ()) -> str:
    """The drawing of a circuit; `ValueError` if it is too large to be read.

    numbers: of a part of a circuit, the net of the whole that each of its nets is.
    """
    gates = sum(1 for cell in circuit.cells if cell.operands)
    if gates > MOST_GATES:
        raise ValueError(f"a circuit of {gates:,} gates is too large to be drawn (at most {MOST_GATES:,})")
    return _Drawing(circuit, numbers).text()


class _Drawing:
    def __init__(self, circuit: Circuit, numbers: Sequence[int]) -> None:
        self.circuit, self.numbers = circuit, numbers
        self.nodes = self._sources_and_gates()
        self.last = 1 + max((node.column for node in self.nodes), default=0)
        self.ends = [_Node(self.last, ROW) for _ in range(len(circuit.outputs) + len(circuit.registers))]
        self.drivers = [net for _, net in circuit.outputs] + [register.next for register in circuit.registers]
        if numbers:
            self._late()
        self.bends: list[_Node] = []
        self.chains = [self._chain(net) for net in range(len(self.nodes))]
        _arrange([*self.nodes, *self.bends, *self.ends], self.last)
        self.rooms, self.places = self._columns()

    def _sources_and_gates(self) -> list[_Node]:
        nodes: list[_Node] = []
        for cell in self.circuit.cells:
            column = 1 + max((nodes[operand].column for operand in cell.operands), default=-1)
            nodes.append(_Node(column, ROW))
        return nodes

    def _late(self) -> None:
        """Move everything as far right as what reads it lets it."""
        columns = [self.last] * len(self.nodes)
        for net in range(len(columns) - 1, -1, -1):
            self.nodes[net].column = columns[net] - 1
            for operand in self.circuit.cells[net].operands:
                columns[operand] = min(columns[operand], columns[net] - 1)
        first = min((node.column for node in self.nodes), default=0)
        for node in self.nodes:
            node.column -= first

    def _columns(self) -> tuple[list[float], list[float]]:
        """(room for names, x) of each column."""
        letters = [0] * (self.last + 1)
        for node, cell in zip(self.nodes, self.circuit.cells, strict=True):
            if not cell.operands:
                name = _short(self._label(cell)[0], self._longest(node))
                letters[node.column] = max(letters[node.column], len(name))
        rooms = [LETTER * count for count in letters]
        places = [MARGIN + 22 + rooms[0]]
        for room in rooms[1:]:
            places.append(places[-1] + COLUMN + room)
        return rooms, places

    def _longest(self, node: _Node) -> int:
        return LONGEST_INSIDE if node.column else LONGEST_NAME

    def _chain(self, net: int) -> dict[int, _Node]:
        """The bends of the wire of a net, by column, up to the last column but one in which it is read."""
        node = self.nodes[net]
        readers = [self.nodes[number] for number, cell in enumerate(self.circuit.cells) if net in cell.operands]
        readers += [self.ends[number] for number, driver in enumerate(self.drivers) if driver == net]
        chain: dict[int, _Node] = {node.column: node}
        for column in range(node.column + 1, max((reader.column for reader in readers), default=0)):
            bend = _Node(column, BEND)
            self.bends.append(bend)
            _join(chain[column - 1], bend)
            chain[column] = bend
        for reader in readers:
            _join(chain[reader.column - 1], reader)
        return chain

    # --- text ---

    def text(self) -> str:
        everything = [*self.nodes, *self.bends, *self.ends]
        top = min((node.y for node in everything), default=0.0)
        for node in everything:
            node.y += MARGIN + 40 - top
        ends = [port.name for port, _ in self.circuit.outputs] + [
            f"next {register_words(r.name)}" for r in self.circuit.registers
        ]
        right = 30 + LETTER * max((len(_short(name, LONGEST_END)) for name in ends), default=0)
        width = self._x(self.last) + right + MARGIN
        height = max((node.y for node in everything), default=0.0) + ROW + MARGIN
        lines = [
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.0f}" height="{height:.0f}" '
            f'viewBox="0 0 {width:.0f} {height:.0f}">',
            f"<style>{STYLE}</style>",
            f'<rect width="{width:.0f}" height="{height:.0f}" fill="#ffffff"/>',
            f'<text class="head" x="{MARGIN:g}" y="{MARGIN + 6:g}">{_escaped(self.circuit.name)}</text>',
        ]
        lines += [self._wires(net) for net in range(len(self.nodes)) if self.nodes[net].after]
        lines += [self._cell(net, cell) for net, cell in enumerate(self.circuit.cells) if self.nodes[net].after]
        lines += [self._end(node, name, port) for node, name, port in zip(self.ends, ends, self._ports(), strict=True)]
        return "\n".join([*lines, "</svg>"]) + "\n"

    def _ports(self) -> list[Port]:
        return [port for port, _ in self.circuit.outputs] + [
            Port(register_words(r.name)) for r in self.circuit.registers
        ]

    def _x(self, column: int) -> float:
        return self.places[column]

    def _wires(self, net: int) -> str:
        """Everything that a net drives, as one path in one colour."""
        parts: list[str] = []
        for bend in self.chains[net].values():
            x, y = self._x(bend.column) + (11 if bend is self.nodes[net] else 0), bend.y
            for to in bend.after:
                slots = to.before
                shift = 5.0 * (slots.index(bend) * 2 - 1) if len(slots) == 2 else 0.0
                end, middle = self._x(to.column) - (11 if to in self.ends or to.room == ROW else 0), COLUMN * 0.45
                room = self.rooms[to.column]
                aim = f"{end - room - middle:g} {to.y + shift:.1f} {end - room:g} {to.y + shift:.1f}"
                parts.append(f"M{x:g} {y:.1f}C{x + middle:g} {y:.1f} {aim}" + (f"H{end:g}" if room else ""))
        name = _escaped(self._label(self.circuit.cells[net])[0] or f"net {net}")
        colour = COLOURS[net % len(COLOURS)]
        return f'<g><title>{name}</title><path class="wire" stroke="{colour}" d="{"".join(parts)}"/></g>'

    def _cell(self, net: int, cell: Cell) -> str:
        x, y = self._x(self.nodes[net].column), self.nodes[net].y
        name, said = self._label(cell)
        match cell.op:
            case Op.NOT:
                shape = f"M{x - 11:g} {y - 7:.1f}l16 7l-16 7Zm16 7a3 3 0 1 0 6 0a3 3 0 1 0 -6 0"
            case Op.AND:
                shape = f"M{x - 11:g} {y - 9:.1f}h11a9 9 0 0 1 0 18h-11Z"
            case Op.OR:
                shape = f"M{x - 13:g} {y - 9:.1f}h8q10 0 16 9q-6 9 -16 9h-8q6 -9 0 -18Z"
            case _:
                kind = {Op.INPUT: "port"}.get(cell.op, cell.op.value)
                dot = f'<circle class="gate {kind}" cx="{x + 6:g}" cy="{y:.1f}" r="5"/>'
                short = _escaped(_short(name, self._longest(self.nodes[net])))
                label = f'<text x="{x - 6:g}" y="{y + 4:.1f}" text-anchor="end">{short}</text>'
                return f"<g><title>{_escaped(said)}</title>{dot}{label}</g>"
        number = self.numbers[net] if self.numbers else net
        return f'<g><title>{cell.op.value}, net {number}</title><path class="gate {cell.op.value}" d="{shape}"/></g>'

    def _label(self, cell: Cell) -> tuple[str, str]:
        """(name of what is no gate, its tooltip)."""
        match cell.op:
            case Op.INPUT:
                return self.circuit.inputs[cell.index].name, _said(self.circuit.inputs[cell.index])
            case Op.REGISTER:
                name = register_words(self.circuit.registers[cell.index].name)
                return name, f"register {name}"
            case Op.CONSTANT:
                return ("true" if cell.index else "false",) * 2
            case _:
                return "", ""

    def _end(self, node: _Node, name: str, port: Port) -> str:
        x, y = self._x(node.column), node.y
        kind = "register" if name != port.name else "port"
        dot = f'<rect class="gate {kind}" x="{x - 11:g}" y="{y - 5:.1f}" width="10" height="10"/>'
        label = f'<text x="{x + 6:g}" y="{y + 4:.1f}">{_escaped(_short(name, LONGEST_END))}</text>'
        return f"<g><title>{_escaped(_said(port))}</title>{dot}{label}</g>"


def _join(left: _Node, right: _Node) -> None:
    left.after.append(right)
    right.before.append(left)


def _arrange(nodes: Sequence[_Node], last: int) -> None:
    """Give every node its y: each column in turn is sorted by the mean of the column beside it, and spaced."""
    columns: list[list[_Node]] = [[] for _ in range(last + 1)]
    for node in nodes:
        columns[node.column].append(node)
    for column in columns:
        _space(column, [0.0] * len(column))
    for sweep in range(SWEEPS):
        for column in columns if sweep % 2 == 0 else columns[::-1]:
            column.sort(key=lambda node: _mean(node, sweep))
            _space(column, [_mean(node, sweep) for node in column])


def _mean(node: _Node, sweep: int) -> float:
    """Where its neighbours would have it (those before it, those after it, at last both), a little nearer to the
    middle, so that what hangs together by nothing stays together."""
    both = [*node.before, *node.after]
    beside = both if sweep >= SWEEPS - 6 else (node.before, node.after)[sweep % 2]
    return PULL * sum(one.y for one in beside) / len(beside) if beside else PULL * node.y


def _space(column: list[_Node], wished: list[float]) -> None:
    """As near to what is wished (least squares) as the order and the room between neighbours allow.

    Neighbours that would come too close are pooled into a block that stands at its mean; a block is [sum, count].
    """
    offsets: list[float] = []
    blocks: list[list[float]] = []
    for node, wish in zip(column, wished, strict=True):
        room = (node.room + column[len(offsets) - 1].room) / 2
        offsets.append(offsets[-1] + room if offsets else 0.0)
        blocks.append([wish - offsets[-1], 1])
        while len(blocks) > 1 and blocks[-2][0] / blocks[-2][1] > blocks[-1][0] / blocks[-1][1]:
            total, count = blocks.pop()
            blocks[-1] = [blocks[-1][0] + total, blocks[-1][1] + count]
    starts = [total / count for total, count in blocks for _ in range(int(count))]
    for node, start, offset in zip(column, starts, offsets, strict=True):
        node.y = start + offset


def _said(port: Port) -> str:
    places = ", ".join(dict.fromkeys(map(str, port.places)))
    return port.name + (f" at {places}" if places else "")


def _short(name: str, longest: int) -> str:
    """Without its end; between gates without its middle, since bits of a counter differ in their ends alone."""
    if len(name) <= longest:
        return name
    tail = 12 if longest == LONGEST_INSIDE else 0
    return f"{name[: longest - 1 - tail]}…{name[len(name) - tail :]}"


def _escaped(text: str) -> str:
    return escape("".join(letter if letter.isprintable() else "?" for letter in text))
