"""`rplan sweep`: what it writes, what it says, and what becomes of a sweep that is stopped (L24)."""

from __future__ import annotations

import csv
import importlib.util
import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import duckdb
import pytest
from click.testing import CliRunner, Result

from rplan.apps.cli import cli
from rplan.apps.doing import sweep as command
from rplan.apps.sweep import processes
from rplan.apps.sweep.processes import EngineError
from rplan.apps.sweep.rows import MEASURED
from rplan.apps.sweep.work import Row, Rows, Runner, Task, Work

PLANS = Path(__file__).parents[2] / "plans"
ROOM = str(PLANS / "make_room")
MAZE = str(Path(__file__).parents[1] / "data" / "imports" / "little_maze.txt")
VISIT = str(Path(__file__).parents[1] / "data" / "visit.yaml")
LOT = str(PLANS / "find_and_fetch" / "parking_lot.yaml")


def sweep(*arguments: str, environment: dict[str, str] | None = None) -> Result:
    """In the room with a task, where nothing else is said."""
    where = () if "--scenario" in arguments else ("--scenario", VISIT)
    result = CliRunner().invoke(cli, ["sweep", *arguments, *where], env=environment, catch_exceptions=False)
    assert "Traceback" not in result.output
    return result


def here(work: Work, tasks: list[Task], workers: int) -> Rows:
    """All tasks in this process, the last one first."""
    runner = Runner(work)
    for task in reversed(tasks):
        yield task, runner.row(task)


@pytest.fixture
def at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """No processes."""
    monkeypatch.setattr(processes, "run", here)


def stop_after(count: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """A user who presses Ctrl-C after so many rows."""

    def interrupted(work: Work, tasks: list[Task], workers: int) -> Rows:
        rows = here(work, tasks, workers)
        for _ in range(count):
            yield next(rows)
        raise KeyboardInterrupt

    monkeypatch.setattr(processes, "run", interrupted)


def table(path: Path) -> list[dict[str, str]]:
    """The rows of a CSV table without what is measured."""
    with path.open(newline="", encoding="utf-8") as file:
        return [{name: cell for name, cell in row.items() if name not in MEASURED} for row in csv.DictReader(file)]


# --- what it writes and says --------------------------------------------------------------------------


def test_every_combination_is_a_row_in_the_order_in_which_it_was_asked_for(at_once: None, tmp_path: Path) -> None:
    output = tmp_path / "rows.parquet"
    result = sweep(
        ROOM, "--scenario", LOT, "--scenario", VISIT, "--param", "runaway.safety-radius=50cm,0.4m",
        "--param", "scenario.time_limit=2,1", "--seeds", "3..4", "--seeds", "0", "-o", str(output),
    )  # fmt: skip
    assert (result.exit_code, result.stderr) == (0, "")
    with duckdb.connect() as database:
        names = 'scenario, "runaway.safety-radius", "scenario.time_limit", seed, duration, error'
        rows = database.execute(f"SELECT {names} FROM read_parquet(?)", [str(output)]).fetchall()
    assert rows == [
        (scenario, radius, limit, seed, float(limit), None)
        for scenario in ("parking lot", "visit")
        for radius in (0.5, 0.4)
        for limit in (2, 1)
        for seed in (0, 3, 4)
    ]
    assert result.stdout.startswith("make-room: 24 of 24 episodes: 0 done, 24 not done (")
    assert f"wrote {output}" in result.stdout
    assert [path.name for path in tmp_path.iterdir()] == ["rows.parquet"]


def test_the_summary_has_a_line_for_each_variant(at_once: None, tmp_path: Path) -> None:
    given = ("--param", "runaway.release=0.1m,0.2m", "--until", "2")
    out = sweep(ROOM, *given, "-o", str(tmp_path / "rows.csv")).stdout.splitlines()
    assert out[2].split()[:3] == ["scenario", "runaway.release", "n"]
    assert out[3].split() == ["visit", "0.1", "10", "0.0", "%", "0.0", "…", "27.8", "-", "-", "-", "0", "0"]
    assert out[4].split()[:3] == ["visit", "0.2", "10"]


def test_rows_come_from_processes_as_they_come_from_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    one, two = tmp_path / "one.csv", tmp_path / "two.csv"
    assert sweep(ROOM, "--seeds", "0..3", "--workers", "2", "-o", str(two)).exit_code == 0
    monkeypatch.setattr(processes, "run", here)
    sweep(ROOM, "--seeds", "0..3", "-o", str(one))
    assert table(one) == table(two)
    assert len(table(one)) == 4


@pytest.mark.rule("L24")
def test_the_summary_speaks_json(at_once: None, tmp_path: Path) -> None:
    output = tmp_path / "rows.csv"
    said: dict[str, Any] = json.loads(
        sweep(ROOM, "--param", "runaway.release=0.1m,0.2m", "--seeds", "0..1", "--json", "-o", str(output)).stdout
    )
    assert (said["plan"], said["episodes"], said["rows"], said["stopped"]) == ("make-room", 4, 4, False)
    assert said["output"] == str(output)
    assert [group["params"] for group in said["groups"]] == [{"runaway.release": 0.1}, {"runaway.release": 0.2}]
    assert said["groups"][0]["interval"][0] == 0.0
    assert said["groups"][0]["duration"] == {"n": 0, "median": None, "interval": None}


def test_times_of_what_was_done_are_summed_up_with_intervals(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def done(work: Work, tasks: list[Task], workers: int) -> Rows:
        for task in tasks:
            yield task, {"seed": task.seed, "done": True, "duration": 10.0 + task.seed, "one_way": 1.0, "error": None}

    monkeypatch.setattr(processes, "run", done)
    out = sweep(ROOM, "--require-done", "1", "-o", str(tmp_path / "rows.csv")).stdout
    assert "100.0 %  72.2 … 100.0  1.0 (1.0 … 1.0)               -  14.5 (11.0 … 18.0)" in out
    monkeypatch.setattr(processes, "run", here)


@pytest.mark.rule("L24")
@pytest.mark.parametrize(("share", "code"), [("0", 0), ("0.01", 1)])
def test_a_share_that_is_not_reached_exits_with_1(at_once: None, tmp_path: Path, share: str, code: int) -> None:
    output = str(tmp_path / "rows.csv")
    assert sweep(ROOM, "--until", "1", "--require-done", share, "-o", output).exit_code == code


@pytest.mark.rule("L24")
def test_an_episode_that_fails_is_told_and_exits_with_1(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def failing(work: Work, tasks: list[Task], workers: int) -> Rows:
        for task, row in here(work, tasks, workers):
            failed: Row = {"done": False, "error": f"ValueError: [{task.seed}]"}
            yield task, row | (failed if task.seed > 0 else {})

    monkeypatch.setattr(processes, "run", failing)
    result = sweep(ROOM, "--until", "1", "--seeds", "0..8", "-o", str(tmp_path / "rows.csv"))
    assert result.exit_code == 1
    assert "0 done, 1 not done, 8 failed" in result.stdout
    assert "failed: visit, seed 1: ValueError: [1]\n" in result.stdout
    assert "… and 3 more" in result.stdout
    assert [row["error"] for row in table(tmp_path / "rows.csv")[:2]] == ["", "ValueError: [1]"]


def test_worlds_of_other_formats_are_swept_and_changed_like_scenarios(at_once: None, tmp_path: Path) -> None:
    result = sweep(
        ROOM, "--scenario", MAZE, "--seeds", "0", "--param", "scenario.time_limit=1,2", "-o", str(tmp_path / "rows.csv")
    )
    assert (result.exit_code, result.stderr) == (0, "")
    assert [row["ticks"] for row in table(tmp_path / "rows.csv")] == ["10", "20"]


def test_a_pattern_stands_for_all_scenarios_that_it_fits(at_once: None, tmp_path: Path) -> None:
    for name in ("b", "c", "a"):
        (tmp_path / f"{name}.yaml").write_text(Path(LOT).read_text().replace("name: parking lot", f"name: lot {name}"))
    output = tmp_path / "rows.csv"
    sweep(ROOM, "--scenario", f"{tmp_path}/?.yaml", "--seeds", "0", "--until", "1", "-o", str(output))
    assert [row["scenario"] for row in table(output)] == ["lot a", "lot b", "lot c"]


def test_a_world_that_cannot_be_imported_is_told(tmp_path: Path) -> None:
    (tmp_path / "bad.world").write_text("floorplan ( ")
    result = sweep(ROOM, "--scenario", str(tmp_path / "bad.world"), "-o", str(tmp_path / "rows.csv"))
    assert (result.exit_code, result.stdout) == (2, "")
    assert result.stderr.startswith("error: nothing was run\n  bad.world")


def test_a_library_in_a_file_goes_to_the_workers(tmp_path: Path) -> None:
    (tmp_path / "spin.py").write_text(
        '"""Nothing."""\nfrom behaviours.interface import Function, Library, Offer\n'
        'SPIN = Library("spin", "No.", (Function("dizzy", "bool", "Never."),), (),\n'
        '    lambda values, workshop: Offer(percepts={"dizzy": lambda: False}))\n'
    )
    plan = tmp_path / "plan.rplan"
    plan.write_text(
        "(use robot) (use spin) (defoutput action command) (goalem (if (dizzy) (do anything) (do action (stop))))"
    )
    result = sweep(
        str(plan), "--scenario", LOT, "--library", str(tmp_path / "spin.py"), "--seeds", "0", "--until", "1",
        "-o", str(tmp_path / "rows.csv"),
    )  # fmt: skip
    assert result.exit_code == 0
    assert table(tmp_path / "rows.csv")[0]["ticks"] == "10"


def test_on_a_terminal_a_bar_shows_how_far_it_is(at_once: None, tmp_path: Path) -> None:
    environment = {"FORCE_COLOR": "1", "TTY_COMPATIBLE": "1", "COLUMNS": "150"}
    result = sweep(ROOM, "--until", "1", "-o", str(tmp_path / "rows.csv"), environment=environment)
    assert "10/10" in result.stderr
    assert "0 done, 10 not done" in result.stderr


# --- sweeps that are stopped --------------------------------------------------------------------------


def test_a_sweep_that_is_stopped_says_what_is_there_and_goes_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    output, whole = tmp_path / "rows.csv", tmp_path / "whole.csv"
    stop_after(3, monkeypatch)
    stopped = sweep(ROOM, "--until", "3", "--seeds", "0..7", "-o", str(output))
    assert stopped.exit_code == 1
    assert "make-room: 3 of 8 episodes: 0 done, 3 not done" in stopped.stdout
    assert f"stopped by hand; the rows are in {output}.jsonl, and --resume continues" in stopped.stdout
    assert not output.exists()
    again = sweep(ROOM, "--until", "3", "--seeds", "0..7", "--resume", "--json", "-o", str(output))
    assert json.loads(again.stdout)["output"] == f"{output}.jsonl"
    assert (json.loads(again.stdout)["resumed"], json.loads(again.stdout)["rows"]) == (3, 6)
    monkeypatch.setattr(processes, "run", here)
    ended = sweep(ROOM, "--until", "3", "--seeds", "0..7", "--resume", "-o", str(output))
    assert (ended.exit_code, Path(f"{output}.jsonl").exists()) == (0, False)
    assert "8 of 8 episodes, 6 of them before: " in ended.stdout
    sweep(ROOM, "--until", "3", "--seeds", "0..7", "-o", str(whole))
    assert table(output) == table(whole)


def test_what_was_all_there_is_written_without_a_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    stop_after(2, monkeypatch)
    sweep(ROOM, "--seeds", "0..1", "-o", str(tmp_path / "rows.csv"))
    monkeypatch.setattr(processes, "run", None)
    result = sweep(ROOM, "--seeds", "0..1", "--resume", "-o", str(tmp_path / "rows.csv"))
    assert result.exit_code == 0
    assert len(table(tmp_path / "rows.csv")) == 2


def test_a_sweep_that_is_stopped_before_its_first_row_has_nothing_to_say(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    stop_after(0, monkeypatch)
    result = sweep(ROOM, "-o", str(tmp_path / "rows.csv"))
    assert result.stdout.startswith("make-room: 0 of 10 episodes: 0 done, 0 not done\n")
    monkeypatch.setattr(processes, "run", here)
    assert sweep(ROOM, "--resume", "--until", "1", "-o", str(tmp_path / "rows.csv")).exit_code == 0


def test_the_rows_of_a_stopped_sweep_are_not_overwritten_nor_mixed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    output = str(tmp_path / "rows.csv")
    stop_after(2, monkeypatch)
    sweep(ROOM, "-o", output)
    before = Path(f"{output}.jsonl").read_text()
    anew = sweep(ROOM, "-o", output)
    assert (anew.exit_code, anew.stdout) == (2, "")
    assert anew.stderr.startswith(f"error: {output}.jsonl has rows of a sweep that was stopped: --resume continues it")
    other = sweep(ROOM, "--until", "3", "--resume", "-o", output)
    assert (other.exit_code, other.stdout) == (2, "")
    assert f"{output}.jsonl:1: an episode that this sweep does not ask for" in other.stderr
    assert Path(f"{output}.jsonl").read_text() == before


def test_workers_that_cannot_go_on_lose_no_row(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(work: Work, tasks: list[Task], workers: int) -> Rows:
        rows = here(work, tasks, workers)
        yield next(rows)
        raise EngineError("the machine is on fire")

    monkeypatch.setattr(processes, "run", broken)
    result = sweep(ROOM, "-o", str(tmp_path / "rows.csv"))
    assert result.exit_code == 2
    kept = tmp_path / "rows.csv.jsonl"
    assert result.stderr == f"error: the machine is on fire\n1 rows are kept in {kept}\n"
    assert len(kept.read_text().splitlines()) == 1


def test_an_interrupt_from_the_terminal_ends_every_process_and_keeps_the_rows(tmp_path: Path) -> None:
    """The signal goes to the whole group, as a terminal sends it, once three rows are there."""
    output = tmp_path / "rows.csv"
    hears = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)"
    arguments = [
        sys.executable,
        "-c",
        f"{hears}; from rplan.apps.cli import main; main()",
        "sweep",
        ROOM,
        "--scenario",
        VISIT,
    ]
    arguments += ["--workers", "2", "--seeds", "0..499", "-o", str(output)]
    with subprocess.Popen(arguments, stdout=-1, stderr=-1, text=True, start_new_session=True) as running:
        for _ in lines(Path(f"{output}.jsonl"), 3, running):
            pass
        os.killpg(running.pid, signal.SIGINT)
        out, err = running.communicate(timeout=30)
    assert (running.returncode, err) == (1, "")
    assert "stopped by hand; " in out
    rows = [json.loads(line) for line in Path(f"{output}.jsonl").read_text().splitlines()]
    assert 3 <= len(rows) < 500
    assert {(row["duration"], row["reason"].partition(" before ")[0]) for row in rows} == {
        (30.0, "out of time at 30 s")
    }


def lines(path: Path, count: int, running: subprocess.Popen[str]) -> Iterator[None]:
    """Turns of waiting until a file has so many lines or nobody writes them any more."""
    while running.poll() is None and not (path.exists() and path.read_text().count("\n") >= count):
        yield


# --- what is used wrongly -----------------------------------------------------------------------------


@pytest.mark.rule("L24")
@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--seeds", "x"), "nothing was run\n  --seeds: expected whole numbers"),
        (("--param", "runaway.releas=1m", "--param", "scenario.x"), "nothing was run\n  --param runaway.releas=1m: "),
        (("--scenario", LOT, "--scenario", LOT), "nothing was run\n  two scenarios are called 'parking lot'"),
        (("--scenario", "moon"), "there is no scenario moon"),
        (("--scenario", "moons/*.yaml"), "no file fits --scenario moons/*.yaml"),
        (("--until", "nan"), "--until is not a number"),
        (("--scheduler", "tcp://x:1"), "--scheduler is for --engine dask"),
        (("-o", "rows.txt"), "--output rows.txt: expected a name that ends in .parquet or .csv"),
        (("-o", "nowhere/rows.csv"), "there is no folder nowhere to write rows.csv into"),
        (("--library", "none.py"), "there is no file none.py"),
        (
            ("--seeds", "0..999999", "--param", "runaway.release=1m,2m"),
            "nothing was run\n  2,000,000 episodes are",
        ),
    ],
)
def test_what_is_used_wrongly_exits_with_2_before_anything_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: tuple[str, ...], said: str
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(processes, "run", None)
    result = sweep(ROOM, "-o", "rows.csv", *arguments)
    assert (result.exit_code, result.stdout) == (2, "")
    assert result.stderr.startswith(f"error: {said}")
    assert list(tmp_path.iterdir()) == []


def test_mistakes_in_a_scenario_are_told_with_their_places(tmp_path: Path) -> None:
    wrong = tmp_path / "wrong.yaml"
    wrong.write_text("name: nook\nbounds: 3\nlamp: 1\n")
    result = sweep(ROOM, "--scenario", str(wrong), "-o", str(tmp_path / "rows.csv"))
    assert result.exit_code == 2
    assert "  wrong.yaml:2:9: bounds: expected" in result.stderr
    assert "  wrong.yaml:3:1: lamp: unknown key" in result.stderr


def test_a_scenario_that_cannot_be_read_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def unreadable(path: Path) -> None:
        raise PermissionError(13, "Permission denied", str(path))

    monkeypatch.setattr(command, "load_world", unreadable)
    result = sweep(ROOM, "-o", str(tmp_path / "rows.csv"))
    assert (result.exit_code, result.stderr.splitlines()[-1].endswith("visit.yaml: Permission denied")) == (2, True)


def test_a_table_that_cannot_be_written_is_told_and_its_rows_are_kept(
    at_once: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(path: Path, work: Work, rows: list[Row]) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(command, "write", full)
    result = sweep(ROOM, "--until", "1", "-o", str(tmp_path / "rows.csv"))
    assert (result.exit_code, result.stdout) == (2, "")
    assert result.stderr == f"error: {tmp_path / 'rows.csv'}: No space left on device\n"
    assert len((tmp_path / "rows.csv.jsonl").read_text().splitlines()) == 10


@pytest.mark.parametrize(
    ("missing", "arguments", "said"),
    [
        ("duckdb", ("-o", "rows.parquet"), "Parquet needs DuckDB: pip install"),
        (
            "distributed",
            ("--engine", "dask", "-o", "rows.csv"),
            "--engine dask needs dask: pip install 'rplan[cluster]'",
        ),
    ],
)
def test_an_extra_that_is_missing_is_told(
    missing: str, arguments: tuple[str, ...], said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    find = importlib.util.find_spec
    monkeypatch.setattr(command, "find_spec", lambda name: None if name == missing else find(name))
    monkeypatch.chdir(tmp_path)
    result = sweep(ROOM, *arguments)
    assert (result.exit_code, result.stdout) == (2, "")
    assert result.stderr.startswith(f"error: {said}")


def test_dask_is_asked_with_the_scheduler_that_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str | None] = []

    def run(work: Work, tasks: list[Task], workers: int, address: str | None) -> Rows:
        asked.append(address)
        return here(work, tasks, workers)

    monkeypatch.setitem(sys.modules, "rplan.apps.sweep.cluster", SimpleNamespace(run=run))
    monkeypatch.setattr("rplan.apps.sweep.cluster", SimpleNamespace(run=run), raising=False)
    output = str(tmp_path / "rows.csv")
    assert sweep(ROOM, "--until", "1", "--engine", "dask", "--scheduler", "tcp://x:1", "-o", output).exit_code == 0
    assert asked == ["tcp://x:1"]
