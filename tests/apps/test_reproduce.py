"""`rplan reproduce`: which rows are run, what is said of them, and what is written."""

from __future__ import annotations

import csv
import json
from collections.abc import Iterator, Sequence
from dataclasses import replace
from multiprocessing import Pipe
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from rplan.apps.cli import cli
from rplan.apps.doing import reproduce as command
from rplan.apps.reproduce import experiment, report
from rplan.apps.reproduce.experiment import Asked, Bench, batches
from rplan.apps.reproduce.figures import case_of, seed_of
from rplan.apps.reproduce.row import Case, Finding, Judgement, Measures, Plot, Preset, Row, Seen
from rplan.apps.reproduce.rows import every_row, row_named
from rplan.apps.sweep import processes
from rplan.apps.sweep.processes import READY, EngineError, Unfit
from rplan.apps.sweep.work import Change, Rows, Task, Work

SHORT = (("time_limit", "2"),)


def measure(seen: Seen) -> Measures:
    if seen.verdict.duration > 2.5:
        raise ValueError("too long")
    return {"ticks": len(seen.moments), "x": seen.moments[0].pose.x + 0.5, "moved": False, "note": "still"}


def judge(preset: Preset, measures: Sequence[Measures]) -> tuple[Finding, ...]:
    ticks = sum(int(one["ticks"] or 0) for one in measures)
    first = measures[0] if measures else None
    verdict: Judgement = "met" if preset == "paper" else "missed"
    because = "" if preset == "paper" else "nothing moves"
    return (Finding("ticks", "20", str(ticks), verdict, because, case_of(first), seed_of(first)),)


def cases(seeds: int) -> tuple[Case, ...]:
    every = tuple(range(seeds))
    return (
        Case("short", "go_to_goal", "make_room/visit", every, SHORT),
        Case("whole", "go_to_goal", "make_room/visit", every[:1]),
    )


ROW = Row(
    name="T1",
    paper="tests",
    title="A short run",
    set_up="Two seconds.",
    printed="“Two.”",
    cases=cases,
    measure=measure,
    judge=judge,
    plots=(Plot("x", "x [m]", 1.0, (0.0, 1.0)), Plot("nothing", "never there")),
    note="It tells nothing.",
)
STILL = replace(row_named("B8"), name="T2", paper="tests")


def here(work: Work, tasks: Sequence[Task], workers: int, start: object) -> Rows:
    """All tasks in this process, the last one first."""
    bench = Bench(work)
    for task in reversed(tasks):
        yield task, bench.row(task)


@pytest.fixture(autouse=True)
def two_rows(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Rows that take no time, in this process."""
    monkeypatch.setattr(command, "every_row", lambda: (ROW, STILL))
    monkeypatch.setattr(experiment, "row_named", lambda name: ROW)
    monkeypatch.setattr(processes, "run", here)
    yield


def reproduce(*arguments: str) -> Result:
    result = CliRunner().invoke(cli, ["reproduce", *arguments], catch_exceptions=False)
    assert "Traceback" not in result.output
    return result


# --- which rows ---------------------------------------------------------------------------------------


def test_the_rows_of_find_and_fetch_stand_in_their_order() -> None:
    rows = every_row()
    assert [row.name for row in rows if row.paper == "find-and-fetch"] == [f"B{n}" for n in range(1, 9)]


def test_every_case_of_every_row_names_a_plan_and_a_scenario_that_can_be_run() -> None:
    for row in every_row():
        asked = [Asked(row, preset) for preset in row.presets]
        for one in asked:
            names = [case.name for case in row.cases_with(one.preset, 4)]
            assert len(names) == len(set(names)), (row.name, one.preset)
        assert sum(len(batch.tasks) for batch in batches(asked, 4)) == sum(
            len(case.seeds) for one in asked for case in row.cases_with(one.preset, 4)
        )


def test_the_list_says_which_rows_there_are_and_runs_nothing() -> None:
    result = reproduce("--list")
    assert result.exit_code == 0
    assert "T1" in result.stdout and "A short run. Two seconds." in result.stdout
    assert [row["row"] for row in json.loads(reproduce("--list", "--json").stdout)] == ["T1", "T2"]


@pytest.mark.parametrize(
    ("name", "hint"), [("T3", "did you mean T"), ("test", "did you mean tests"), ("zzz", "there are: T1")]
)
def test_a_row_that_is_not_there_is_told_with_what_was_meant(name: str, hint: str) -> None:
    result = reproduce(name)
    assert result.exit_code == 2
    assert f"there is no row or paper {name}" in result.stderr and hint in result.stderr


def test_a_row_is_found_by_its_name_or_by_its_paper_in_any_case() -> None:
    assert [row.name for row in command.chosen_rows(["t2"])] == ["T2"]
    assert [row.name for row in command.chosen_rows(["Tests", "T1"])] == ["T1", "T2"]


# --- what is said -------------------------------------------------------------------------------------


def test_the_table_has_the_paper_beside_ours_and_a_command_that_shows_one_run() -> None:
    result = reproduce("T1", "T2", "--seeds", "1")
    assert result.exit_code == 1, "the whole run failed"
    lines = result.stdout.splitlines()
    assert lines[0].split()[:3] == ["row", "preset", "set-up"]
    assert any("T1" in line and "met" in line for line in lines)
    assert "rplan reproduce T1 --case" in result.stdout
    assert "T1 (paper), whole, seed 0: ValueError: too long" in result.stdout
    assert "2 episodes in" in result.stdout and "2 met, 0 close, 0 missed" in result.stdout


def test_both_presets_are_run_where_they_are_asked_for_and_a_miss_has_its_reason() -> None:
    result = reproduce("--seeds", "1", "--preset", "both")
    assert result.exit_code == 1
    assert "T1 (modern), ticks: missed, since nothing moves" in result.stdout
    assert "--preset modern --case 'short' --seed 0" in result.stdout.replace("\n", " ")


def test_programs_get_the_findings_and_the_measures_of_every_episode() -> None:
    told = json.loads(reproduce("--seeds", "2", "--preset", "modern", "--json").stdout)
    assert told["stopped"] is False
    assert [(row["row"], row["preset"]) for row in told["rows"]] == [("T1", "modern"), ("T2", None)]
    episodes = told["rows"][0]["episodes"]
    assert [(e["case"], e["seed"], e["error"]) for e in episodes[:2]] == [("short", 0, None), ("short", 1, None)]
    assert episodes[0]["ticks"] == 20
    assert told["rows"][0]["findings"][0] == {
        "what": "ticks",
        "paper": "20",
        "ours": "40",
        "verdict": "missed",
        "because": "nothing moves",
        "see": "rplan reproduce T1 --preset modern --case 'short' --seed 0 --replay x.html",
    }


def test_a_preset_that_no_library_of_the_plan_knows_is_told_before_anything_runs(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    without = replace(ROW, cases=lambda seeds: (Case("short", "make_room", "make_room/visit", (0,)),))
    monkeypatch.setattr(command, "every_row", lambda: (without,))
    monkeypatch.setattr(experiment, "PRESET", "no-such")
    result = reproduce("--preset", "modern")
    assert (result.exit_code, result.stderr) == (
        2,
        "error: nothing was run\n  no library of the plan make-room has a preset\n",
    )


def test_a_setting_that_makes_no_scenario_is_told_before_anything_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    wrong = replace(
        ROW, cases=lambda seeds: (Case("short", "make_room", "make_room/visit", (0,), (("time_limit", "x"),)),)
    )
    monkeypatch.setattr(command, "every_row", lambda: (wrong,))
    result = reproduce()
    assert result.exit_code == 2 and "nothing was run" in result.stderr and "time_limit" in result.stderr


def test_the_preset_is_given_to_every_library_that_knows_one() -> None:
    (batch,) = batches([Asked(ROW, "modern")], 1)
    assert Change("natigation", "preset", "modern") in batch.work.variants[0].changes


def test_ctrl_c_ends_it_and_nothing_is_written(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    def interrupted(work: Work, tasks: Sequence[Task], workers: int, start: object) -> Rows:
        yield from ()
        raise KeyboardInterrupt

    monkeypatch.setattr(processes, "run", interrupted)
    result = reproduce("T1", "--seeds", "1", "--write", str(tmp_path / "docs"))
    assert result.exit_code == 1
    assert not (tmp_path / "docs").exists()


def test_workers_that_cannot_begin_end_it_with_a_clear_line(monkeypatch: pytest.MonkeyPatch) -> None:
    def unfit(work: Work, tasks: Sequence[Task], workers: int, start: object) -> Rows:
        yield from ()
        raise EngineError("a worker cannot begin: no memory")

    monkeypatch.setattr(processes, "run", unfit)
    result = reproduce("T1", "--seeds", "1")
    assert (result.exit_code, result.stderr) == (2, "error: a worker cannot begin: no memory\n")


# --- one episode --------------------------------------------------------------------------------------


def test_one_episode_is_played_on_a_page(tmp_path: Path) -> None:
    page = tmp_path / "x.html"
    result = reproduce("T1", "--case", "short", "--seed", "3", "--replay", str(page))
    assert result.exit_code == 0
    assert result.stdout.startswith("T1 (paper), short, seed 3: done in 2.0 s\n")
    assert page.read_text(encoding="utf-8").startswith("<!doctype html>")


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("T1", "--case", "shirt", "--replay", "x.html"), "T1 has no case 'shirt' (did you mean 'short'?)"),
        (("T1", "--case", "zzzzz", "--replay", "x.html"), "T1 has no case 'zzzzz' (there are: short, whole)"),
        (("T2", "--replay", "x.html"), "T2 drives nothing"),
        (("T1", "T2", "--replay", "x.html"), "name one row"),
        (("T1", "--preset", "both", "--replay", "x.html"), "name one row"),
        (("T1", "--replay", "nowhere/x.html"), "there is no folder nowhere"),
        (("T1", "--case", "short"), "give --replay FILE"),
        (("T1", "--write", "nowhere/docs"), "there is no folder nowhere"),
    ],
)
def test_what_cannot_be_shown_is_told(arguments: tuple[str, ...], said: str) -> None:
    result = reproduce(*arguments)
    assert result.exit_code == 2
    assert said in result.stderr


def test_a_page_that_cannot_be_written_is_told(tmp_path: Path) -> None:
    result = reproduce("T1", "--replay", str(tmp_path))
    assert result.exit_code == 2


# --- pages --------------------------------------------------------------------------------------------


def test_the_page_has_tables_pictures_and_every_episode(tmp_path: Path) -> None:
    result = reproduce("--seeds", "2", "--write", str(tmp_path / "docs"))
    assert result.exit_code == 1
    page = (tmp_path / "docs" / "experiments" / "tests.md").read_text(encoding="utf-8")
    assert "| [T1](#t1-a-short-run) | paper | ticks | 20 | 40 | met |" in page
    assert "> “Two.”" in page and "It tells nothing." in page
    assert "| short | 2 | 20 | 0.5 | 0 of 2 | still |" in page
    assert "whole, seed 0 did not run: ValueError: too long" in page
    for picture in ("t1-paper.png", "t1-paper-spread.png"):
        assert f"](../pictures/reproduce/{picture})" in page
        assert (tmp_path / "docs" / "pictures" / "reproduce" / picture).read_bytes().startswith(b"\x89PNG")
    with (tmp_path / "docs" / "experiments" / "tests.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [(row["case"], row["seed"], row["moved"]) for row in rows] == [
        ("short", "0", "false"), ("short", "1", "false"), ("whole", "0", ""),
    ]  # fmt: skip


def test_the_page_says_where_it_needs_matplotlib(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(command, "find_spec", lambda name: None)
    result = reproduce("T1", "--write", str(tmp_path))
    assert (result.exit_code, result.stderr) == (2, "error: --write needs matplotlib: pip install 'rplan[plot]'\n")


def test_a_folder_that_takes_no_pages_is_told(tmp_path: Path) -> None:
    (tmp_path / "experiments").write_text("in the way")
    result = reproduce("T2", "--write", str(tmp_path))
    assert result.exit_code == 2


# --- workers ------------------------------------------------------------------------------------------


def work_of(row: Row) -> tuple[Work, tuple[Task, ...]]:
    (batch,) = batches([Asked(row, "paper")], 1)
    return batch.work, batch.tasks


def test_a_worker_takes_work_and_tasks_and_gives_measures() -> None:
    work, tasks = work_of(ROW)
    ours, theirs = Pipe()
    for message in (work, tasks[0], None):
        ours.send(message)
    experiment.serve(theirs)
    assert ours.recv() == READY
    assert ours.recv()["ticks"] == 20


def test_a_worker_that_cannot_begin_says_why() -> None:
    ours, theirs = Pipe()
    ours.send("no work")
    experiment.serve(theirs)
    assert isinstance(ours.recv(), Unfit)


def test_a_worker_ends_when_whoever_asked_is_gone() -> None:
    work, _ = work_of(ROW)
    ours, theirs = Pipe()
    ours.send(work)
    ours.close()
    experiment.serve(theirs)


def test_workers_are_processes_of_their_own() -> None:
    worker = experiment.start()
    worker.connection.send("no work")
    assert isinstance(worker.connection.recv(), Unfit)
    worker.process.join()
    assert worker.process.exitcode == 0


def test_a_run_without_changed_keys_is_shown_by_rplan_simulate() -> None:
    asked = Asked(ROW, "paper")
    whole = Finding("ticks", "20", "300", "met", case="whole", seed=0)
    result = report.Result(asked, ROW.cases(1), (), (), (whole,))
    assert report.see(result, whole) == (
        "rplan simulate plans/go_to_goal --scenario make_room/visit --seed 0 --replay x.html"
    )
    assert report.see(result, replace(whole, seed=None)) == ""
