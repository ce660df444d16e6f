"""Why a tick did what it did: literals that are enough, what is kept, what lost."""

from __future__ import annotations

import pytest
from properties.strategies import percept
from properties.texts import compiled, decider

import rplan.ways.why as why_module
from rplan.driver import Compiled
from rplan.goals.condition import AllOf, AnyOf, Constant, Not, OutputIs
from rplan.runtime.why import why
from rplan.ways.kept import Kept, Literal, Now, kept, kept_by
from rplan.ways.lost import Lost
from rplan.ways.situations import nothing
from rplan.ways.why import Reasons, Why


def asked(text: str, *ticks: dict[str, bool | float]) -> tuple[Compiled, Why]:
    """Why the last of these ticks of a plan is as it is; percepts that are not named are false or 0."""
    plan = compiled(text, allow_holes=True)
    decide = decider(plan)
    decision = [decide.tick(nothing(plan.ways) | tick) for tick in ticks][-1]
    return plan, why(plan, decision)


def lost(found: Why) -> dict[str, tuple[str, str]]:
    return {one.goal: (one.reason, one.because) for one in found.lost}


def test_of_a_disjunction_that_holds_twice_the_first_literal_is_enough() -> None:
    _, found = asked("(goalem (when (or (a) (b)) (do x on)))", {"(a)": True, "(b)": True})
    assert found.literals == (Literal("(a)", True),)
    assert found.smallest


def test_a_comparison_that_another_one_implies_is_left_out() -> None:
    text = "(declare (d) (number m)) (goalem (when (and (< d 0.5m) (< d 0.2m)) (do x on)))"
    _, found = asked(text, {"(d)": 0.1})
    assert [one.text for one in found.literals] == ["(< (d) 0.2m)"]


def test_what_is_assumed_need_not_be_said() -> None:
    text = "(assume (not (and (a) (b)))) (goalem (when (and (a) (not (b))) (do x on)))"
    _, found = asked(text, {"(a)": True})
    assert [one.text for one in found.literals] == ["(a)"]
    _, broken = asked(text, {"(a)": True, "(b)": True})
    assert [one.text for one in broken.literals] == ["(b)"], "what breaks an assumption is explained without it"


def test_what_always_happens_needs_no_reason() -> None:
    _, found = asked("(goalem (if (a) (do x on) (do x on)))", {})
    assert found.literals == ()


def test_what_is_kept_is_named_with_its_count() -> None:
    _, found = asked("(goalem (when (held-for 0.3s (a)) (do x on)))", {"(a)": True}, {"(a)": True}, {"(a)": True})
    assert found.literals == (Literal("(a)", True),)
    assert found.kept == (Kept("(held-for 0.3s (a))", 2),)
    assert str(found.kept[0]) == "2 ticks"
    assert str(Kept("(once (a))", True)) == "true"
    assert str(Kept("(within 1s (a))", 1)) == "1 tick"


def test_every_goal_that_lost_says_the_one_thing_against_it() -> None:
    text = """
    (defgoalr (maint safe) (when (close) (do x flee)))
    (defgoalr (ach drive) (do x drive))
    (defgoalr (ach rest) (if (tired) (ach sleep) (do y play)))
    (defgoalr (ach sleep) (do y sleep))
    (defgoalr (maint order) (if (not (and (close) (tired))) (do anything) (do z tidy)))
    (goalem (prio-and (maint safe) (ach drive) (ach rest) (maint order) (do z late)))
    """
    _, found = asked(text, {"(close)": True})
    said = lost(found)
    assert said["(ach drive)"] == ("conflict", "x would be (drive), and (maint safe) sets it to (flee)")
    assert said["(ach rest)"] == ("conflict", "it comes after (ach drive), which is given up")
    assert said["(ach sleep)"][0] == "conflict"
    assert next(one for one in found.lost if one.goal == "(ach sleep)").part_of == "(ach rest)"
    assert found.lost[0].by.line == 2, "where it is set otherwise"
    _, calm = asked(text.replace("(ach drive) (ach rest)", "(ach rest)"), {})
    said = lost(calm)
    assert said["(maint safe)"] == ("satisfied", "already satisfied: (close) is false")
    assert said["(ach sleep)"] == ("condition", "(tired) is false")
    assert said["(maint order)"] == ("satisfied", "already satisfied: (close) is false")
    assert said["(do z (tidy))"][0] == "condition"
    assert [rule.head for rule in calm.served] == ["(maint safe)", "(ach rest)", "(maint order)"]
    assert calm.served[0].span.line == 2


def test_alternatives_that_lost_say_which_one_is_taken() -> None:
    text = """
    (defgoalr (ach left) (do x left)) (defgoalr (ach right) (do x right))
    (goalem (prio-and (when (a) (do x right)) (or (ach left) (ach right))))
    """
    assert lost(asked(text, {})[1])["(ach right)"] == (
        "alternative",
        "(ach left) is taken, which stands before it",
    )
    assert lost(asked(text, {"(a)": True})[1])["(ach left)"] == (
        "alternative",
        "(ach right) is taken; this alternative does not go together with what is kept, or gives up more",
    )


def test_in_a_hole_everything_has_lost() -> None:
    text = "(defgoalr (ach one) (do x on)) (goalem (and (ach one) (when (a) (do x off))))"
    _, found = asked(text, {"(a)": True})
    assert found.way.hole
    assert {one.reason for one in found.lost} == {"hole"}
    assert {one.because for one in found.lost} == {"no way is open: x must be (on) and (off)"}
    assert [one.by.column for one in found.lost] == [45, 65, 21]
    assert found.literals == (Literal("(a)", True),)


def test_in_a_hole_what_a_condition_leaves_out_is_not_blamed() -> None:
    text = "(goalem (and (do x on) (if (a) (do x off) (when (b) (do y on))) (or (do z a) (do z b))))"
    _, found = asked(text, {"(a)": True, "(b)": True})
    assert lost(found) == {
        "(do x (on))": ("hole", "no way is open: x must be (on) and (off)"),
        "(do x (off))": ("hole", "no way is open: x must be (on) and (off)"),
        "(do y (on))": ("condition", "(a) is true"),
        "(do z (a))": ("hole", "no way is open: x must be (on) and (off)"),
        "(do z (b))": ("hole", "no way is open: x must be (on) and (off)"),
    }


def test_a_hole_among_alternatives_alone_says_so() -> None:
    _, found = asked("(goalem (and (do x on) (or (do x off) (do x dim))))", {})
    because = "no way is open: no alternative of what must be done goes together with the rest"
    assert {one.because for one in found.lost} == {because}


def test_a_goal_that_is_always_satisfied_says_no_condition() -> None:
    _, found = asked("(defgoalr (maint calm) (do anything)) (goalem (and (maint calm) (do x on)))", {})
    assert lost(found) == {"(maint calm)": ("satisfied", "already satisfied")}


def test_a_goal_that_stepped_aside_is_not_said_to_be_satisfied() -> None:
    text = """
    (defgoalr (ach drive) (if (or (danger) (arrived)) (do anything) (do x drive)))
    (goalem (and (when (danger) (do x flee)) (ach drive)))
    """
    assert lost(asked(text, {"(danger)": True})[1])["(ach drive)"] == ("nothing", "asks for nothing: (danger) is true")
    assert lost(asked(text, {"(arrived)": True})[1])["(ach drive)"] == (
        "nothing",
        "asks for nothing: (arrived) is true",
    )


@pytest.mark.rule("L20")
def test_a_goal_of_operators_is_satisfied_where_its_fact_holds() -> None:
    text = """
    (defop (pick) :do (x pick) :pre (near) :add ((held)))
    (defop (walk) :do (x walk) :pre (not (near)) :add ((near)))
    (defgoalr (maint all) (ach held))
    (goalem (maint all))
    """
    held = lost(asked(text, {"(held)": True})[1])
    assert held["(ach held)"] == ("satisfied", "already satisfied: (held) is true")
    assert held["(maint all)"] == ("satisfied", "already satisfied: (held) is true")
    assert "(ach held)" not in lost(asked(text, {"(near)": True})[1])


@pytest.mark.rule("L9")
@pytest.mark.parametrize(
    "form",
    [
        "(delay true (a))", "(once (a))", "(historically (a))", "(since (a) (b))", "(latch (a) (b))", "(rose (a))",
        "(fell (a))", "(held-for 0.3s (a))", "(held-for 0.1s (a))", "(within 0.3s (a))", "(at-least 2 (a))",
        "(at-least 2 (a) :reset (b))", "(delay false (once (and (a) (not (b)))))", "(or (rose (a)) (not (once (b))))",
    ],
)  # fmt: skip
def test_memory_is_read_in_every_tick_as_it_was_compiled(form: str) -> None:
    plan = compiled(f"(goalem (when {form} (do x on)))", allow_holes=True)
    decide = decider(plan)
    goal = next(node for node in plan.ways.layout.nodes if plan.ways.asked[node.number] > 1)
    for n in range(64):
        percepts = nothing(plan.ways) | {"(a)": n % 7 not in (3, 5), "(b)": n % 11 == 4}
        decision = decide.tick({name: percepts[name] for name in nothing(plan.ways)})
        now = Now(plan.ways, decision.inputs, decision.registers)
        assert now.holds(goal.goal.condition) == (decision.outputs["x"] is not None)


def test_a_condition_that_asks_its_own_past_is_explained_by_what_is_kept() -> None:
    text = "(defcond (on) (or (a) (delay false (on)))) (goalem (when (on) (do x on)))"
    plan, found = asked(text, {"(a)": True}, {})
    assert found.literals == ()
    assert len(found.kept) == 1
    assert found.kept[0].value is True
    assert kept(plan.ways, found.kept[0].condition, (False,)).value is False
    assert [*kept_by(plan.ways).values()] == [(0,)]


def test_past_the_limit_of_checks_no_literal_can_be_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    plan = compiled("(goalem (when (or (and (a) (b)) (c)) (do x on)))")
    monkeypatch.setattr(why_module, "MOST_CHECKS", 0)
    found = Reasons(plan.ways).why((True, True, True), ())
    assert not found.smallest
    assert [one.text for one in found.literals] in (["(c)"], ["(a)", "(b)"])


def test_numbers_that_cannot_be_together_exactly_are_all_named() -> None:
    clash = compiled("(declare (d) number) (goalem (when (and (< d 1) (> d 2)) (do x on)))", allow_holes=True)
    found = Reasons(clash.ways).why((True, True), ())
    assert not found.smallest
    assert len(found.literals) == 2


def test_conditions_are_read_whatever_stands_in_them() -> None:
    plan = compiled("(goalem (when (a) (do x on)))")
    now = Now(plan.ways, (True,), ())
    a, yes = percept("(a)"), Constant(True)
    assert now.holds(AllOf((yes, a)))
    assert now.holds(AnyOf((Not(yes), a)))
    assert now.deciding(AllOf((yes, Not(a)))) == (Literal("(a)", True),)
    assert now.deciding(AnyOf((yes, a))) == ()
    with pytest.raises(ValueError, match="ask no outputs"):
        now.holds(OutputIs("x", None))
    assert now.deciding(OutputIs("x", None)) == ()


def test_a_question_that_is_too_hard_leaves_every_literal() -> None:
    plan = compiled("(declare (d) number) (declare (e) number) (goalem (when (> (* d e) 2) (do x on)))")
    reasons = Reasons(plan.ways)
    reasons.solver.set("rlimit", 1)
    found = reasons.why((True,), ())
    assert (len(found.literals), found.smallest) == (1, False)


def test_lost_is_a_plain_value() -> None:
    _, found = asked("(defgoalr (ach one) (when (a) (do x on))) (goalem (ach one))", {})
    assert isinstance(found.lost[0], Lost)
    assert found.lost[0].condition == "(a)"
    assert found.lost[1].part_of == "(ach one)"
