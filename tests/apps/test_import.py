"""`rplan import`: scenarios from worlds of other formats, recordings from logs, and errors in one line."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from rplan.apps.cli import cli
from sim.recording import readings
from sim.scenarios.format import load

SAMPLES = Path(__file__).parents[1] / "data" / "imports"


def run(*arguments: str) -> Result:
    result = CliRunner().invoke(cli, ["import", *arguments], catch_exceptions=False)
    assert "Traceback" not in result.output
    return result


def test_a_world_becomes_a_scenario_on_stdout_and_what_is_left_out_goes_to_stderr() -> None:
    result = run(str(SAMPLES / "yard.world"))
    assert result.exit_code == 0
    assert result.stdout.startswith("# Imported from yard.world (stage).\n")
    assert "left out: 1 x trailer: this type is nowhere defined\n" in result.stderr


def test_a_scenario_is_written_where_it_is_asked_for(tmp_path: Path) -> None:
    out = tmp_path / "world.yaml"
    result = run(f"{SAMPLES / 'cylinders.json'}#10", "-o", str(out), "--start", "-2", "4", "1.5")
    assert (result.exit_code, result.stdout) == (0, "")
    scenario = load(out)
    assert (scenario.name, scenario.robot.start, scenario.robot.heading) == ("BARN 10", (-2, 4), 1.5)


def test_options_reach_the_importer(tmp_path: Path) -> None:
    out = tmp_path / "world.yaml"
    run(str(SAMPLES / "small.map"), "-o", str(out), "--resolution", "0.5", "--model", "denning", "--least-area", "1")
    scenario = load(out)
    assert scenario.bounds == (0, 0, 3.5, 2.5)
    assert scenario.robot.build.mass == 120
    assert run(str(SAMPLES / "yard.world"), "--robot", "idle", "--summary").stdout.endswith("sensors\n")
    assert run(str(SAMPLES / "cylinders.json"), "--world", "10", "--format", "barn", "--summary").stdout.startswith(
        "cylinders.json (barn): 1 things, 1 discs"
    )


def test_the_summary_says_how_much_there_is() -> None:
    result = run(str(SAMPLES / "little_maze.txt"), "--summary")
    expected = "little_maze.txt (micromouse): 1 things, 0 discs, 3 rings, 18 vertices, 0 sensors\n"
    assert result.stdout == expected
    value = json.loads(run(str(SAMPLES / "small.map"), "--json").stdout)
    assert (value["rings"], value["vertices"], value["left_out"]) == (2, 16, ["swamp (1 cells): it is free"])


@pytest.mark.parametrize("name", ["corridor.log", "corridor.log.gz"])
def test_a_log_becomes_a_recording_from_which_readings_are_read(tmp_path: Path, name: str) -> None:
    out = tmp_path / "run.mcap"
    result = run(str(SAMPLES / name), "-o", str(out))
    assert (result.exit_code, result.stdout) == (0, f"{name} (carmen): 4 scans in 2.9 s\n")
    found = list(readings(out))
    assert [reading.tick for reading in found] == [0, 1, 2, 3]
    assert found[0].lidar is not None
    assert found[0].lidar.ranges[0] == 1.0


def test_the_summary_of_a_log_is_for_programs_too(tmp_path: Path) -> None:
    value = json.loads(run(str(SAMPLES / "corridor.log"), "-o", str(tmp_path / "a.mcap"), "--json").stdout)
    assert value == {"source": "corridor.log (carmen)", "scans": 4, "seconds": pytest.approx(2.9)}


def test_recordings_of_a_log_are_the_same_to_the_byte(tmp_path: Path) -> None:
    for name in ("a", "b"):
        run(str(SAMPLES / "corridor.log"), "-o", str(tmp_path / name))
    assert (tmp_path / "a").read_bytes() == (tmp_path / "b").read_bytes()


def test_what_cannot_be_imported_exits_with_2_and_one_line(tmp_path: Path) -> None:
    bad = tmp_path / "bad.world"
    bad.write_text("model (\n  size [1 1 x]\n)\n")
    sealed = tmp_path / "none" / "a.mcap"
    for arguments, message in [
        ([str(bad)], "bad.world:1: size: expected a number up to 100000, got 'x'"),
        ([str(tmp_path / "gone.map")], "gone.map: there is no such file"),
        ([str(SAMPLES / "corridor.log")], "corridor.log is a log: say where its recording goes (-o FILE.mcap)"),
        ([str(SAMPLES / "corridor.log"), "-o", str(sealed)], f"{sealed}: No such file or directory"),
        ([str(SAMPLES / "small.map"), "-o", str(sealed)], f"{sealed}: No such file or directory"),
        ([str(SAMPLES / "small.map"), "--start", "nan", "0", "0"], "--start: expected numbers up to 100000"),
    ]:
        result = run(*arguments)
        last = result.stderr.splitlines()[-1]
        assert (result.exit_code, result.stdout, last) == (2, "", f"error: {message}")


def test_a_scenario_that_would_be_unsound_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("rplan.apps.doing.import_.text_of", lambda imported: "name: x\n")
    result = run(str(SAMPLES / "small.map"))
    assert result.exit_code == 2
    assert "small.map: the scenario that comes of it is unsound: small.map:1:1: bounds: this key is missing" in (
        result.stderr
    )
