"""The meaning of one tick on a robot: order, stops before starts, channels, failures (L25)."""

from __future__ import annotations

import pytest
from properties.texts import compiled, decider
from runtime.crew import LIBRARY, Logged, Move, controller, ticks

from rplan.runtime.controller import Controller, UnboundError
from rplan.runtime.encode import PerceptError
from rplan.runtime.robot import Crew

PLAN = """
(defoutput goal pose) (defoutput legs command :idle (rest)) (defoutput eyes command)
(goalem (cond ((a) (and (do eyes look) (do legs walk) (do goal home)))
              ((b) (do legs run))
              ((c) (do eyes look))))
"""


@pytest.fixture
def crew() -> Logged:
    return Logged()


def test_estimators_come_first_then_every_percept_once_then_channels_in_declared_order(crew: Logged) -> None:
    control = controller(PLAN, crew)
    ticks(control, crew, "a")
    assert crew.log == [
        "estimate reading 0",
        "sample a",
        "sample b",
        "sample c",
        "value home",
        "start walk",
        "step walk",
        "start look",
        "step look",
    ]


def test_what_lost_its_turn_is_stopped_before_anything_new_starts(crew: Logged) -> None:
    control = controller(PLAN, crew)
    ticks(control, crew, "a")
    crew.log.clear()
    (tick,) = ticks(control, crew, "b")
    moves = [entry for entry in crew.log if entry.split()[0] in ("start", "step", "stop")]
    assert sorted(moves[:2]) == ["stop look", "stop walk"]
    assert moves[2:] == ["start run", "step run"]
    assert sorted(tick.stopped) == ["look", "walk"]
    assert tick.started == ("run",)


def test_what_goes_on_is_stepped_and_not_started_again(crew: Logged) -> None:
    control = controller(PLAN, crew)
    made = ticks(control, crew, "b", "b", "b")
    assert [entry for entry in crew.log if "run" in entry] == ["start run", "step run", "step run", "step run"]
    assert [tick.started for tick in made] == [("run",), (), ()]
    assert [tick.number for tick in made] == [0, 1, 2]


def test_an_idle_value_drives_where_a_tick_leaves_its_channel_open(crew: Logged) -> None:
    control = controller(PLAN, crew)
    none, looking = ticks(control, crew, "", "c")
    assert none.command == Move(0.0)
    assert (none.values["legs"], none.values["eyes"]) == (Move(0.0), None)
    assert looking.command == Move(0.0, 3.0)
    assert [entry for entry in crew.log if "rest" in entry] == ["start rest", "step rest", "step rest"]


def test_commands_of_all_channels_make_one_command_upon_the_safe_one(crew: Logged) -> None:
    control = controller(PLAN, crew)
    assert ticks(control, crew, "a")[0].command == Move(1.0, 3.0)
    without_idle = controller("(defoutput eyes command) (goalem (when (a) (do eyes look)))", crew)
    assert [tick.command for tick in ticks(without_idle, crew, "a", "")] == [Move(0.0, 3.0), Move(0.0)]


@pytest.mark.rule("L25")
def test_a_channel_reads_this_ticks_value_of_those_before_it_and_last_ticks_of_the_others(crew: Logged) -> None:
    control = controller(
        """(defoutput first pose) (defoutput second pose) (defoutput legs command)
           (goalem (and (do second next) (do first home) (do legs walk)))""",
        crew,
    )
    before, after = ticks(control, crew, "", "")
    assert crew.seen["value home"] == {
        "first": before.values["first"], "second": before.values["second"], "legs": Move(1.0),
    }  # fmt: skip
    assert crew.seen["value next"] == {
        "first": after.values["first"], "second": before.values["second"], "legs": Move(1.0),
    }  # fmt: skip
    assert crew.seen["step walk"]["second"] == after.values["second"] != before.values["second"]
    assert crew.seen["start walk"] == {
        "first": before.values["first"], "second": before.values["second"], "legs": None,
    }  # fmt: skip


@pytest.mark.rule("L25")
def test_percepts_and_estimators_see_last_ticks_channels_and_reports(crew: Logged) -> None:
    control = controller(PLAN, crew)
    first, *_ = ticks(control, crew, "a", "", "")
    assert crew.reports[0] == ({}, {"goal": None, "legs": None, "eyes": None})
    reports, channels = crew.reports[1]
    assert channels == first.values
    assert sorted(reports) == ["look", "walk"]
    assert sorted(crew.reports[2][0]) == ["rest"], "reports are of the last tick alone"


def test_values_may_be_numbers_truths_and_symbols(crew: Logged) -> None:
    control = controller(
        """(defoutput lamp bool :idle false) (defoutput gap (number m)) (defoutput mode symbol :hold :initial calm)
           (goalem (when (a) (and (do lamp true) (do gap 57cm) (do mode wild))))""",
        crew,
    )
    values = [tick.values for tick in ticks(control, crew, "", "a", "")]
    assert values == [
        {"lamp": False, "gap": None, "mode": "calm"},
        {"lamp": True, "gap": 0.57, "mode": "wild"},
        {"lamp": False, "gap": None, "mode": "wild"},
    ]


def test_a_held_competence_goes_on_where_the_plan_leaves_its_channel_open(crew: Logged) -> None:
    control = controller("(defoutput legs command :hold :initial (rest)) (goalem (when (a) (do legs walk)))", crew)
    assert [tick.command.legs for tick in ticks(control, crew, "", "a", "", "")] == [0.0, 1.0, 1.0, 1.0]
    assert crew.log.count("start walk") == 1


# --- failures ---------------------------------------------------------------------------------------

FAILING = """
(defoutput legs command :idle (rest)) (defoutput eyes command)
(goalem (and (when (a) (do legs run))
             (when (competence-failed run) (do eyes look))
             (when (competence-failed rest) (do eyes look))))
"""


@pytest.mark.rule("L25")
@pytest.mark.parametrize(
    ("trouble", "message"),
    [
        ("start", "WreckError: cannot start"),
        ("step", "WreckError: cannot step"),
        ("nan", "its command is not finite"),
        ("late", "it overran its deadline of 0.5 s"),
    ],
)
def test_a_competence_that_fails_is_stopped_and_its_channel_takes_the_idle_value_for_that_tick(
    crew: Logged, trouble: str, message: str
) -> None:
    control = controller(FAILING, crew, deadline=0.5)
    crew.members["run"].trouble = trouble
    (tick,) = ticks(control, crew, "a")
    assert [(fault.competence, fault.message) for fault in tick.faults] == [("run", message)]
    assert tick.command == Move(0.0)
    assert [*tick.reports] == ["rest"]
    assert crew.log[-5:][0].startswith(("start", "step"))
    assert crew.log[-4:] == ["stop run", "start rest", "step rest", "stop rest"]
    assert (tick.started, tick.stopped) == (("run", "rest"), ("run", "rest"))


@pytest.mark.rule("L25")
def test_the_plan_sees_a_failure_in_the_next_tick_and_only_then(crew: Logged) -> None:
    control = controller(FAILING, crew)
    crew.members["run"].trouble = "step"
    first, *_ = ticks(control, crew, "a")
    crew.members["run"].trouble = ""
    second, third = ticks(control, crew, "a", "a")
    seen = [tick.percepts["(competence-failed run)"] for tick in (first, second, third)]
    assert seen == [False, True, False]
    assert [tick.values["eyes"] for tick in (first, second, third)] == [None, Move(None, 3.0), None]
    assert not any(tick.percepts["(competence-failed rest)"] for tick in (first, second, third))
    assert second.command == Move(2.0, 3.0), "it is tried again"


@pytest.mark.rule("L25")
def test_a_failure_in_stop_is_taken_down_and_hinders_nothing(crew: Logged) -> None:
    control = controller(FAILING, crew)
    ticks(control, crew, "a")
    crew.members["run"].trouble = "stop"
    tick, after = ticks(control, crew, "", "")
    assert [(fault.competence, fault.message) for fault in tick.faults] == [
        ("run", "stopping: WreckError: cannot stop")
    ]
    assert tick.command == Move(0.0)
    assert after.percepts["(competence-failed run)"] is True


def test_where_the_idle_value_fails_too_the_safe_command_stays(crew: Logged) -> None:
    control = controller(FAILING, crew)
    crew.members["run"].trouble = crew.members["rest"].trouble = "step"
    failing, alone = ticks(control, crew, "a", "")
    assert [fault.competence for fault in failing.faults] == ["run", "rest"]
    assert failing.values["legs"] is None
    assert failing.command == Move(0.0)
    assert [fault.competence for fault in alone.faults] == ["rest"], "an idle value is not its own fallback"


def test_without_an_idle_value_a_failure_leaves_the_channel_open(crew: Logged) -> None:
    control = controller("(defoutput legs command) (goalem (do legs run))", crew)
    crew.members["run"].trouble = "nan"
    (tick,) = ticks(control, crew, "")
    assert (tick.values, tick.command) == ({"legs": None}, Move(0.0))


def test_a_step_within_its_deadline_is_no_failure_and_without_a_deadline_none_is_late(crew: Logged) -> None:
    assert ticks(controller(FAILING, crew, deadline=0.5), crew, "a")[0].faults == ()
    crew.members["run"].trouble = "late"
    assert ticks(controller(FAILING, crew), crew, "a")[0].faults == ()


def test_close_stops_all_that_runs_and_gives_the_safe_command(crew: Logged) -> None:
    control = controller(PLAN, crew)
    ticks(control, crew, "a")
    crew.log.clear()
    assert control.close() == Move(0.0)
    assert sorted(crew.log) == ["stop look", "stop walk"]
    crew.log.clear()
    assert control.close() == Move(0.0)
    assert crew.log == []


def test_close_stops_the_others_where_one_cannot_stop(crew: Logged) -> None:
    control = controller(PLAN, crew)
    ticks(control, crew, "a")
    crew.members["walk"].trouble = "stop"
    crew.log.clear()
    control.close()
    assert sorted(crew.log) == ["stop look", "stop walk"]


def test_a_percept_that_has_no_proper_value_comes_through_to_whoever_ticks(crew: Logged) -> None:
    control = controller("(defoutput legs command) (goalem (when (> (level) 3) (do legs run)))", crew)
    crew.percepts["level"] = float("nan")
    with pytest.raises(PerceptError, match="finite number"):
        ticks(control, crew, "")
    crew.percepts["level"] = 4.0
    assert ticks(control, crew, "")[0].command == Move(2.0)


def test_a_plan_that_needs_what_the_crew_lacks_is_refused_with_everything_that_is_missing(crew: Logged) -> None:
    text = """(use crew) (defoutput legs command :idle (sit)) (defoutput goal pose)
              (goalem (if (and (a) (sees car)) (do legs fly) (and (do legs walk) (do goal away) (do goal walk-to))))"""
    plan = compiled(text, {"crew": LIBRARY}, allow_holes=True)
    with pytest.raises(UnboundError) as caught:
        Controller(decider(plan), crew.crew())
    assert [term.text for term in caught.value.terms] == ["(sees (car))", "(fly)", "(away)", "(walk-to)", "(sit)"]
    assert str(caught.value) == "(sees (car)), (fly), (away), (walk-to), (sit)"


def test_a_crew_of_nothing_suffices_for_a_plan_of_nothing() -> None:
    control = Controller(decider(compiled("(goalem (do anything))")), Crew({}, {}, {}, (), Move(0.0)))
    assert control.step(None).command == Move(0.0)
