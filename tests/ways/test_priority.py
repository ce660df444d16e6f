"""Which way a tick takes: members given up, fallbacks, alternatives, and what is said of them (L12-L18)."""

from __future__ import annotations

import pytest
from properties.texts import compiled, decider

from rplan.driver import Compiled
from rplan.ways.way import TakenWay, taken_way


def way(text: str, *true: str) -> TakenWay:
    """The way of a plan where these percepts are true and all others false."""
    plan = compiled(text, allow_holes=True)
    return taken_way(plan.ways, [atom.text in true for atom in plan.ways.atoms])


def acts(text: str, *true: str) -> dict[str, str]:
    taken = way(text, *true)
    assert not taken.hole
    return {act.output: act.value for act in taken.acts}


def given_up(text: str, *true: str) -> list[str]:
    return [member.member for member in way(text, *true).given_up]


@pytest.mark.rule("L12")
def test_do_sets_an_output_and_do_anything_sets_nothing() -> None:
    assert acts("(goalem (and (do lamp on) (do anything)))") == {"lamp": "(on)"}


@pytest.mark.rule("L13")
@pytest.mark.parametrize(
    ("true", "value"),
    [(("(a)",), "(one)"), (("(a)", "(b)"), "(one)"), (("(b)",), "(two)"), ((), "(three)")],
)
def test_cond_is_the_first_branch_whose_condition_holds(true: tuple[str, ...], value: str) -> None:
    text = "(goalem (cond ((a) (do x one)) ((b) (do x two)) (else (do x three))))"
    assert acts(text, *true) == {"x": value}


@pytest.mark.rule("L13")
def test_cond_without_else_and_when_end_in_anything() -> None:
    assert acts("(goalem (cond ((a) (do x one))))") == {}
    assert acts("(goalem (when (a) (do x one)))") == {}
    assert acts("(goalem (when (a) (do x one)))", "(a)") == {"x": "(one)"}


@pytest.mark.rule("L14")
def test_equal_canonical_text_is_no_conflict_and_different_text_is_one() -> None:
    assert acts("(goalem (and (do x home) (do x (home)) (do y 57cm) (do y 0.57m)))") == {"x": "(home)", "y": "0.57m"}
    assert way("(goalem (and (do x home) (do x away)))").hole


@pytest.mark.rule("L15")
def test_an_earlier_alternative_is_preferred_to_a_later_one() -> None:
    assert acts("(goalem (or (do x one) (do x two)))") == {"x": "(one)"}


@pytest.mark.rule("L15")
def test_a_later_alternative_is_taken_where_the_earlier_one_does_not_go_together_with_what_must_be() -> None:
    text = "(goalem (and (or (do x one) (do x two)) (when (a) (do x two))))"
    assert acts(text) == {"x": "(one)"}
    assert acts(text, "(a)") == {"x": "(two)"}


@pytest.mark.rule("L16")
def test_a_member_that_is_given_up_takes_all_later_members_with_it() -> None:
    text = "(goalem (prio-and (do x one) (do x two) (do y three)))"
    assert acts(text) == {"x": "(one)"}
    assert given_up(text) == ["(do x (two))", "(do y (three))"]


@pytest.mark.rule("L18")
def test_a_priority_conjunction_inside_another_gives_up_its_outer_last_member_first() -> None:
    text = "(goalem (prio-and (prio-and (do a one) (do b one)) (do b two)))"
    assert acts(text) == {"a": "(one)", "b": "(one)"}
    assert given_up(text) == ["(do b (two))"]


@pytest.mark.rule("L18")
def test_an_alternative_is_taken_where_that_saves_a_member() -> None:
    text = "(goalem (prio-and (or (do x one) (do x two)) (when (a) (do x two))))"
    assert acts(text) == {"x": "(one)"}
    assert acts(text, "(a)") == {"x": "(two)"}
    assert given_up(text, "(a)") == []


@pytest.mark.rule("L18")
def test_an_enclosing_conjunction_turns_to_a_fallback_instead_of_a_hole() -> None:
    text = "(goalem (and (prio-and (do x one) (do y one)) (do y two)))"
    assert acts(text) == {"x": "(one)", "y": "(two)"}
    assert given_up(text) == ["(do y (one))"]


@pytest.mark.rule("L18")
def test_of_two_priority_conjunctions_the_one_that_stands_first_in_the_text_keeps_its_members() -> None:
    text = "(goalem (and (prio-and (do a one) (do x one)) (prio-and (do b one) (do x two))))"
    assert acts(text) == {"a": "(one)", "b": "(one)", "x": "(one)"}
    assert given_up(text) == ["(do x (two))"]


@pytest.mark.rule("L18")
def test_a_hole_sends_idle_and_held_values_and_says_so() -> None:
    plan = compiled(
        """(defoutput lamp symbol :idle off) (defoutput horn symbol :hold :initial quiet) (defoutput x symbol)
           (goalem (and (when (a) (and (do horn loud) (do lamp on))) (when (b) (do horn soft))))""",
        allow_holes=True,
    )
    decide = decider(plan)
    sent = []
    for a, b in ((True, True), (True, False), (True, True), (False, False), (False, True)):
        decision = decide.tick({"(a)": a, "(b)": b})
        assert decision.hole == (a and b)
        sent.append([None if term is None else term.text for term in decision.sent.values()])
    assert sent == [
        ["off", "quiet", None],
        ["on", "loud", None],
        ["off", "loud", None],
        ["off", "loud", None],
        ["off", "soft", None],
    ]


RULES = """
(defgoalr (maint safe) (when (close) (do action back-off)))
(defgoalr (ach fetch) (if (seen) (do action grasp) (do action search)))
(defgoalr (ach shine) (do lamp on))
(goalem (prio-and (maint safe) (ach fetch) (ach shine)))
"""


def test_a_way_names_rules_branches_and_places_of_what_it_does() -> None:
    taken = way(RULES, "(seen)")
    assert taken.rules == ("(maint safe)", "(ach fetch)", "(ach shine)")
    assert [(branch.condition, branch.value, branch.rule) for branch in taken.branches] == [
        ("(close)", False, "(maint safe)"),
        ("(seen)", True, "(ach fetch)"),
    ]
    assert [(act.value, act.rule, act.span.line) for act in taken.acts] == [
        ("(grasp)", "(ach fetch)", 3),
        ("(on)", "(ach shine)", 4),
    ]


def test_what_is_given_up_says_why() -> None:
    taken = way(RULES, "(close)")
    assert taken.rules == ("(maint safe)",)
    assert [(member.member, member.because) for member in taken.given_up] == [
        ("(ach fetch)", "action would be (search), and (maint safe) sets it to (back-off)"),
        ("(ach shine)", "it comes after (ach fetch), which is given up"),
    ]


def test_a_member_at_odds_with_itself_says_so() -> None:
    (lost,) = way("(goalem (prio-and (do x one) (and (do y one) (do y two))))").given_up
    assert (lost.member, lost.because) == ("the and at 1", "it sets y both to (one) and to (two)")


def test_a_member_none_of_whose_alternatives_goes_says_so() -> None:
    (lost,) = way("(goalem (prio-and (do x one) (or (do x two) (do x three))))").given_up
    assert lost.because == "no alternative of it goes together with what is kept"


def test_a_member_inside_a_branch_is_given_up_only_where_the_branch_is_reached() -> None:
    text = "(goalem (and (do x one) (when (a) (prio-and (do y one) (if (b) (do x two) (do z one))))))"
    assert given_up(text) == []
    assert given_up(text, "(a)") == []
    assert given_up(text, "(a)", "(b)") == ["the if at 1"]


def test_a_hole_has_neither_rules_nor_acts() -> None:
    taken = way("(goalem (and (do x one) (do x two)))")
    assert taken == TakenWay(True, (), (), (), ())


def test_a_plan_of_nothing_does_nothing() -> None:
    plan: Compiled = compiled("(goalem (do anything))")
    assert plan.circuit.inputs == ()
    assert [port.name for port, _ in plan.circuit.outputs] == ["hole"]
    assert decider(plan).tick({}).outputs == {}
