"""The fixture `plan`: ticks by hand, episodes, recordings played to another plan; failures that can be read."""

from __future__ import annotations

from pathlib import Path

import pytest

import rplan.apps.pytest_plugin.shelf  # noqa: F401
from rplan.apps import pytest_plugin
from rplan.apps.simulation import load_world, simulate
from rplan.apps.testing import PlanUnderTest
from rplan.apps.trying import TicksError
from rplan.apps.wiring import compile_file
from rplan.runtime.tick import Decision

pytest_plugins = ["pytester"]

GUARD = """\
(plan guard :period 0.1s)
(declare (near) bool "")
(declare (lost) bool "")
(declare (distance) (number m) "")
(declare (flee) command "")
(declare (rest) command "")
(defoutput action command :idle (rest))
(defoutput alarm-on bool :idle false)
(defoutput limit (number m))
(defgoalr (maint distance)
  (when (held-for 0.3s (near)) (and (do action (flee)) (do alarm-on true))))
(goalem (prio-and (maint distance)
                  (when (> (distance) 3m) (and (do action (rest)) (do limit 2m)))
                  (when (and (lost) (> (distance) 5m)) (do action (flee)))))
"""
ROOM = """\
(plan make-room :period 0.1s)
(use robot)
(use runaway :safety-radius 0.4m)
(defoutput action command :idle (stop))
(goalem (when (anything-is-too-close) (do action (move-away-from-danger))))
"""
NOOK = """\
name: nook
bounds: [-2, -2, 2, 2]
robot: {start: [0, 0], heading: 0}
donor: {at: [1.9, 0]}
things:
  - {kind: trashcan, id: one, at: [-0.85, 0]}
"""


@pytest.fixture
def guard(tmp_path: Path) -> PlanUnderTest:
    path = tmp_path / "guard.rplan"
    path.write_text(GUARD, encoding="utf-8")
    return PlanUnderTest.of(path)


# --- ticks by hand ----------------------------------------------------------------------------------


def test_percepts_last_until_they_are_changed(guard: PlanUnderTest) -> None:
    run = guard.given("near").expect(action="open").then().expect(action=None).then().expect(action="(flee)")
    assert run.now.time == pytest.approx(0.2)
    assert run.now.way.rules == ("(maint distance)",)
    run.then("not near").expect(action="open").then("near").then("(not (near))", "near=true").expect(action="open")


def test_the_clock_is_virtual(guard: PlanUnderTest) -> None:
    run = guard.given("near").after("2s").expect(action="flee", alarm_on=True)
    assert run.now.time == pytest.approx(2.0)
    guard.given("near").after("200ms").then().after("1s").throughout(action="(flee)")
    with pytest.raises(AssertionError, match=r"in tick 1 \(at 0.1 s\)"):
        guard.given("near").after("2s").throughout(action="flee")


def test_numbers_are_given_with_or_without_a_unit(guard: PlanUnderTest) -> None:
    guard.given("distance=350cm").expect(action="rest", limit="2m").then("(distance)=2.9").expect(action="open")
    assert guard.given("distance = 4").now.sent == {"action": "(rest)", "alarm-on": None, "limit": "2m"} | {
        "alarm-on": "false"
    }


def test_every_given_begins_on_a_plan_that_has_just_been_started(guard: PlanUnderTest) -> None:
    guard.given("near").after("1s").expect(action="flee")
    guard.given("near").expect(action="open")


def test_a_failure_shows_the_way_and_the_conditions(guard: PlanUnderTest) -> None:
    with pytest.raises(AssertionError) as failure:
        guard.given("lost", "distance=6").expect(action="open", alarm_on="true")
    assert str(failure.value).splitlines() == [
        "guard: not as expected in tick 0 (at 0 s)",
        "  `action`: expected open, got (rest)",
        "  `alarm-on`: expected true, got open, so that false is sent",
        "  given: (distance) = 6m, (lost)",
        "  by: (maint distance)",
        "    11: (held-for 0.3s (near)) is false",
        "    13: (> (distance) 3m) is true",
        "    13: the top goal sets action to (rest)".replace("the top goal", "(goalem)"),
        "    13: (goalem) sets limit to 2m",
        "    14: the if at 14 is given up: action would be (flee), and (goalem) sets it to (rest)",
    ]


def test_a_hole_is_not_as_expected_unless_it_is_said(tmp_path: Path) -> None:
    path = tmp_path / "hole.rplan"
    path.write_text(GUARD.replace("(goalem (prio-and", "(goalem (and"), encoding="utf-8")
    plan = PlanUnderTest.of(path)
    plan.given("lost", "distance=6").expect(hole=True)
    with pytest.raises(AssertionError, match="expected no hole, got hole") as failure:
        plan.given("lost", "distance=6").expect()
    assert "by: no way is open" in str(failure.value)


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ("neer", "`neer` is a percept that the plan neither declares nor reads"),
        ("distence=1m", "did you mean `distance`?"),
        ("distance", "`distance` is a number: write `distance=0.3`"),
        ("near=3", "`near` is true or false, not 3"),
        ("distance=far", "`distance`: `far` begins like a number and is none"),
        ("distance=3s", "`distance=3s`: its unit is m, not s"),
    ],
)
def test_a_wrong_percept_is_one_clear_line(given: str, says: str, guard: PlanUnderTest) -> None:
    with pytest.raises(TicksError) as error:
        guard.given(given)
    assert says in str(error.value)


@pytest.mark.parametrize("duration", ["2", "3m", "0.01s", "soon", "1e9s"])
def test_a_wrong_duration_is_one_clear_line(duration: str, guard: PlanUnderTest) -> None:
    with pytest.raises(TicksError):
        guard.given().after(duration)


def test_a_percept_that_is_declared_and_not_read_may_be_given(tmp_path: Path) -> None:
    path = tmp_path / "guard.rplan"
    path.write_text('(declare (wet) bool "")(declare (depth) (number m) "")' + GUARD, encoding="utf-8")
    PlanUnderTest.of(path).given("wet", "depth=2m").expect(action="open")
    with pytest.raises(TicksError, match="`depth` is a number"):
        PlanUnderTest.of(path).given("depth")


def test_an_output_that_there_is_not_is_one_clear_line(guard: PlanUnderTest) -> None:
    with pytest.raises(TicksError, match="has no output `acton`; did you mean `action`"):
        guard.given().expect(acton="flee")
    with pytest.raises(TicksError, match="there are: action, alarm-on, limit"):
        guard.given().expect(x="flee")


# --- golden ticks -----------------------------------------------------------------------------------

QUIET = '{"outputs": {"action": null, "alarm-on": null, "limit": null}'
ALARM = '{"outputs": {"action": "(flee)", "alarm-on": "true", "limit": null}}'


def test_golden_ticks_beside_the_plan_are_compared_and_counted(guard: PlanUnderTest, tmp_path: Path) -> None:
    (tmp_path / "guard.ticks").write_text(f'["near"]\n{QUIET}}}\n{{}}\n{{}}\n{{}}\n{ALARM}\n', encoding="utf-8")
    seen: list[Decision] = []
    plan = PlanUnderTest(guard.compiled, watch=seen.append)
    with pytest.raises(AssertionError, match="2 of 4 ticks differ") as error:
        plan.golden("guard.ticks")
    assert "guard.ticks:3: tick 1\n    + nothing stands there yet" in str(error.value)
    (tmp_path / "guard.ticks").write_text(f'["near"]\n{QUIET}}}\n{{}}\n{ALARM}\n', encoding="utf-8")
    with pytest.raises(AssertionError, match="1 of 2 ticks differ") as error:
        plan.golden(tmp_path / "guard.ticks")
    assert "    - outputs: action = (flee)" in str(error.value)
    assert len(seen) == 4 + 2


def test_where_a_slip_was_made_golden_ticks_are_compared_without_their_way(
    guard: PlanUnderTest, tmp_path: Path
) -> None:
    text = f'["near"]\n{QUIET}, "way": {{"rules": ["(maint nothing)"]}}}}\n'
    (tmp_path / "slip.ticks").write_text(text, encoding="utf-8")
    PlanUnderTest(guard.compiled, ways=False).golden("slip.ticks")
    with pytest.raises(AssertionError, match=r"- way: \(maint nothing\)"):
        guard.golden("slip.ticks")


# --- episodes and recordings ------------------------------------------------------------------------


@pytest.fixture
def room(tmp_path: Path) -> PlanUnderTest:
    (tmp_path / "room.rplan").write_text(ROOM, encoding="utf-8")
    (tmp_path / "nook.yaml").write_text(NOOK, encoding="utf-8")
    return PlanUnderTest.of(tmp_path / "room.rplan")


def test_an_episode_gives_verdict_and_trace(room: PlanUnderTest) -> None:
    run = room.episode("nook.yaml", seed=3).run(until=2).expect(done=False)
    assert len(run.trace) == 20
    assert run.switches("action")[0][1] == "(move-away-from-danger)"
    assert run.trace[0].way.branches[0].value
    assert run.faults == ()
    with pytest.raises(
        AssertionError, match=r"the task is not done after 2 s: out of time .*\n  the last tick, at 1.9 s:"
    ):
        run.expect()


def test_an_episode_of_a_plan_that_does_not_fetch_is_not_said_to_be_on_its_way_to_a_donor() -> None:
    run = (
        PlanUnderTest.of(Path(__file__).parents[2] / "plans" / "make_room" / "make_room.rplan")
        .episode(Path(__file__).parents[1] / "data" / "visit.yaml")
        .run(until=1)
    )
    with pytest.raises(AssertionError, match="not done after 1 s: out of time at 1 s before it came to the donor"):
        run.expect(done=True)


def test_a_recorded_run_shows_where_an_edited_plan_decides_otherwise(room: PlanUnderTest, tmp_path: Path) -> None:
    recording = tmp_path / "run.mcap"
    plan = tmp_path / "room.rplan"
    simulate(compile_file(plan), load_world(tmp_path / "nook.yaml"), 0, until=2, record=recording)
    assert room.replayed(recording) == ()
    edited = tmp_path / "edited.rplan"
    edited.write_text(ROOM.replace("0.4m", "0.01m"), encoding="utf-8")
    changed = PlanUnderTest.of(edited).replayed(recording)
    assert changed[0].tick == 0
    assert changed[0].differs == {"action": ("(move-away-from-danger)", "open")}
    assert str(changed[0]).splitlines()[0].endswith("action was (move-away-from-danger), would be open")


def test_other_outputs_and_holes_are_decided_otherwise_too(room: PlanUnderTest, tmp_path: Path) -> None:
    recording = tmp_path / "run.mcap"
    simulate(compile_file(tmp_path / "room.rplan"), load_world(tmp_path / "nook.yaml"), 0, until=1, record=recording)
    edited = tmp_path / "edited.rplan"
    edited.write_text(
        ROOM.replace("(goalem (when", "(defoutput horn bool)(goalem (and (do horn true) (do action (stop)) (when")
        + ")",
        encoding="utf-8",
    )
    changed = PlanUnderTest.of(edited).replayed(recording)
    assert changed[0].differs["hole"] == ("false", "true")


# --- under pytest -----------------------------------------------------------------------------------


@pytest.fixture
def run(pytester: pytest.Pytester, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("PYTEST_DISABLE_PLUGIN_AUTOLOAD", "1")
    (pytester.path / "guard.rplan").write_text(GUARD, encoding="utf-8")
    return lambda *arguments: pytester.runpytest_inprocess(*arguments, plugins=[pytest_plugin])


def test_the_fixture_opens_a_plan_beside_the_test(pytester: pytest.Pytester, run) -> None:
    pytester.makepyfile("def test_it(plan):\n    plan('guard.rplan').given('near').after('1s').expect(action='flee')\n")
    run().assert_outcomes(passed=1)


def test_a_failure_ends_where_the_test_says_it(pytester: pytest.Pytester, run) -> None:
    pytester.makepyfile(
        "def test_it(plan):\n    plan('guard.rplan').given('near').expect(action='flee')\n"
        "def test_slip(plan):\n    plan('guard.rplan').given('neer')\n"
    )
    result = run()
    result.assert_outcomes(failed=2)
    result.stdout.fnmatch_lines(
        [
            "E  *`action`: expected (flee), got open, so that (rest) is sent",
            "E  *11: (held-for 0.3s (near)) is false",
            "E  *TicksError: `neer` is a percept that *",
        ]
    )
    assert "testing.py" not in result.stdout.str()
    assert "trying.py:" not in result.stdout.str().replace("trying.TicksError", "")


def test_a_plan_that_is_not_there_or_wrong_is_one_clear_failure(pytester: pytest.Pytester, run) -> None:
    (pytester.path / "wrong.rplan").write_text("(goalem (ach nothing))", encoding="utf-8")
    pytester.makepyfile(
        "def test_none(plan):\n    plan('none.rplan')\ndef test_wrong(plan):\n    plan('wrong.rplan')\n"
        "def test_packaged(plan):\n    plan('make_room')\n"
    )
    result = run()
    result.assert_outcomes(failed=2, passed=1)
    result.stdout.fnmatch_lines(["there is no file or folder none.rplan*", "error?no-rule?: *"])
    assert result.stdout.str().count("\nthere is no file or folder none.rplan") == 1
    assert "another exception" not in result.stdout.str()


def test_a_folder_beside_the_test_is_its_plan(pytester: pytest.Pytester, run) -> None:
    (pytester.path / "robot").mkdir()
    (pytester.path / "robot" / "guard.rplan").write_text(GUARD, encoding="utf-8")
    pytester.makepyfile("def test_it(plan):\n    plan('robot').given('near').after('1s').expect(action='flee')\n")
    run().assert_outcomes(passed=1)


@pytest.mark.parametrize(
    ("does", "says"),
    [
        ("golden('none.ticks')", "FileNotFoundError: *none.ticks*"),
        ("episode('none.yaml').run()", "FileNotFoundError: *none.yaml*"),
        ("replayed('none.mcap')", "FileNotFoundError: *none.mcap*"),
        ("replayed(__file__)", "*RecordingError: *is not an MCAP file*"),
        ("episode('room.yaml').run(until=0.3).switches('akshun')", "*the plan has no output `akshun`*"),
    ],
)
def test_what_cannot_be_read_is_said_where_the_test_asks(does: str, says: str, pytester: pytest.Pytester, run) -> None:
    (pytester.path / "room.yaml").write_text(NOOK, encoding="utf-8")
    pytester.makepyfile(f"def test_it(plan):\n    plan('make_room').{does}\n")
    result = run("--tb=short")
    shown = [line for line in result.stdout.lines if ": in " in line]
    assert [line.partition(":")[0] for line in shown] == [Path(pytester.path).name.rstrip("0123456789") + ".py"], shown
    result.stdout.fnmatch_lines([f"E   {says}"])
