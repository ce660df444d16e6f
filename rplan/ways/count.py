"""Ways counted as Bonasso, Antonisse and Slack (1992) count them (L23).

Takes: a reduced goal. Gives: how many ways the compilation of GAPPS enumerates, how many of them are distinct, and how
many are ever taken. Leaves alone: the circuit, which is built without enumerating anything.

Conditions are put into inclusive disjunctive form, one way a disjunct. `prio-and` takes every combination; one with
contradictory preconditions keeps its first goals only. `and` drops combinations with contradictory preconditions, then
those that set one output to two values.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import product

from rplan.goals.condition import AllOf, AnyOf, Comparison, Condition, Constant, Memory, Named, Not, OutputIs, Percept
from rplan.goals.goal import And, Anything, Do, Goal, If, Impossible, Or, PrioAnd, Reduced

Cube = frozenset[tuple[str, bool]]


@dataclass(frozen=True, slots=True)
class PaperWay:
    """A guard (literals: atom and sign), what is set, and how many members of `prio-and`s were dropped on the way."""

    guard: Cube
    acts: frozenset[tuple[str, str]]
    dropped: int = 0


@dataclass(frozen=True, slots=True)
class PaperCount:
    """total as in the paper; distinct: without duplicates; taken: open in some situation with none that drops less."""

    total: int
    distinct: int
    taken: int
    ways: tuple[PaperWay, ...]


def count(goal: Goal) -> PaperCount:
    """Ways of a goal as the paper counts them."""
    ways = _ways(goal)
    by_content: dict[tuple[Cube, frozenset[tuple[str, str]]], PaperWay] = {}
    for way in ways:
        key = (way.guard, way.acts)
        if key not in by_content or way.dropped < by_content[key].dropped:
            by_content[key] = way
    distinct = tuple(by_content.values())
    taken = sum(
        1 for way in distinct if not _covered(way.guard, [w.guard for w in distinct if w.dropped < way.dropped])
    )
    return PaperCount(len(ways), len(distinct), taken, distinct)


def _covered(guard: Cube, others: list[Cube]) -> bool:
    """Whether every situation in which `guard` holds lies in one of the others (splitting on their literals)."""
    restricted = [other - guard for other in others if not _contradictory(other | guard)]
    if any(not other for other in restricted):
        return True
    if not restricted:
        return False
    atom = min(name for name, _ in restricted[0])
    return all(_covered(guard | {(atom, value)}, restricted) for value in (False, True))


def _ways(goal: Goal) -> list[PaperWay]:
    match goal:
        case Do(output=output, value=value):
            return [PaperWay(frozenset(), frozenset([(output, value.text)]))]
        case Anything():
            return [PaperWay(frozenset(), frozenset())]
        case Impossible():
            return []
        case Reduced(goal=inner):
            return _ways(inner)
        case If(condition=condition, then=then, otherwise=otherwise):
            return _guarded(_disjuncts(condition, True), _ways(then)) + _guarded(
                _disjuncts(condition, False), _ways(otherwise)
            )
        case Or(goals):
            return [way for inner in goals for way in _ways(inner)]
        case And(goals):
            joined = [_joined(parts) for parts in product(*map(_ways, goals))]
            return [way for way in joined if not _contradictory(way.guard) and not _conflicting(way)]
        case PrioAnd(goals):
            return [_first_that_go_together(parts) for parts in product(*map(_ways, goals))]


def _guarded(cubes: list[Cube], ways: list[PaperWay]) -> list[PaperWay]:
    pairs = (PaperWay(cube | way.guard, way.acts, way.dropped) for cube, way in product(cubes, ways))
    return [way for way in pairs if not _contradictory(way.guard)]


def _joined(parts: Iterable[PaperWay]) -> PaperWay:
    whole = tuple(parts)
    guard: Cube = frozenset().union(*(way.guard for way in whole))
    acts: frozenset[tuple[str, str]] = frozenset().union(*(way.acts for way in whole))
    return PaperWay(guard, acts, sum(way.dropped for way in whole))


def _first_that_go_together(parts: tuple[PaperWay, ...]) -> PaperWay:
    kept = len(parts)
    while kept > 1 and _contradictory(_joined(parts[:kept]).guard):
        kept -= 1
    way = _joined(parts[:kept])
    return PaperWay(way.guard, way.acts, way.dropped + len(parts) - kept)


def _contradictory(guard: Cube) -> bool:
    return any((atom, not value) in guard for atom, value in guard)


def _conflicting(way: PaperWay) -> bool:
    return len({output for output, _ in way.acts}) < len(way.acts)


def _disjuncts(condition: Condition, wanted: bool) -> list[Cube]:
    """The condition (or its negation) in inclusive disjunctive form, contradictory disjuncts left out."""
    match condition:
        case Constant(value):
            return [frozenset()] if value == wanted else []
        case Percept(text) | Comparison(text) | Memory(text) | Named(text):
            return [frozenset([(text, wanted)])]
        case OutputIs():
            raise ValueError("only properties ask for outputs")
        case Not(inner):
            return _disjuncts(inner, not wanted)
        case AllOf(parts) | AnyOf(parts):
            inner_cubes = [_disjuncts(part, wanted) for part in parts]
            if isinstance(condition, AnyOf) == wanted:
                return [cube for cubes in inner_cubes for cube in cubes]
            joined = (Cube().union(*cubes) for cubes in product(*inner_cubes))
            return [cube for cube in joined if not _contradictory(cube)]
