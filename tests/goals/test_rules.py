"""Goals reduced by their rules: heads, several rules, circles, depth (L10, L17)."""

from __future__ import annotations

import pytest
from properties.texts import compiled, decider, findings, said

from rplan.goals.goal import print_goal
from rplan.lang.diagnostic import Diagnostic


def errors(text: str) -> list[Diagnostic]:
    return [d for d in findings(text) if d.severity == "error"]


def reduced(text: str) -> str:
    return print_goal(compiled(text, allow_holes=True).goals.top)


@pytest.mark.rule("L17")
def test_a_subgoal_is_the_body_of_the_rule_whose_head_matches() -> None:
    text = "(defgoalr (ach home) (do x one)) (defgoalr (maint home) (do y two)) (goalem (and (maint home) (ach home)))"
    assert reduced(text) == "(and (rule (maint home) (do y (two))) (rule (ach home) (do x (one))))"


@pytest.mark.rule("L17")
def test_several_rules_of_one_head_are_alternatives_in_textual_order_with_a_warning_that_names_both() -> None:
    text = "(goalem (ach home))\n(defgoalr (ach home) (do x one))\n(defgoalr (ach home) (do x two))"
    assert reduced(text) == "(rule (ach home) (or (do x (one)) (do x (two))))"
    (warning,) = [d for d in findings(text) if d.code == "several-rules"]
    assert warning.severity == "warning"
    assert [warning.span.line, *(place.span.line for place in warning.related)] == [2, 3]


@pytest.mark.rule("L17")
@pytest.mark.parametrize(
    ("goal", "hint"),
    [
        ("(ach hoem-again)", "did you mean `(ach home-again)`?"),
        ("(maint home-again)", "there is a rule for `(ach home-again)`; `ach` and `maint` are different heads"),
        ("(ach rest)", "write `(defgoalr (ach rest) GOAL)`"),
    ],
)
def test_a_goal_without_a_rule_is_an_error_with_a_hint(goal: str, hint: str) -> None:
    (found,) = errors(f"(defgoalr (ach home-again) (do x one)) (goalem {goal})")
    assert (found.code, found.hint) == ("no-rule", hint)


@pytest.mark.rule("L17")
def test_every_goal_without_a_rule_is_reported_also_in_rules_that_nothing_asks_for() -> None:
    text = "(defgoalr (ach a) (and (ach b) (ach c))) (goalem (and (ach d) (do x one)))"
    assert [d.message.split("`")[1] for d in errors(text)] == ["(ach d)", "(ach b)", "(ach c)"]


@pytest.mark.rule("L17")
def test_a_goal_that_reduces_to_itself_is_an_error_that_shows_the_path() -> None:
    (found,) = errors("""(goalem (ach a))
        (defgoalr (ach a) (if (p) (maint b) (do x one)))
        (defgoalr (maint b) (and (do y one) (ach c)))
        (defgoalr (ach c) (or (do x two) (ach a)))""")
    assert found.code == "goal-circle"
    assert found.message.endswith("(ach a) → (maint b) → (ach c) → (ach a)")
    assert [found.span.line, *(place.span.line for place in found.related)] == [4, 2, 3]


@pytest.mark.rule("L17")
def test_a_circle_that_no_goal_reaches_is_an_error_too() -> None:
    (found,) = errors("(goalem (do x one)) (defgoalr (ach a) (ach b)) (defgoalr (ach b) (ach a))")
    assert found.code == "goal-circle"


@pytest.mark.rule("L17")
def test_the_same_rule_twice_without_a_circle_is_fine() -> None:
    text = "(defgoalr (ach a) (do x one)) (defgoalr (ach b) (ach a)) (goalem (and (ach a) (ach b) (ach a)))"
    assert errors(text) == []


def chain(length: int) -> str:
    rules = "".join(f"(defgoalr (ach r{n}) (ach r{n + 1}))\n" for n in range(length - 1))
    return f"{rules}(defgoalr (ach r{length - 1}) (do x one))\n(goalem (ach r0))"


@pytest.mark.rule("L17")
def test_a_thousand_rules_inside_one_another_are_reduced_and_one_more_is_an_error() -> None:
    assert errors(chain(1_000)) == []
    (found,) = errors(chain(1_001))
    assert found.code == "too-deep"
    assert "1000" in found.message
    assert found.span.line == 1_000


def test_a_goal_that_doubles_with_every_rule_is_refused_before_it_fills_the_memory() -> None:
    rules = "".join(f"(defgoalr (ach r{n}) (and (ach r{n + 1}) (ach r{n + 1})))" for n in range(60))
    found = errors(f"{rules}(defgoalr (ach r60) (do x one))(goalem (ach r0))")
    assert {d.code for d in found} == {"too-large"}


def test_a_plan_without_a_top_goal_is_checked_all_the_same() -> None:
    assert said(findings("(defgoalr (ach a) (ach b))"), "error") == ["no-goal", "no-rule"]


# --- conditions -------------------------------------------------------------------------------------


@pytest.mark.rule("L8")
def test_a_named_condition_stands_for_its_text_at_any_depth() -> None:
    text = """(defcond (safe) (not (close))) (defcond (free) (and (safe) (< (load) 3)))
              (goalem (if (or (free) safe) (do x one) (do anything)))"""
    assert reduced(text) == "(if (or (and (not (close)) (< (load) 3)) (not (close))) (do x (one)) (do anything))"


@pytest.mark.rule("L10")
def test_a_condition_that_depends_on_itself_is_one_error_that_shows_the_circle() -> None:
    text = """(defcond (c) (b)) (defcond (a) (or (p) (not (b)))) (defcond (b) (and (a) (q)))
              (goalem (when (c) (do x one)))"""
    (found,) = errors(text)
    assert found.code == "condition-circle"
    assert found.message.endswith("a → b → a")
    assert [place.message for place in found.related] == ["`a` is defined here", "`b` is defined here"]


@pytest.mark.rule("L10")
def test_a_condition_of_itself_is_a_circle_also_where_nothing_uses_it() -> None:
    (found,) = errors("(defcond (a) (not a)) (goalem (do x one))")
    assert found.message.endswith("a → a")


def test_a_named_condition_takes_as_many_arguments_as_its_head_has() -> None:
    assert [d.code for d in errors("(defcond (a) (p)) (goalem (when (a home) (do x one)))")] == ["wrong-arity"]


@pytest.mark.rule("L8")
@pytest.mark.parametrize(
    ("operator", "true_for"),
    [("<", [1]), ("<=", [1, 2]), (">", [3]), (">=", [2, 3]), ("=", [2]), ("/=", [1, 3])],
)
def test_a_comparison_compares(operator: str, true_for: list[int]) -> None:
    decide = decider(compiled(f"(goalem (when ({operator} (n) 2) (do x one)))"))
    assert [n for n in (1, 2, 3) if decide.tick({"(n)": n}).outputs["x"]] == true_for
