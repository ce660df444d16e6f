"""Goals and conditions with arguments (L17), what properties and tests ask, and files that include others."""

from __future__ import annotations

import pytest
from properties.texts import compiled, findings, said

from rplan.driver import compile_plan
from rplan.goals.condition import print_condition
from rplan.goals.goal import print_goal
from rplan.lang.diagnostic import Diagnostic, PlanError
from rplan.lang.include import OpenFile
from rplan.lang.source import Source


def reduced(text: str) -> str:
    return print_goal(compiled(text, allow_holes=True).goals.top)


def errors(text: str) -> list[Diagnostic]:
    return [found for found in findings(text) if found.severity == "error"]


# --- arguments --------------------------------------------------------------------------------------


@pytest.mark.rule("L17")
def test_values_are_put_in_the_place_of_variables() -> None:
    text = "(defgoalr (ach go-to ?place) (do action (drive-to ?place))) (goalem (ach go-to (dock left)))"
    assert reduced(text) == "(rule (ach go-to (dock (left))) (do action (drive-to (dock (left)))))"


@pytest.mark.rule("L17")
def test_conditions_and_numbers_are_put_in_the_place_of_variables() -> None:
    text = """(defgoalr (ach wait ?until ?most) (when (and (not ?until) (< (waited) ?most)) (do action stop)))
              (goalem (ach wait (or (ready) (late)) (* 2 3s)))"""
    head = "(ach wait (or (ready) (late)) (* 2 3s))"
    asked = "(and (not (or (ready) (late))) (< (waited) (* 2 3s)))"
    assert reduced(text) == f"(rule {head} (if {asked} (do action (stop)) (do anything)))"


@pytest.mark.rule("L17")
def test_a_constant_in_a_head_fits_its_own_text_and_both_rules_are_alternatives() -> None:
    text = """(defgoalr (ach go-to kitchen) (do action crawl)) (defgoalr (ach go-to ?place) (do action (drive ?place)))
              (goalem (and (ach go-to (kitchen)) (when (late) (ach go-to bath))))"""
    assert reduced(text) == (
        "(and (rule (ach go-to (kitchen)) (or (do action (crawl)) (do action (drive (kitchen))))) "
        "(if (late) (rule (ach go-to (bath)) (do action (drive (bath)))) (do anything)))"
    )
    assert [found.message for found in findings(text) if found.code == "several-rules"] == [
        "2 rules reduce `(ach go-to (kitchen))`: they are alternatives in this order"
    ]


@pytest.mark.rule("L17")
def test_one_goal_with_two_arguments_is_no_circle_and_with_the_same_it_is() -> None:
    steps = "(defgoalr (ach by a) (ach by b)) (defgoalr (ach by b) (do x one)) (goalem (ach by a))"
    assert errors(steps) == []
    (found,) = errors("(defgoalr (ach by ?x) (ach via ?x)) (defgoalr (ach via ?x) (ach by ?x)) (goalem (ach by a))")
    assert found.code == "goal-circle"
    assert found.message.endswith("(ach by (a)) → (ach via (a)) → (ach by (a))")


@pytest.mark.rule("L17")
@pytest.mark.parametrize("body", ["(ach n (next ?x))", "(and (ach n (a ?x)) (ach n (b ?x)))", "(ach n (f ?x ?x))"])
def test_arguments_that_grow_for_ever_are_an_error(body: str) -> None:
    assert [found.code for found in errors(f"(defgoalr (ach n ?x) {body}) (goalem (ach n 0))")] == ["too-deep"]


@pytest.mark.rule("L17")
@pytest.mark.parametrize(
    ("goal", "code", "hint"),
    [
        ("(ach go-to)", "wrong-arity", "there are: `(ach go-to ?place)`, `(ach go-to (hall) ?speed)`"),
        ("(ach go-to hal 2)", "no-rule", "there are: `(ach go-to ?place)`, `(ach go-to (hall) ?speed)`"),
    ],
)
def test_arguments_that_no_head_takes_are_an_error_that_names_the_heads(goal: str, code: str, hint: str) -> None:
    text = f"""(defgoalr (ach go-to ?place) (do action ?place)) (defgoalr (ach go-to hall ?speed) (do action ?speed))
               (goalem {goal})"""
    (found,) = errors(text)
    assert (found.code, found.hint) == (code, hint)


@pytest.mark.rule("L17")
@pytest.mark.parametrize(
    ("body", "argument", "code"),
    [
        ("(do action ?x)", "(not (a))", "not-a-value"),
        ("(when ?x (do action stop))", "3m", "not-a-condition"),
        ("(when (< ?x 2) (do action stop))", "true", "not-a-number"),
        ("(do action (go ?x))", "(and (a) (b))", "misplaced-form"),
    ],
)
def test_an_argument_that_does_not_fit_its_place_is_an_error_at_the_argument(
    body: str, argument: str, code: str
) -> None:
    (found,) = errors(f"(goalem (ach g {argument}))\n(defgoalr (ach g ?x) {body})")
    assert (found.code, found.span.line) == (code, 1)


def test_a_rule_that_nothing_asks_for_is_checked_all_the_same() -> None:
    text = "(defgoalr (ach g ?x) (if (and ?x (near ?x)) (ach h ?x) (do a ?x))) (goalem (do a one))"
    assert [found.code for found in errors(text)] == ["no-rule"]


@pytest.mark.rule("L10")
def test_a_condition_with_arguments_stands_for_its_text_and_may_ask_its_own_past() -> None:
    text = """(defcond (kept ?c) (and ?c (delay true (kept ?c)))) (defcond (near ?p) (< (far ?p) 1m))
              (goalem (when (kept (near dock)) (do action stop)))"""
    plan = compiled(text)
    assert print_goal(plan.goals.top).startswith("(if (and (< (far (dock)) 1m) (delay true (kept (near (dock)))))")
    assert [*plan.goals.definitions] == ["kept (near (dock))"]


# --- properties and tests ---------------------------------------------------------------------------


def test_a_property_asks_outputs_and_the_past() -> None:
    text = """(goalem (if (bumped) (do action stop) (do speed 2m/s)))
              (defproperty p "why" :always (or (= action stop) (/= speed 2m/s) (open action)) :provided (once (bumped)))
              (assume (or (bumped) (= (load) 3)))"""
    (claim,) = compiled(text).goals.properties
    assert print_condition(claim.always) == "(or (= action (stop)) (not (= speed 2m/s)) (open action))"
    assert (claim.name, claim.doc, print_condition(claim.provided)) == ("p", "why", "(once (bumped))")
    (assumed,) = compiled(text).goals.assumptions
    assert print_condition(assumed.condition) == "(or (bumped) (= (load) 3))"


def test_an_expected_value_and_a_given_one_are_of_the_right_type() -> None:
    text = "(declare (near) bool) (defoutput v (number m/s)) (goalem (when (near) (do v 1m/s))) (deftest t {})"
    assert said(findings(text.format("(tick :given ((near true)) :expect ((v 1m/s)))"))) == []
    assert said(findings(text.format("(tick :expect ((v true)))"))) == ["type-mismatch"]
    assert said(findings(text.format("(tick :given ((near 3)))"))) == ["type-mismatch"]


def test_required_is_told_of_an_output() -> None:
    outputs = compiled("(defoutput a command :required) (defoutput b bool) (goalem (do a x))").goals.outputs
    assert [(output.name, output.required) for output in outputs] == [("a", True), ("b", False)]


# --- files ------------------------------------------------------------------------------------------


def files(**texts: str) -> OpenFile:
    def open_file(path: str) -> Source:
        if path not in (known := {f"lib/{name}.rplan": text for name, text in texts.items()}):
            raise FileNotFoundError(2, "No such file or directory", path)
        return Source(path, known[path])

    return open_file


MAIN = Source("main.rplan", '(include "lib/a.rplan") (include "lib/b.rplan") (goalem (ach rest))')


def test_definitions_come_from_other_files_once_and_their_own_top_goal_does_not() -> None:
    a = '(plan a) (include "b.rplan") (defgoalr (ach rest) (when (tired) (do action sit))) (goalem (ach rest))'
    plan = compile_plan(MAIN, open_file=files(a=a, b="(defcond (tired) (late))"))
    assert print_goal(plan.goals.top) == "(rule (ach rest) (if (late) (do action (sit)) (do anything)))"
    assert [source.name for source in plan.sources] == ["main.rplan", "lib/a.rplan", "lib/b.rplan"]
    assert [*plan.texts] == ["main.rplan", "lib/a.rplan", "lib/b.rplan"]
    assert plan.goals.name == "main"
    assert plan.goals.rules[0].span.file == "lib/a.rplan"


@pytest.mark.parametrize(
    ("b", "code", "file"),
    [
        ('(include "c.rplan")', "missing-file", "lib/b.rplan"),
        ('(include "../main.rplan")', "include-circle", "lib/b.rplan"),
        ('(include "./b.rplan")', "include-circle", "lib/b.rplan"),
        ("(include b)", "wrong-parts", "lib/b.rplan"),
        ("(defcond (x) (", "missing-parenthesis", "lib/b.rplan"),
    ],
)
def test_what_is_wrong_in_another_file_is_told_with_its_file_and_text(b: str, code: str, file: str) -> None:
    with pytest.raises(PlanError) as raised:
        compile_plan(MAIN, open_file=files(a="(defgoalr (ach rest) (do action sit))", b=b))
    (found,) = [found for found in raised.value.diagnostics if found.severity == "error"]
    assert (found.code, found.span.file) == (code, file)
    assert raised.value.texts[file] == b
