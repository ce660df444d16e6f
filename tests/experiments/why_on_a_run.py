"""A run of find and fetch: `why` and `why-not` of twenty of its ticks are as trying every combination of percepts says.

Run by hand: `python tests/experiments/why_on_a_run.py --ticks 20`. The ticks are spread over the switches of the run,
so that every phase has some. The twelve percepts of the plan have 4,096 combinations; all are tried, for each output
that the plan can set. Prints what was compared, and stops with exit code 1 at the first tick that differs.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from properties.explanations import Tick, Trial, differs

from rplan.apps.simulation import load_world, simulate
from rplan.apps.wiring import compile_file
from sim.recording import read

FOLDER = Path(__file__).parents[2] / "plans" / "find_and_fetch"


def chosen(inputs: list[tuple[bool, ...]], ticks: int) -> list[int]:
    """Ticks at which the percepts change, evenly over the run; then others."""
    changes = [n for n in range(len(inputs)) if n == 0 or inputs[n] != inputs[n - 1]]
    every = changes if len(changes) >= ticks else sorted({*changes, *range(0, len(inputs), len(inputs) // ticks)})
    return [every[n * len(every) // ticks] for n in range(ticks)]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--ticks", type=int, default=20)
    parser.add_argument("--seed", type=int, default=0)
    wanted = parser.parse_args()
    compiled = compile_file(FOLDER / "find_and_fetch.rplan")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "run.mcap"
        simulate(compiled, load_world(FOLDER / "parking_lot.yaml"), wanted.seed, record=path)
        plans = [tick["plan"] for tick in read(path).ticks]
    inputs = [tuple(bool(bit) for bit in plan["inputs"]) for plan in plans if isinstance(plan, dict)]
    trial = Trial(compiled.ways)
    for number in chosen(inputs, wanted.ticks):
        atoms = inputs[number]
        values: dict[str, bool | float] = dict(zip(trial.percepts, atoms, strict=True))
        said = differs(trial, Tick(values, atoms, (), None))
        if said:
            print(f"tick {number} differs: {said}")
            return 1
    print(f"{wanted.ticks} ticks of {len(inputs):,}: every `why` and every `why-not` is as 4,096 combinations say")
    return 0


if __name__ == "__main__":
    sys.exit(main())
