"""`rplan tick`: JSON lines in, JSON lines out, and what is said of lines that are wrong (L22)."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner, Result

from behaviours.interface import Odometry, Pose, Ranges, Reading
from rplan.apps.cli import cli
from sim.recording import Recorder, read

PLAN = """(use robot)
(declare (lost) bool "")
(declare (gap) (number m) "")
(declare (sees (what symbol)) bool "")
(declare (spare) bool "")
(defoutput goal pose)
(defoutput action command :idle (stop))
(goalem (when (or (lost) (sees car) (< (gap) 2m)) (do action (stop))))
"""
GOOD = {"lost": False, "gap": 3, "(sees car)": False}


@pytest.fixture
def plan(tmp_path: Path) -> str:
    path = tmp_path / "plan.rplan"
    path.write_text(PLAN, encoding="utf-8")
    return str(path)


def tick(plan: str, *lines: str | bytes | dict[str, object], options: tuple[str, ...] = ()) -> Result:
    raw = [json.dumps(line) if isinstance(line, dict) else line for line in lines]
    stdin = b"".join((line if isinstance(line, bytes) else line.encode()) + b"\n" for line in raw)
    result = CliRunner().invoke(cli, ["tick", plan, *options], input=stdin, catch_exceptions=False)
    assert "Traceback" not in result.output
    return result


@pytest.mark.rule("L22")
def test_every_line_becomes_a_line_with_the_fields_of_the_language(plan: str) -> None:
    result = tick(plan, GOOD, "", GOOD | {"lost": True}, GOOD | {"gap": 1.5})
    assert result.exit_code == 0
    lines = [json.loads(line) for line in result.stdout.splitlines()]
    assert [[*line] for line in lines] == [["tick", "hole", "outputs", "sent", "way"]] * 3
    assert [line["tick"] for line in lines] == [0, 1, 2]
    assert [line["outputs"] for line in lines] == [
        {"goal": None, "action": None},
        {"goal": None, "action": "(stop)"},
        {"goal": None, "action": "(stop)"},
    ]
    assert [line["sent"] for line in lines] == [{"goal": None, "action": "(stop)"}] * 3
    assert result.stdout.startswith(
        '{"tick": 0, "hole": false, "outputs": {"goal": null, "action": null}, "sent": {"goal": null, '
    )


@pytest.mark.rule("L22")
@pytest.mark.parametrize(
    "line",
    [
        {"(lost)": False, "(gap)": 3, "(sees car)": False},
        GOOD | {"spare": True, "speed": 0.1, "time-since-start": 3},
        "\ufeff" + json.dumps(GOOD),
        json.dumps(GOOD) + "\r",
    ],
)
def test_canonical_keys_percepts_that_are_only_declared_and_odd_line_ends_are_accepted(
    plan: str, line: str | dict[str, object]
) -> None:
    assert tick(plan, line).exit_code == 0


@pytest.mark.rule("L22")
@pytest.mark.parametrize(
    ("line", "said"),
    [
        (GOOD | {"weather": True}, "`weather` is a percept that the plan neither declares nor reads"),
        (GOOD | {"spear": True}, "`spear` is a percept"),
        (GOOD | {"spar": True}, "`spar` is a percept"),
        (GOOD | {"speeed": 1}, "(did you mean `speed`?)"),
        (GOOD | {"stop": True}, "`stop` is a percept that the plan neither declares nor reads"),
        (GOOD | {"sees": True}, "`sees` is a percept that the plan neither declares nor reads"),
        ({"lost": False, "gap": 3}, "`(sees car)`: the plan reads it, and there is no value"),
        ({"lost": False, "(sees car)": True}, "`gap`: the plan reads it, and there is no value"),
        (GOOD | {"lost": 1}, "`lost`: true or false is wanted, not 1"),
        (GOOD | {"lost": None}, "`lost`: true or false is wanted, not null"),
        (GOOD | {"gap": "2m"}, '`gap`: a finite number is wanted, not "2m"'),
        (GOOD | {"gap": True}, "`gap`: a finite number is wanted, not true"),
        (GOOD | {"gap": float("nan")}, "`gap`: a finite number is wanted, not NaN"),
        (GOOD | {"gap": float("inf")}, "`gap`: a finite number is wanted, not Infinity"),
        (GOOD | {"gap": 10**400}, "`gap`: a finite number is wanted, not 1000"),
        (GOOD | {"spare": "no"}, '`spare`: true or false is wanted, not "no"'),
        (GOOD | {"speed": float("nan")}, "`speed`: a finite number is wanted, not NaN"),
        (GOOD | {"(lost)": True}, "`lost` is there twice, also as `(lost)`"),
        ('{"lost": true, "lost": true}', "`lost` is there twice"),
        ('{"lost": tru', "not JSON: Expecting value at column 10"),
        ('{"lost": true', "not JSON: "),
        ("lost", "not JSON: Expecting value at column 1"),
        ("[1, 2]", "an object percept → value is wanted, not [1, 2]"),
        ("null", "an object percept → value is wanted, not null"),
        ("[" * 100_000, "nested too deep"),
        ('{"gap": ' + "1" * 5_000 + "}", "a number has too many digits"),
        (b'{"lost": "\xff"}', "not text in UTF-8"),
    ],
)
def test_a_wrong_line_ends_it_with_line_and_key_after_the_lines_before_it(
    plan: str, line: str | bytes | dict[str, object], said: str
) -> None:
    result = tick(plan, GOOD, "", line, GOOD)
    assert result.exit_code == 2
    assert len(result.stdout.splitlines()) == 1
    last = result.stderr.splitlines()[-1]
    assert last.startswith("error: line 3: ")
    assert said in last


@pytest.mark.rule("L22")
def test_an_empty_input_gives_nothing(plan: str) -> None:
    result = tick(plan)
    assert (result.exit_code, result.stdout) == (0, "")


def test_lines_may_come_from_a_file(plan: str, tmp_path: Path) -> None:
    lines = tmp_path / "lines"
    lines.write_text(json.dumps(GOOD), encoding="utf-8")
    assert len(tick(plan, options=("--input", str(lines))).stdout.splitlines()) == 1
    assert tick(plan, options=("--input", str(tmp_path / "nowhere"))).exit_code == 2


@pytest.mark.rule("L18")
def test_a_tick_in_a_hole_says_so_and_sends_idle_values(tmp_path: Path) -> None:
    path = tmp_path / "hole.rplan"
    path.write_text(
        "(defoutput a symbol :idle rest) (defoutput b symbol :hold :initial low)"
        "(goalem (and (when (lost) (and (do a one) (do b high))) (when (found) (do a two))))"
    )
    result = tick(
        str(path), *({"lost": x, "found": y} for x, y in ((True, False), (True, True))), options=("--allow-holes",)
    )
    hole = json.loads(result.stdout.splitlines()[1])
    assert hole["hole"] is True
    assert hole["outputs"] == {"a": None, "b": None}
    assert hole["sent"] == {"a": "rest", "b": "high"}
    assert hole["way"] == {"rules": [], "branches": [], "acts": [], "given_up": []}


def test_a_plan_that_reads_its_own_failures_takes_them_as_percepts(tmp_path: Path) -> None:
    path = tmp_path / "plan.rplan"
    path.write_text(
        "(use robot) (defoutput action command)(goalem (when (not (competence-failed stop)) (do action (stop))))"
    )
    result = tick(str(path), {"(competence-failed stop)": True}, {"(competence-failed stop)": False})
    assert [json.loads(line)["outputs"]["action"] for line in result.stdout.splitlines()] == [None, "(stop)"]


# --- over readings that were recorded ---------------------------------------------------------------

MAKE_ROOM = Path(__file__).parents[2] / "plans" / "make_room" / "make_room.rplan"
RINGS = np.linspace(-math.pi, math.pi, 24, endpoint=False), np.linspace(-math.pi, math.pi, 6, endpoint=False)


def sensed(n: int, nearest: float) -> Reading:
    """The robot stands; the nearest echo of its sonars is straight ahead."""
    waist, skirt = (
        Ranges(n / 10, True, bearings, np.where(bearings == 0, nearest, 5.0), 7.62, 0.35) for bearings in RINGS
    )
    return Reading(n / 10, n, Odometry(Pose(0.0, 0.0), 0.0, 0.0, n / 10), sonar=waist, skirt=skirt)


def recorded(path: Path, *nearest: float) -> str:
    with Recorder(path, {"plan": None}) as recorder:
        for n, distance in enumerate(nearest):
            recorder.tick(n / 10, {}, "null", sensed(n, distance))
    return str(path)


def over(plan: str | Path, recording: str, *options: str) -> Result:
    result = CliRunner().invoke(
        cli, ["tick", str(plan), "--readings", recording, *options], catch_exceptions=False, input=b""
    )
    assert "Traceback" not in result.output
    return result


def test_a_plan_runs_over_readings_that_were_recorded_without_a_world(tmp_path: Path) -> None:
    recording = recorded(tmp_path / "run.mcap", 5.0, 5.0, 0.1, 0.1, 5.0)
    result = over(MAKE_ROOM, recording)
    assert result.exit_code == 0
    lines = [json.loads(line) for line in result.stdout.splitlines()]
    assert [[*line] for line in lines] == [["t", "tick", "hole", "outputs", "sent", "way"]] * 5
    assert [line["t"] for line in lines] == [0.0, 0.1, 0.2, 0.3, 0.4]
    assert [line["tick"] for line in lines] == [0, 1, 2, 3, 4]
    fleeing = "(move-away-from-danger)"
    assert [line["sent"]["action"] for line in lines[:4]] == ["(stop)", "(stop)", fleeing, fleeing]


def test_switches_are_only_the_ticks_in_which_something_else_is_sent(tmp_path: Path) -> None:
    recording = recorded(tmp_path / "run.mcap", 5.0, 5.0, 0.1, 0.1)
    lines = [json.loads(line) for line in over(MAKE_ROOM, recording, "--switches").stdout.splitlines()]
    assert [(line["tick"], line["sent"]["action"]) for line in lines] == [(0, "(stop)"), (2, "(move-away-from-danger)")]


def test_a_run_in_a_world_decides_the_same_over_its_own_recording(tmp_path: Path) -> None:
    path = str(tmp_path / "run.mcap")
    CliRunner().invoke(cli, ["simulate", str(MAKE_ROOM), "--until", "10", "--record", path])
    ticks: list[Any] = list(read(path).ticks)
    then = [tick["plan"]["sent"] for tick in ticks if tick["plan"]]
    again = [json.loads(line)["sent"] for line in over(MAKE_ROOM, path).stdout.splitlines()]
    assert again[: len(then)] == then
    assert len({*map(str, then)}) > 1, "something happened"


def test_a_recording_without_readings_and_no_recording_are_clear_errors(tmp_path: Path) -> None:
    with Recorder(tmp_path / "bare.mcap", {"plan": None}) as recorder:
        recorder.tick(0.0, {}, "null")
    (tmp_path / "text.mcap").write_text("(plan)")
    for name, says in (
        ("bare.mcap", "holds no readings"),
        ("text.mcap", "is not an MCAP file"),
        ("none.mcap", "none.mcap: No such file"),
    ):
        result = over(MAKE_ROOM, str(tmp_path / name))
        assert result.exit_code == 2
        assert says in result.stderr


def test_switches_without_readings_are_refused(plan: str) -> None:
    result = tick(plan, options=("--switches",))
    assert result.exit_code == 2
    assert "--switches goes with --readings" in result.stderr


def test_a_plan_that_nothing_brings_to_life_cannot_run_over_readings(plan: str, tmp_path: Path) -> None:
    result = over(plan, recorded(tmp_path / "run.mcap", 5.0))
    assert result.exit_code == 1
    assert "error[unbound]" in result.stderr
