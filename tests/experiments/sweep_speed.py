"""How much two workers bring, and what a killed one costs: `python tests/experiments/sweep_speed.py --seeds 200`.

Takes: how many episodes of find and fetch. Gives: the wall time with one worker and with two, their ratio, and whether
the rows of both, and of a run in which a worker was killed on the way, are the same; exit code 1 if they are not.
Leaves alone: whether the machine was idle, on which the ratio depends.
"""

from __future__ import annotations

import argparse
import sys
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


def drive(whole: Work, seeds: range, workers: int, kill_after: int | None = None) -> tuple[list[Row], float]:
    """Rows in the order of their seeds without what is measured, and how long they took [s]."""
    started: list[Worker] = []

    def kept() -> Worker:
        started.append(start())
        return started[-1]

    begin = perf_counter()
    rows: list[tuple[int, Row]] = []
    for task, row in run(whole, tasks(whole, seeds), workers, kept):
        rows.append((task.index, {name: value for name, value in row.items() if name not in MEASURED}))
        if len(rows) == kill_after:
            started[0].process.kill()
    wall = perf_counter() - begin
    return [row for _, row in sorted(rows, key=lambda pair: pair[0])], wall


def main() -> int:
    """Run three times, print, compare."""
    arguments = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    arguments.add_argument("--seeds", type=int, default=200)
    arguments.add_argument("--until", type=float, help="simulated seconds at most")
    given = arguments.parse_args()
    whole, seeds = work(given.until), range(given.seeds)
    one, alone = drive(whole, seeds, 1)
    print(f"1 worker:  {len(one)} rows in {alone:.1f} s", flush=True)
    two, together = drive(whole, seeds, 2)
    print(f"2 workers: {len(two)} rows in {together:.1f} s, {alone / together:.2f} x (goal: {GOAL} x)", flush=True)
    killed, late = drive(whole, seeds, 2, max(1, given.seeds // 4))
    print(f"2 workers, one killed on the way: {len(killed)} rows in {late:.1f} s", flush=True)
    print(f"done: {sum(row['done'] is True for row in one)} of {len(one)}")
    same = one == two == killed
    print("the rows of all three runs are the same" if same else "THE ROWS DIFFER")
    return 0 if same and len(one) == given.seeds else 1


if __name__ == "__main__":
    sys.exit(main())
