"""Workers: the same rows whoever runs them, in whatever number, and whatever becomes of them on the way."""

from __future__ import annotations

import dataclasses
import os
import signal
from collections.abc import Iterable
from multiprocessing import get_context
from multiprocessing.connection import Connection
from pathlib import Path

import pytest

from rplan.apps.simulation import World, simulate
from rplan.apps.sweep import processes, work
from rplan.apps.sweep.processes import READY, THREADS, EngineError, Unfit, Worker, one_thread_each, run, serve, start
from rplan.apps.sweep.rows import MEASURED
from rplan.apps.sweep.work import Change, Row, Runner, Task, Variant, Work, in_words, row_of, tasks
from rplan.apps.wiring import compile_file
from rplan.lang.source import Source
from sim.scenarios.format import loads

PLANS = Path(__file__).parents[2] / "plans"
LIBRARY = '''"""Turning on the spot, or ending the process that it runs in."""

import os
import signal
from pathlib import Path

from behaviours.interface import Command, Drive, Function, Library, Offer, Parameter, Report

ONCE, ALWAYS, RAISE = 1.0, 2.0, 3.0


class Spin:
    def __init__(self, deadly):
        self.deadly = deadly

    def start(self, reading, channels):
        mark = Path(__file__).with_suffix(".died")
        if self.deadly == ALWAYS or (self.deadly == ONCE and not mark.exists()):
            mark.touch()
            os.kill(os.getpid(), signal.SIGKILL)

    def step(self, reading, channels):
        return Command(drive=Drive(0.0, 0.5)), Report()

    def stop(self):
        pass


def build(values, workshop):
    if values["deadly"] == RAISE:
        raise RuntimeError("the wheels are stuck")
    return Offer(competences={"spin": Spin(values["deadly"])})


SPIN = Library(
    "spin",
    "Turning on the spot.",
    (Function("spin", "command", "Turn.", actuators=("drive",)),),
    (Parameter("deadly", "number", "", 0.0, "Whether it ends the process: once (1) or always (2); 3 raises."),),
    build,
)
'''
PLAN = """(plan turning) (include "part.rplan") (use spin) (defoutput action command)
(goalem (ach turn))
"""
PART = "(defgoalr (ach turn) (do action (spin)))"
NOOK = """name: nook
bounds: [-2, -2, 2, 2]
robot: {start: [0, 0], heading: {between: [0, 1]}}
donor: {at: [1.9, 0]}
"""
SEEDS = (0, 1, 2, 5)


def variant(deadly: float, text: str = NOOK) -> Variant:
    return Variant("nook", "nook.yaml", text, (Change("spin", "deadly", deadly),), (("spin.deadly", deadly),))


@pytest.fixture
def some(tmp_path: Path) -> Work:
    """Work that comes with everything it needs but the library: the plan is in no file."""
    library = tmp_path / "spin.py"
    library.write_text(LIBRARY, encoding="utf-8")
    sources = (Source("nowhere/turning.rplan", PLAN), Source("nowhere/part.rplan", PART))
    return Work(sources, (variant(0.0), variant(0.5)), (library,), until=1.0)


def told(rows: Iterable[tuple[Task, Row]]) -> dict[Task, Row]:
    """Rows without what is measured, in the order of their tasks."""
    plain = {task: {name: value for name, value in row.items() if name not in MEASURED} for task, row in rows}
    return dict(sorted(plain.items(), key=lambda pair: pair[0].index))


def expected(some: Work) -> dict[Task, Row]:
    runner = Runner(some)
    return told((task, runner.row(task)) for task in tasks(some, SEEDS))


# --- one worker's part --------------------------------------------------------------------------------


def test_a_row_says_what_was_run_and_what_came_of_it(some: Work) -> None:
    row = Runner(some).row(Task(5, 1, 1))
    assert {name: row[name] for name in ("scenario", "spin.deadly", "seed", "done", "stage", "ticks", "contacts")} == {
        "scenario": "nook",
        "spin.deadly": 0.5,
        "seed": 1,
        "done": False,
        "stage": "to the donor",
        "ticks": 10,
        "contacts": 0,
    }
    assert (row["duration"], row["distance"], row["error"]) == (1.0, 0.0, None)
    assert isinstance(row["wall"], float)


def test_what_an_episode_raises_is_told_in_its_row(some: Work) -> None:
    wrong = dataclasses.replace(some, variants=(variant(3.0), variant(0.0, NOOK + "lamp: 1"), variant(0.0)))
    runner = Runner(wrong)
    raised, unread, sound = (runner.row(Task(0, index, 7)) for index in range(3))
    assert (raised["done"], raised["seed"], raised["error"]) == (False, 7, "RuntimeError: the wheels are stuck")
    assert str(unread["error"]).startswith("ScenarioError: nook.yaml:5:1: lamp: unknown key")
    assert sound["error"] is None


def test_a_long_error_is_cut_and_an_empty_one_has_its_name() -> None:
    assert in_words(ValueError()) == "ValueError"
    assert len(in_words(ValueError("x" * 10_000))) == work.LONGEST_ERROR


def test_of_a_verdict_that_says_more_a_row_has_more(monkeypatch: pytest.MonkeyPatch) -> None:
    world = World(loads(NOOK), NOOK)
    run = simulate(compile_file(PLANS / "make_room" / "make_room.rplan"), world, 0, until=1.0)
    more = {"laps": 3, "where": Path("x"), "far": float("inf"), "times": {"pit": 4.0}, "sectors": [1, 2]}
    monkeypatch.setattr(work, "asdict", lambda verdict: more)
    row = row_of(run)
    assert {name: row[name] for name in ("laps", "where", "far", "pit", "sectors")} == {
        "laps": 3, "where": "x", "far": None, "pit": 4.0, "sectors": 2,
    }  # fmt: skip


def pipe() -> tuple[Connection, Connection]:
    return get_context("spawn").Pipe()


def test_a_worker_takes_work_and_tasks_and_gives_rows_until_none_comes(some: Work) -> None:
    ours, theirs = pipe()
    for message in (some, Task(0, 0, 0), Task(5, 1, 1), None):
        ours.send(message)
    serve(theirs)
    assert ours.recv() == READY
    assert [ours.recv()["seed"] for _ in range(2)] == [0, 1]
    assert not ours.poll()


def test_a_worker_ends_quietly_when_nobody_is_there_any_more(some: Work) -> None:
    ours, theirs = pipe()
    ours.send(some)
    ours.close()
    serve(theirs)


def test_a_worker_that_cannot_compile_says_why(some: Work) -> None:
    ours, theirs = pipe()
    ours.send(dataclasses.replace(some, sources=(Source("p.rplan", "(goalem"),)))
    serve(theirs)
    said = ours.recv()
    assert isinstance(said, Unfit)
    assert said.why.startswith("PlanError: p.rplan:1:1: ")


def test_a_worker_does_not_hear_an_interrupt_and_leaves_the_handler_as_it_was() -> None:
    before = signal.getsignal(signal.SIGINT)
    with processes.deaf_to_interrupts():
        os.kill(os.getpid(), signal.SIGINT)
    assert signal.getsignal(signal.SIGINT) is before


def test_processes_that_are_started_use_one_thread_for_linear_algebra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(THREADS[0], "7")
    monkeypatch.delenv(THREADS[1], raising=False)
    with one_thread_each():
        assert [os.environ[name] for name in THREADS] == ["1"] * len(THREADS)
    assert os.environ[THREADS[0]] == "7"
    assert THREADS[1] not in os.environ


def test_there_is_a_core_to_run_on(monkeypatch: pytest.MonkeyPatch) -> None:
    assert processes.cores() >= 1
    monkeypatch.delattr(os, "sched_getaffinity")
    monkeypatch.setattr(os, "cpu_count", lambda: None)
    assert processes.cores() == 1


# --- processes ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("workers", [1, 2])
def test_rows_do_not_depend_on_the_number_of_workers(some: Work, workers: int) -> None:
    assert told(run(some, tasks(some, SEEDS), workers)) == expected(some)


def test_there_are_no_more_workers_than_tasks_and_none_are_left_over(some: Work) -> None:
    started: list[Worker] = []
    assert len(list(run(some, [Task(0, 0, 0)], 8, lambda: kept(started)))) == 1
    assert len(started) == 1
    assert not started[0].process.is_alive()


def kept(started: list[Worker]) -> Worker:
    started.append(start())
    return started[-1]


def test_a_worker_that_is_killed_costs_no_result(some: Work) -> None:
    started: list[Worker] = []
    rows: list[tuple[Task, Row]] = []
    for pair in run(some, tasks(some, SEEDS), 2, lambda: kept(started)):
        rows.append(pair)
        if len(rows) == 2:
            started[0].process.kill()
    assert len(rows) == 8
    assert told(rows) == expected(some)


def test_an_episode_that_was_with_a_killed_worker_is_run_again(some: Work) -> None:
    once = dataclasses.replace(some, variants=(variant(0.0), variant(1.0)))
    rows = told(run(once, tasks(once, SEEDS), 1))
    assert len(rows) == 8
    assert {row["error"] for row in rows.values()} == {None}


def test_an_episode_that_no_worker_survives_is_a_row_and_all_others_are_run(some: Work) -> None:
    deadly = dataclasses.replace(some, variants=(variant(0.0), variant(2.0), variant(0.5)))
    rows = told(run(deadly, tasks(deadly, (3,)), 2))
    died: Row = {
        "scenario": "nook",
        "spin.deadly": 2.0,
        "seed": 3,
        "done": False,
        "error": "every worker that ran it ended",
    }
    assert [row["error"] for row in rows.values()] == [None, died["error"], None]
    assert rows[Task(1, 1, 3)] == died


def test_work_that_no_worker_can_begin_is_told(some: Work) -> None:
    wrong = dataclasses.replace(some, library_files=())
    with pytest.raises(EngineError, match=r"a worker cannot begin: PlanError: .*no library is called `spin`"):
        list(run(wrong, tasks(wrong, SEEDS), 1))


def test_workers_that_end_before_they_are_ready_are_not_started_for_ever(some: Work) -> None:
    started: list[Worker] = []

    def stillborn() -> Worker:
        context = get_context("spawn")
        ours, theirs = context.Pipe()
        process = context.Process(target=os._exit, args=(3,), daemon=True)
        process.start()
        theirs.close()
        started.append(Worker(process, ours))
        return started[-1]

    with pytest.raises(EngineError, match=r"3 workers in a row ended before they were ready \(with exit code 3\)"):
        list(run(some, tasks(some, SEEDS), 1, stillborn))
    assert len(started) == 3


def test_workers_end_when_nobody_wants_more_rows(some: Work) -> None:
    started: list[Worker] = []
    rows = run(some, tasks(some, SEEDS), 2, lambda: kept(started))
    next(rows)
    rows.close()
    assert [worker.process.is_alive() for worker in started] == [False] * len(started)
