"""How many times faster than real time the world runs, without a brain.

Run by hand: `python tests/benchmarks/bench_simulator.py`. The scene that simulators are compared in: a room of 20 x 20
m, 50 discs, a round robot of 0.2 m on a circle of 2 m at 0.5 m/s, one lidar of 10 m over 360 degrees each step of
0.1 s, no noise. Then the same with the discs moving, at equal density with 10 to 10,000 discs, and a grid map of
2,000 x 2,000 cells. Medians of five batches; with `--numpy` without the compiled caster.
"""

from __future__ import annotations

import argparse
import math
import statistics
import time
from dataclasses import replace
from functools import partial

import numpy as np

from behaviours.interface import Command, Drive, Pose
from sim import world
from sim.raycast import Rings, Scene
from sim.scenarios.format import loads
from sim.scenarios.grid import trace
from sim.scenarios.scenario import Scenario, ThingSpec
from sim.sensors.build import LidarBuild
from sim.world import World

ROUND = Command(Drive(0.5, 0.25))
HEAD = """
name: bench
bounds: [-10, -10, 10, 10]
robot:
  start: [0, -2]
  shape: {circle: 0.2}
  drive: {kind: differential, max_speed: 1}
  sensors: [{kind: lidar, beams: 360, max_range: 10, sd: 0}]
things:
"""


def room(discs: int, moving: bool = False) -> Scenario:
    """A square room with so many discs, eight square metres to each, none on the robot's circle."""
    half = math.sqrt(8.0 * discs) / 2
    lines = [f" - {{kind: wall, from: [{-half}, {y}], to: [{half}, {y}]}}" for y in (-half, half)]
    lines += [f" - {{kind: wall, from: [{x}, {-half}], to: [{x}, {half}]}}" for x in (-half, half)]
    chance, left = np.random.default_rng(1), discs
    while left:
        x, y, radius = chance.uniform(-half + 0.5, half - 0.5), chance.uniform(-half + 0.5, half - 0.5), 0.2
        if abs(math.hypot(x, y) - 2.0) > 0.7:
            place = f"keyframes: [[0, {x}, {y}], [4, {x}, {y + 0.05}], [8, {x}, {y}]]" if moving else f"at: [{x}, {y}]"
            lines.append(f" - {{kind: disc, radius: {radius}, {place}}}")
            left -= 1
    return loads(HEAD.replace("[-10, -10, 10, 10]", f"[{-half}, {-half}, {half}, {half}]") + "\n".join(lines) + "\n")


def with_beams(scenario: Scenario, beams: int) -> Scenario:
    """The same with so many beams; 0: without a lidar."""
    lidar = scenario.robot.sensors[0]
    assert isinstance(lidar.build, LidarBuild)
    sensors = (replace(lidar, build=replace(lidar.build, beams=beams)),) if beams else ()
    return replace(scenario, robot=replace(scenario.robot, sensors=sensors))


def factor(scenario: Scenario, command: Command = ROUND, steps: int = 400) -> float:
    """Simulated seconds a second: median of five batches."""
    running, batches = World(scenario, 0), list[float]()
    for _ in range(5):
        begin = time.perf_counter()
        for _ in range(steps):
            running.sense()
            running.step(command)
        batches.append(steps * running.period / (time.perf_counter() - begin))
    return statistics.median(batches)


def grid_map(cells: int) -> tuple[Scenario, float, int]:
    """A map of rooms with doors and furniture at 5 cm a cell, the seconds that it took, and its edges."""
    chance = np.random.default_rng(2)
    occupied = np.zeros((cells, cells), dtype=bool)
    for at in range(0, cells, 100):
        occupied[at : at + 4, :] = occupied[:, at : at + 4] = True
    for row in range(0, cells, 100):
        for column in range(0, cells, 100):
            occupied[row + 40 : row + 60, column : column + 4] = False
            occupied[row : row + 4, column + 40 : column + 60] = False
            for _ in range(4):
                y, x = row + 10 + chance.integers(0, 70), column + 10 + chance.integers(0, 70)
                occupied[y : y + 8, x : x + 12] = True
    middle = cells // 2 + 50
    occupied[middle - 44 : middle + 44, middle - 44 : middle + 44] = False
    begin = time.perf_counter()
    rings = Rings(trace(occupied, 0.05, Pose(0.0, 0.0)))
    thing = ThingSpec("outline", rings, 2.0, (0.0, 0.0))
    start = (middle * 0.05, middle * 0.05 - 2.0) if cells * 0.05 > 20 else (1.0, 1.0)
    base = room(10)
    scenario = replace(base, things=(thing,), robot=replace(base.robot, start=start))
    World(with_beams(scenario, 360), 0).sense()
    return scenario, time.perf_counter() - begin, sum(map(len, rings.rings))


def main() -> None:
    """Print a line for each measurement."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--numpy", action="store_true", help="without the compiled caster")
    if parser.parse_args().numpy:
        vars(world)["Scene"] = partial(Scene, loops=lambda: None)
    print("one robot among 50 discs, 0.1 s steps, without a brain: times real time")
    scene = room(50)
    for beams in (360, 24, 0):
        print(f"  {beams:4} rays: {factor(with_beams(scene, beams)):7,.0f}")
    print(f"  360 rays, all 50 discs moving: {factor(room(50, moving=True), steps=100):,.0f}")
    print("at equal density, 360 rays")
    for discs in (10, 100, 1_000, 10_000):
        print(f"  {discs:6,} discs: {factor(room(discs), steps=200):7,.0f}")
    scenario, seconds, edges = grid_map(2_000)
    print(f"a map of 2,000 x 2,000 cells ({edges:,} edges): ready after {seconds:.2f} s")
    for beams in (360, 24):
        print(f"  {beams:4} rays: {factor(with_beams(scenario, beams)):7,.0f}")


if __name__ == "__main__":
    main()
