"""The worlds of the benchmark BARN: success, contacts, time-outs, time and score of presets.

Takes: worlds in the format of the benchmark, seeds, presets, plans/barn. Gives: a line for each preset, and with --each
one for each run that failed. Leaves alone: worlds that are not asked for; nothing is tuned to single ones.
Run it with `python tests/experiments/barn.py --data FILE`.

The score of a run is that of the organisers: success * OT / clip(AT, 2 OT, 8 OT), AT the time taken, OT the length of
start, planned path and goal at 2 m/s; the most is 0.5. Any contact is a failure, and so is being under way after 100 s.
Source: Perille, Truong, Xiao and Stone 2020, "Benchmarking metric ground navigation"; BARN challenge.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import statistics
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import cache, partial
from itertools import pairwise
from pathlib import Path

from rplan.apps.simulation import World, simulate
from rplan.apps.wiring import compile_source
from rplan.driver import Compiled
from rplan.lang.source import Source
from sim.scenarios.importers import Options, load

ROOT = Path(__file__).parents[2]
PLAN = ROOT / "plans" / "barn" / "barn.rplan"
PRESETS = ("paper", "modern")


@dataclass(frozen=True, slots=True)
class Result:
    """What came of one world: how it ended, the time [s], the optimal time [s], the score."""

    world: int
    end: str
    time: float
    optimal: float
    score: float


def data() -> Path:
    """Where the worlds lie."""
    beside = ROOT.parent / "shared" / "data"
    return (beside if beside.exists() else Path(os.environ.get("RPLAN_DATA", "."))) / "barn" / "barn.json"


@cache
def plan(preset: str, parameters: str) -> Compiled:
    """The plan with a preset and more parameters of `svfh`."""
    text = PLAN.read_text(encoding="utf-8").replace(":preset modern", f":preset {preset}")
    for name, value in (pair.split("=") for pair in parameters.split()):
        start = text.find(f":{name} ")
        end = start if start < 0 else min(i for i in (text.find(c, start + len(name) + 2) for c in " \n)") if i > 0)
        given = f":{name} {value}"
        text = text[:start] + given + text[end:] if start >= 0 else text.replace(":goal-x", f"{given} :goal-x")
    return compile_source(Source(str(PLAN), text))


def optimal_time(file: Path, index: int) -> float:
    """[s] of the planned path at 2 m/s."""
    whole = json.loads(file.read_text(encoding="utf-8"))
    world = next(world for world in whole["worlds"] if world["index"] == index)
    stops = [whole["start"][:2], *world["path"], whole["goal"][:2]]
    return sum(math.dist(a, b) for a, b in pairwise(stops)) / 2.0


def drive(run: tuple[int, int], preset: str, parameters: str, file: Path) -> Result:
    """One world with one seed."""
    index, seed = run
    verdict = simulate(plan(preset, parameters), World(*load(file, Options(world=index))), seed).verdict
    optimal = optimal_time(file, index)
    end = "reached" if verdict.done else "contact" if verdict.contacts else "time-out"
    score = optimal / min(max(verdict.duration, 2 * optimal), 8 * optimal) if verdict.done else 0.0
    return Result(index, end, verdict.duration, optimal, score)


def told(name: str, results: list[Result]) -> str:
    """What is to be said of the runs."""
    times = [result.time for result in results if result.end == "reached"]
    ends = ", ".join(f"{end} {sum(r.end == end for r in results)}" for end in ("reached", "contact", "time-out"))
    score = statistics.mean(result.score for result in results)
    mean = f"{statistics.mean(times):.1f}" if times else "-"
    return f"{name}: {ends} of {len(results)}; time of those that reached {mean} s; score {score:.3f}"


def main() -> None:
    """Print a line for each preset."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, default=data(), help="file of worlds")
    parser.add_argument("--seeds", type=int, default=1, help="runs of each world")
    parser.add_argument("--every", type=int, default=1, help="only each so manyth world")
    parser.add_argument("--first", type=int, default=0, help="the first of them")
    parser.add_argument("--preset", choices=(*PRESETS, "both"), default="both")
    parser.add_argument("--parameters", default="", help="more parameters of svfh: name=value …")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--each", action="store_true", help="a line for each run that did not reach the goal")
    asked = parser.parse_args()
    if not asked.data.exists():
        parser.error(f"{asked.data}: no such file; name one with --data")
    worlds = [world["index"] for world in json.loads(asked.data.read_text(encoding="utf-8"))["worlds"]]
    runs = [(index, seed) for index in worlds[asked.first :: asked.every] for seed in range(asked.seeds)]
    with ProcessPoolExecutor(asked.jobs) as pool:
        for preset in PRESETS if asked.preset == "both" else (asked.preset,):
            work = partial(drive, preset=preset, parameters=asked.parameters, file=asked.data)
            results = list(pool.map(work, runs))
            if asked.each:
                print([f"{r.world}: {r.end} {r.time:.0f}" for r in results if r.end != "reached"])
            print(told(preset, results), flush=True)


if __name__ == "__main__":
    main()
