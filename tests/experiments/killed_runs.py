"""Runs that are killed: `python tests/experiments/killed_runs.py --runs 20`. It exits with 1 where too much is lost.

Takes: find and fetch in the parking lot. Gives: for each run the simulated time [s] at which SIGKILL struck, the time
up to which the repaired recording goes, and what was lost. Leaves alone: why runs die.

The run prints its simulated time into a pipe after every recorded tick. It is killed when it has printed a time that
the seed draws, plus a moment of wall time that the seed draws, so that it dies anywhere within a tick.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from mcap.reader import make_reader

from sim.repair import repair

ROOT = Path(__file__).parents[2]
BOUND_S = 0.2
LATEST_S = 60.0
WORST_WAIT_S = 0.005

RUN = """
import sys
from pathlib import Path
from rplan.apps import simulation
from rplan.apps.wiring import compile_file
from sim.recording import Recorder

class Telling(Recorder):
    def tick(self, t, *rest):
        super().tick(t, *rest)
        sys.stdout.write(f"{t:.3f}\\n")
        sys.stdout.flush()

simulation.Recorder = Telling
plan, lot, seed, target = sys.argv[1:]
world = simulation.load_world(Path(lot))
simulation.simulate(compile_file(Path(plan)), world, int(seed), record=Path(target))
"""


def killed(path: Path, seed: int, at: float, wait: float) -> float:
    """Simulated time [s] that a run had recorded when it was killed."""
    fetch = ROOT / "plans" / "find_and_fetch"
    arguments = [str(fetch / "find_and_fetch.rplan"), str(fetch / "parking_lot.yaml"), str(seed), str(path)]
    command = [sys.executable, "-c", RUN, *arguments]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])}
    run = subprocess.Popen(command, stdout=subprocess.PIPE, env=environment)
    assert run.stdout is not None
    last = 0.0
    for line in run.stdout:
        last = float(line)
        if last >= at:
            time.sleep(wait)
            break
    run.kill()
    run.wait()
    told = run.stdout.read()  # what was in the pipe; each line is written at once, so that none is torn
    run.stdout.close()
    return float(told.split()[-1]) if told else last


def trials(runs: int, seed: int, folder: Path) -> Iterator[tuple[float, float]]:
    """Simulated time [s] at which each run died, and up to which its repaired recording goes."""
    chance = np.random.default_rng(seed)
    for number in range(runs):
        path = folder / f"run_{number}.mcap"
        died = killed(path, number, float(chance.uniform(0.2, LATEST_S)), float(chance.uniform(0, WORST_WAIT_S)))
        saved = repair(path)
        with path.open("rb") as stream:
            summary = make_reader(stream).get_summary()
            assert summary is not None and summary.statistics is not None
            assert summary.statistics.message_end_time == round(saved.seconds * 1e9)
        yield died, saved.seconds


def main() -> None:
    """Print a line a run, and the worst."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=20)
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args()
    worst = 0.0
    with tempfile.TemporaryDirectory() as folder:
        for number, (died, saved) in enumerate(trials(asked.runs, asked.seed, Path(folder))):
            lost = max(0.0, died - saved)
            worst = max(worst, lost)
            print(f"run {number:3}: died at {died:6.1f} s, saved up to {saved:6.1f} s, lost {lost:.1f} s", flush=True)
    print(f"worst: {worst:.1f} s of simulated time (bound {BOUND_S} s)")
    raise SystemExit(0 if worst <= BOUND_S + 1e-9 else 1)


if __name__ == "__main__":
    main()
