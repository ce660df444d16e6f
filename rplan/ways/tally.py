"""What of a plan was reached by the ticks that were seen: ways, branches, and conditions (MC/DC).

Takes: `Ways`, and inputs and registers of ticks. Gives: `Reached`: how often each arm of a fork was taken, what can
never be, and for each part of a condition whether it was seen to decide both as true and as false. Leaves alone: where
ticks come from, and how it is shown.

A part of a condition is an atom, or a form with memory. It decides in a tick where the condition would come out
otherwise if only it were the other way (masking MC/DC; Chilenski 2001, DOT/FAA/AR-01/18); both values must be seen to
decide. All ticks are looked at together, one bit a tick.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

from rplan.goals.condition import (
    AllOf,
    AnyOf,
    Comparison,
    Condition,
    Constant,
    Memory,
    Named,
    Not,
    OutputIs,
    Percept,
    print_condition,
)
from rplan.goals.goal import If
from rplan.lang.source import Span
from rplan.ways.exhaust import classes, evaluate_many
from rplan.ways.forks import Arm, Fork, forks, taken
from rplan.ways.guards import Guards
from rplan.ways.memory import Registers
from rplan.ways.reach import Reach
from rplan.ways.reduce import Ways
from rplan.ways.situations import Undecided

Bits = tuple[bool, ...]
Ticks = dict[tuple[Bits, Bits], int]
"""Inputs and registers of a tick -> how often it was seen."""


@dataclass(frozen=True, slots=True)
class ArmReached:
    """times: ticks that took it; never: proven that none can."""

    arm: Arm
    times: int
    never: bool


@dataclass(frozen=True, slots=True)
class ForkReached:
    fork: Fork
    arms: tuple[ArmReached, ...]


@dataclass(frozen=True, slots=True)
class PartReached:
    """A part of the condition at `span`; values for which it was seen to decide."""

    text: str
    span: Span
    rule: str
    as_true: bool
    as_false: bool

    @property
    def missing(self) -> str:
        """The values for which it was not seen to decide, in words; empty if there is none."""
        return " or ".join(word for word, seen in (("true", self.as_true), ("false", self.as_false)) if not seen)


@dataclass(frozen=True, slots=True)
class Reached:
    """ways: so many different ones were taken; ticks: seen, holes among them."""

    ways: int
    ticks: int
    forks: tuple[ForkReached, ...]
    parts: tuple[PartReached, ...]

    @property
    def arms(self) -> tuple[int, int]:
        """Arms taken, and those that can be (rules themselves are not counted)."""
        every = [arm for fork in self.forks if fork.fork.kind != "rule" for arm in fork.arms if not arm.never]
        return sum(arm.times > 0 for arm in every), len(every)

    @property
    def conditions(self) -> tuple[int, int]:
        """Values of parts that were seen to decide, of all (two a part)."""
        return sum(part.as_true + part.as_false for part in self.parts), 2 * len(self.parts)


def reached(ways: Ways, ticks: Ticks, reach: Reach | None = None) -> Reached:
    """What these ticks reached. reach: to prove what can never be; without it nothing is said to be never."""
    table = _Table(ways, ticks)
    found = tuple(
        ForkReached(fork, tuple(_arm(arm, table.times(arm.guards), reach) for arm in fork.arms)) for fork in forks(ways)
    )
    seen = classes(ways, table.values, table.every & ~table.values[ways.hole]) if ticks else 0
    return Reached(seen, sum(ticks.values()), found, tuple(_parts(ways, table, found)))


def _arm(arm: Arm, times: int, reach: Reach | None) -> ArmReached:
    answer: bool | Undecided = True if times or reach is None else taken(reach, arm)
    return ArmReached(arm, times, answer is False)


class _Table:
    """Every guard in every tick that was seen; bit n is tick n."""

    def __init__(self, ways: Ways, ticks: Ticks) -> None:
        self.ways = ways
        self.counts = list(ticks.values())
        self.every = (1 << len(ticks)) - 1
        self.guards = Guards(list(ways.guards.nodes), dict(ways.guards.index))
        self._atoms = {atom.text: number for number, atom in enumerate(ways.atoms)}
        self._again = _Again(self.guards, self.guard_of, known=_numbers(ways))
        asked = [node.goal.condition for node in ways.layout.nodes if isinstance(node.goal, If)]
        for condition in asked:
            for part in parts_of(condition):
                self.guard_of(part)
        inputs = [inputs for inputs, _ in ticks]
        registers = [registers for _, registers in ticks]
        self.values = evaluate_many(
            self.guards, _columns(inputs, len(ways.atoms)), len(ticks), _columns(registers, len(ways.registers))
        )

    def times(self, guards: Iterable[int]) -> int:
        """In how many ticks any of the guards holds."""
        seen = 0
        for guard in guards:
            seen |= self.values[guard]
        return sum(count for number, count in enumerate(self.counts) if seen >> number & 1)

    def value(self, condition: Condition) -> int:
        """Where a condition holds."""
        return self.values[self.guard_of(condition)]

    def guard_of(self, condition: Condition) -> int:
        match condition:
            case Constant(value):
                return int(value)
            case Percept(text) | Comparison(text):
                return self.guards.atom(self._atoms[text])
            case Memory():
                return self._again.value(condition)
            case Named(name):
                return self.guard_of(self.ways.goals.definitions[name])
            case Not(inner):
                return self.guards.negation(self.guard_of(inner))
            case AllOf(parts):
                return self.guards.all_of(map(self.guard_of, parts))
            case AnyOf(parts):
                return self.guards.any_of(map(self.guard_of, parts))
            case OutputIs():
                raise ValueError("only properties ask for outputs")


@dataclass(slots=True)
class _Again(Registers):
    """Finds the registers of a plan again by their names."""

    known: dict[str, int] = field(default_factory=dict)

    def _new(self, name: str, initial: bool) -> tuple[int, int]:  # noqa: ARG002
        number = self.known[name]
        return number, self.guards.register(number)


def _numbers(ways: Ways) -> dict[str, int]:
    return {register.name: number for number, register in enumerate(ways.registers)}


def _columns(rows: list[Bits], width: int) -> list[int]:
    """Bit n of column c is row n's c-th bit; rows may be shorter."""
    columns = [0] * width
    for number, row in enumerate(rows):
        for place, bit in enumerate(row):
            if bit:
                columns[place] |= 1 << number
    return columns


# --- conditions ---


def parts_of(condition: Condition) -> Iterator[Condition]:
    """The parts of a condition that may decide it, in textual order, once each."""
    seen: dict[str, Condition] = {}
    stack = [condition]
    while stack:
        here = stack.pop()
        match here:
            case Not(inner):
                stack.append(inner)
            case AllOf(parts) | AnyOf(parts):
                stack += reversed(parts)
            case Constant():
                pass
            case _:
                seen.setdefault(print_condition(here), here)
    yield from seen.values()


def _parts(ways: Ways, table: _Table, found: tuple[ForkReached, ...]) -> Iterator[PartReached]:
    for fork in (one.fork for one in found if one.fork.kind == "if"):
        seen: dict[str, tuple[bool, bool]] = {}
        for number in fork.nodes:
            goal = ways.layout.nodes[number].goal
            assert isinstance(goal, If)
            asked = table.values[ways.reached[number]]
            for place, part in enumerate(parts_of(goal.condition)):
                name = print_condition(part)
                key = name if len(fork.nodes) == 1 else f"{place}"
                decides = asked & _decides(table, goal.condition, name)
                value = table.value(part)
                before = seen.get(key, (False, False))
                seen[key] = before[0] or bool(decides & value), before[1] or bool(decides & ~value)
        first = ways.layout.nodes[fork.nodes[0]].goal
        assert isinstance(first, If)
        for part, (as_true, as_false) in zip(parts_of(first.condition), seen.values(), strict=False):
            yield PartReached(print_condition(part), fork.span, fork.rule, as_true, as_false)


def _decides(table: _Table, condition: Condition, part: str) -> int:
    """Where the condition would come out otherwise if only this part were the other way."""
    return _with(table, condition, part, table.every) ^ _with(table, condition, part, 0)


def _with(table: _Table, condition: Condition, part: str, value: int) -> int:
    """Where a condition holds if a part of it has this value."""
    if print_condition(condition) == part:
        return value
    match condition:
        case Not(inner):
            return table.every ^ _with(table, inner, part, value)
        case AllOf(parts):
            found = table.every
            for one in parts:
                found &= _with(table, one, part, value)
            return found
        case AnyOf(parts):
            found = 0
            for one in parts:
                found |= _with(table, one, part, value)
            return found
        case _:
            return table.value(condition)
