"""The part of a circuit that a person can read at once.

Takes: a circuit, and what is asked for: an output, a percept, a register or a gate. Gives: the gates nearest to it, as
a circuit of their own whose cut wires end in ports that name the gate behind them; and the whole circuit in few
letters, for a page that takes such parts itself (sim/circuit.js, which cuts by the same rules). Leaves alone: how a
part looks (svg.py).

What an output, or a gate, is made of is read backwards; what a percept or a register has a say in, forwards. Of gates
that are as near as each other those with smaller numbers come first.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from difflib import get_close_matches

from rplan.apps.drawing.inspect_words import register_words
from rplan.circuit.build import HOLE
from rplan.circuit.cell import Cell, Op
from rplan.circuit.circuit import Circuit, Port

MOST_SHOWN = 200
"""Gates of a part."""
LETTERS = {Op.CONSTANT: "c", Op.INPUT: "i", Op.REGISTER: "r", Op.NOT: "n", Op.AND: "a", Op.OR: "o"}
NUMBER = re.compile(r"(?:gate|net)?\s*(\d+)")


@dataclass(frozen=True, slots=True)
class Choice:
    """What a part is to show. nets: where it begins; ends: which outputs of the circuit, by number."""

    says: str
    nets: tuple[int, ...]
    ends: tuple[int, ...] = ()
    forwards: bool = False


@dataclass(frozen=True, slots=True)
class Part:
    """A circuit to be drawn. numbers: the net of the whole circuit that each of its nets is; shown: its gates."""

    circuit: Circuit
    numbers: tuple[int, ...]
    shown: int


# --- what is asked for -----------------------------------------------------------------------------


def choice(circuit: Circuit, of: str = "") -> Choice:
    """What `of` names, the first output that is made of gates if it is empty; `ValueError` if nothing is called so."""
    names = [port.name for port, _ in circuit.outputs]
    made = (port.name for port, net in circuit.outputs if port.name != HOLE and circuit.cells[net].operands)
    of = of or next(made, names[0])
    called = [n for n, name in enumerate(names) if of in (name, name.partition("=")[0])]
    if called:
        return Choice(of, tuple(dict.fromkeys(circuit.outputs[n][1] for n in called)), tuple(called))
    sources = _sources(circuit)
    for name in (of, f"({of})"):
        if name in sources:
            return Choice(name, (sources[name],), forwards=True)
    number = NUMBER.fullmatch(of)
    if number and int(number[1]) < len(circuit.cells):
        net = int(number[1])
        return Choice(f"gate {net}", (net,), forwards=not circuit.cells[net].operands)
    raise ValueError(_unknown(of, [*dict.fromkeys(name.partition("=")[0] for name in names), *names, *sources]))


def _unknown(of: str, names: Sequence[str]) -> str:
    near = get_close_matches(of, names, 3, 0.5)
    said = f"; near it: {', '.join(near)}" if near else ""
    return f"nothing in the circuit is called {of}: name an output, a percept, a register, or a gate ('gate 12'){said}"


def _sources(circuit: Circuit) -> dict[str, int]:
    """Percepts and registers by name; a register also by what it is in words."""
    found: dict[str, int] = {}
    for net, cell in enumerate(circuit.cells):
        match cell.op:
            case Op.INPUT:
                found.setdefault(circuit.inputs[cell.index].name, net)
            case Op.REGISTER:
                name = circuit.registers[cell.index].name
                found.setdefault(name, net)
                found.setdefault(register_words(name), net)
            case _:
                pass
    return found


# --- the part --------------------------------------------------------------------------------------


def part(circuit: Circuit, wanted: Choice, most: int = MOST_SHOWN) -> Part:
    """The gates nearest to what is wanted, no more than `most`."""
    return _Cut(circuit, wanted, most).part()


class _Cut:
    def __init__(self, circuit: Circuit, wanted: Choice, most: int) -> None:
        self.circuit, self.wanted = circuit, wanted
        self.readers: list[list[int]] = [[] for _ in circuit.cells]
        for net, cell in enumerate(circuit.cells):
            for operand in dict.fromkeys(cell.operands):
                self.readers[operand].append(net)
        self.shown = self._nearest(most)
        read = {operand for net in self.shown for operand in circuit.cells[net].operands}
        self.numbers = tuple(sorted({*wanted.nets, *self.shown, *read}))
        self.at = {net: n for n, net in enumerate(self.numbers)}

    def _beside(self, net: int) -> Sequence[int]:
        beside = self.readers[net] if self.wanted.forwards else self.circuit.cells[net].operands
        return [one for one in beside if self.circuit.cells[one].operands]

    def _nearest(self, most: int) -> frozenset[int]:
        shown: dict[int, None] = {}
        seen = set(self.wanted.nets)
        level = sorted(seen)
        while level and len(shown) < most:
            shown |= dict.fromkeys([net for net in level if self.circuit.cells[net].operands][: most - len(shown)])
            level = sorted({one for net in level for one in self._beside(net)} - seen)
            seen.update(level)
        return frozenset(shown)

    def part(self) -> Part:
        """What was cut out, ready to be drawn."""
        inputs: list[Port] = []
        cells = tuple(self._cell(net, inputs) for net in self.numbers)
        whole, shown = self.circuit, len(self.shown)
        gates = sum(1 for cell in whole.cells if cell.operands)
        what = "what reads" if self.wanted.forwards else "what makes"
        name = f"{whole.name}: {shown:,} of {gates:,} gates: {what} {self.wanted.says}"
        return Part(Circuit(name, tuple(inputs), (), cells, tuple(self._outputs())), self.numbers, shown)

    def _cell(self, net: int, inputs: list[Port]) -> Cell:
        cell = self.circuit.cells[net]
        if net in self.shown:
            return Cell(cell.op, tuple(self.at[operand] for operand in cell.operands))
        match cell.op:
            case Op.CONSTANT:
                return cell
            case Op.INPUT:
                inputs.append(self.circuit.inputs[cell.index])
            case Op.REGISTER:
                inputs.append(Port(register_words(self.circuit.registers[cell.index].name)))
            case _:
                inputs.append(Port(f"… gate {net}"))
        return Cell(Op.INPUT, (), len(inputs) - 1)

    def _outputs(self) -> list[tuple[Port, int]]:
        """Those that are asked for; where none is, all that leaves what is shown."""
        if self.wanted.ends:
            return [(self.circuit.outputs[n][0], self.at[self.circuit.outputs[n][1]]) for n in self.wanted.ends]
        roots = sorted({*self.wanted.nets, *(self.shown if self.wanted.forwards else ())})
        ends = [*self.circuit.outputs]
        ends += [(Port(f"next {register_words(one.name)}"), one.next) for one in self.circuit.registers]
        return [(port, self.at[net]) for port, net in ends if net in roots] + list(self._read_beyond(roots))

    def _read_beyond(self, roots: Sequence[int]) -> Iterator[tuple[Port, int]]:
        """Where a wire leads on to gates that are not shown."""
        for net in roots:
            away = sum(1 for reader in self.readers[net] if reader not in self.shown)
            if away:
                name = f"gate {net}" if self.circuit.cells[net].operands else self.wanted.says
                yield Port(f"… {away:,} more read{'s' if away == 1 else ''} {name}"), self.at[net]


# --- for pages -------------------------------------------------------------------------------------


def compact(circuit: Circuit) -> dict[str, object]:
    """The circuit for sim/circuit.js: "ops" has a letter for each cell, "a" its first operand or its index, "b" its
    second operand or -1; "outputs" are [name, net, line or 0]."""
    cells = circuit.cells
    return {
        "ops": "".join(LETTERS[cell.op] for cell in cells),
        "a": [cell.operands[0] if cell.operands else cell.index for cell in cells],
        "b": [cell.operands[1] if len(cell.operands) > 1 else -1 for cell in cells],
        "inputs": [port.name for port in circuit.inputs],
        "registers": [[register_words(one.name), one.next] for one in circuit.registers],
        "outputs": [[port.name, net, port.places[0].line if port.places else 0] for port, net in circuit.outputs],
    }
