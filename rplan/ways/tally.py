"""What of a plan was reached by the ticks that were seen: ways, branches, and conditions (MC/DC).

Takes: `Asked` (the ways of a plan and the parts of its conditions), and inputs and registers of ticks. Gives:
`Reached`: how often each arm of a fork was taken, for each part of a condition whether it was seen to decide both as
true and as false (parts.py), and what of it can never be. Leaves alone: where ticks come from, and how it is shown.

All ticks are looked at together, one bit a tick.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from rplan.ways.exhaust import classes, evaluate_many
from rplan.ways.forks import Arm, Fork, witness
from rplan.ways.parts import Asked, Part
from rplan.ways.reach import Reach
from rplan.ways.reduce import Ways
from rplan.ways.situations import Trace, Undecided

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
class ValueReached:
    """One value of a part of a condition. seen: it was seen to decide so; never: proven that it cannot.

    guards: it decides so where any of them holds.
    """

    value: bool
    guards: tuple[int, ...]
    seen: bool
    never: bool

    @property
    def word(self) -> str:
        return "true" if self.value else "false"


@dataclass(frozen=True, slots=True)
class PartReached:
    """A part of a condition and its two values, true first."""

    part: Part
    values: tuple[ValueReached, ValueReached]

    @property
    def missing(self) -> str:
        """The values for which it was not seen to decide though it may, in words; empty if there is none."""
        return " or ".join(one.word for one in self.values if not one.seen and not one.never)

    @property
    def never(self) -> str:
        """The values for which it cannot decide, in words; empty if there is none."""
        return " or ".join(one.word for one in self.values if one.never)


@dataclass(frozen=True, slots=True)
class Reached:
    """ways: the signatures of those that were taken; ticks: so many were seen, holes among them."""

    ways: tuple[Bits, ...]
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
        """Values of parts that were seen to decide, and those that can (two a part at most)."""
        every = [one for part in self.parts for one in part.values if not one.never]
        return sum(one.seen for one in every), len(every)


PATIENCE = 1
"""So many questions of a plan may spend the solver's budget; after that none is asked any more."""


class Prover:
    """Says of guards whether any of them can hold, and by what trace, as long as answers are to be had."""

    def __init__(self, ways: Ways) -> None:
        self.reach = Reach(ways)
        self._undecided = 0

    def never(self, guards: Iterable[int]) -> bool:
        """Proven that none of the guards can hold; what is not decided may be."""
        if self._undecided >= PATIENCE:
            return False
        answers = [self.reach.possible((guard, True)) for guard in guards]
        self._undecided += any(isinstance(one, Undecided) for one in answers)
        return all(one is False for one in answers)

    def trace(self, guards: Iterable[int]) -> Trace | None:
        """The simplest trace to one of the guards, where it is at hand."""
        return None if self._undecided >= PATIENCE else witness(self.reach, guards)


def reached(asked: Asked, ticks: Ticks, prover: Prover | None = None) -> Reached:
    """What these ticks reached. prover: of the same ways; without it nothing is said to be never."""
    table = _Table(asked.ways, ticks)
    found = tuple(
        ForkReached(fork, tuple(_arm(arm, table.times(arm.guards), prover) for arm in fork.arms))
        for fork in asked.forks
    )
    parts = tuple(
        PartReached(part, (_value(table, prover, True, part.as_true), _value(table, prover, False, part.as_false)))
        for part in asked.parts
    )
    return Reached(tuple(table.signatures()), sum(ticks.values()), found, parts)


def _arm(arm: Arm, times: int, prover: Prover | None) -> ArmReached:
    return ArmReached(arm, times, not times and prover is not None and prover.never(arm.guards))


def _value(table: _Table, prover: Prover | None, value: bool, guards: tuple[int, ...]) -> ValueReached:
    seen = bool(table.where(guards))
    return ValueReached(value, guards, seen, not seen and prover is not None and prover.never(guards))


class _Table:
    """Every guard in every tick that was seen; bit n is tick n."""

    def __init__(self, ways: Ways, ticks: Ticks) -> None:
        self.ways = ways
        self.counts = list(ticks.values())
        inputs = [inputs for inputs, _ in ticks]
        registers = [registers for _, registers in ticks]
        self.values = evaluate_many(
            ways.guards, _columns(inputs, len(ways.atoms)), len(ticks), _columns(registers, len(ways.registers))
        )

    def where(self, guards: Iterable[int]) -> int:
        """The ticks in which any of the guards holds."""
        seen = 0
        for guard in guards:
            seen |= self.values[guard]
        return seen

    def times(self, guards: Iterable[int]) -> int:
        """In how many ticks any of the guards holds."""
        seen = self.where(guards)
        return sum(count for number, count in enumerate(self.counts) if seen >> number & 1)

    def signatures(self) -> list[Bits]:
        """The different ways that were taken, in the order in which they were seen."""
        guards = tuple(dict.fromkeys(self.ways.signature()))
        first = sorted(ticks & -ticks for ticks in classes(self.ways, self.values, (1 << len(self.counts)) - 1))
        return [tuple(bool(self.values[guard] & tick) for guard in guards) for tick in first]


def _columns(rows: list[Bits], width: int) -> list[int]:
    """Bit n of column c is row n's c-th bit; rows may be shorter."""
    columns = [0] * width
    for number, row in enumerate(rows):
        for place, bit in enumerate(row):
            if bit:
                columns[place] |= 1 << number
    return columns
