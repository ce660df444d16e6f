"""What is surely a mistake in a plan, each said once, and what one may want to know (L6, L18)."""

from __future__ import annotations

import json

import pytest
from properties.texts import compiled, decider

from rplan.driver import compile_plan
from rplan.lang.diagnostic import Diagnostic, PlanError
from rplan.lang.source import Source
from rplan.ways.coverage import review


def reviewed(text: str) -> list[Diagnostic]:
    return list(review(compiled(text, allow_holes=True).ways))


def warnings(text: str) -> list[str]:
    return [one.code for one in reviewed(text) if one.severity == "warning"]


@pytest.mark.rule("L18")
@pytest.mark.parametrize(
    ("text", "codes"),
    [
        ("(goalem (if (p) (do x a) (do x b)))", []),
        ("(goalem (if (p) (if (p) (do x a) (do x b)) (do x c)))", ["duplicate-condition"]),
        ("(goalem (if (or (p) (not (p))) (do x a) (do x b)))", ["always-true"]),
        ("(goalem (if (< (d) 1) (do x a) (if (< (d) 0) (do x b) (do x c))))", ["always-false"]),
        ("(goalem (if (< (d) 1) (do x a) (if (< (d) 0) (if (p) (do x b) (do x d)) (do x c))))", ["always-false"]),
        ("(goalem (prio-and (do x a) (do x b) (do y c)))", ["dead", "never-set"]),
        ("(goalem (prio-and (when (p) (do x a)) (do x b)))", []),
        ("(goalem (or (do x a) (do x b)))", ["shadowed"]),
        ("(goalem (and (or (do x a) (do x b)) (when (p) (do x b))))", []),
        ("(goalem (or (do x a) (do x a)))", ["duplicate-rule"]),
        ("(goalem (when (and (once (p)) (historically (not (p)))) (do x a)))", ["always-false", "never-set"]),
        ("(goalem (when (held-for 3s (p)) (do x a)))", []),
        ("(assume (not (p))) (goalem (if (p) (do x a) (do x b)))", ["always-false"]),
        ("(assume (p)) (assume (not (p))) (goalem (do x a))", ["no-situation", "never-set"]),
    ],
)  # fmt: skip
def test_a_mistake_is_said_once_at_its_outermost_place(text: str, codes: list[str]) -> None:
    assert warnings(text) == codes


def test_a_rule_that_is_reached_in_one_place_is_not_called_dead_for_another() -> None:
    text = "(defgoalr (ach r) (if (p) (do x a) (do x b))) (goalem (if (p) (ach r) (ach r)))"
    assert warnings(text) == []


def test_acts_that_never_go_together_are_named_with_a_trace_that_replays() -> None:
    text = """(defgoalr (maint safe) (when (held-for 0.3s (close)) (do x a)))
              (defgoalr (ach move) (do x b))
              (goalem (prio-and (maint safe) (ach move)))"""
    plan = compiled(text)
    (found,) = [one for one in review(plan.ways) if one.code == "two-values"]
    assert (found.severity, found.span.line, [r.span.line for r in found.related]) == ("note", 2, [1])
    decide = decider(plan)
    ticks = [{f"({key})": value for key, value in json.loads(line).items()} for line in found.trace]
    sent = [decide.tick(tick).outputs["x"] for tick in ticks]
    assert [term and term.text for term in sent] == ["(b)", "(b)", "(a)"]


def test_alternatives_that_go_equally_well_tie_unless_they_set_the_same() -> None:
    codes = [one.code for one in reviewed("(goalem (and (or (do x a) (do x b)) (when (p) (do x b))))")]
    assert codes == ["tie"]


def required(text: str) -> list[str]:
    try:
        return [one.code for one in compile_plan(Source("p", text)).diagnostics if one.severity == "error"]
    except PlanError as error:
        return [f"{one.code}: {one.when}" for one in error.diagnostics if one.severity == "error"]


def test_a_required_output_that_a_situation_leaves_open_is_an_error_with_a_witness() -> None:
    text = "(defoutput x symbol :required) (goalem (prio-and {} (do x b)))"
    assert required(text.format("(when (p) (do x a))")) == []
    assert required("(defoutput x symbol :required) (goalem (when (not (once (p))) (do x a)))") == ["left-open: (p)"]


def test_without_notes_only_warnings_are_looked_for() -> None:
    ways = compiled("(goalem (prio-and (when (p) (do x a)) (do x b)))").ways
    assert review(ways, notes=False) == ()
    assert [one.code for one in review(ways)] == ["two-values"]
