"""Fields of discs are crossed by the scaled vector field histogram: contacts, arrivals, times.

Takes: seeds, presets, plans/cross_field. Gives: a line for each preset, and with --each one for each run. Leaves alone:
what is to be thought of it. Run it with `python tests/experiments/obstacle_fields.py --seeds 100 --preset paper`.

A field is 30 m long: discs of 0.1 to 0.3 m radius, as many and where chance puts them, 0.1 of them on each square
metre; only start and goal are kept clear.
"""

from __future__ import annotations

import argparse
import math
import statistics
from pathlib import Path

import numpy as np

from rplan.apps.simulation import Run, World, simulate
from rplan.apps.wiring import compile_source
from rplan.driver import Compiled
from rplan.lang.source import Source
from sim.scenarios.format import loads

PLAN = Path(__file__).parents[2] / "plans" / "cross_field" / "cross_field.rplan"
DENSITY, LENGTH, HALF_WIDTH, CLEAR = 0.1, 30.0, 10.0, 1.2
PRESETS = ("paper", "modern")


def plan(preset: str, parameters: str = "") -> Compiled:
    """The plan with a preset and more parameters of `svfh`."""
    text = PLAN.read_text(encoding="utf-8")
    return compile_source(Source(str(PLAN), text.replace(":preset paper", f":preset {preset} {parameters}")))


def field(seed: int, density: float = DENSITY) -> World:
    """A field that the seed lays out."""
    chance = np.random.default_rng(seed)
    area = (LENGTH + 4.0) * 2 * HALF_WIDTH
    things = []
    for _ in range(chance.poisson(density * area)):
        x, y, radius = (
            chance.uniform(-2.0, LENGTH + 2.0),
            chance.uniform(-HALF_WIDTH, HALF_WIDTH),
            chance.uniform(0.1, 0.3),
        )
        if min(math.hypot(x, y), math.hypot(x - LENGTH, y)) > CLEAR + radius:
            things.append(f"  - {{kind: disc, at: [{x:.3f}, {y:.3f}], radius: {radius:.3f}, height: 1}}")
    text = "\n".join(
        [
            "name: field of discs",
            f"bounds: [-3, {-HALF_WIDTH - 1}, {LENGTH + 3}, {HALF_WIDTH + 1}]",
            "time_limit: 4 min",
            "robot: {model: packbot, start: [0, 0]}",
            f"goal: {{at: [{LENGTH}, 0], within: 2.5 m}}",
            "things:",
            *things,
        ]
    )
    return World(loads(text, "field"), text)


def told(name: str, runs: list[Run]) -> str:
    """What is to be said of the runs."""
    arrived = [run.verdict.duration for run in runs if run.verdict.done]
    contacts = sum(len(run.verdict.contacts) for run in runs)
    touched = sum(bool(run.verdict.contacts) for run in runs)
    nearest = min(run.verdict.smallest_clearance for run in runs)
    times = f", median {statistics.median(arrived):.1f} s, longest {max(arrived):.1f} s" if arrived else ""
    return (
        f"{name}: contacts {contacts} in {touched} of {len(runs)} runs, arrived {len(arrived)}{times}, "
        f"smallest clearance {nearest:.2f} m"
    )


def main() -> None:
    """Print a line for each preset."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=100, help="how many")
    parser.add_argument("--first", type=int, default=0, help="the first seed")
    parser.add_argument("--preset", choices=(*PRESETS, "both"), default="both")
    parser.add_argument("--parameters", default="", help="more parameters of svfh, as in a plan")
    parser.add_argument("--each", action="store_true", help="a line for each run that touched or did not arrive")
    asked = parser.parse_args()
    for preset in PRESETS if asked.preset == "both" else (asked.preset,):
        compiled = plan(preset, asked.parameters)
        runs = []
        for seed in range(asked.first, asked.first + asked.seeds):
            run = simulate(compiled, field(seed), seed)
            runs.append(run)
            if asked.each and (run.verdict.contacts or not run.verdict.done):
                print(seed, run.verdict.reason or "arrived", [f"{t.thing} {t.time:.1f}" for t in run.verdict.contacts])
        print(told(preset, runs), flush=True)


if __name__ == "__main__":
    main()
