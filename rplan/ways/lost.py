"""Every goal that lost in a tick, and the one thing that stood against it.

Takes: `Ways`, the values of its atoms and registers in one tick. Gives: `Lost`, one for each rule and act that the way
taken does not serve, and one for each rule that is served by doing nothing. Leaves alone: what would have to change;
see why_not.py.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal as Word

from rplan.goals.condition import print_condition
from rplan.goals.goal import Anything, Do, If, Or, PrioAnd, Reduced
from rplan.lang.source import Span
from rplan.ways.kept import Literal, Now
from rplan.ways.layout import Node
from rplan.ways.reduce import Ways
from rplan.ways.way import TakenWay, label, wants

Reason = Word["satisfied", "nothing", "condition", "conflict", "alternative", "hole"]


@dataclass(frozen=True, slots=True)
class Lost:
    """A goal that set nothing. because: in words; condition: of the `if` that decided, "" where none did.

    reason: `satisfied`, the fact that operators are to bring about holds, or nothing has to be done to maintain what is
    to be maintained; `nothing`, the rule of what is to be achieved asks for nothing in this situation, be it that it is
    achieved or that the rule steps aside; `condition`, another branch is taken; `conflict`, a
    member of a `prio-and` is given up; `alternative`, another way of an `or` is taken; `hole`, no way is open.
    literals: what makes the condition as it is. part_of: the goal that lost as a whole, where this is a part of it.
    span: of the goal; by: of what stood against it.
    """

    goal: str
    reason: Reason
    because: str
    condition: str
    literals: tuple[Literal, ...]
    part_of: str
    span: Span
    by: Span


def lost(ways: Ways, way: TakenWay, atoms: Sequence[bool], registers: Sequence[bool]) -> tuple[Lost, ...]:
    """The goals that lost, in textual order; `way` is the one that these atoms and registers take."""
    return _Looking(ways, way, atoms, registers).lost()


class _Looking:
    def __init__(self, ways: Ways, way: TakenWay, atoms: Sequence[bool], registers: Sequence[bool]) -> None:
        self.ways, self.way = ways, way
        self.nodes = ways.layout.nodes
        self.now = Now(ways, atoms, registers)
        self.rules = {rule.span for rule in ways.goals.rules}
        every = (*atoms, *(False for _ in ways.atoms[len(atoms) :]))
        values = ways.guards.evaluate(every, (*registers, *(False for _ in ways.registers[len(registers) :])))
        self.values = values
        self.served = [values[guard] for guard in ways.reached]
        self.offered = {pick: values[guard] for pick, guard in ways.on_offer.items()}
        given_up = [m.node for m in ways.layout.members[1:] if values[ways.given_up[m.number]]]
        self.because = dict(zip(given_up, (one.because for one in way.given_up), strict=True))
        self.clash = clashing(wants(ways, 0, values)) if way.hole else ()

    def lost(self) -> tuple[Lost, ...]:
        found = []
        for node in self.nodes:
            if not isinstance(node.goal, Reduced | Do):
                continue
            if not self.served[node.number]:
                found.append(self._unserved(node))
            elif isinstance(node.goal, Reduced) and not self._does_something(node.number):
                found.append(self._asks_for_nothing(node))
        return tuple(found)

    def _unserved(self, node: Node) -> Lost:
        """Blocked where the way leaves the path to it."""
        outermost = node
        while outermost.parent >= 0 and not self.served[outermost.parent]:
            outermost = self.nodes[outermost.parent]
        goal, part_of = label(node.goal), self._part_of(node)
        if outermost.parent < 0:
            return self._in_a_hole(node)
        parent = self.nodes[outermost.parent]
        match parent.goal:
            case If():
                return self._by_condition(node, parent.goal, part_of)
            case Or(span=span):
                because = self._instead(parent, outermost)
                return Lost(goal, "alternative", because, "", (), part_of, node.goal.span, span)
            case _:
                assert isinstance(parent.goal, PrioAnd)
                because, by = self.because[outermost.number], self._against(outermost)
                return Lost(goal, "conflict", because, "", (), part_of, node.goal.span, by)

    def _by_condition(self, node: Node, asked: If, part_of: str) -> Lost:
        literals = self.now.deciding(asked.condition)
        because, condition = said(literals), print_condition(asked.condition)
        return Lost(label(node.goal), "condition", because, condition, literals, part_of, node.goal.span, asked.span)

    def _in_a_hole(self, node: Node) -> Lost:
        """Blocked where a condition leaves it out in any case, else by what does not go together."""
        asked, here = None, node
        while here.parent >= 0:
            above, inside = self.nodes[here.parent], self.ways.layout.inside[here.parent]
            if isinstance(above.goal, If) and here.number != inside[not self.values[self.ways.asked[above.number]]]:
                asked = above.goal
            here = above
        if asked is not None:
            return self._by_condition(node, asked, "")
        return Lost(label(node.goal), "hole", self._no_way(), "", (), "", node.goal.span, self._clash_of(node))

    def _no_way(self) -> str:
        """What must be done and does not go together."""
        if not self.clash:
            return "no way is open: no alternative of what must be done goes together with the rest"
        first, second = self.clash
        return f"no way is open: {first.output} must be {first.value.text} and {second.value.text}"

    def _clash_of(self, node: Node) -> Span:
        """The act that the goal does not go together with; of one that has no part in it, the goal itself."""
        others = [do.span for do in self.clash if do is not node.goal]
        return others[0] if len(others) == 1 else node.goal.span

    def _part_of(self, node: Node) -> str:
        """The outermost rule around it that is not served or does nothing."""
        found, here = "", node
        while here.parent >= 0:
            here = self.nodes[here.parent]
            if isinstance(here.goal, Reduced) and not self._does_something(here.number):
                found = here.goal.head
        return found

    def _against(self, member: Node) -> Span:
        """The act that a member does not go together with, else the member itself."""
        acts = {act.output: act for act in self.way.acts}
        wanted = wants(self.ways, member.number, self.values)
        other = [acts[do.output] for do in wanted if do.output in acts and acts[do.output].value != do.value.text]
        return other[0].span if other else member.goal.span

    def _instead(self, parent: Node, outermost: Node) -> str:
        inside = self.ways.layout.inside[parent.number]
        taken = next(number for number in inside if self.served[number])
        place = f"{label(self.nodes[taken].goal)} is taken"
        if self.offered.get((parent.number, inside.index(outermost.number)), False):
            return f"{place}, which stands before it"
        return f"{place}; this alternative does not go together with what is kept, or gives up more"

    def _does_something(self, number: int) -> bool:
        here = self.nodes[number]
        if not self.served[number] or isinstance(here.goal, Do):
            return self.served[number]
        return any(map(self._does_something, self.ways.layout.inside[number]))

    def _asks_for_nothing(self, node: Node) -> Lost:
        """Its last conditions lead to nothing.

        What is to be maintained then is as it should be, and so is what operators would bring about (L20); of a rule
        for what is to be achieved that is not known.
        """
        asked = [self.nodes[number].goal for number in self._last_ifs(node.number, None)]
        conditions = [goal for goal in asked if isinstance(goal, If)]
        literals = tuple(dict.fromkeys(one for goal in conditions for one in self.now.deciding(goal.condition)))
        by_operators = isinstance(node.goal, Reduced) and node.goal.rule_span not in self.rules
        holds = by_operators or label(node.goal).startswith("(maint ")
        reason: Reason = "satisfied" if holds else "nothing"
        words = "already satisfied" if holds else "asks for nothing"
        words = f"{words}: {said(literals)}" if literals else words
        condition = print_condition(conditions[0].condition) if len(conditions) == 1 else ""
        by = conditions[0].span if conditions else node.goal.span
        part_of = self._part_of(node)
        return Lost(label(node.goal), reason, words, condition, literals, part_of, node.goal.span, by)

    def _last_ifs(self, number: int, asked: int | None) -> list[int]:
        """The innermost `if`s above the places that are served by nothing."""
        here = self.nodes[number].goal
        if not self.served[number]:
            return []
        if isinstance(here, Anything):
            return [] if asked is None else [asked]
        below = number if isinstance(here, If) else asked
        every = (one for child in self.ways.layout.inside[number] for one in self._last_ifs(child, below))
        return [*dict.fromkeys(every)]


def clashing(must: Sequence[Do]) -> tuple[Do, ...]:
    """The first two acts that set one output to two values; none if all go together."""
    first: dict[str, Do] = {}
    for do in must:
        other = first.setdefault(do.output, do)
        if other.value.text != do.value.text:
            return other, do
    return ()


def said(literals: Sequence[Literal]) -> str:
    """Literals as words."""
    return " and ".join(map(str, literals)) or "it is always so"
