"""What would have made a tick do otherwise: the fewest percepts, or what would have had to be kept."""

from __future__ import annotations

import pytest
from properties.texts import compiled

import rplan.ways.why_not as why_not_module
from rplan.backends.python import PythonEngine
from rplan.driver import Compiled
from rplan.runtime.tick import Decider
from rplan.runtime.why import why_not
from rplan.ways.kept import Kept, Literal
from rplan.ways.situations import nothing
from rplan.ways.why_not import Change, Changes, PastChange, Wanted, WantedError, WhyNot

LENGTHS = "(declare (d) (number m)) (declare (e) (number m)) (defoutput x symbol) "
Percepts = dict[str, bool | float]


def asked(text: str, wanted: Wanted, *ticks: Percepts, known: bool = True) -> tuple[Compiled, WhyNot]:
    """What would have made the last of these ticks do otherwise; percepts that are not named are false or 0."""
    plan = compiled(text, allow_holes=True)
    atoms = plan.ways.atoms[: plan.ways.asking]
    decide = Decider(plan.goals, atoms, plan.circuit, PythonEngine(plan.circuit))
    every = [nothing(plan.ways) | tick for tick in ticks]
    decision = [decide.tick(tick) for tick in every][-1]
    return plan, why_not(plan, decision, wanted, every[-1] if known else None)


def test_what_happens_already_is_said_with_its_way() -> None:
    _, found = asked("(goalem (when (a) (do x on)))", {"x": "(on)"}, {"(a)": True})
    assert found.verdict == "already"
    assert found.way is not None
    assert found.way.acts[0].value == "(on)"


def test_the_fewest_percepts_win_and_of_those_as_few_the_first() -> None:
    text = "(goalem (when (or (and (a) (b)) (c) (d)) (do x on)))"
    _, found = asked(text, {"x": "(on)"}, {})
    assert found.changes == (Change("(c)", False, True, ()),)


def test_a_number_counts_once_whatever_comparisons_ask_of_it() -> None:
    text = LENGTHS + "(goalem (when (or (and (< d 2m) (< d 1m) (> d 0.5m)) (and (a) (b))) (do x on)))"
    _, found = asked(text, {"x": "on"}, {"(d)": 3.0})
    assert [one.percept for one in found.changes] == ["(d)"]
    (change,) = found.changes
    assert change.was == 3.0
    assert change.becomes == 0.9
    assert change.comparisons == (Literal("(< (d) 2m)", True), Literal("(< (d) 1m)", True))


@pytest.mark.parametrize(
    ("comparison", "was", "becomes"),
    [
        ("(> d 0.95m)", 0.6, 0.96),
        ("(> d 0.95m)", 0.95, 0.96),
        ("(< d 0.4m)", 0.917, 0.39),
        ("(> d 30m)", 0.0, 31.0),
        ("(< d -0.5m)", 0.0, -0.51),
        ("(> d 0.5236m)", 0.0, 0.53),
        ("(and (> d 0.95m) (< d 0.955m))", 0.0, 0.9525),
        ("(<= d 1m)", 2.0, 1.0),
        ("(> d 0m)", 0.0, 1.0),
    ],
)
def test_the_number_that_would_do_is_a_round_one_near_to_what_it_was(
    comparison: str, was: float, becomes: float
) -> None:
    _, found = asked(f"{LENGTHS}(goalem (when {comparison} (do x on)))", {"x": "on"}, {"(d)": was})
    (change,) = found.changes
    assert change.becomes == becomes


def test_where_numbers_are_not_known_only_what_comparisons_said_counts() -> None:
    text = LENGTHS + "(goalem (when (< d e) (do x on)))"
    _, found = asked(text, {"x": "on"}, {"(d)": 3.0}, known=False)
    assert found.verdict == "percepts"
    assert [(one.percept, one.was) for one in found.changes] == [("(d)", None)]
    assert found.atoms == (True,)


def test_a_number_that_is_not_changed_stays() -> None:
    text = LENGTHS + "(goalem (when (and (< d e) (> d 1m)) (do x on)))"
    _, found = asked(text, {"x": "on"}, {"(d)": 3.0, "(e)": 2.5})
    assert [one.percept for one in found.changes] == ["(d)"]
    assert 1.0 < (found.changes[0].becomes or 0.0) < 2.5


def test_what_cannot_be_is_left_out() -> None:
    text = LENGTHS + "(goalem (when (and (< d 1m) (> d 2m)) (do x on)))"
    assert asked(text, {"x": "on"}, {})[1].verdict == "never"
    text = "(assume (or (not (a)) (b))) (goalem (when (a) (do x on)))"
    _, found = asked(text, {"x": "(on)"}, {})
    assert [one.percept for one in found.changes] == ["(a)"]
    text = "(assume (or (not (a)) (b))) (goalem (if (a) (when (not (b)) (do x on)) (when (b) (do y on))))"
    assert asked(text, {"x": "(on)"}, {})[1].verdict == "never"


def test_an_output_can_be_wanted_open_and_several_together() -> None:
    text = "(goalem (and (when (a) (do x on)) (when (b) (do y on))))"
    _, found = asked(text, {"x": None, "y": "(on)"}, {"(a)": True})
    assert [(one.percept, one.becomes) for one in found.changes] == [("(a)", False), ("(b)", True)]


def test_an_idle_value_stands_where_the_output_is_open() -> None:
    text = "(defoutput x symbol :idle rest) (goalem (when (a) (do x go)))"
    _, found = asked(text, {"x": "rest"}, {"(a)": True})
    assert [(one.percept, one.becomes) for one in found.changes] == [("(a)", False)]


def test_what_is_kept_can_hold_it_and_is_said_with_what_it_would_have_had_to_be() -> None:
    text = "(goalem (when (held-for 0.3s (a)) (do x on)))"
    _, found = asked(text, {"x": "(on)"}, {})
    assert found.verdict == "kept"
    form = "(held-for 0.3s (a))"
    assert found.past == (PastChange(Kept(form, 0), Kept(form, 2)),)
    assert [one.percept for one in found.changes] == ["(a)"]
    assert found.registers == (False, True)


def test_a_past_that_cannot_have_been_is_left_out() -> None:
    text = (
        "(goalem (when (or (and (once (a)) (historically (not (a)))) (and (once (b)) (once (c)) (not (b)))) (do x on)))"
    )
    _, found = asked(text, {"x": "(on)"}, {"(a)": True}, {})
    assert found.verdict == "kept"
    assert [one.was.condition for one in found.past] == ["(once (b))"]
    assert [one.percept for one in found.changes] == ["(c)"]


def test_what_no_tick_does_is_said_of_plans_with_memory_as_well() -> None:
    text = "(goalem (when (and (once (a)) (historically (not (a)))) (do x on)))"
    assert asked(text, {"x": "(on)"}, {})[1].verdict == "never"
    text = "(assume (not (a))) (goalem (when (once (a)) (do x on)))"
    assert asked(text, {"x": "(on)"}, {})[1].verdict == "never"


def test_where_no_past_is_found_in_time_only_the_verdict_stands(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(why_not_module, "MOST_PASTS", 0)
    _, found = asked("(goalem (when (fell (a)) (do x on)))", {"x": "(on)"}, {})
    assert (found.verdict, found.past, found.way) == ("kept", (), None)


def test_a_hole_is_not_what_is_wanted() -> None:
    text = "(goalem (and (do y on) (when (a) (do y off)) (when (b) (do x on))))"
    _, found = asked(text, {"x": None}, {"(b)": True, "(a)": True})
    assert [one.percept for one in found.changes] == ["(a)", "(b)"]


@pytest.mark.parametrize(
    ("wanted", "says"),
    [
        ({"z": "(on)"}, "there is no output z (there are: x)"),
        ({"x": "(off)"}, "the plan never sets x to (off) (what it can be: (on))"),
    ],
)
def test_what_is_none_of_the_plans_is_an_error(wanted: Wanted, says: str) -> None:
    plan = compiled("(goalem (when (a) (do x on)))")
    with pytest.raises(WantedError) as raised:
        Changes(plan.ways, wanted)
    assert str(raised.value) == says


def test_many_ticks_are_asked_of_one_solver() -> None:
    plan = compiled("(goalem (when (and (a) (b)) (do x on)))")
    changes = Changes(plan.ways, {"x": "(on)"})
    counts = [len(changes.why_not(bits, ()).changes) for bits in ((False, False), (True, False), (False, True)) * 2]
    assert counts == [2, 1, 1, 2, 1, 1]


def test_a_question_that_is_too_hard_is_not_decided(monkeypatch: pytest.MonkeyPatch) -> None:
    text = "(declare (d) number) (declare (e) number) (goalem (when (and (> (* d e) 2) (a)) (do x on)))"
    changes = Changes(compiled(text).ways, {"x": "(on)"})
    changes.unrolling.solver.set("rlimit", 1)
    assert changes.why_not((False, False), ()).verdict == "undecided"


def test_a_number_that_no_float_says_is_left_open() -> None:
    text = "(declare (d) number) (goalem (when (= (* d 3) 1) (do x on)))"
    _, found = asked(text, {"x": "(on)"}, {"(d)": 0.1})
    assert found.verdict == "percepts"
    assert found.changes[0].comparisons == (Literal("(= (* (d) 3) 1)", True),)
