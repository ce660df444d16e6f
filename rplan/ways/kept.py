"""What a plan keeps from tick to tick, in words, and what makes a condition true or false in one tick.

Takes: `Ways`, the values of its atoms and registers in one tick. Gives: `Now`, which says of any condition of the goal
whether it holds and which literals make it so; `Kept`, a condition with memory and what is kept of it. Leaves alone:
what the plan does with that; see why.py.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from rplan.goals.condition import AllOf, AnyOf, Comparison, Condition, Constant, Memory, Named, Not, OutputIs, Percept
from rplan.ways.reduce import Ways


@dataclass(frozen=True, slots=True)
class Literal:
    """A percept, comparison or condition with memory (canonical text), and whether it holds."""

    text: str
    value: bool

    def __str__(self) -> str:
        return f"{self.text} is {'true' if self.value else 'false'}"


@dataclass(frozen=True, slots=True)
class Kept:
    """A condition with memory and what is kept of it before a tick: a truth value, or so many ticks."""

    condition: str
    value: bool | int

    def __str__(self) -> str:
        match self.value:
            case bool():
                return "true" if self.value else "false"
            case count:
                return f"{count} tick{'' if count == 1 else 's'}"


def kept_by(ways: Ways) -> dict[str, tuple[int, ...]]:
    """Text of a condition with memory -> its driving registers; those of a counter from the lowest bit on."""
    found: dict[str, tuple[int, ...]] = {}
    for number, register in enumerate(ways.registers[: ways.driving]):
        text, mark, place = register.name.rpartition("#")
        text = text if mark and place.isdigit() else register.name
        found[text] = (*found.get(text, ()), number)
    return found


def kept(ways: Ways, text: str, registers: Sequence[bool]) -> Kept:
    """What these registers keep of a condition."""
    return _kept(ways, text, kept_by(ways)[text], registers)


def _kept(ways: Ways, text: str, numbers: Sequence[int], registers: Sequence[bool]) -> Kept:
    if ways.registers[numbers[0]].name == text:
        return Kept(text, registers[numbers[0]])
    return Kept(text, sum(registers[number] << place for place, number in enumerate(numbers)))


class Now:
    """One tick. atoms, registers: by number, the driving ones."""

    def __init__(self, ways: Ways, atoms: Sequence[bool], registers: Sequence[bool]) -> None:
        self._definitions = ways.goals.definitions
        self._atoms = {atom.text: value for atom, value in zip(ways.atoms, atoms, strict=False)}
        self._kept = {text: _kept(ways, text, numbers, registers).value for text, numbers in kept_by(ways).items()}

    def holds(self, condition: Condition) -> bool:
        """Whether it holds in this tick."""
        match condition:
            case Constant(value):
                return value
            case Percept(text) | Comparison(text):
                return self._atoms[text]
            case Memory():
                return self._remembered(condition)
            case Named(name):
                return self.holds(self._definitions[name])
            case Not(inner):
                return not self.holds(inner)
            case AllOf(parts):
                return all(map(self.holds, parts))
            case AnyOf(parts):
                return any(map(self.holds, parts))
            case OutputIs():
                raise ValueError("goals ask no outputs")

    def deciding(self, condition: Condition) -> tuple[Literal, ...]:
        """Literals that make it true or false: of parts that each suffice, those of the first."""
        match condition:
            case Constant() | OutputIs():
                return ()
            case Percept(text) | Comparison(text) | Memory(text):
                return (Literal(text, self.holds(condition)),)
            case Named(name):
                return self.deciding(self._definitions[name])
            case Not(inner):
                return self.deciding(inner)
            case AllOf(parts) | AnyOf(parts):
                enough = isinstance(condition, AnyOf)
                first = next((part for part in parts if self.holds(part) == enough), None)
                chosen = parts if first is None else (first,)
                return tuple(dict.fromkeys(literal for part in chosen for literal in self.deciding(part)))

    def _remembered(self, memory: Memory) -> bool:
        """As rplan/ways/memory.py builds it."""
        before = self._kept.get(memory.text, 0)
        if memory.form == "delay":
            return bool(before)
        now = self.holds(memory.conditions[0])
        other = len(memory.conditions) > 1 and self.holds(memory.conditions[1])
        match memory.form:
            case "once" | "within":
                return now or bool(before)
            case "historically" | "fell":
                return bool(before) and now == (memory.form == "historically")
            case "since":
                return other or (now and bool(before))
            case "latch":
                return (now or bool(before)) and not other
            case "rose":
                return now and not before
            case "held-for":
                return now and before == memory.ticks - 1
            case "at-least":
                return before + now >= memory.ticks and not other
