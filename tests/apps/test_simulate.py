"""`rplan simulate`: the verdict, why switches happened, recordings, and what is said of wrong scenarios (L24)."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner, Result

from behaviours.competences.fixate import Fixate
from rplan.apps import files
from rplan.apps.cli import cli
from rplan.apps.simulation import lasted
from rplan.apps.wiring import PlanBrain
from sim.recording import read

PLANS = Path(__file__).parents[2] / "plans"
FIND = str(PLANS / "find_and_fetch" / "find_and_fetch.rplan")
LOT = str(PLANS / "find_and_fetch" / "parking_lot.yaml")
SMALL = """name: nook
bounds: [-2, -2, 2, 2]
robot: {start: [0, 0], heading: 0}
donor: {at: [1.9, 0]}
"""


def simulate(*arguments: str, environment: dict[str, str] | None = None) -> Result:
    result = CliRunner().invoke(cli, ["simulate", *arguments], env=environment, catch_exceptions=False)
    assert "Traceback" not in result.output
    return result


@pytest.fixture
def nook(tmp_path: Path) -> str:
    path = tmp_path / "nook.yaml"
    path.write_text(SMALL, encoding="utf-8")
    return str(path)


# --- the verdict ------------------------------------------------------------------------------------


@pytest.mark.rule("L24")
def test_a_run_that_does_not_finish_the_task_exits_with_1_and_says_why() -> None:
    result = simulate(FIND, "--until", "5")
    assert (result.exit_code, result.stderr) == (1, "")
    assert result.stdout.startswith("NOT DONE: out of time at 5 s ")
    assert "find-and-fetch in parking lot, seed 0" in result.stdout
    rows = dict(re.findall(r"^ (\S.*?)  +(\S+) *$", result.stdout, re.MULTILINE))
    assert (rows["ticks"], rows["holes"], rows["contacts"]) == ("50", "0", "0")


def test_every_switch_says_what_made_it() -> None:
    out = simulate(FIND, "--until", "5").stdout
    assert re.search(r"0\.0 s +action +\(start-ir-search\) +it is the first tick", out)
    assert re.search(r"0\.1 s +action +\(continue-ir-search\) +\(ir-search-has-been-started\) became true", out)


def test_a_condition_that_changed_but_that_neither_way_asks_is_no_reason(nook: str, tmp_path: Path) -> None:
    plan = tmp_path / "plan.rplan"
    plan.write_text(
        "(use robot) (defoutput action command)"
        "(goalem (if (> (time-since-start) 0.5s) (do action (stop))"
        " (when (> (time-since-start) 9s) (if (>= (time-since-start) 0.55s) (do action (stop)) (do anything)))))"
    )
    verdict = json.loads(simulate(str(plan), "--scenario", nook, "--until", "1", "--json").stdout)
    assert [switch["because"] for switch in verdict["switches"]] == ["(> (time-since-start) 0.5s) became true"]


@pytest.mark.rule("L24")
def test_the_verdict_speaks_json() -> None:
    result = simulate(FIND, "--until", "5", "--json", "--seed", "3")
    verdict: dict[str, Any] = json.loads(result.stdout)
    assert result.exit_code == 1
    assert (verdict["plan"], verdict["scenario"], verdict["seed"]) == ("find-and-fetch", "parking lot", 3)
    assert (verdict["done"], verdict["ticks"], verdict["duration"]) == (False, 50, 5.0)
    assert verdict["competences"]["(continue-ir-search)"] == {"ticks": 49, "switches": 1}
    assert sum(share["ticks"] for share in verdict["competences"].values()) == 50
    assert verdict["holes"] == 0
    assert verdict["faults"] == []


def test_a_plan_that_commands_nothing_leaves_the_robot_where_it_is(nook: str, tmp_path: Path) -> None:
    plan = tmp_path / "nothing.rplan"
    plan.write_text("(plan [/red] :period 0.1s) (goalem (do anything))", encoding="utf-8")
    result = simulate(str(plan), "--scenario", nook, "--until", "1")
    assert result.exit_code == 1
    assert "[/red] in nook, seed 0" in result.stdout
    assert json.loads(simulate(str(plan), "--scenario", nook, "--until", "1", "--json").stdout)["distance"] == 0.0


def test_a_hole_is_driven_only_where_holes_are_allowed_and_is_counted(nook: str, tmp_path: Path) -> None:
    plan = tmp_path / "hole.rplan"
    plan.write_text(
        "(use robot) (defoutput action command :idle (stop)) (defoutput x bool)"
        "(goalem (and (do action (stop)) (do x true) (when (>= (time-since-start) 0.45s) (do x false))))"
    )
    refused = simulate(str(plan), "--scenario", nook, "--until", "1")
    assert (refused.exit_code, refused.stdout) == (1, "")
    assert "when: (time-since-start) = 0.45s" in refused.stderr
    allowed = simulate(str(plan), "--scenario", nook, "--until", "1", "--allow-holes", "--json")
    assert json.loads(allowed.stdout)["holes"] == 5


def test_a_competence_that_fails_shows_as_a_fault_with_its_time(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(self: Fixate, reading: object, channels: object) -> None:
        raise RuntimeError("the head is stuck [/]")

    monkeypatch.setattr(Fixate, "step", fail)
    result = simulate(FIND, "--until", "1")
    assert "fault at 0.0 s: (start-ir-search): RuntimeError: the head is stuck [/]" in result.stdout
    assert json.loads(simulate(FIND, "--until", "1", "--json").stdout)["faults"]


def test_a_run_that_is_stopped_by_hand_gives_the_verdict_so_far(monkeypatch: pytest.MonkeyPatch) -> None:
    step = PlanBrain.step

    def interrupted(self: PlanBrain, reading: Any) -> Any:
        if reading.tick == 20:
            raise KeyboardInterrupt
        return step(self, reading)

    monkeypatch.setattr(PlanBrain, "step", interrupted)
    result = simulate(FIND)
    assert result.exit_code == 1
    assert result.stdout.startswith("NOT DONE: stopped by hand at 2 s ")


def test_on_a_terminal_a_bar_shows_time_and_phase() -> None:
    result = simulate(FIND, "--until", "12", environment={"FORCE_COLOR": "1", "TTY_COMPATIBLE": "1"})
    assert " s " in result.stderr
    assert "to the donor" in result.stderr


# --- recordings -------------------------------------------------------------------------------------


def test_a_run_is_recorded_replayed_and_plotted(tmp_path: Path) -> None:
    record, replay, plot = (tmp_path / name for name in ("run.mcap", "run.html", "run.png"))
    result = simulate(FIND, "--until", "3", "--record", str(record), "--replay", str(replay), "--plot", str(plot))
    assert result.exit_code == 1
    for path in (record, replay, plot):
        assert path.stat().st_size > 1_000
        assert f"wrote {path}" in result.stdout.replace("\n", "").replace("wrote", "wrote ").replace("  ", " ")
    recording = read(record)
    assert recording.header["plan"]["name"] == "find-and-fetch"
    assert sum(1 for _ in recording.ticks) >= 30


def test_a_page_alone_leaves_no_recording_behind(tmp_path: Path) -> None:
    simulate(FIND, "--until", "1", "--replay", str(tmp_path / "run.html"))
    assert [path.name for path in tmp_path.iterdir()] == ["run.html"]


@pytest.mark.rule("L24")
@pytest.mark.parametrize("option", ["--record", "--replay", "--plot"])
def test_a_folder_that_is_not_there_is_refused_before_the_run(option: str, tmp_path: Path) -> None:
    result = simulate(FIND, "--until", "5", option, str(tmp_path / "nowhere" / "run"))
    assert (result.exit_code, result.stdout) == (2, "")
    assert "there is no folder" in result.stderr


@pytest.mark.rule("L24")
@pytest.mark.parametrize("option", ["--record", "--replay", "--plot"])
def test_a_file_that_cannot_be_written_is_said_so(option: str) -> None:
    name = "x" * 300 + ".png"
    result = simulate(FIND, "--until", "0.5", option, name)
    assert result.exit_code == 2
    assert "File name too long" in result.stderr


def run_apart(hash_seed: int, folder: Path) -> bytes:
    target = folder / f"{hash_seed}.mcap"
    command = [sys.executable, "-c", "from rplan.apps.cli import main; main()"]
    done = subprocess.run(
        [*command, "simulate", FIND, "--until", "60", "--seed", "7", "--record", str(target)],
        env=os.environ | {"PYTHONHASHSEED": str(hash_seed)}, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 1, done.stderr
    return target.read_bytes()


def test_the_same_run_is_the_same_recording_byte_for_byte_whatever_the_hash_seed(tmp_path: Path) -> None:
    assert run_apart(1, tmp_path) == run_apart(2, tmp_path)


# --- what can be wrong with the input ---------------------------------------------------------------


@pytest.mark.rule("L24")
@pytest.mark.parametrize(
    ("text", "said"),
    [
        (SMALL.replace("[1.9, 0]", "[far, 0]"), "4:"),
        (SMALL.replace("[1.9, 0]", "[far, 0]"), "donor.at[0]: expected a length in metres, got 'far'"),
        (SMALL.replace("bounds: [-2, -2, 2, 2]", "bounds: 3"), "bounds: expected a region"),
        (SMALL + "colour: red\n", "colour: unknown key"),
        (SMALL.replace("name: nook\n", ""), "name"),
        ("{{{", "not YAML"),
        (b"\xff\xfe\x00", "not"),
        ("", "broken.yaml:1:1: "),
    ],
)
def test_a_broken_scenario_is_told_by_line_key_and_what_is_expected(
    tmp_path: Path, text: str | bytes, said: str
) -> None:
    path = tmp_path / "broken.yaml"
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    result = simulate(FIND, "--scenario", str(path), "--until", "1")
    assert (result.exit_code, result.stdout) == (2, "")
    assert "error: the scenario is wrong\n  broken.yaml:" in result.stderr
    assert said in result.stderr


@pytest.mark.rule("L24")
def test_a_scenario_is_found_beside_the_plan_by_name_or_alone(tmp_path: Path) -> None:
    plan = tmp_path / "plan.rplan"
    plan.write_text("(goalem (do anything))")
    none = simulate(str(plan), "--until", "1")
    assert (none.exit_code, none.stdout) == (2, "")
    assert "there is no scenario (*.yaml) beside" in none.stderr
    (tmp_path / "worlds").mkdir()
    (tmp_path / "worlds" / "far.yaml").write_text(SMALL)
    assert simulate(str(plan), "--until", "1").stderr.endswith("give one with --scenario, such as worlds/far\n")
    assert "in nook" in simulate(str(plan), "--until", "1", "--scenario", "worlds/far").stdout
    (tmp_path / "one.yaml").write_text(SMALL)
    assert "in nook" in simulate(str(plan), "--until", "1").stdout
    (tmp_path / "two.yaml").write_text(SMALL.replace("nook", "niche"))
    assert "say which with --scenario: one.yaml, two.yaml" in simulate(str(plan), "--until", "1").stderr
    assert "in niche" in simulate(str(plan), "--until", "1", "--scenario", "two").stdout
    assert "in niche" in simulate(str(plan), "--until", "1", "--scenario", "two.yaml").stdout
    assert "there is no scenario three" in simulate(str(plan), "--scenario", "three").stderr
    assert "is a folder" in simulate(str(plan), "--scenario", str(tmp_path)).stderr


@pytest.mark.rule("L24")
def test_a_scenario_that_the_system_does_not_give_is_said_so(nook: str, monkeypatch: pytest.MonkeyPatch) -> None:
    from rplan.apps import simulation as module

    def refuse(path: Path) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(module, "load_world", refuse)
    assert simulate(FIND, "--scenario", nook).stderr == f"error: {nook}: Permission denied\n"


@pytest.mark.rule("L24")
@pytest.mark.parametrize("until", ["0", "-1", "nan", "inf", "soon"])
def test_a_time_that_is_none_is_refused(until: str) -> None:
    result = simulate(FIND, "--until", until)
    assert (result.exit_code, result.stdout) == (2, "")
    assert "--until" in result.stderr


@pytest.mark.rule("L24")
def test_a_plan_that_nothing_brings_to_life_is_wrong() -> None:
    result = simulate(str(PLANS / "figure_1" / "figure.rplan"), "--scenario", LOT, "--until", "1")
    assert (result.exit_code, result.stdout) == (1, "")
    assert result.stderr.count("error[unbound]") > 10
    assert "hint: `use` a library that offers it" in result.stderr


@pytest.mark.rule("L24")
def test_a_scenario_without_room_for_what_it_scatters_is_told(tmp_path: Path) -> None:
    path = tmp_path / "full.yaml"
    path.write_text(SMALL + "scatter: [{kinds: [person], count: [50, 50], region: [-1, -1, 1, 1], min_gap: 1}]\n")
    result = simulate(FIND, "--scenario", str(path), "--until", "1")
    assert (result.exit_code, result.stdout) == (2, "")
    said = "no room for 50 scattered things in [-1.0, -1.0, 1.0, 1.0]: make the region wider or min_gap smaller"
    assert result.stderr == f"error: full.yaml, seed 0: scatter: {said}\n"


def test_plans_of_an_installed_rplan_come_from_its_own_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "patrol").mkdir()
    (tmp_path / "patrol" / "patrol.rplan").write_text("(goalem (do anything))")
    monkeypatch.setattr(files, "PACKAGED", tmp_path)
    assert [path.name for path in files.packaged_plans()] == ["patrol.rplan"]


@pytest.mark.rule("L24")
def test_a_recording_that_finds_no_room_on_the_disk_is_told_plainly() -> None:
    result = simulate(FIND, "--until", "1", "--record", "/dev/full")
    assert (result.exit_code, result.stdout) == (2, "")
    assert "/dev/full: the recording cannot be written" in result.stderr


def test_a_scenario_of_another_plan_is_found_by_its_folder_and_name() -> None:
    result = simulate("fetch_by_operators", "--scenario", "find_and_fetch/parking_lot", "--until", "1")
    assert "fetch-by-operators in parking lot" in result.stdout
    without = simulate("fetch_by_operators", "--until", "1")
    assert without.exit_code == 2
    assert "find_and_fetch/parking_lot, make_room/visit" in without.stderr


@pytest.mark.parametrize(
    ("seconds", "said"),
    [(None, "-"), (0.04, "0.0 s"), (59.94, "59.9 s"), (59.96, "1 min 00.0 s"), (239.96, "4 min 00.0 s")],
)
def test_times_are_rounded_before_they_are_taken_apart(seconds: float | None, said: str) -> None:
    assert lasted(seconds) == said
