"""dask.distributed gives the rows that processes give, also where workers end on the way."""

from __future__ import annotations

import dataclasses
import signal
from collections.abc import Iterable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import distributed
import pytest

from rplan.apps.sweep import cluster
from rplan.apps.sweep.cluster import PRIVATE, Station, row, run
from rplan.apps.sweep.processes import EngineError
from rplan.apps.sweep.rows import MEASURED
from rplan.apps.sweep.work import Change, Row, Runner, Task, Variant, Work, tasks
from rplan.lang.source import Source

LIBRARY = '''"""Turning on the spot, or ending the process that it runs in: once (1) or always (2)."""

import os
import signal
from pathlib import Path

from behaviours.interface import Command, Drive, Function, Library, Offer, Parameter, Report


class Spin:
    def __init__(self, deadly):
        self.deadly = deadly

    def start(self, reading, channels):
        mark = Path(__file__).with_suffix(".died")
        if self.deadly == 2.0 or (self.deadly == 1.0 and not mark.exists()):
            mark.touch()
            os.kill(os.getpid(), signal.SIGKILL)

    def step(self, reading, channels):
        return Command(drive=Drive(0.0, 0.5)), Report()

    def stop(self):
        pass


SPIN = Library(
    "spin",
    "Turning on the spot.",
    (Function("spin", "command", "Turn.", actuators=("drive",)),),
    (Parameter("deadly", "number", "", 0.0, "Whether it ends the process."),),
    lambda values, workshop: Offer(competences={"spin": Spin(values["deadly"])}),
)
'''
PLAN = "(plan turning) (use spin) (defoutput action command) (goalem (do action (spin)))"
NOOK = """name: nook
bounds: [-2, -2, 2, 2]
robot: {start: [0, 0], heading: {between: [0, 1]}}
donor: {at: [1.9, 0]}
"""
SEEDS = (0, 1, 2, 5, 6)


def variant(deadly: float) -> Variant:
    return Variant("nook", "nook.yaml", NOOK, (Change("spin", "deadly", deadly),), (("spin.deadly", deadly),))


@pytest.fixture
def some(tmp_path: Path) -> Work:
    library = tmp_path / "spin.py"
    library.write_text(LIBRARY, encoding="utf-8")
    return Work((Source("turning.rplan", PLAN),), (variant(0.0), variant(1.0)), (library,), until=1.0)


def told(rows: Iterable[tuple[Task, Row]]) -> dict[Task, Row]:
    plain = {task: {name: value for name, value in row.items() if name not in MEASURED} for task, row in rows}
    return dict(sorted(plain.items(), key=lambda pair: pair[0].index))


def test_dask_gives_the_rows_that_a_worker_gives_also_where_one_is_killed(some: Work) -> None:
    """The second variant kills the first worker that runs it."""
    rows = told(run(some, tasks(some, SEEDS), 2))
    assert list(Path(some.library_files[0]).parent.glob("*.died"))
    runner = Runner(some)
    assert rows == told((task, runner.row(task)) for task in tasks(some, SEEDS))


def test_an_episode_that_no_worker_survives_is_a_row_and_takes_no_other_one_down(
    some: Work, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The scheduler blames what waits for the worker as well, here after the first death."""
    monkeypatch.setitem(cluster.SETTINGS, "distributed.scheduler.allowed-failures", 0)
    deadly = dataclasses.replace(some, variants=(variant(2.0), variant(0.0), variant(0.5)))
    errors = [row["error"] for row in told(run(deadly, tasks(deadly, (3,)), 1)).values()]
    assert errors == ["every worker that ran it ended", None, None]


def test_a_cluster_that_runs_already_is_used_and_left_as_it_was(some: Work) -> None:
    local: Any = distributed.LocalCluster
    (some.library_files[0].parent / "spin.died").touch()
    with local(n_workers=1, threads_per_worker=2, processes=False, protocol="tcp", **PRIVATE) as running:
        rows = told(run(some, tasks(some, SEEDS), 7, running.scheduler_address))
        assert [row["error"] for row in rows.values()] == [None] * 10
        assert [name for name in running.scheduler.worker_plugins if name.startswith("rplan")] == []
        with pytest.raises(EngineError, match=r"a worker cannot begin: .*no library is called `spin`"):
            list(run(dataclasses.replace(some, library_files=()), tasks(some, SEEDS), 7, running.scheduler_address))


def test_an_address_without_a_scheduler_is_told(some: Work, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cluster, "PATIENCE", 0.5)
    with pytest.raises(EngineError, match=r"there is no dask scheduler with workers at tcp://127\.0\.0\.1:9: "):
        list(run(some, tasks(some, SEEDS), 1, "tcp://127.0.0.1:9"))


def test_a_task_is_run_by_the_plan_that_its_worker_has(some: Work, monkeypatch: pytest.MonkeyPatch) -> None:
    before = signal.getsignal(signal.SIGINT)
    station = Station(some)
    station.setup(None)
    monkeypatch.setattr(cluster, "get_worker", lambda: SimpleNamespace(plugins={station.name: station}))
    assert row(station.name, Task(0, 0, 3))["seed"] == 3
    assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN
    station.teardown(None)
    assert signal.getsignal(signal.SIGINT) is before


def future(error: Exception | None) -> SimpleNamespace:
    return SimpleNamespace(exception=lambda: error)


def test_what_a_worker_raises_that_is_no_episode_ends_the_sweep() -> None:
    with pytest.raises(EngineError, match="a worker cannot run an episode: ModuleNotFoundError: no rplan"):
        cluster.result_of(future(ModuleNotFoundError("no rplan")))


def test_a_cluster_that_goes_away_ends_the_sweep(some: Work, monkeypatch: pytest.MonkeyPatch) -> None:
    def gone(*_: object, pure: bool) -> None:
        raise distributed.CancelledError("scheduler-connection-lost")

    def client(*_: object) -> SimpleNamespace:
        return SimpleNamespace(register_plugin=lambda plugin: None, nthreads=lambda: {"a": 1}, submit=gone)

    monkeypatch.setattr(cluster, "_client", client)
    with pytest.raises(EngineError, match="the dask scheduler is gone: scheduler-connection-lost"):
        list(run(some, tasks(some, SEEDS), 1, "tcp://x:1"))
