"""What the ticks that were seen did not reach of a plan, each with a situation that would.

Takes: `Reached` and a `Prover` of the same ways. Gives: `Missing`, in the order of the text, a bounded number of each
kind, those that have a place with the simplest trace that reaches them. Leaves alone: how many there are in all, which
`Reached` counts, and plans with many forks, whose traces would take long.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import islice

from rplan.lang.source import Span
from rplan.ways.listing import taken_ways
from rplan.ways.reduce import Ways
from rplan.ways.situations import Trace, replay
from rplan.ways.tally import Prover, Reached
from rplan.ways.way import TakenWay, taken_way

LARGE = 200
"""Plans with more forks get no traces."""


@dataclass(frozen=True, slots=True)
class Missing:
    """text: of the branch, or of the part and its value. trace: its last tick reaches it; None: none is at hand."""

    span: Span
    rule: str
    text: str
    trace: Trace | None


@dataclass(frozen=True, slots=True)
class MissingWay:
    way: TakenWay
    trace: Trace


def missing_branches(seen: Reached, prover: Prover, most: int) -> tuple[Missing, ...]:
    """Branches that can be taken and were not; rules themselves are not among them."""
    found = (
        Missing(arm.arm.span, fork.fork.rule, arm.arm.text, _trace(seen, prover, arm.arm.guards))
        for fork in seen.forks
        if fork.fork.kind != "rule"
        for arm in fork.arms
        if not arm.times and not arm.never
    )
    return tuple(islice(found, most))


def missing_conditions(seen: Reached, prover: Prover, most: int) -> tuple[Missing, ...]:
    """Values for which parts of conditions may decide and were not seen to."""
    found = (
        Missing(part.part.span, part.part.rule, f"{part.part.text} as {one.word}", _trace(seen, prover, one.guards))
        for part in seen.parts
        for one in part.values
        if not one.seen and not one.never
    )
    return tuple(islice(found, most))


def missing_ways(seen: Reached, ways: Ways, prover: Prover, most: int) -> tuple[MissingWay, ...]:
    """Ways that can be taken and were not, as far as they show within a few ticks; none of a large plan."""
    if len(seen.forks) > LARGE:
        return ()
    guards = tuple(dict.fromkeys(ways.signature()))
    return tuple(_way(ways, prover, guards, trace) for trace in taken_ways(ways, most, seen.ways))


def _way(ways: Ways, prover: Prover, guards: tuple[int, ...], trace: Trace) -> MissingWay:
    """The way that a trace ends with, by the simplest trace that does."""
    values = replay(ways, trace).guards
    simple = prover.reach.trace((ways.hole, False), *((guard, values[guard]) for guard in guards))
    trace = simple if isinstance(simple, tuple) else trace
    last = replay(ways, trace)
    return MissingWay(taken_way(ways, last.atoms, last.registers), trace)


def _trace(seen: Reached, prover: Prover, guards: Iterable[int]) -> Trace | None:
    return None if len(seen.forks) > LARGE else prover.trace(guards)
