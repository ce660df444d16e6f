"""Situations that a plan does not cover, with their witnesses (L18, L26)."""

from __future__ import annotations

import pytest
import z3
from properties.texts import compiled, findings, said

from rplan.driver import Compiled
from rplan.lang.diagnostic import Diagnostic
from rplan.ways import coverage
from rplan.ways.guards import FALSE
from rplan.ways.listing import taken_ways
from rplan.ways.reach import Reach
from rplan.ways.situations import Undecided, describe, replay


def hole(text: str) -> Diagnostic:
    (found,) = [d for d in findings(text) if d.code == "hole"]
    return found


@pytest.mark.rule("L18")
def test_a_hole_is_an_error_with_a_witness_and_a_warning_where_holes_are_allowed() -> None:
    text = "(goalem (and (when (bumped) (do a stop)) (when (called) (do a go))))"
    assert hole(text).severity == "error"
    assert hole(text).when == "(bumped) and (called)"
    (warning,) = [d for d in compiled(text, allow_holes=True).diagnostics if d.code == "hole"]
    assert warning.severity == "warning"


@pytest.mark.rule("L18")
def test_a_hole_shows_both_acts_that_do_not_go_together() -> None:
    found = hole("(goalem (and\n(when (bumped) (do a stop))\n(when (called) (do a go))))")
    assert "`a` must be set to (stop) and to (go)" in found.message
    assert (found.span.line, found.related[0].span.line) == (2, 3)


def test_a_hole_among_alternatives_points_at_the_top_goal() -> None:
    found = hole("\n(goalem (and (or (do a one) (do a two)) (do a three)))")
    assert "no alternative" in found.message
    assert (found.span.line, found.related) == (2, ())


@pytest.mark.rule("L18")
def test_a_hole_in_a_situation_that_numbers_rule_out_is_none() -> None:
    text = "(goalem (and (when (< (d) 0.2m) (do a stop)) (when ({} (d) 0.5m) (do a go))))"
    assert "hole" not in said(findings(text.format(">")))
    assert hole(text.format("<")).when == "(d) = 0"


@pytest.mark.rule("L26")
def test_a_witness_has_the_fewest_true_percepts_then_the_first_ones_false() -> None:
    found = hole("(goalem (and (do x a) (when (or (and (p) (q) (r)) (and (s) (t)) (and (t) (u))) (do x b))))")
    assert found.when == "not (p) and not (q) and not (r) and not (s) and (t) and (u)"
    fewer = hole("(goalem (and (do x a) (when (or (p) (and (q) (r))) (do x b))))")
    assert fewer.when == "(p) and not (q) and not (r)"


@pytest.mark.rule("L26")
@pytest.mark.parametrize(
    ("condition", "witness"),
    [
        ("(< (d) 3m)", "(d) = 0m"),
        ("(> (d) 3m)", "(d) = 4m"),
        ("(and (> (d) 3m) (< (d) 4m))", "(d) = 3.5m"),
        ("(and (>= (d) 3m) (/= (d) 3m) (<= (d) 50m))", "(d) = 26.5m"),
        ("(and (< (d) (e)) (> (d) 0m))", "(d) = 1m and (e) = 2m"),
        ("(= (d) 57cm)", "(d) = 0.57m"),
        ("(< (d) (e))", "(d) = 0m and (e) = 1m"),
    ],
)
def test_the_numbers_of_a_witness_are_simple_ones_that_fit(condition: str, witness: str) -> None:
    text = f"""(declare (d) (number m) "") (declare (e) (number m) "")
               (goalem (and (do x a) (when {condition} (do x b))))"""
    assert hole(text).when == witness


def test_a_plan_that_always_contradicts_itself_has_a_hole_always() -> None:
    assert hole("(goalem (and (do x a) (do x b)))").when == "always"


def test_where_the_solver_gives_up_the_plan_is_said_to_be_undecided(monkeypatch: pytest.MonkeyPatch) -> None:
    plan = compiled("(goalem (and (when (p) (do x a)) (when (q) (do x b))))", allow_holes=True)
    monkeypatch.setattr(z3.Solver, "check", lambda solver, *assumptions: z3.unknown)
    reach = Reach(plan.ways)
    assert isinstance(reach.trace((plan.ways.hole, True)), Undecided)
    assert isinstance(reach.possible((FALSE, True)), Undecided)
    (found,) = coverage.find(plan.ways)
    assert (found.code, found.severity) == ("not-decided", "warning")


def ways(plan: Compiled, limit: int = 99) -> list[str]:
    return sorted(describe(trace, plan.ways) for trace in taken_ways(plan.ways, limit))


def test_every_way_that_can_be_taken_has_its_situation() -> None:
    plan = compiled("(goalem (if (p) (do x a) (if (> (d) 1m) (do x b) (do x c))))")
    traces = [*taken_ways(plan.ways, 99)]
    assert len(traces) == 3
    reached = {tuple(replay(plan.ways, t).guards[g] for g in plan.ways.sets["x"].values()) for t in traces}
    assert reached == {(True, False, False), (False, True, False), (False, False, True)}


def test_no_more_ways_are_sought_than_asked_for_and_holes_are_no_ways() -> None:
    plan = compiled("(goalem (and (when (p) (do x a)) (when (q) (do x b))))", allow_holes=True)
    assert len(ways(plan, 2)) == 2
    assert ways(plan) == ["(p) and not (q)", "not (p) and (q)", "not (p) and not (q)"]


def test_ways_that_wait_for_the_past_are_listed_with_the_ticks_that_lead_there() -> None:
    plan = compiled("(goalem (if (held-for 0.3s (p)) (do x a) (do x b)))")
    assert ways(plan) == ["not (p)", "ticks 0 to 2: (p)"]
