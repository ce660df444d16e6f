"""Where the ways of a plan part: rules, and inside them branches, alternatives and members that can be given up.

Takes: `Ways`. Gives: `Fork`s, one a place of the text, each with its `Arm`s and the guards under which an arm is taken.
Leaves alone: whether an arm can be taken (reach.py) or has been (tally.py). A rule that stands in several places is
one rule; what operators generate has no place of its own and is left out.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import Literal

from rplan.goals.condition import print_condition
from rplan.goals.goal import Anything, Do, Goal, If, Impossible, Or, PrioAnd, Reduced
from rplan.lang.source import Span
from rplan.ways.layout import Node
from rplan.ways.reach import Reach
from rplan.ways.reduce import Ways
from rplan.ways.situations import Trace, Undecided
from rplan.ways.way import label

Kind = Literal["rule", "if", "or", "prio-and"]


@dataclass(frozen=True, slots=True)
class Arm:
    """One way on. guards: it is taken where any of them holds; span: of the goal that follows."""

    text: str
    span: Span
    guards: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Fork:
    """rule: head of the rule in the text; owner: the rule's place (the top goal's is that of the goal itself)."""

    kind: Kind
    span: Span
    rule: str
    owner: Span
    arms: tuple[Arm, ...]
    nodes: tuple[int, ...]


@dataclass(slots=True)
class _Group:
    kind: Kind
    rule: str
    owner: Span
    nodes: list[Node] = field(default_factory=list)


def forks(ways: Ways) -> tuple[Fork, ...]:
    """Every fork, in textual order of the reduced goal; rules that nothing asks for are not among them."""
    heads = {rule.span: rule.head for rule in ways.goals.rules}
    owners: list[Span] = []
    groups: dict[tuple[Kind, Span], _Group] = {}
    for node in ways.layout.nodes:
        above = owners[node.parent] if node.parent >= 0 else node.goal.span
        owner = node.goal.rule_span if isinstance(node.goal, Reduced) else above
        owners.append(owner)
        place = _place(node.goal)
        if place is not None:
            group = groups.setdefault(place, _Group(place[0], heads.get(owner, "the top goal"), owner))
            group.nodes.append(node)
    return tuple(_fork(ways, span, group) for (_, span), group in groups.items())


def _place(goal: Goal) -> tuple[Kind, Span] | None:
    match goal:
        case Reduced(rule_span=span):
            return "rule", span
        case If(span=span, generated=False):
            return "if", span
        case Or(span=span):
            return "or", span
        case PrioAnd(span=span):
            return "prio-and", span
        case _:
            return None


def _fork(ways: Ways, span: Span, group: _Group) -> Fork:
    return Fork(
        group.kind, span, group.rule, group.owner, tuple(_arms(ways, group)), tuple(node.number for node in group.nodes)
    )


def _arms(ways: Ways, group: _Group) -> Iterator[Arm]:
    if group.kind == "rule":
        yield Arm("the rule is served", group.owner, tuple(ways.reached[node.number] for node in group.nodes))
        return
    first = group.nodes[0]
    for number in range(len(ways.layout.inside[first.number])):
        inside = [ways.layout.inside[node.number] for node in group.nodes]
        here = [children[number] for children in inside if number < len(children)]
        goal = ways.layout.nodes[here[0]].goal
        if group.kind == "prio-and" and number == 0:
            continue
        text = _text(first.goal, goal, number)
        yield Arm(text, goal.span, tuple(dict.fromkeys(ways.reached[child] for child in here)))


def _text(goal: Goal, inner: Goal, number: int) -> str:
    match goal:
        case If(condition=condition):
            said = print_condition(condition)
            return f"{said if number == 0 else opposite(said)} → {short(inner)}"
        case Or():
            return f"alternative {number + 1} → {short(inner)}"
        case _:
            return f"member {number + 1} → {short(inner)}"


def opposite(said: str) -> str:
    """The negation of a condition's text, without two in a row."""
    return said[5:-1] if said.startswith("(not ") else f"(not {said})"


def short(goal: Goal) -> str:
    """A goal in a few words."""
    match goal:
        case Anything():
            return "(do anything)"
        case Impossible():
            return "no way"
        case Do() | Reduced():
            return label(goal)
        case If(condition=condition):
            return f"(if {print_condition(condition)} …)"
        case _:
            return f"{label(goal).split()[1]} at line {goal.span.line}"


def taken(reach: Reach, arm: Arm) -> bool | Undecided:
    """Whether an arm can be taken in some tick."""
    unknown: bool | Undecided = False
    for guard in arm.guards:
        answer = reach.possible((guard, True))
        if answer is True:
            return True
        unknown = answer if isinstance(answer, Undecided) else unknown
    return unknown


def witness(reach: Reach, guards: Iterable[int]) -> Trace | None:
    """The simplest trace whose last tick has one of the guards; None if there is none, or it is not decided."""
    ticks = [(tick, guard) for guard in guards if isinstance(tick := reach.first_tick((guard, True)), int)]
    if not ticks:
        return None
    trace = reach.trace((min(ticks)[1], True))
    return trace if isinstance(trace, tuple) else None
