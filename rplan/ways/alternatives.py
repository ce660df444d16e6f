"""The choices between alternatives that have to be weighed against one another.

Takes: a layout. Gives: for each group the list of its choices, the preferred one first; a `PlanError` that names the
goals where they are too many (L19). Leaves alone: which choice is taken; see reduce.py.

`if` branches exclude each other, so their choices are paired, not multiplied: the first choice of one branch goes with
the first of the other. Where one branch has more, the choice is open only where its branch is reached.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product, zip_longest

from rplan.goals.condition import Condition
from rplan.goals.goal import Goal, If, Or
from rplan.lang.diagnostic import Diagnostic, PlanError, Related
from rplan.ways.guards import TRUE, Guards
from rplan.ways.layout import Layout, Node

LIMIT = 4_096


@dataclass(frozen=True, slots=True)
class Choice:
    """One alternative for each `or` that matters: (node number, alternative). guard: where it is on offer."""

    picks: tuple[tuple[int, int], ...] = ()
    guard: int = TRUE

    def agrees(self, node: Node) -> bool:
        """Whether the node is inside what was picked."""
        return set(node.under) <= set(self.picks)


@dataclass(slots=True)
class Alternatives:
    """Enumerates the choices of one group after another."""

    layout: Layout
    guards: Guards
    guard_of: Callable[[Condition], int]
    limit: int = LIMIT

    def choices(self) -> list[list[Choice]]:
        """For each group its choices, in textual order of the alternatives."""
        marks = self._marks()
        found = [[Choice()]]
        for group in range(1, self.layout.groups):
            count = self._count(0, group, marks)
            if count > self.limit:
                raise self._too_many(group, count)
            found.append(self._choices(0, group, marks))
        return found

    def _marks(self) -> list[int]:
        """For each node the groups whose `or`s are in it, as bits."""
        marks = [0] * len(self.layout.nodes)
        for node in reversed(self.layout.nodes):
            if isinstance(node.goal, Or):
                marks[node.number] |= 1 << self.layout.group_of_or[node.number]
            if node.parent >= 0:
                marks[node.parent] |= marks[node.number]
        return marks

    def _count(self, number: int, group: int, marks: list[int]) -> int:
        if not marks[number] >> group & 1:
            return 1
        counts = [self._count(child, group, marks) for child in self.layout.inside[number]]
        match self.layout.nodes[number].goal:
            case If():
                return max(counts)
            case Or():
                return sum(counts)
            case _:
                result = 1
                for count in counts:
                    result *= count
                return result

    def _choices(self, number: int, group: int, marks: list[int]) -> list[Choice]:
        if not marks[number] >> group & 1:
            return [Choice()]
        parts = [self._choices(child, group, marks) for child in self.layout.inside[number]]
        match self.layout.nodes[number].goal:
            case If(condition=condition):
                return self._paired(parts[0], parts[1], self.guard_of(condition))
            case Or():
                return [
                    Choice(((number, n), *choice.picks), choice.guard)
                    for n, choices in enumerate(parts)
                    for choice in choices
                ]
            case _:
                return [self._joined(combination) for combination in product(*parts)]

    def _paired(self, then: list[Choice], otherwise: list[Choice], condition: int) -> list[Choice]:
        pairs = []
        for a, b in zip_longest(then, otherwise):
            if b is None:
                pairs.append(Choice(a.picks, self.guards.both(a.guard, condition)))
            elif a is None:
                pairs.append(Choice(b.picks, self.guards.but_not(b.guard, condition)))
            else:
                inside = self.guards.both(condition, a.guard)
                outside = self.guards.but_not(b.guard, condition)
                pairs.append(Choice((*a.picks, *b.picks), self.guards.either(inside, outside)))
        return pairs

    def _joined(self, parts: tuple[Choice, ...]) -> Choice:
        picks = tuple(pick for part in parts for pick in part.picks)
        return Choice(picks, self.guards.all_of(part.guard for part in parts))

    def _too_many(self, group: int, count: int) -> PlanError:
        ors: list[Goal] = [
            node.goal
            for node in self.layout.nodes
            if isinstance(node.goal, Or) and self.layout.group_of_or[node.number] == group
        ]
        return PlanError(
            [
                Diagnostic(
                    "too-many-alternatives",
                    "error",
                    f"{count:,} ways to choose between alternatives that share outputs; {self.limit:,} are the most",
                    ors[0].span,
                    tuple(Related("multiplied by the alternatives here", goal.span) for goal in ors[1:4]),
                    "let the alternatives set different outputs, or settle them by conditions",
                )
            ]
        )
