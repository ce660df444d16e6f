"""What casting costs. Run it by hand: `python tests/benchmarks/bench_rays.py`.

Takes: nothing. Gives: a line for each world, with the cost of 24 and of 360 rays round the robot, 10 m far, while it
drives at 1 m/s and senses every 0.1 s: processor time of a sweep in the mean, new cells included. Worlds: discs and
boxes at equal density, 10 to 10,000 of them; 50 discs of which ten move; a map of rings with about 10,000 edges.
Leaves alone: stepping the world (`bench_world.py`).
"""

from __future__ import annotations

import argparse
import math
import statistics
import time
from collections.abc import Callable
from functools import partial

import numpy as np

from behaviours.interface import Pose, Vec2
from sim.raycast import Circle, Fan, Outline, Rays, Rings, Scene, box, cast, sweep
from sim.raycast_c import Loops
from sim.raycast_c import loops as compiled_loops

DENSITY = 50 / 400  # things per square metre: 50 in a room of 20 x 20 m
MAX_RANGE, HEIGHT, STEP = 10.0, 0.3, 0.1
BATCH, BATCHES = 100, 5


def no_loops() -> Loops | None:
    """In their place: arrays alone."""
    return None


def room(half: float) -> Rings:
    """Four walls, 0.2 m thick."""
    out, within = half + 0.2, half
    hole = ((-within, -within), (-within, within), (within, within), (within, -within))
    return Rings((((-out, -out), (out, -out), (out, out), (-out, out)), hole))


def scattered(one: Outline, count: int, loops: Callable[[], Loops | None]) -> tuple[Scene, float]:
    """A room of so many things at equal density, and half its width [m]; the middle is left free."""
    chance, half = np.random.default_rng(count), math.sqrt(count / DENSITY) / 2
    places: list[Pose] = []
    while len(places) < count:
        x, y = chance.uniform(-half, half, 2)
        if abs(y) > 0.8:
            places.append(Pose(float(x), float(y), float(chance.uniform(-3, 3))))
    outlines = [room(half), *[one] * count]
    return Scene(outlines, [Pose(0, 0), *places], [1.0] * len(outlines), loops), half


def ring_map(blocks: int, cell: float, loops: Callable[[], Loops | None]) -> tuple[Scene, float]:
    """Rough blocks as a grid map gives them: one thing of many rings, their sides along the cells."""
    chance, half = np.random.default_rng(blocks), blocks * 2.5 / 2
    rings: list[tuple[Vec2, ...]] = []
    for k in range(blocks * blocks):
        x, y = (k % blocks) * 2.5 - half + 0.8, (k // blocks) * 2.5 - half + 0.8
        tops = [(float(h) * cell, float(g) * cell) for h, g in chance.integers(1, 12, (4, 2))]
        left = x
        upper: list[Vec2] = []
        for width, top in tops:
            upper += [(left, y + top), (left + width, y + top)]
            left += width
        steps = [corner for corner, after in zip(upper, [*upper[1:], None], strict=True) if corner != after]
        rings.append(((x, y), (left, y), *reversed(steps)))
    return Scene([Rings(tuple(rings)), room(half)], [Pose(0, 0)] * 2, [1.0] * 2, loops), half


def microseconds(work: Callable[[int], object]) -> float:
    """Median of the batches, per call."""
    batches = []
    for batch in range(BATCHES):
        start = time.process_time()
        for number in range(BATCH):
            work(batch * BATCH + number)
        batches.append((time.process_time() - start) / BATCH * 1e6)
    return statistics.median(batches)


def driving(scene: Scene, half: float, rays: int, moving: int = 0) -> float:
    """Cost of a sweep [us] while the robot drives to and fro; `moving` things move before each."""
    fan = Fan(np.arange(rays) / rays * math.tau)
    way = max(half - 1.0, 0.5)

    def work(number: int) -> None:
        along = number * STEP % (4 * way)
        x = along - way if along < 2 * way else 3 * way - along
        for thing in range(1, moving + 1):
            scene.place(thing, Pose(float(scene.x[thing]) + (0.01 if number % 2 else -0.01), float(scene.y[thing])))
        sweep(fan, Pose(x, 0.1 * math.sin(x), 0.3 * number), HEIGHT, MAX_RANGE, scene)

    return microseconds(work)


def hull(scene: Scene) -> float:
    """Cost of a sonar ring [us]: 30 cones of 5 rays, 5 m far, from the hull."""
    axes = np.repeat(np.arange(30) / 30 * math.tau, 5)
    angles, high = axes + np.tile(np.linspace(-0.157, 0.157, 5), 30), np.full(150, HEIGHT)
    x, y = 0.35 * np.cos(axes), 0.35 * np.sin(axes)
    return microseconds(lambda number: cast(Rays(x + number * 0.001, y, angles, high), 5.0, scene))


def line(name: str, make: Callable[[], tuple[Scene, float]]) -> None:
    """Print one world; each figure is of a scene of its own, that knows no cell yet."""
    few, many, ring = driving(*make(), 24), driving(*make(), 360), hull(make()[0])
    print(f"{name:24} sweep of 24 rays {few:6.1f} us, of 360 rays {many:6.1f} us; sonar ring {ring:6.1f} us")


def main() -> None:
    """Print a line for each world."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--arrays", action="store_true", help="without the compiled loops")
    loops = no_loops if parser.parse_args().arrays else compiled_loops
    for name, one in (("discs", Circle(0.3)), ("boxes", box(0.6, 0.4))):
        for count in (10, 50, 100, 1000, 10000):
            line(f"{count} {name}", partial(scattered, one, count, loops))
    moving = driving(*scattered(Circle(0.3), 50, loops), 360, 10)
    print(f"{'50 discs, 10 moving':24} sweep of 360 rays and placing {moving:6.1f} us")
    edges = ring_map(32, 0.05, loops)[0].edges.shape[1]
    line(f"rings of {edges} edges", partial(ring_map, 32, 0.05, loops))


if __name__ == "__main__":
    main()
