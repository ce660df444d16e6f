"""Workers of dask.distributed: processes of this machine, or of a cluster whose scheduler has an address.

Takes: work and its tasks. Gives: rows in the order in which they are ready, the same as processes.py gives. Leaves
alone: where a cluster comes from. Its workers need rplan of this version, and library files under the same paths.

Needs the extra `cluster`; this file is imported only where it is asked for.
"""

from __future__ import annotations

import hashlib
import logging
import pickle
import threading
from collections.abc import Iterable, Iterator
from contextlib import ExitStack
from itertools import islice
from typing import Any

import dask
import distributed
from distributed import CancelledError, KilledWorker, WorkerPlugin, get_worker

from rplan.apps.sweep.processes import MOST_DEATHS, EngineError, deaf_to_interrupts, died
from rplan.apps.sweep.work import Row, Rows, Runner, Task, Work

UNTYPED: Any = distributed
"""What of the package has no types."""
AHEAD = 2
"""Tasks with the scheduler, for each thread of a worker: it is never idle, and a sweep of any size fits."""
PATIENCE = 20  # [s] to reach the scheduler, and for it to have a worker
PRIVATE = {
    "host": "127.0.0.1",
    "dashboard_address": "127.0.0.1:0",
    "worker_dashboard_address": "127.0.0.1:0",
    "silence_logs": logging.CRITICAL,
}
"""A cluster of this machine is heard and seen from this machine only."""
SETTINGS = {"distributed.scheduler.allowed-failures": MOST_DEATHS - 1}


class Station(WorkerPlugin):
    """What every worker has: the plan, compiled when the worker joins."""

    def __init__(self, work: Work) -> None:
        self.work = work
        self.name = f"rplan-{hashlib.sha256(pickle.dumps(work)).hexdigest()[:16]}"

    def setup(self, worker: Any) -> None:  # noqa: ARG002
        """Compile, and leave Ctrl-C to the one who asked."""
        self.runner = Runner(self.work)
        self.interrupts = ExitStack()
        if threading.current_thread() is threading.main_thread():
            self.interrupts.enter_context(deaf_to_interrupts())

    def teardown(self, worker: Any) -> None:  # noqa: ARG002
        """Hear it again."""
        self.interrupts.close()


def row(station: str, task: Task) -> Row:
    """A task, run where the worker is."""
    plugin = get_worker().plugins[station]
    assert isinstance(plugin, Station)
    return plugin.runner.row(task)


def run(work: Work, tasks: Iterable[Task], workers: int, address: str | None = None) -> Rows:
    """Every task with its row, as they get ready. Raises EngineError.

    workers: processes that are started here; without meaning where address names a scheduler that has its own.
    """
    with ExitStack() as opened, dask.config.set(SETTINGS):
        client = _client(opened, workers, address)
        station = Station(work)
        try:
            client.register_plugin(station)
        except Exception as error:
            raise EngineError(f"a worker cannot begin: {error}") from error
        opened.callback(_leave, client, station.name)
        try:
            yield from _rows(client, station, work, iter(tasks))
        except (CancelledError, OSError) as error:
            raise EngineError(f"the dask scheduler is gone: {error}") from error


def _client(opened: ExitStack, workers: int, address: str | None) -> Any:
    try:
        if address is not None:
            client = opened.enter_context(UNTYPED.Client(address, timeout=PATIENCE))
            client.wait_for_workers(1, timeout=PATIENCE)
            return client
        cluster = UNTYPED.LocalCluster(n_workers=workers, threads_per_worker=1, **PRIVATE)
        return opened.enter_context(UNTYPED.Client(opened.enter_context(cluster)))
    except (OSError, ValueError, TimeoutError) as error:
        where = "on this machine" if address is None else f"with workers at {address}"
        raise EngineError(f"there is no dask scheduler {where}: {error}") from error


def _leave(client: Any, station: str) -> None:
    """A cluster that stays keeps nothing of the sweep."""
    try:
        client.unregister_worker_plugin(station)
    except Exception as error:
        logging.getLogger(__name__).debug("the cluster is gone: %s", error)


def _rows(client: Any, station: Station, work: Work, tasks: Iterator[Task]) -> Rows:
    """A window of tasks is with the scheduler; for each that ends the next one goes there.

    Where a worker ends, the scheduler blames every task that waits for it; those that it gives up are run again in the
    end, one at a time.
    """
    asked: dict[str, Task] = {}
    blamed: list[Task] = []

    def ask(some: Iterable[Task]) -> list[Any]:
        futures = [(client.submit(row, station.name, task, pure=False), task) for task in some]
        asked.update((future.key, task) for future, task in futures)
        return [future for future, _ in futures]

    waiting = UNTYPED.as_completed(ask(islice(tasks, AHEAD * sum(client.nthreads().values()))))
    for future in waiting:
        task = asked.pop(future.key)
        result = result_of(future)
        if result is None:
            blamed.append(task)
        else:
            yield task, result
        for another in ask(islice(tasks, 1)):
            waiting.add(another)
    for task in blamed:
        yield task, result_of(client.submit(row, station.name, task, pure=False)) or died(work, task)


def result_of(future: Any) -> Row | None:
    """The row of a task; None where its workers ended."""
    error = future.exception()
    match error:
        case None:
            result: Row = future.result()
            return result
        case KilledWorker():
            return None
        case _:
            raise EngineError(f"a worker cannot run an episode: {type(error).__name__}: {error}")
