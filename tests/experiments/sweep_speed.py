"""How much two workers bring, and what a killed one costs: `python tests/experiments/sweep_speed.py --seeds 200`.

Takes: how many episodes of find and fetch. Gives: the wall time with one worker and with two, their ratio, and whether
the rows of both, and of a run in which a worker was killed on the way, are the same; exit code 1 if they are not.
Leaves alone: whether the machine was idle, on which the ratio depends; processor times tell it.
"""

from __future__ import annotations

import argparse
import resource
import sys
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter

from rplan.apps.simulation import load_world
from rplan.apps.sweep.processes import Worker, run, start
from rplan.apps.sweep.rows import MEASURED
from rplan.apps.sweep.work import Row, Variant, Work, tasks
from rplan.apps.wiring import compile_file

FOLDER = Path(__file__).parents[2] / "plans" / "find_and_fetch"
GOAL = 1.8


def work(until: float | None) -> Work:
    """Find and fetch in the parking lot."""
    world = load_world(FOLDER / "parking_lot.yaml")
    sources = compile_file(FOLDER / "find_and_fetch.rplan").sources
    return Work(sources, (Variant(world.scenario.name, "parking_lot.yaml", world.text),), until=until)


@dataclass(frozen=True, slots=True)
class Drive:
    """rows: in the order of their seeds, without what is measured. wall, processor [s]: of all workers together."""

    rows: list[Row]
    wall: float
    processor: float

    def __str__(self) -> str:
        return f"{len(self.rows)} rows in {self.wall:.1f} s ({self.processor:.1f} s of processor)"


def processor_time() -> float:
    """What processes that have ended took [s]."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def drive(whole: Work, seeds: range, workers: int, kill_after: int | None = None) -> Drive:
    """Run them, and kill a worker once so many rows are there."""
    started: list[Worker] = []

    def kept() -> Worker:
        started.append(start())
        return started[-1]

    begin, before = perf_counter(), processor_time()
    rows: list[tuple[int, Row]] = []
    for task, row in run(whole, tasks(whole, seeds), workers, kept):
        rows.append((task.index, {name: value for name, value in row.items() if name not in MEASURED}))
        if len(rows) == kill_after:
            started[0].process.kill()
    wall = perf_counter() - begin
    return Drive([row for _, row in sorted(rows, key=lambda pair: pair[0])], wall, processor_time() - before)


def main() -> int:
    """Run three times, print, compare."""
    arguments = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    arguments.add_argument("--seeds", type=int, default=200)
    arguments.add_argument("--until", type=float, help="simulated seconds at most")
    given = arguments.parse_args()
    whole, seeds = work(given.until), range(given.seeds)
    one = drive(whole, seeds, 1)
    print(f"1 worker:  {one}", flush=True)
    two = drive(whole, seeds, 2)
    print(f"2 workers: {two}, {one.wall / two.wall:.2f} x (goal: {GOAL} x)", flush=True)
    killed = drive(whole, seeds, 2, max(1, given.seeds // 4))
    print(f"2 workers, one killed on the way: {killed}")
    print(f"done: {sum(row['done'] is True for row in one.rows)} of {len(one.rows)}")
    same = one.rows == two.rows == killed.rows
    print("the rows of all three runs are the same" if same else "THE ROWS DIFFER")
    return 0 if same and len(one.rows) == given.seeds else 1


if __name__ == "__main__":
    sys.exit(main())
