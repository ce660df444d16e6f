"""Workers that are processes of this machine, supervised: one that is killed costs no result.

Takes: work and its tasks. Gives: rows in the order in which they are ready. Leaves alone: what a task does (work.py).

A worker gets the work once, then one task after the other over a pipe of its own. Where a worker ends in the middle of
a task, the task goes to another one; after `MOST_DEATHS` the task itself is held to be the cause, and its row says so.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from typing import Any, Literal, Protocol

from rplan.apps.sweep.work import Row, Rows, Runner, Task, Work, head, in_words

MOST_DEATHS = 3
PATIENCE = 5.0  # [s] for a worker to end when it is asked to
THREADS = (
    "OMP_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "MKL_NUM_THREADS",
    "VECLIB_MAXIMUM_THREADS",
    "NUMEXPR_NUM_THREADS",
)

READY: Literal["ready"] = "ready"


class EngineError(Exception):
    """No worker can do the work; the message says why."""


@dataclass(frozen=True, slots=True)
class Unfit:
    """A worker cannot begin."""

    why: str


# --- the worker's side --------------------------------------------------------------------------------


class Bench(Protocol):
    """Where tasks become rows."""

    def row(self, task: Any, /) -> Row:
        """The row of a task."""
        ...


def serve(connection: Connection, set_up: Callable[[Any], Bench] = Runner) -> None:
    """What a worker does: work in, `READY` or `Unfit` out, then tasks in and rows out, until None or the end.

    set_up: what makes a bench of the work.
    """
    with deaf_to_interrupts():
        try:
            runner = set_up(connection.recv())
        except Exception as error:
            connection.send(Unfit(in_words(error)))
            return
        try:
            connection.send(READY)
            while (task := connection.recv()) is not None:
                connection.send(runner.row(task))
        except (EOFError, OSError):
            return  # whoever asked is gone


@contextmanager
def deaf_to_interrupts() -> Iterator[None]:
    """Ctrl-C is for the one who supervises: an episode that it stopped would look like one that failed."""
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


@contextmanager
def one_thread_each() -> Iterator[None]:
    """Processes that are started inside use one thread for linear algebra: the cores are taken by workers."""
    before = {name: os.environ.get(name) for name in THREADS}
    os.environ.update(dict.fromkeys(THREADS, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


# --- the supervisor's side ----------------------------------------------------------------------------


@dataclass(slots=True)
class Worker:
    """A process, the pipe to it, and what it does; ready: it has compiled the plan."""

    process: BaseProcess
    connection: Connection
    ready: bool = False
    task: Task | None = None


def start(serving: Callable[[Connection], None] = serve) -> Worker:
    """A worker process that shares nothing with this one; serving: what it does."""
    context = multiprocessing.get_context("spawn")
    ours, theirs = context.Pipe()
    with one_thread_each():
        process = context.Process(target=serving, args=(theirs,), daemon=True)
        process.start()
    theirs.close()
    return Worker(process, ours)


def cores() -> int:
    """How many cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def run(work: Work, tasks: Iterable[Task], workers: int, start: Callable[[], Worker] = start) -> Rows:
    """Every task with its row, as they get ready. Raises EngineError. Workers end when the iterator is closed."""
    supervisor = _Supervisor(work, deque(tasks), workers, start)
    try:
        while supervisor.open:
            supervisor.occupy()
            yield from supervisor.hear()
    finally:
        supervisor.stop()


@dataclass(slots=True)
class _Supervisor:
    """deaths: task -> how many workers ended in it; stillborn: workers in a row that ended before they were ready."""

    work: Work
    queue: deque[Task]
    most: int
    start: Callable[[], Worker]
    workers: list[Worker] = field(default_factory=list)
    deaths: dict[Task, int] = field(default_factory=dict)
    stillborn: int = 0

    @property
    def open(self) -> bool:
        """Whether a row is still to come."""
        return bool(self.queue) or any(worker.task is not None for worker in self.workers)

    def occupy(self) -> None:
        """As many workers as can be of use, and a task for each that has none."""
        busy = sum(worker.task is not None for worker in self.workers)
        for _ in range(min(self.most, busy + len(self.queue)) - len(self.workers)):
            worker = self.start()
            self.workers.append(worker)
            _send(worker, self.work)
        for worker in self.workers:
            if worker.ready and worker.task is None and self.queue:
                worker.task = self.queue.popleft()
                _send(worker, worker.task)

    def hear(self) -> Iterator[tuple[Task, Row]]:
        """What workers say, waiting until one says something or ends."""
        said = wait([worker.connection for worker in self.workers])
        for worker in [worker for worker in self.workers if worker.connection in said]:
            try:
                message = worker.connection.recv()
            except (EOFError, OSError):
                yield from self._lost(worker)
                continue
            match message:
                case Unfit(why):
                    raise EngineError(f"a worker cannot begin: {why}")
                case dict() if worker.task is not None:
                    task, worker.task = worker.task, None
                    yield task, message
                case _:
                    worker.ready, self.stillborn = True, 0

    def _lost(self, worker: Worker) -> Iterator[tuple[Task, Row]]:
        self.workers.remove(worker)
        worker.connection.close()
        worker.process.join(PATIENCE)
        how, task = _ending(worker.process.exitcode), worker.task
        if task is None:
            self.stillborn += not worker.ready
            if self.stillborn >= MOST_DEATHS:
                raise EngineError(f"{self.stillborn} workers in a row ended before they were ready ({how})")
            return
        self.deaths[task] = self.deaths.get(task, 0) + 1
        if self.deaths[task] < MOST_DEATHS:
            self.queue.appendleft(task)
        else:
            yield task, died(self.work, task)

    def stop(self) -> None:
        """End every worker: one that rests is asked to, one that works is made to."""
        for worker in self.workers:
            if worker.task is None and worker.ready:
                _send(worker, None)
            else:
                worker.process.kill()
        for worker in self.workers:
            worker.process.join(PATIENCE)
            worker.process.kill()
            worker.process.join()
            worker.connection.close()


def _send(worker: Worker, what: Work | Task | None) -> None:
    try:
        worker.connection.send(what)
    except OSError:
        return  # it has ended, which shows when it is heard


def _ending(code: int | None) -> str:
    if code is not None and code < 0:
        return f"by {signal.Signals(-code).name}"
    return f"with exit code {code}"


def died(work: Work, task: Task) -> Row:
    """The row of an episode that no worker survives."""
    return head(work.variants[task.variant], task.seed) | {"done": False, "error": "every worker that ran it ended"}
