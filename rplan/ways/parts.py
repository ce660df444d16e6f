"""The parts of a plan's conditions, and where each alone decides.

Takes: `Ways`. Gives: `Asked`: the same ways with more guards, and for each part of each condition the guards under
which it decides as true, and as false. Leaves alone: whether that can be (reach.py) or was seen (tally.py).

A part of a condition is an atom, or a form with memory. It decides in a tick where the condition is asked and would
come out otherwise if only the part were the other way (masking MC/DC; Chilenski 2001, DOT/FAA/AR-01/18).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

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
from rplan.ways.forks import Fork, forks
from rplan.ways.guards import FALSE, TRUE, Guards
from rplan.ways.memory import Registers
from rplan.ways.reduce import Ways


@dataclass(frozen=True, slots=True)
class Part:
    """A part of the condition at `span`. as_true, as_false: it decides so where any of these guards holds."""

    text: str
    span: Span
    rule: str
    as_true: tuple[int, ...]
    as_false: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Asked:
    """ways: those of the plan, with the guards of the parts after its own."""

    ways: Ways
    forks: tuple[Fork, ...]
    parts: tuple[Part, ...]


def asked(ways: Ways) -> Asked:
    """The parts of every condition that the text has, in textual order of the reduced goal."""
    more = replace(ways, guards=Guards(list(ways.guards.nodes), dict(ways.guards.index)))
    every = forks(more)
    looking = _Looking(more)
    return Asked(more, every, tuple(part for fork in every if fork.kind == "if" for part in looking.parts(fork)))


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


class _Looking:
    def __init__(self, ways: Ways) -> None:
        self._ways, self._guards = ways, ways.guards
        self._atoms = {atom.text: number for number, atom in enumerate(ways.atoms)}
        known = {register.name: number for number, register in enumerate(ways.registers)}
        self._again = _Again(self._guards, self._guard_of, known=known)

    def parts(self, fork: Fork) -> Iterator[Part]:
        """Those of the condition of a fork; where it stands in several places, they go together by their order."""
        every = [self._of_node(number) for number in fork.nodes]
        for place, (text, _, _) in enumerate(every[0]):
            here = [parts[place] for parts in every if place < len(parts)]
            as_true, as_false = dict.fromkeys(one for _, one, _ in here), dict.fromkeys(one for _, _, one in here)
            yield Part(text, fork.span, fork.rule, tuple(as_true), tuple(as_false))

    def _of_node(self, number: int) -> list[tuple[str, int, int]]:
        """Each part with the guards under which it decides as true, and as false."""
        goal, g = self._ways.layout.nodes[number].goal, self._guards
        assert isinstance(goal, If)
        found = []
        for part in parts_of(goal.condition):
            text, value = print_condition(part), self._guard_of(part)
            one, other = (self._with(goal.condition, text, guard) for guard in (TRUE, FALSE))
            differs = g.either(g.but_not(one, other), g.but_not(other, one))
            decides = g.both(self._ways.reached[number], differs)
            found.append((text, g.both(decides, value), g.but_not(decides, value)))
        return found

    def _with(self, condition: Condition, part: str, value: int) -> int:
        """The guard of a condition in which a part has this value."""
        if print_condition(condition) == part:
            return value
        match condition:
            case Not(inner):
                return self._guards.negation(self._with(inner, part, value))
            case AllOf(parts):
                return self._guards.all_of(self._with(one, part, value) for one in parts)
            case AnyOf(parts):
                return self._guards.any_of(self._with(one, part, value) for one in parts)
            case _:
                return self._guard_of(condition)

    def _guard_of(self, condition: Condition) -> int:
        match condition:
            case Constant(value):
                return int(value)
            case Percept(text) | Comparison(text):
                return self._guards.atom(self._atoms[text])
            case Memory():
                return self._again.value(condition)
            case Named(name):
                return self._guard_of(self._ways.goals.definitions[name])
            case Not(inner):
                return self._guards.negation(self._guard_of(inner))
            case AllOf(parts):
                return self._guards.all_of(map(self._guard_of, parts))
            case AnyOf(parts):
                return self._guards.any_of(map(self._guard_of, parts))
            case OutputIs():
                raise ValueError("only properties ask for outputs")


@dataclass(slots=True)
class _Again(Registers):
    """Finds the registers of a plan again by their names."""

    known: dict[str, int] = field(default_factory=dict)

    def _new(self, name: str, initial: bool) -> tuple[int, int]:  # noqa: ARG002
        number = self.known[name]
        return number, self.guards.register(number)
