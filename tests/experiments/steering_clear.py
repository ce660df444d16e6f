"""Find and fetch with and without the two lines that steer clear, where wheel stops that no sonar sees hold the robot.

Takes: seeds, plans/find_and_fetch and plans/fetch_steering_clear with navigation and searches at `:preset modern`.
Gives: a line for each of them. Leaves alone: why. Run it with `python tests/experiments/steering_clear.py --seeds 20`.
"""

from __future__ import annotations

import argparse
import statistics
from pathlib import Path

from rplan.apps.simulation import World, simulate
from rplan.apps.sweep.work import Change, changed
from rplan.apps.wiring import compile_file
from rplan.driver import Compiled
from sim.scenarios.format import loads

PLANS = Path(__file__).parents[2] / "plans"
LOT = PLANS / "fetch_steering_clear" / "wheel_stops.yaml"
MODERN = ("natigation", "ir-search", "stereo-search", "find-and-fetch")


def plan(name: str) -> Compiled:
    """The plan as its file has it, but for the presets."""
    changes = tuple(Change(library, "preset", "modern") for library in MODERN)
    return changed(compile_file(PLANS / name / f"{name}.rplan"), changes)


def main() -> None:
    """Print a line for each plan."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=20, help="how many")
    seeds = parser.parse_args().seeds
    text = LOT.read_text(encoding="utf-8")
    world = World(loads(text, LOT.name), text)
    for name in ("find_and_fetch", "fetch_steering_clear"):
        compiled = plan(name)
        verdicts = [simulate(compiled, world, seed).verdict for seed in range(seeds)]
        done = [verdict for verdict in verdicts if verdict.done]
        touched = statistics.median(verdict.driven_into for verdict in verdicts)
        times = [verdict.duration for verdict in done] or [float("nan")]
        print(
            f"{name}: fetched {len(done)}/{seeds}, out of time {seeds - len(done)}, driven into {touched:.0f} times in "
            f"the median, done after {statistics.median(times):.0f} s in the median",
            flush=True,
        )


if __name__ == "__main__":
    main()
