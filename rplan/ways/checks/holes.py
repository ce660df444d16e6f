"""Situations in which no way is open, and outputs that must not stay open and do.

Takes: a `Reach`. Gives: an error for each with the simplest trace that shows it. Leaves alone: why a member was
given up.
"""

from __future__ import annotations

from collections.abc import Iterator

from rplan.goals.goal import Do, If
from rplan.lang.diagnostic import Diagnostic, Related
from rplan.ways.checks.finding import not_decided, shown
from rplan.ways.reach import Reach
from rplan.ways.reduce import Ways
from rplan.ways.situations import Trace, Undecided, replay
from rplan.ways.way import taken_way


def check_holes(reach: Reach, allow_holes: bool) -> Iterator[Diagnostic]:
    """A hole is an error, or a warning where holes are allowed (L18)."""
    ways = reach.ways
    trace = reach.trace((ways.hole, True))
    if isinstance(trace, Undecided):
        yield not_decided("whether the plan has a hole", ways.goals.span)
    elif trace is not None:
        clash = _clashing(ways, trace)
        yield shown(
            ways, trace, "hole",
            "warning" if allow_holes else "error",
            f"there is a situation in which no way is open: {_words(clash)}",
            clash[0].span if clash else ways.goals.top.span,
            tuple(Related(f"and here to {do.value.text}", do.span) for do in clash[1:]),
            "let one of them be given up (`prio-and`), or add conditions that keep them apart",
        )  # fmt: skip


def _words(clash: list[Do]) -> str:
    if not clash:
        return "no alternative of what must be done goes together with the rest"
    first, second = clash
    return f"`{first.output}` must be set to {first.value.text} and to {second.value.text}"


def _clashing(ways: Ways, trace: Trace) -> list[Do]:
    """Two acts that must both be and set one output to two values in this situation."""
    values = replay(ways, trace).guards
    must: dict[str, Do] = {}
    passed = [True] * len(ways.layout.nodes)
    for node in ways.layout.nodes:
        if node.parent >= 0:
            passed[node.number] = passed[node.parent] and _branch(ways, node.number, values)
        goal = node.goal
        if isinstance(goal, Do) and passed[node.number] and node.owner == 0 and not node.under:
            other = must.setdefault(goal.output, goal)
            if other.value.text != goal.value.text:
                return [other, goal]
    return []


def _branch(ways: Ways, number: int, values: list[bool]) -> bool:
    parent = ways.layout.nodes[number].parent
    inside = ways.layout.inside[parent]
    if not isinstance(ways.layout.nodes[parent].goal, If):
        return True
    return values[ways.asked[parent]] == (inside[0] == number)


def check_required(reach: Reach) -> Iterator[Diagnostic]:
    """An output that is required and that a way leaves open; a hole is a finding of its own."""
    ways = reach.ways
    for output in ways.goals.outputs:
        if not output.required:
            continue
        unset = tuple((guard, False) for guard in ways.sets.get(output.name, {}).values())
        trace = reach.trace((ways.hole, False), *unset)
        if isinstance(trace, Undecided):
            yield not_decided(f"whether the required output `{output.name}` is always set", output.span)
        elif trace is not None:
            seen = replay(ways, trace)
            taken = taken_way(ways, seen.atoms, seen.registers)
            passed = tuple(
                Related(f"`{branch.condition}` is {'true' if branch.value else 'false'} here", branch.span)
                for branch in taken.branches
            )
            yield shown(
                ways, trace, "left-open", "error",
                f"the required output `{output.name}` is left open in a situation that can be",
                output.span, passed,
                "set it in every branch, or say what stands where it is open (`:idle`)",
            )  # fmt: skip
