"""Figure 1 of Bonasso, Antonisse and Slack (1992): what is known of it by number."""

from __future__ import annotations

from itertools import product
from pathlib import Path

import pytest
from properties.texts import compiled, said

from rplan.driver import Compiled
from rplan.goals.goal import And, Goal, Or, PrioAnd, Reduced
from rplan.ways.count import count
from rplan.ways.exhaust import count_situations, exhaustible
from rplan.ways.meaning import Situation, Way, taken
from rplan.ways.meaning import ways as open_ways

FOLDER = Path(__file__).parents[2] / "plans" / "figure_1"


@pytest.fixture(scope="module")
def text() -> Compiled:
    return compiled((FOLDER / "text.rplan").read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def figure() -> Compiled:
    return compiled((FOLDER / "figure.rplan").read_text(encoding="utf-8"))


def every_situation(plan: Compiled) -> list[dict[str, bool]]:
    names = [term.text for term in plan.goals.percepts()]
    return [dict(zip(names, bits, strict=True)) for bits in product((False, True), repeat=len(names))]


@pytest.mark.rule("L23")
def test_the_paper_counts_63_ways_of_which_36_are_distinct_and_31_ever_taken(text: Compiled) -> None:
    counted = count(text.goals.top)
    assert (counted.total, counted.distinct, counted.taken) == (63, 36, 31)


@pytest.mark.rule("L23")
def test_its_three_programs_have_2_11_and_4_ways_and_the_priority_conjunction_22(text: Compiled) -> None:
    top = text.goals.top
    assert isinstance(top, And)
    priority, move = top.goals
    assert isinstance(priority, PrioAnd)
    assert [count(goal).total for goal in (*priority.goals, move)] == [2, 11, 4]
    assert count(priority).total == 22


@pytest.mark.rule("L6")
def test_both_readings_compile_with_notes_alone_though_nothing_is_declared(text: Compiled, figure: Compiled) -> None:
    for plan in (text, figure):
        assert said(plan.diagnostics) == []
        assert set(said(plan.diagnostics, "note")) == {"undeclared"}


@pytest.mark.rule("L18")
def test_neither_reading_has_a_hole_in_its_4096_situations(text: Compiled, figure: Compiled) -> None:
    for plan in (text, figure):
        assert exhaustible(plan.ways)
        assert 2 ** len(plan.ways.atoms) == 4096
        assert count_situations(plan.ways, plan.ways.hole) == 0


def settled_inside(goal: Goal, situation: Situation) -> Goal:
    """The goal with each `prio-and` replaced by the members that it keeps when it looks at nothing outside itself."""
    match goal:
        case PrioAnd(goals, span):
            inner = tuple(settled_inside(member, situation) for member in goals)
            kept = max(n for n in range(1, len(inner) + 1) if n == 1 or taken(And(inner[:n], span), situation))
            return And(inner[:kept], span)
        case And(goals, span):
            return And(tuple(settled_inside(inner, situation) for inner in goals), span)
        case Reduced(head, inner, span, rule_span):
            return Reduced(head, settled_inside(inner, situation), span, rule_span)
        case _:
            assert not isinstance(goal, Or)
            return goal


@pytest.mark.rule("L18")
def test_settled_inside_its_priority_conjunction_the_text_would_have_160_holes(text: Compiled) -> None:
    holes = 0
    for here in every_situation(text):
        goal = settled_inside(text.goals.top, here.__getitem__)
        holes += taken(goal, here.__getitem__) is None
    assert holes == 160


def acts(plan: Compiled, situation: dict[str, bool]) -> frozenset[tuple[str, str]]:
    way = taken(plan.goals.top, situation.__getitem__)
    assert way is not None
    return frozenset(way.acts)


def test_text_and_figure_differ_in_160_situations_where_the_text_drives_and_the_figure_searches(
    text: Compiled, figure: Compiled
) -> None:
    apart = [here for here in every_situation(text) if acts(text, here) != acts(figure, here)]
    assert len(apart) == 160
    drive = ("action", "(move-according-to-NaT-plan)")
    for here in apart:
        assert acts(text, here) == {drive}
        assert drive not in acts(figure, here)
        assert dict(acts(figure, here))["action"] in ("(continue-search)", "(start-stereo-ranging)")
        assert here["(there-is-a-goal)"]
        assert not here["(we-are-at-the-goal)"]


def test_the_compiled_plans_differ_where_the_reference_says(text: Compiled, figure: Compiled) -> None:
    assert [term.text for term in text.goals.percepts()] == [term.text for term in figure.goals.percepts()]
    for plan in (text, figure):
        for here in every_situation(plan)[::7]:
            seen = plan.ways.guards.evaluate([here[atom.text] for atom in plan.ways.atoms])
            now = {(o, v) for o, values in plan.ways.sets.items() for v, guard in values.items() if seen[guard]}
            assert now == acts(plan, here)


def test_the_reference_offers_every_fallback_the_way_that_gives_up_least_first(figure: Compiled) -> None:
    nothing = dict.fromkeys((term.text for term in figure.goals.percepts()), False)
    here = nothing | {"(ir-search-has-been-started)": True, "(there-is-a-goal)": True}
    ways: list[Way] = open_ways(figure.goals.top, here.__getitem__)
    assert [len(way.given_up) for way in ways] == [1, 2]
    assert [dict(way.acts) for way in ways] == [{"action": "(continue-search)"}, {}]
