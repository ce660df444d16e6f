"""What compiling costs: gates grow with the text, alternatives multiply only where they share outputs (L19)."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from properties.texts import compiled, findings, said

from rplan.circuit.build import build
from rplan.circuit.passes import run
from rplan.circuit.stats import stats
from rplan.driver import NO_LIBRARIES
from rplan.goals.expand import expand
from rplan.lang.depth import deep_recursion
from rplan.lang.diagnostic import PlanError
from rplan.lang.parse import parse_text
from rplan.lang.source import Source
from rplan.ways.reduce import reduce


def gates(text: str) -> int:
    with deep_recursion():
        goals, _ = expand(parse_text(Source("test.rplan", text))[0], NO_LIBRARIES)
        return stats(run(build(reduce(goals)))).gates


def rule(n: int, then: str = "") -> str:
    return f"(defgoalr (ach r{n}) (prio-and (when (c{n}) (do x{n % 5} v{n % 7})) {then}))\n"


def flat(joint: str) -> Callable[[int], str]:
    return lambda count: (
        "".join(map(rule, range(count))) + f"(goalem ({joint} {' '.join(f'(ach r{n})' for n in range(count))}))"
    )


def nested(count: int) -> str:
    rules = [rule(n, f"(ach r{n + 1})") for n in range(count - 1)]
    return "".join([*rules, rule(count - 1), "(goalem (ach r0))"])


@pytest.mark.rule("L19")
@pytest.mark.parametrize("plan", [flat("prio-and"), flat("and"), nested], ids=["priorities", "conjunction", "nested"])
def test_without_alternatives_gates_grow_linearly_with_the_rules(plan: Callable[[int], str]) -> None:
    ten, hundred, thousand = (gates(plan(count)) for count in (10, 100, 1_000))
    assert ten < hundred
    assert 8 * hundred < thousand < 12 * hundred
    steps = [gates(plan(count)) for count in (315, 630, 945)]
    assert steps[2] - steps[1] == steps[1] - steps[0], "outputs and values repeat every 35 rules"


def independent(count: int) -> str:
    parts = " ".join(f"(or (do x{n} a) (do x{n} b)) (when (c{n}) (do x{n} b))" for n in range(count))
    return f"(goalem (and {parts}))"


@pytest.mark.rule("L19")
def test_twenty_alternatives_that_share_no_output_are_twenty_times_one() -> None:
    one = stats(compiled(independent(1)).circuit).gates
    assert 0 < stats(compiled(independent(20)).circuit).gates == 20 * one


@pytest.mark.rule("L19")
def test_alternatives_that_share_an_output_are_refused_past_the_limit_with_the_goals_named() -> None:
    found = findings("(goalem (and\n" + "\n".join("(or (do x a) (do x b))" for _ in range(13)) + "))")
    (wrong,) = [d for d in found if d.severity == "error"]
    assert wrong.code == "too-many-alternatives"
    assert "8,192" in wrong.message
    assert "4,096" in wrong.message
    assert [wrong.span.line, *(related.span.line for related in wrong.related)] == [2, 3, 4, 5]


@pytest.mark.rule("L19")
def test_alternatives_share_an_output_also_through_others() -> None:
    chain = "(goalem (and (or (do a one) (do b one)) (or (do b two) (do c one)) (or (do c two) (do d one))))"
    assert refused(chain, 7)
    assert not refused(chain, 8)


def refused(text: str, limit: int) -> bool:
    goals, _ = expand(parse_text(Source("test.rplan", text))[0], NO_LIBRARIES)
    try:
        reduce(goals, limit=limit)
    except PlanError as error:
        assert said(error.diagnostics) == ["too-many-alternatives"]
        return True
    return False


@pytest.mark.rule("L19")
def test_alternatives_of_branches_that_exclude_each_other_do_not_multiply() -> None:
    branches = "(if (c) (or (do x one) (do x two)) (or (do x three) (do x four) (do x five)))"
    assert refused(f"(goalem {branches})", 2)
    assert not refused(f"(goalem {branches})", 3)


@pytest.mark.rule("L18")
def test_a_choice_that_one_branch_has_more_is_open_only_there() -> None:
    text = """(goalem (and (if (c) (or (do x one) (do x two)) (or (do x three) (do x four) (do x five)))
                           (when (d) (do x five)) (when (e) (do x one))))"""
    plan = compiled(text, allow_holes=True)
    holes = [
        (c, d, e)
        for c in (False, True)
        for d in (False, True)
        for e in (False, True)
        if plan.ways.guards.evaluate([c, d, e])[plan.ways.hole]
    ]
    assert holes == [(False, False, True), (False, True, True), (True, True, False), (True, True, True)]


@pytest.mark.rule("L18")
def test_a_choice_that_only_the_first_branch_has_does_not_hide_a_hole_of_the_other() -> None:
    branches = "(if (c) (or (do x one) (do x two) (do x three)) (or (do x four) (do x five)))"
    text = f"(goalem (and {branches} (when (d) (do x three))))"
    plan = compiled(text, allow_holes=True)
    holes = [(c, d) for c in (False, True) for d in (False, True) if plan.ways.guards.evaluate([c, d])[plan.ways.hole]]
    assert holes == [(False, True)]
