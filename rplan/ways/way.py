"""The way that a tick took, in the words of the plan.

Takes: `Ways` and the atoms' values in one situation. Gives: `TakenWay`: the acts with their rules and places, the
branches on the way, and the members that were given up, each with what stood against it. Leaves alone: how it is shown.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from rplan.goals.condition import print_condition
from rplan.goals.goal import Do, Goal, If, Or, Reduced
from rplan.lang.source import Span
from rplan.ways.reduce import Ways


@dataclass(frozen=True, slots=True)
class Act:
    """`rule` set `output` to `value` (canonical text)."""

    output: str
    value: str
    rule: str
    span: Span


@dataclass(frozen=True, slots=True)
class Branch:
    """An `if` that was passed, and whether its condition held."""

    condition: str
    value: bool
    rule: str
    span: Span


@dataclass(frozen=True, slots=True)
class GivenUp:
    """A member of a `prio-and` that was not served, and why."""

    member: str
    because: str
    span: Span


@dataclass(frozen=True, slots=True)
class TakenWay:
    """rules: heads of the rules that were served, in textual order, once each. A hole has nothing in it."""

    hole: bool
    rules: tuple[str, ...]
    branches: tuple[Branch, ...]
    acts: tuple[Act, ...]
    given_up: tuple[GivenUp, ...]


def taken_way(ways: Ways, atoms: Sequence[bool], registers: Sequence[bool] = ()) -> TakenWay:
    """The way taken where atoms and registers (by number, the driving ones) have these values."""
    atoms = (*atoms, *(False for _ in ways.atoms[len(atoms) :]))
    every = (*registers, *(False for _ in ways.registers[len(registers) :]))
    values = ways.guards.evaluate(atoms, every)
    served = [node for node in ways.layout.nodes if values[ways.reached[node.number]]]
    acts = tuple(
        Act(node.goal.output, node.goal.value.text, node.goal.rule, node.goal.span)
        for node in served
        if isinstance(node.goal, Do)
    )
    return TakenWay(
        hole=values[ways.hole],
        rules=tuple(dict.fromkeys(node.goal.head for node in served if isinstance(node.goal, Reduced))),
        branches=tuple(
            Branch(
                print_condition(node.goal.condition), values[ways.asked[node.number]], node.goal.rule, node.goal.span
            )
            for node in served
            if isinstance(node.goal, If)
        ),
        acts=acts,
        given_up=tuple(
            GivenUp(label(member.goal), _because(ways, member.node, member.before, values, acts), member.goal.span)
            for member in ways.layout.members[1:]
            if values[ways.given_up[member.number]]
        ),
    )


def label(goal: Goal) -> str:
    """A short name of a goal."""
    match goal:
        case Reduced(head=head):
            return head
        case Do(output=output, value=value):
            return f"(do {output} {value.text})"
        case _:
            return f"the {type(goal).__name__.lower().replace('prioand', 'prio-and')} at {goal.span.line}"


def _because(ways: Ways, node: int, before: int, values: list[bool], acts: tuple[Act, ...]) -> str:
    if before and values[ways.given_up[before]]:
        return f"it comes after {label(ways.layout.members[before].goal)}, which is given up"
    set_to = {act.output: act for act in acts}
    wanted: dict[str, str] = {}
    for do in wants(ways, node, values):
        other = set_to.get(do.output)
        if other is not None and other.value != do.value.text:
            return f"{do.output} would be {do.value.text}, and {other.rule} sets it to {other.value}"
        if wanted.setdefault(do.output, do.value.text) != do.value.text:
            return f"it sets {do.output} both to {wanted[do.output]} and to {do.value.text}"
    return "no alternative of it goes together with what is kept"


def wants(ways: Ways, number: int, values: list[bool]) -> list[Do]:
    """What a goal must set in this situation, alternatives left out."""
    node = ways.layout.nodes[number]
    inside = ways.layout.inside[number]
    match node.goal:
        case Do():
            return [node.goal]
        case If():
            return wants(ways, inside[0 if values[ways.asked[number]] else 1], values)
        case Or():
            return []
        case _:
            must = [child for child in inside if ways.layout.nodes[child].owner == node.owner]
            return [do for child in must for do in wants(ways, child, values)]
