"""Donors 25 to 60 feet away in any direction: how often they are found, and how soon.

Takes: seeds, plans/fetch_far with other parameters. Gives: a line for each way to choose where to listen next.
Leaves alone: how it is done. Run it with `python tests/experiments/far_search.py --seeds 50`.
"""

from __future__ import annotations

import argparse
import math
from pathlib import Path

import numpy as np

from rplan.apps.simulation import World, simulate
from rplan.apps.wiring import compile_source
from rplan.driver import Compiled
from rplan.lang.source import Source
from sim.scenarios.format import loads

PLAN = Path(__file__).parents[2] / "plans" / "fetch_far" / "fetch_far.rplan"
LOT = PLAN.parent / "far_lot.yaml"
WAYS = (("chance, faint", ""), ("chance", " :faint off"), ("spiral", " :faint off :route spiral"))
FOOT = 0.3048


def plan(parameters: str) -> Compiled:
    """The plan with parameters of find-and-fetch."""
    text = PLAN.read_text(encoding="utf-8")
    used = "(use find-and-fetch :preset modern"
    return compile_source(Source(str(PLAN), text.replace(used, used + parameters)))


def lot(seed: int) -> World:
    """The lot with a donor somewhere else."""
    chance = np.random.default_rng(seed)
    away, angle = chance.uniform(25, 60) * FOOT, chance.uniform(-math.pi, math.pi)
    place = f"at: [{away * math.cos(angle):.3f}, {away * math.sin(angle):.3f}]"
    text = LOT.read_text(encoding="utf-8").replace("at: [45 ft, 0]", place)
    return World(loads(text, "lot"), text)


def main() -> None:
    """Print a line for each way."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=50, help="how many")
    seeds = parser.parse_args().seeds
    for name, parameters in WAYS:
        compiled = plan(parameters)
        runs = [simulate(compiled, lot(seed), seed) for seed in range(seeds)]
        arrivals = [run.verdict.times.arrival for run in runs if run.verdict.times.arrival is not None]
        listens = [run.shares["(start-ir-search)"].switches for run in runs]
        fetched = sum(run.verdict.done for run in runs)
        into = sum(run.verdict.driven_into for run in runs)
        mean = sum(arrivals) / len(arrivals)
        print(
            f"{name}: found {len(arrivals)}/{seeds}, fetched {fetched}/{seeds}, driven into {into}, until there mean "
            f"{mean:.0f} s, longest {max(arrivals):.0f} s, listens {sum(listens) / seeds:.1f}",
            flush=True,
        )


if __name__ == "__main__":
    main()
