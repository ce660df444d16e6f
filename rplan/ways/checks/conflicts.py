"""Acts that do not go together, and alternatives between which nothing but their order decides.

Takes: a `Reach`. Gives: notes with the simplest situation that shows each. Leaves alone: conflicts that nothing
gives way to; those are holes.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

from rplan.goals.goal import Do, Goal, Or, walk
from rplan.lang.diagnostic import Diagnostic, Related
from rplan.ways.checks.finding import not_decided, places, shown
from rplan.ways.layout import Node
from rplan.ways.reach import Reach
from rplan.ways.reduce import Ways
from rplan.ways.situations import Trace, Undecided, replay
from rplan.ways.way import label, wants

MOST_SHOWN = 100
"""Members given up that are shown with a situation each; the others are counted."""


def check_conflicts(reach: Reach) -> Iterator[Diagnostic]:
    """Members that are given up because an act of theirs does not go together with what is kept."""
    ways = reach.ways
    members = {member.node: member for member in ways.layout.members[1:]}
    found, others = 0, []
    for place in places(ways, lambda node: (node.goal.span, label(node.goal)) if node.number in members else None):
        for node in place.nodes:
            member = members[node.number]
            own = ((ways.given_up[member.before], False),) if member.before else ()
            if found == MOST_SHOWN:
                if reach.possible((ways.given_up[member.number], True), *own) is not False:
                    others.append(node.goal)
                    break
                continue
            trace = reach.trace((ways.given_up[member.number], True), *own)
            if isinstance(trace, Undecided):
                yield not_decided(f"whether {label(node.goal)} is ever given up", node.goal.span)
            elif trace is not None:
                yield _given_up(ways, node, trace)
                found += 1
                break
    if others:
        message = f"{len(others):,} more members are given up in some situation"
        yield Diagnostic("two-values", "note", message, others[0].span)


def _given_up(ways: Ways, node: Node, trace: Trace) -> Diagnostic:
    found = clash(ways, node.number, replay(ways, trace).guards)
    if not found:
        message = f"{label(node.goal)} is given up: no alternative of it goes together with what is kept"
        return shown(ways, trace, "two-values", "note", message, node.goal.span)
    mine, other = found
    return shown(
        ways, trace, "two-values", "note",
        f"these never go together: `{mine.output}` gets two values, and {label(node.goal)} is given up",
        mine.span, (Related(f"{other.value.text} is kept, by {other.rule}", other.span),),
    )  # fmt: skip


def clash(ways: Ways, number: int, values: list[bool]) -> list[Do]:
    """An act that a goal must do and one that is done, or two of its own, that set one output to two values."""
    done = [node.goal for node in ways.layout.nodes if isinstance(node.goal, Do) and values[ways.reached[node.number]]]
    set_to: dict[str, Do] = {}
    for act in done:
        set_to.setdefault(act.output, act)
    for mine in wants(ways, number, values):
        other = set_to.setdefault(mine.output, mine)
        if other.value.text != mine.value.text:
            return [mine, other]
    return []


def check_ties(reach: Reach) -> Iterator[Diagnostic]:
    """Alternatives that give up the same and set different values: the earlier one is taken (L18)."""
    ways = reach.ways
    for place in places(ways, lambda node: node.goal.span if isinstance(node.goal, Or) else None):
        for first, second in combinations(range(len(ways.layout.inside[place.nodes[0].number])), 2):
            yield from _tie(reach, place.nodes, first, second)


def _tie(reach: Reach, nodes: tuple[Node, ...], first: int, second: int) -> Iterator[Diagnostic]:
    ways = reach.ways
    for node in nodes:
        inside = ways.layout.inside[node.number]
        one, other = (ways.layout.nodes[inside[number]].goal for number in (first, second))
        offered = ways.on_offer.get((node.number, second))
        if offered is None or _acts(one) == _acts(other):
            continue
        trace = reach.trace((ways.reached[inside[first]], True), (offered, True))
        if isinstance(trace, Undecided):
            yield not_decided("whether these alternatives tie", node.goal.span)
        elif trace is not None:
            yield shown(
                ways, trace, "tie", "note", f"{label(one)} and {label(other)} go equally well: the first is taken",
                one.span, (Related("the other", other.span),),
            )  # fmt: skip
            return


def _acts(goal: Goal) -> dict[tuple[str, str], None]:
    return {(node.output, node.value.text): None for node in walk(goal) if isinstance(node, Do)}
