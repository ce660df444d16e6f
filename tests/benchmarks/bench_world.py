"""What a tick of the parking lot costs. Run it by hand: `python tests/benchmarks/bench_world.py`."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from behaviours.interface import Command, Drive, Pose
from sim.episode import Episode
from sim.raycast import Circle, Outline, Rays, Scene, box, cast
from sim.scenarios.format import load
from sim.world import PERIOD, World

LOT = load(Path(__file__).parents[2] / "plans" / "find_and_fetch" / "parking_lot.yaml")
ROUND = Command(Drive(0.2, 0.15))


def microseconds(work: Callable[[], object], times: int) -> float:
    """Median of five batches, per call."""
    batches = []
    for _ in range(5):
        start = time.perf_counter()
        for _ in range(times):
            work()
        batches.append((time.perf_counter() - start) / times * 1e6)
    return statistics.median(batches)


def main() -> None:
    """Print a line for each measurement."""
    stepping, sensing, whole = World(LOT, 1), World(LOT, 1), Episode(LOT, 1)
    pure = microseconds(lambda: stepping.step(ROUND), 600)

    def sense_and_step() -> None:
        sensing.sense()
        sensing.step(ROUND)

    both = microseconds(sense_and_step, 600)

    def tick() -> None:
        whole.world.sense()
        whole.world.step(ROUND)
        whole.judge.observe()

    judged = microseconds(tick, 600)
    shown = microseconds(whole.snapshot, 600)
    print(f"tick: step {pure:.0f} us, with sensing {both:.0f} us, with the judge {judged:.0f} us")
    print(f"      {PERIOD * 1e6 / judged:.0f} times real time; a snapshot {shown:.0f} us more")
    chance = np.random.default_rng(0)
    outlines: list[Outline] = [*[box(2.0, 0.2)] * 200, *[Circle(0.3)] * 60]
    poses = [Pose(*chance.uniform((-20, -20, -3), (20, 20, 3)).tolist()) for _ in outlines]
    scene, zeros = Scene(outlines, poses, [1.0] * 260), np.zeros(360)
    rays = Rays(zeros, zeros, np.linspace(0, 6.28, 360), zeros)
    print(f"cast: 360 rays, 260 things: {microseconds(lambda: cast(rays, 20.0, scene), 100):.0f} us")


if __name__ == "__main__":
    main()
