"""What following a wall costs: `python tests/benchmarks/bench_wall.py`. Run by hand; it asserts nothing.

Takes: nothing. Gives: processor time of a scan of 667 beams while a wall is followed, with its parts, of a scan in
which one is looked for, and how many times faster than real time the whole loop of world, robot and plan runs at a scan
each 28 ms. Leaves alone: whether that is fast enough. Every figure is the least of nine batches, so that a busy machine
shows less.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from behaviours.cores.view_path import ViewPath
from behaviours.cores.wall_fit import Fit, FitSettings, Line, acquire, track
from behaviours.cores.wall_loss import end_of, invented
from behaviours.cores.wall_state import FilterSettings, begun, predicted, updated
from behaviours.estimators.fitted_wall import FittedWall, FittedWallSettings
from behaviours.estimators.surroundings import scan_points
from behaviours.interface import Odometry, Pose, Reading, Scan
from rplan.apps.simulation import load_world
from rplan.apps.wiring import PlanBrain, compile_file
from sim.episode import Episode

PLAN = Path(__file__).parents[2] / "plans" / "follow_wall"
BEAMS, REACH, BATCHES, TIMES = 667, 4.0, 9, 400
BESIDE = Line(-math.pi / 2, 1.0)


def each(work: Callable[[], object], times: int = TIMES) -> float:
    """Microseconds of the processor a call."""
    batches = []
    for _ in range(BATCHES):
        begin = time.process_time()
        for _ in range(times):
            work()
        batches.append((time.process_time() - begin) / times * 1e6)
    return min(batches)


def scan(ends: float = math.inf) -> Scan:
    """Beside a wall a metre to the right, which may end so far ahead."""
    bearings = np.radians(np.linspace(-120, 120, BEAMS))
    with np.errstate(divide="ignore"):
        ranges = np.where(np.sin(bearings) < 0, -1.0 / np.sin(bearings), np.inf)
    ranges = np.where(ranges * np.cos(bearings) <= ends, ranges, np.inf)
    ranges = ranges * (1 + np.random.default_rng(0).normal(0, 0.01, BEAMS))
    return Scan(0.0, True, Pose(0.0, 0.0), bearings, np.minimum(ranges, REACH), 0.02, REACH)


def reading(one: Scan) -> Reading:
    """The robot goes straight ahead."""
    return Reading(0.0, 0, Odometry(Pose(0.0, 0.0), 0.48, 0.0), lidar=one)


def wall(one: Reading, settings: FittedWallSettings) -> FittedWall:
    """One that is followed."""
    found = FittedWall(settings)
    found.update(one, {}, {})
    assert found.is_found
    return found


def followed() -> list[tuple[str, float]]:
    """Scans of a wall that goes on, and of one that ends."""
    on, ends = reading(scan()), reading(scan(0.7))
    whole, ending = wall(on, FittedWallSettings()), wall(ends, FittedWallSettings())
    bare = wall(on, FittedWallSettings(loss=False, curve=False))
    return [
        ("a scan: points, fit, filter, end, curvature", each(lambda: whole.update(on, {}, {}))),
        ("a scan of a wall that ends", each(lambda: ending.update(ends, {}, {}))),
        ("a scan without curvature and wall loss", each(lambda: bare.update(on, {}, {}))),
    ]


def parts() -> list[tuple[str, float]]:
    """One by one."""
    one, view, settings, filtered = scan(0.7), ViewPath(), FitSettings(), FilterSettings()
    points = scan_points(one)
    held = points[view.holds(points)]
    fit = track(held, BESIDE, settings)
    assert isinstance(fit, Fit)
    state = begun(BESIDE, filtered)
    chance = np.random.default_rng(0)
    return [
        ("  points of the scan", each(lambda: scan_points(one))),
        ("  view path", each(lambda: view.holds(points))),
        ("  followed fit", each(lambda: track(held, BESIDE, settings))),
        ("  filter", each(lambda: updated(predicted(state, 0.013, 0.0, 1.0, filtered), fit.line, filtered))),
        ("  end and invented points", each(lambda: invented(fit, held, end_of(fit, held, view), view))),
        ("a wall looked for, 50 samples", each(lambda: acquire(points, settings, chance), 50)),
        ("  with patience", each(lambda: acquire(points, replace(settings, patient=True), chance), 50)),
    ]


def real_time() -> float:
    """How many times faster than real time 20 s of the plan are."""
    compiled, world = compile_file(PLAN / "follow_wall.rplan"), load_world(PLAN / "worlds" / "straight.yaml")

    def run() -> float:
        brain = PlanBrain(compiled)
        begin = time.process_time()
        verdict = Episode(world.scenario, 0, compiled.goals.period).run(brain, 20.0)
        brain.close()
        return verdict.duration / (time.process_time() - begin)

    return max(run() for _ in range(5))


def main() -> None:
    """Print it."""
    for name, cost in followed() + parts():
        print(f"{name:<48}{cost:>9.1f} us")
    print(f"{'whole loop at 28 ms':<48}{real_time():>9.0f} times real time")


if __name__ == "__main__":
    main()
