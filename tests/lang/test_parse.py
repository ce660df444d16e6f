"""Forms to plans: every form of the language, and what is said of wrong ones."""

from __future__ import annotations

import math
from typing import get_args

import pytest

from rplan.lang.diagnostic import Diagnostic, PlanError
from rplan.lang.forms.words import COMPARATORS
from rplan.lang.parse import parse, parse_text
from rplan.lang.plan import (
    AllOf,
    And,
    AnyOf,
    Anything,
    Call,
    Comparator,
    Compare,
    Condition,
    Do,
    Goal,
    If,
    Not,
    Number,
    Or,
    Plan,
    PrioAnd,
    Setting,
    Subgoal,
    Truth,
    Type,
)
from rplan.lang.printer import print_condition, print_goal, print_plan
from rplan.lang.reader import read
from rplan.lang.source import NOWHERE, Source, Span
from tests.properties.strategies_lang import without_places

FIGURE_1 = """
(defgoalr (maint runaway)
  (if (anything-is-too-close)
      (do action (move-away-from-danger))
      (do anything)))

(defgoalr (ach move-to-goal)
  (if (or (anything-is-too-close)
          (not (there-is-a-goal))
          (we-are-at-the-goal))
      (do anything)
      (do action (move-according-to-NaT-plan))))

(defgoalr (ach retrieve-widget-from-donor)
  (if (anything-is-too-close)
      (do goal (remember-the-current-goal-if-any))
      (if (donor-has-been-located)
          (ach fetch-widget&go-home)
          (ach find-donor))))

(defgoalr (ach fetch-widget&go-home)
  (if (we-already-have-the-widget)
      (do goal the-robots-home-position)
      (do goal (set-goal-as-the-donors-location))))

(defgoalr (ach find-donor)
  (if (we-know-the-donor-direction)
      (ach find-donor-location)
      (maint find-donor-direction)))

(defgoalr (maint find-donor-direction)
  (if (ir-search-has-been-started)
      (do action (continue-search))
      (if (and (the-ir-search-is-finished)
                (the-returned-angle-is-no-good))
          (do rpt-ir-failure? true)
          (do anything))))

(defgoalr (ach find-donor-location)
  (if (stereo-ranging-is-started)
      (if (a-range-value-has-been-returned)
          (if (the-range-value-is-no-good)
              (do rpt-prism-failure? true)
              (do anything))
          (do action (continue-search)))
      (do action (start-stereo-ranging))))

(goallem (and (prio-and (maint runaway)
                      (ach retrieve-widget-from-donor)
                      (ach move-to-goal)))
"""
"""Bonasso, Antonisse and Slack 1992, Figure 1, as printed: the last line lacks a parenthesis."""


def parsed(text: str, name: str = "a.rplan") -> tuple[Plan, tuple[Diagnostic, ...]]:
    return parse_text(Source(name, text))


def plan_of(text: str, name: str = "a.rplan") -> Plan:
    plan, found = parsed(text, name)
    assert found == ()
    return plan


def errors_of(text: str) -> list[Diagnostic]:
    with pytest.raises(PlanError) as caught:
        parsed(text)
    return [found for found in caught.value.diagnostics if found.severity == "error"]


def error_of(text: str) -> Diagnostic:
    (error,) = errors_of(text)
    return error


def goal_of(text: str) -> Goal:
    top = plan_of(f"(goalem {text})").top
    assert top
    goal: Goal = without_places(top.goal)
    return goal


def condition_of(text: str) -> Condition:
    condition: Condition = without_places(plan_of(f"(defcond (c) {text})").conditions[0].condition)
    return condition


def span(line: int, column: int, end_line: int, end_column: int) -> Span:
    return Span("a.rplan", line, column, end_line, end_column)


X, Y = Call("x", (), NOWHERE), Call("y", (), NOWHERE)
G, H = Subgoal("ach", "g", (), NOWHERE), Subgoal("maint", "h", (), NOWHERE)
NOTHING = Anything(NOWHERE)


# --- Figure 1 -------------------------------------------------------------------------------------


def test_figure_1_lacks_one_parenthesis_and_nothing_else() -> None:
    error = error_of(FIGURE_1)
    assert (error.code, error.span) == ("missing-parenthesis", span(48, 1, 48, 2))


def test_figure_1_is_a_plan_once_the_parenthesis_is_there() -> None:
    plan = plan_of(FIGURE_1.rstrip() + ")", "figure-1.rplan")
    assert (plan.header.name, plan.header.period) == ("figure-1", 0.1)
    assert [(rule.kind, rule.name) for rule in plan.rules] == [
        ("maint", "runaway"),
        ("ach", "move-to-goal"),
        ("ach", "retrieve-widget-from-donor"),
        ("ach", "fetch-widget&go-home"),
        ("ach", "find-donor"),
        ("maint", "find-donor-direction"),
        ("ach", "find-donor-location"),
    ]
    assert plan.top
    assert print_goal(plan.top.goal) == (
        "(and (prio-and (maint runaway) (ach retrieve-widget-from-donor) (ach move-to-goal)))"
    )
    assert print_goal(plan.rules[5].goal) == (
        "(if (ir-search-has-been-started) (do action (continue-search)) "
        "(if (and (the-ir-search-is-finished) (the-returned-angle-is-no-good)) "
        "(do rpt-ir-failure? true) (do anything)))"
    )


# --- goals ----------------------------------------------------------------------------------------


@pytest.mark.rule("L12")
def test_do_sets_an_output_or_nothing() -> None:
    assert goal_of("(do o (x))") == Do("o", X, NOWHERE)
    assert goal_of("(do rpt? true)") == Do("rpt?", Truth(True, NOWHERE), NOWHERE)
    assert goal_of("(do speed 20cm/s)") == Do("speed", Number(0.2, "m/s", NOWHERE), NOWHERE)
    assert goal_of("(do anything)") == NOTHING


@pytest.mark.rule("L7")
def test_a_bare_symbol_is_a_call_at_any_depth() -> None:
    assert goal_of("(do o home)") == goal_of("(do o (home))")
    assert goal_of("(do o (go home))") == goal_of("(do o (go (home)))")
    assert condition_of("(and x (not x))") == condition_of("(and (x) (not (x)))")


@pytest.mark.rule("L13")
def test_when_and_cond_are_nested_ifs() -> None:
    assert goal_of("(when x (ach g))") == goal_of("(if x (ach g) (do anything))") == If(X, G, NOTHING, NOWHERE)
    assert goal_of("(cond (x (ach g)) (y (maint h)))") == goal_of("(if x (ach g) (when y (maint h)))")
    assert goal_of("(cond (x (ach g)) (else (maint h)))") == If(X, G, H, NOWHERE)
    assert goal_of("(cond (else (ach g)))") == G


@pytest.mark.rule("L4")
def test_the_branches_of_cond_have_the_places_of_their_clauses() -> None:
    top = plan_of("(goalem (cond (x (ach g))\n  (y (ach g))))").top
    assert top
    first = top.goal
    assert isinstance(first, If)
    assert isinstance(first.otherwise, If)
    assert first.span == span(1, 15, 1, 26)
    assert first.otherwise.span == span(2, 3, 2, 14)
    assert first.otherwise.otherwise.span == span(1, 9, 2, 15)


@pytest.mark.rule("L14")
def test_and_or_and_prio_and_join_goals() -> None:
    assert goal_of("(and (ach g) (maint h))") == And((G, H), NOWHERE)
    assert goal_of("(or (ach g))") == Or((G,), NOWHERE)
    assert goal_of("(prio-and (ach g) (maint h) (do anything))") == PrioAnd((G, H, NOTHING), NOWHERE)


# --- conditions -----------------------------------------------------------------------------------


@pytest.mark.rule("L8")
def test_conditions_are_truths_calls_and_their_junctions() -> None:
    assert condition_of("true") == Truth(True, NOWHERE)
    assert condition_of("(and x (not y))") == AllOf((X, Not(Y, NOWHERE)), NOWHERE)
    assert condition_of("(or x y false)") == AnyOf((X, Y, Truth(False, NOWHERE)), NOWHERE)
    assert condition_of("(near (x) 5m)") == Call("near", (X, Number(5.0, "m", NOWHERE)), NOWHERE)


@pytest.mark.rule("L8")
@pytest.mark.parametrize("operator", get_args(Comparator))
def test_numbers_compare(operator: Comparator) -> None:
    assert operator in COMPARATORS
    assert condition_of(f"({operator} x 90deg)") == Compare(operator, X, Number(math.pi / 2, "rad", NOWHERE), NOWHERE)


@pytest.mark.parametrize("text", ["(not)", "(not x y)", "(and)", "(or)", "(< 1)", "(= x y x)"])
def test_a_condition_with_a_wrong_number_of_parts_is_one_error(text: str) -> None:
    assert error_of(f"(defcond (c) {text})").code == "wrong-parts"


@pytest.mark.parametrize("text", ["(ach g)", "(if x y y)", "(do o x)", "anything", "(plan x)", "(true)", "goalem"])
def test_a_word_of_the_language_is_no_percept(text: str) -> None:
    assert error_of(f"(defcond (c) (or {text} x))").code == "misplaced-form"


# --- the top level --------------------------------------------------------------------------------


def test_the_header_tells_name_text_and_period() -> None:
    header = plan_of('(plan patrol "round and round" :period 70ms)').header
    assert (header.name, header.doc, header.period, header.span) == (
        "patrol",
        "round and round",
        0.07,
        span(1, 1, 1, 45),
    )


@pytest.mark.parametrize(
    ("file", "name"),
    [
        ("plans/find_and_fetch.rplan", "find_and_fetch"),
        ("my plan.rplan", "my-plan"),
        ("2nd.rplan", "plan-2nd"),
        ("<stdin>", "<stdin>"),
        ("", "plan"),
    ],
)
def test_without_a_header_the_file_names_the_plan(file: str, name: str) -> None:
    plan = plan_of("(goalem (ach g))", file)
    assert (plan.header.name, plan.header.period) == (name, 0.1)
    assert without_places(plan_of(print_plan(plan), "other.rplan")) == without_places(plan)


@pytest.mark.rule("L3")
@pytest.mark.parametrize("period", ["0.1m", "90deg", "5%"])
def test_a_period_is_a_time(period: str) -> None:
    error = error_of(f"(plan x :period {period})")
    assert (error.code, error.span) == ("unit-mismatch", span(1, 17, 1, 17 + len(period)))


@pytest.mark.parametrize("period", ["0s", "-1s", "fast", '"0.1s"'])
def test_a_period_is_longer_than_nothing(period: str) -> None:
    assert error_of(f"(plan x :period {period})").code == "bad-value"


@pytest.mark.rule("L3")
def test_a_bare_number_is_seconds_with_a_warning() -> None:
    plan, (warning,) = parsed("(plan x :period 2)")
    assert plan.header.period == 2.0
    assert (warning.code, warning.severity, warning.span) == ("bare-number", "warning", span(1, 17, 1, 18))


def test_use_binds_parameters_of_a_library() -> None:
    (use,) = plan_of("(use natigation :radius 25ft :mode paper :on true)").uses
    assert use.library == "natigation"
    assert use.settings[0] == Setting("radius", Number(7.62, "m", span(1, 25, 1, 29)), span(1, 17, 1, 29))
    assert [print_condition_or_value(setting) for setting in use.settings] == ["7.62m", "(paper)", "true"]


def print_condition_or_value(setting: Setting) -> str:
    value = setting.value
    return "7.62m" if isinstance(value, Number) and value.value == 7.62 else print_condition(value_as_condition(value))


def value_as_condition(value: Number | Truth | Call) -> Condition:
    assert not isinstance(value, Number)
    return value


@pytest.mark.rule("L5")
def test_declare_tells_the_types_of_a_function() -> None:
    first, second = plan_of(
        '(declare (dist (to pose) (by symbol)) (number m) "how far")\n(declare home pose)'
    ).declarations
    assert (first.name, first.type, first.doc) == ("dist", Type("number", "m"), "how far")
    assert first.parameters == (("to", Type("pose")), ("by", Type("symbol")))
    assert (second.name, second.parameters, second.type, second.doc) == ("home", (), Type("pose"), "")


def test_outputs_have_an_idle_value_or_hold_theirs() -> None:
    idle, hold, neither = plan_of(
        "(defoutput a command :idle (stop)) (defoutput b (number m/s) :hold :initial 1m/s) (defoutput c bool)"
    ).outputs
    assert (idle.type, without_places(idle.idle), idle.hold, idle.initial) == (
        Type("command"),
        Call("stop", (), NOWHERE),
        False,
        None,
    )
    assert (hold.idle, hold.hold, without_places(hold.initial)) == (None, True, Number(1.0, "m/s", NOWHERE))
    assert (neither.idle, neither.hold, neither.initial) == (None, False, None)


@pytest.mark.parametrize("options", [":idle 1 :hold", ":initial 1", ":idle 1 :initial 1"])
def test_options_of_an_output_that_do_not_go_together_are_one_error(options: str) -> None:
    assert error_of(f"(defoutput a number {options})").code == "bad-option"


def test_a_named_condition_may_have_a_text_and_parentheses() -> None:
    for text in ('(defcond (lost) "we are" (and x y))', '(defcond lost "we are" (and x y))'):
        (named,) = plan_of(text).conditions
        assert (named.name, named.doc) == ("lost", "we are")
        assert print_condition(named.condition) == "(and (x) (y))"


@pytest.mark.rule("L17")
def test_rules_may_share_a_head_and_have_a_text() -> None:
    first, second = plan_of('(defgoalr (ach g) "first" (do anything))\n(defgoalr (ach g) (maint h))').rules
    assert (first.kind, first.name, first.doc) == (second.kind, second.name, "first") == ("ach", "g", "first")
    assert (second.doc, second.head_span, second.span) == ("", span(2, 11, 2, 18), span(2, 1, 2, 29))


def test_a_plan_may_be_without_a_top_goal() -> None:
    assert plan_of("(plan x)").top is None


@pytest.mark.parametrize(
    ("text", "first"),
    [
        ("(plan x)\n(plan x)", span(1, 1, 1, 9)),
        ("(goalem (ach g))\n(goallem (ach g))", span(1, 1, 1, 17)),
        ("(defoutput a bool)\n(defoutput a bool)", span(1, 1, 1, 19)),
        ("(defcond a x)\n(defcond (a) y)", span(1, 1, 1, 14)),
        ("(declare a bool)\n(declare (a) bool)", span(1, 1, 1, 17)),
        ("(use lib)\n(use lib :a 1)", span(1, 1, 1, 10)),
    ],
)
def test_what_must_be_there_once_is_told_with_both_places(text: str, first: Span) -> None:
    error = error_of(text)
    assert (error.code, error.span.line) == ("duplicate", 2)
    assert [related.span for related in error.related] == [first]


@pytest.mark.rule("L6")
def test_name_spaces_are_separate() -> None:
    text = "(declare a bool) (defoutput a bool) (defcond b a) (defgoalr (ach a) (do a a)) (defgoalr (maint a) (ach a))"
    assert len(plan_of(text).rules) == 2


# --- errors ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "code", "place"),
    [
        ("(goalem (if x (ach g)))", "wrong-parts", (9, 23)),
        ("(goalem (when x (ach g) (ach g)))", "wrong-parts", (9, 33)),
        ("(goalem (cond))", "wrong-parts", (9, 15)),
        ("(goalem (cond (x)))", "wrong-parts", (15, 18)),
        ("(goalem (cond x))", "wrong-parts", (15, 16)),
        ("(goalem (cond (else (ach g)) (x (ach g))))", "misplaced-else", (15, 29)),
        ("(goalem (and))", "wrong-parts", (9, 14)),
        ("(goalem (prio-and))", "wrong-parts", (9, 19)),
        ("(goalem (do x))", "wrong-parts", (9, 15)),
        ("(goalem (do anything 1))", "wrong-parts", (9, 24)),
        ("(goalem (do 5 x))", "not-a-name", (13, 14)),
        ('(goalem (do o "x"))', "not-a-value", (15, 18)),
        ("(goalem (do o ((x))))", "no-head", (16, 19)),
        ("(goalem (ach))", "wrong-parts", (9, 14)),
        ("(goalem (ach and x))", "reserved-name", (14, 17)),
        ("(goalem (maint (and x y)))", "misplaced-form", (17, 20)),
        ("(goalem (ach g :depth 0))", "bad-value", (23, 24)),
        ("(goalem (ach ?x))", "no-variables", (14, 16)),
        ("(goalem anything)", "not-a-goal", (9, 17)),
        ("(goalem ())", "no-head", (9, 11)),
        ("(goalem (if (and 1) (ach g) (ach g)))", "not-a-condition", (18, 19)),
        ("(goalem (if (f else) (ach g) (ach g)))", "misplaced-form", (16, 20)),
        ("(goalem (do :x (stop)))", "not-a-name", (13, 15)),
        ("(goalem (mant g))", "unknown-form", (10, 14)),
        ("(goalem (not x))", "misplaced-form", (9, 16)),
        ("(goalem (goalem (ach g)))", "misplaced-form", (9, 25)),
        ("(goalem)", "wrong-parts", (1, 9)),
        ("(goalem (if 5 (ach g) (ach g)))", "not-a-condition", (13, 14)),
        ("(goalem (if (x ?y) (ach g) (ach g)))", "unbound-variable", (16, 18)),
        ("(goalem (if (?y) (ach g) (ach g)))", "no-variables", (14, 16)),
        ("(defgoalr (ach g))", "wrong-parts", (1, 19)),
        ('(defgoalr (ach g) "doc")', "not-a-goal", (19, 24)),
        ("(defgoalr g (do anything))", "bad-head", (11, 12)),
        ("(defgoalr (ach g ?x ?x) (do anything))", "duplicate", (21, 23)),
        ("(defgoalr (ach g (f ?x)) (do anything))", "unbound-variable", (21, 23)),
        ("(defgoalr (ach g ?x) (do o ?y))", "unbound-variable", (28, 30)),
        ("(defgoalr (ach g) (ach g) (ach g))", "wrong-parts", (1, 35)),
        ("(defcond (c))", "wrong-parts", (1, 14)),
        ("(defcond (c ?x) ?y)", "unbound-variable", (17, 19)),
        ("(defop (f) :do (o v))", "wrong-parts", (1, 22)),
        ("(defop (f) :add ((g)))", "wrong-parts", (1, 23)),
        ("(defproperty p)", "wrong-parts", (1, 16)),
        ("(assume)", "wrong-parts", (1, 9)),
        ("(deftest t)", "wrong-parts", (1, 12)),
        ("(deftest t (tock))", "wrong-parts", (12, 18)),
        ("(deftest t (tick :given (x)))", "wrong-parts", (26, 27)),
        ("(deftest t (tick :given ((x y))))", "bad-value", (29, 30)),
        ("(deftest t (tick :times 0))", "bad-value", (25, 26)),
        ("(defoutput o bool :required :idle true)", "bad-option", (19, 28)),
        ("(defcond (c y) x)", "wrong-parts", (13, 14)),
        ("(defcond () x)", "no-head", (10, 12)),
        ("(defcond and x)", "reserved-name", (10, 13)),
        ("(defcond (c) (< true 1))", "not-a-number", (17, 21)),
        ('(defcond (c) (< 1 "x"))', "not-a-number", (19, 22)),
        ("(declare (f (x)) bool)", "wrong-parts", (13, 16)),
        ("(declare (f (x bool) (x bool)) bool)", "duplicate", (22, 30)),
        ("(declare () bool)", "no-head", (10, 12)),
        ("(declare f)", "wrong-parts", (1, 12)),
        ("(declare f bol)", "unknown-type", (12, 15)),
        ("(declare f cm)", "unknown-type", (12, 14)),
        ("(declare f (pose m))", "unknown-type", (12, 20)),
        ("(declare f (number cm))", "unknown-unit", (20, 22)),
        ("(declare f (number furlong))", "unknown-unit", (20, 27)),
        ("(defoutput o)", "wrong-parts", (1, 14)),
        ("(defoutput o bool :idle)", "wrong-parts", (19, 24)),
        ("(defoutput o bool :idel true)", "unknown-keyword", (19, 24)),
        ("(use)", "wrong-parts", (1, 6)),
        ("(plan x |#)", "unopened-comment", (9, 11)),
        ('(plan x "\\q")', "bad-escape", (10, 12)),
        ("(goalem (do x 3q m))", "bad-number", (15, 17)),
        ("(use lib :a 1 :a 2)", "duplicate", (15, 17)),
        ("(plan)", "wrong-parts", (1, 7)),
        ("(plan ?x)", "no-variables", (7, 9)),
        ("(defgaolr (ach g) (ach g))", "unknown-form", (2, 10)),
        ("(ach g)", "misplaced-form", (1, 8)),
        ("a few words", "stray-word", (1, 12)),
        ("(?x)", "no-variables", (2, 4)),
        ("", "empty-plan", (1, 1)),
        ("; nothing", "empty-plan", (1, 1)),
    ],
)
def test_one_mistake_is_one_error_at_its_place(text: str, code: str, place: tuple[int, int]) -> None:
    error = error_of(text)
    assert (error.code, error.span) == (code, span(1, place[0], 1, place[1]))


@pytest.mark.parametrize("goal", ["(ach (at ?place) :depth 2)", "(ach (and (at ?place)) :depth 2)"])
def test_a_goal_with_a_depth_keeps_the_variables_of_its_rule(goal: str) -> None:
    rule = plan_of(f"(defgoalr (ach visit ?place) (prio-and {goal} (do leg ?place)))").rules[0]
    assert print_goal(rule.goal) == f"(prio-and {goal.replace('(ach (at ?place)', '(ach at ?place')} (do leg ?place))"


def test_an_if_with_two_parts_is_told_what_it_takes() -> None:
    error = error_of("(goalem (if x (ach g)))")
    assert error.message == "`if` takes a condition, a goal and an else goal; here are 2 parts"
    assert error.hint == "use `when` for an if without else"


@pytest.mark.parametrize(
    ("text", "hint"),
    [
        ("(defgaolr (ach g) (ach g))", "did you mean `defgoalr`?"),
        ("(goalem (mant g))", "did you mean `maint`?"),
        ("(goalem (prioand (ach g)))", "did you mean `prio-and`?"),
        ("(defoutput o bool :idel true)", "did you mean `:idle`?"),
    ],
)
def test_a_slip_of_the_pen_is_told_what_was_meant(text: str, hint: str) -> None:
    assert error_of(text).hint.startswith(hint)


def test_errors_of_text_and_of_forms_are_told_together_in_order() -> None:
    text = "(plan x :period 1m)\n(goalem (if x (do o 3x)\n(defgoalr (ach g) (whn x (ach g)))\n"
    text += "(defgoalr (ach h) (do o 0.2meters)))\n"
    found = [(error.code, error.span.line) for error in errors_of(text)]
    assert found == [
        ("unit-mismatch", 1),
        ("missing-parenthesis", 2),
        ("bad-number", 2),
        ("unknown-form", 3),
        ("bad-number", 4),
        ("extra-parenthesis", 4),
    ]


def test_after_fifty_errors_of_forms_the_rest_is_counted() -> None:
    errors = errors_of("(x)" * 60)
    assert (len(errors), errors[-1].message) == (51, "and 10 more errors")


def test_a_bad_number_is_told_once_wherever_it_stands() -> None:
    texts = ["(plan x :period 3x)", "(goalem 3x)", "(3x)", "3x", "(defcond 3x y)", "(defcond (c) (< 3x y))", "(use 3x)"]
    assert [error_of(text).code for text in texts] == ["bad-number"] * len(texts)


# --- depth ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "text",
    [
        "(goalem " + "(and " * 998 + "(do x 1)" + ")" * 999,
        "(goalem (if " + "(not " * 990 + "x" + ")" * 990 + " (ach g) (ach g)))",
        "(goalem (do x " + "(f " * 990 + "x" + ")" * 992,
        "(goalem (cond " + "(a (do b 1))" * 990 + "))",
    ],
)
def test_plans_may_be_nearly_a_thousand_levels_deep(text: str) -> None:
    printed = print_plan(plan_of(text))
    assert print_plan(plan_of(printed)) == printed


@pytest.mark.parametrize(
    "text", ["(goalem (cond " + "(a (do b 1))" * 1_000 + "))", "(goalem " + "(and " * 999 + "(do x 1)" + ")" * 1_000]
)
def test_more_levels_are_one_error(text: str) -> None:
    assert error_of(text).code == "too-deep"


def test_read_and_parse_give_what_parse_text_gives() -> None:
    source = Source("a.rplan", FIGURE_1 + ")")
    assert parse(read(source), source) == parse_text(source)
