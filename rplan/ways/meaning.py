"""The reference meaning of a goal in one situation (L12-L18), as plainly as it can be said.

Takes: a reduced goal and a situation (which atoms hold, now and before). Gives: its open ways, and the one taken.
Leaves alone: cost. It builds every way; the compiler (reduce.py) must agree with it and builds none.

A place in a goal is the path of child numbers that leads to it, so that comparing paths compares textual order.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from itertools import product

from rplan.goals.condition import AllOf, AnyOf, Comparison, Condition, Constant, Memory, Named, Not, OutputIs, Percept
from rplan.goals.goal import And, Anything, Do, Goal, If, Impossible, Or, PrioAnd, Reduced, children

Place = tuple[int, ...]
Atoms = Callable[[str], bool]
"""Canonical text of an atom -> whether it holds."""


@dataclass(frozen=True, slots=True)
class Situation:
    """A tick: which atoms hold, the tick before (None: this is the first), and what recursive names stand for.

    acts: what the way taken sets, where a property asks for it.
    """

    atoms: Atoms
    before: Situation | None = None
    definitions: Mapping[str, Condition] = field(default_factory=dict)
    acts: Mapping[str, str] | None = None

    def history(self) -> list[Situation]:
        """This tick and all before it, the latest first."""
        here: Situation | None = self
        found = []
        while here is not None:
            found.append(here)
            here = here.before
        return found


@dataclass(frozen=True, slots=True)
class Way:
    """What one way does: leaves by place, members given up, alternatives chosen; acts: output -> canonical text."""

    leaves: tuple[Place, ...]
    given_up: tuple[Place, ...]
    chosen: tuple[tuple[Place, int], ...]
    acts: tuple[tuple[str, str], ...]


def holds(condition: Condition, situation: Situation) -> bool:
    """Whether a condition holds in a situation."""
    match condition:
        case Constant(value):
            return value
        case Percept(text) | Comparison(text):
            return situation.atoms(text)
        case Named(name):
            return holds(situation.definitions[name], situation)
        case OutputIs(output, value):
            assert situation.acts is not None
            return situation.acts.get(output) == value
        case Memory():
            return _remembered(condition, situation)
        case Not(inner):
            return not holds(inner, situation)
        case AllOf(parts):
            return all(holds(part, situation) for part in parts)
        case AnyOf(parts):
            return any(holds(part, situation) for part in parts)


def _remembered(memory: Memory, situation: Situation) -> bool:
    """A condition that asks the past (L9), said of the whole history."""
    past = situation.history()
    before = past[1:2]

    def held(tick: Situation, condition: int = 0) -> bool:
        return holds(memory.conditions[condition], tick)

    match memory.form:
        case "delay":
            return held(before[0]) if before else memory.initial
        case "once":
            return any(map(held, past))
        case "historically":
            return all(map(held, past))
        case "since":
            return any(held(tick, 1) and all(map(held, past[:ago])) for ago, tick in enumerate(past))
        case "latch":
            return any(
                held(tick) and not any(held(later, 1) for later in past[: ago + 1]) for ago, tick in enumerate(past)
            )
        case "rose":
            return any(held(situation) and not held(tick) for tick in before)
        case "fell":
            return any(not held(situation) and held(tick) for tick in before)
        case "held-for":
            return len(past) >= memory.ticks and all(map(held, past[: memory.ticks]))
        case "within":
            return any(map(held, past[: memory.ticks]))
        case "at-least":
            resets = len(memory.conditions) == 2
            since = next((ago for ago, tick in enumerate(past) if resets and held(tick, 1)), len(past))
            return sum(map(held, past[:since])) >= memory.ticks


def ways(goal: Goal, situation: Situation | Atoms) -> list[Way]:
    """Every open way of a goal in a situation, the preferred one first (L18)."""
    situation = situation if isinstance(situation, Situation) else Situation(situation)
    compatible = (way for way in _ways(goal, (), situation) if not _conflicting(way))
    members, alternatives = _places(goal)
    return sorted(compatible, key=lambda way: _rank(way, members, alternatives))


def taken(goal: Goal, situation: Situation | Atoms) -> Way | None:
    """The way that gives up least; None is a hole."""
    return next(iter(ways(goal, situation)), None)


def _rank(way: Way, members: list[Place], alternatives: list[Place]) -> tuple[tuple[bool, ...], tuple[int, ...]]:
    chosen = dict(way.chosen)
    return (
        tuple(member in way.given_up for member in members),
        tuple(chosen.get(place, -1) for place in alternatives),
    )


def _conflicting(way: Way) -> bool:
    return len({output for output, _ in way.acts}) < len(way.acts)


def _ways(goal: Goal, place: Place, situation: Situation) -> Iterator[Way]:
    match goal:
        case Do(output=output, value=value):
            yield Way((place,), (), (), ((output, value.text),))
        case Anything():
            yield Way((), (), (), ())
        case Impossible():
            return
        case If(condition=condition, then=then, otherwise=otherwise):
            number, branch = (0, then) if holds(condition, situation) else (1, otherwise)
            yield from _ways(branch, (*place, number), situation)
        case Reduced(goal=inner):
            yield from _ways(inner, (*place, 0), situation)
        case And(goals):
            yield from _together(goals, place, situation)
        case Or(goals):
            for number, inner in enumerate(goals):
                for way in _ways(inner, (*place, number), situation):
                    yield Way(way.leaves, way.given_up, ((place, number), *way.chosen), way.acts)
        case PrioAnd(goals):
            for kept in range(len(goals), 0, -1):
                given_up = tuple((*place, number) for number in range(kept, len(goals)))
                for way in _together(goals[:kept], place, situation):
                    yield Way(way.leaves, (*way.given_up, *given_up), way.chosen, way.acts)


def _together(goals: tuple[Goal, ...], place: Place, situation: Situation) -> Iterator[Way]:
    for parts in product(*(list(_ways(goal, (*place, n), situation)) for n, goal in enumerate(goals))):
        yield Way(
            leaves=tuple(leaf for way in parts for leaf in way.leaves),
            given_up=tuple(member for way in parts for member in way.given_up),
            chosen=tuple(choice for way in parts for choice in way.chosen),
            acts=tuple(dict.fromkeys(act for way in parts for act in way.acts)),
        )


def _places(goal: Goal) -> tuple[list[Place], list[Place]]:
    """The members of `prio-and`s that can be given up, and the `or`s, both in textual order."""
    members: list[Place] = []
    alternatives: list[Place] = []

    def visit(here: Goal, place: Place) -> None:
        if isinstance(here, Or):
            alternatives.append(place)
        for number, child in enumerate(children(here)):
            if isinstance(here, PrioAnd) and number > 0:
                members.append((*place, number))
            visit(child, (*place, number))

    visit(goal, ())
    return members, alternatives
