"""Are the caster's distances right? `python tests/experiments/rays_exact.py --poses 10000`; exits 1 above 1e-9 m.

Takes: how many poses, a seed. Gives: random worlds of discs, convex polygons and rings with holes, some of which move,
some low and some taken out; from every pose a fan and a ring of rays from a hull, against a caster of its own that
tries every ray on every shape in extended precision; the worst difference.
Leaves alone: speed.
"""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from behaviours.interface import Pose
from sim.raycast import Circle, Fan, Outline, Polygon, Rays, Rings, Scene, cast, sweep, sweep_things
from sim.raycast_c import Loops
from sim.raycast_c import loops as compiled_loops

TOLERANCE = 1e-9  # [m]
POSES_PER_WORLD = 20
Wide = NDArray[np.longdouble]


# --- the judge ------------------------------------------------------------------------------------


class Judge:
    """The same things, in extended precision; shares nothing with the caster but the words for outlines."""

    def __init__(self, outlines: list[Outline], poses: list[Pose], heights: list[float]) -> None:
        self.outlines, self.poses, self.heights = outlines, list(poses), heights

    def ranges(self, x: float, y: float, angles: Wide, height: float, max_range: float) -> Wide:
        """Distance to the first thing along each ray."""
        best = np.full(angles.shape, np.longdouble(max_range))
        for outline, pose, high in zip(self.outlines, self.poses, self.heights, strict=True):
            if high > height and math.hypot(pose.x - x, pose.y - y) < max_range + 10:
                best = np.minimum(best, _alone(outline, pose, x, y, angles))
        return best


def _alone(outline: Outline, pose: Pose, x: float, y: float, angles: Wide) -> Wide:
    """Distances to one thing; inf where it is not met."""
    to_x, to_y = np.longdouble(x) - np.longdouble(pose.x), np.longdouble(y) - np.longdouble(pose.y)
    c, s = np.cos(np.longdouble(pose.theta)), np.sin(np.longdouble(pose.theta))
    own_x, own_y = c * to_x + s * to_y, c * to_y - s * to_x  # the start in the frame of the thing
    turned = angles - np.longdouble(pose.theta)
    match outline:
        case Circle(radius):
            return _disc(own_x, own_y, turned, np.longdouble(radius))
        case Polygon(vertices):
            return _rings((vertices,), own_x, own_y, turned)
        case Rings(rings):
            return _rings(rings, own_x, own_y, turned)


def _disc(x: np.longdouble, y: np.longdouble, angles: Wide, radius: np.longdouble) -> Wide:
    """The roots of |start + t direction| = radius."""
    half_b, rest = x * np.cos(angles) + y * np.sin(angles), x * x + y * y - radius * radius
    if rest < 0:
        return np.zeros_like(angles)
    inner = half_b * half_b - rest
    at = -half_b - np.sqrt(np.maximum(inner, 0))
    return np.where((inner >= 0) & (at >= 0), at, np.inf)


def _rings(
    rings: tuple[tuple[tuple[float, float], ...], ...], x: np.longdouble, y: np.longdouble, angles: Wide
) -> Wide:
    """The nearest side, or 0 where the angles under which the sides are seen add up to a turn."""
    dx, dy = np.cos(angles), np.sin(angles)
    best, seen = np.full(angles.shape, np.longdouble(np.inf)), np.longdouble(0)
    for ring in rings:
        corners = np.array(ring, dtype=np.longdouble) - np.array([x, y])
        for (ax, ay), (bx, by) in zip(corners, np.roll(corners, -1, axis=0), strict=True):
            seen += np.arctan2(ax * by - ay * bx, ax * bx + ay * by)
            best = np.minimum(best, _side(dx, dy, ax, ay, bx - ax, by - ay))
    return np.zeros_like(angles) if seen > math.pi else best


def _side(dx: Wide, dy: Wide, ax: np.longdouble, ay: np.longdouble, ex: np.longdouble, ey: np.longdouble) -> Wide:
    closing = dx * ey - dy * ex
    safe = np.where(closing == 0, np.longdouble(1), closing)
    along, share = (ax * ey - ay * ex) / safe, (ax * dy - ay * dx) / safe
    return np.where((closing != 0) & (along >= 0) & (share >= 0) & (share <= 1), along, np.inf)


# --- random worlds --------------------------------------------------------------------------------


def _star(chance: np.random.Generator, inner: float, outer: float, corners: int) -> list[tuple[float, float]]:
    """A ring round the origin, counter-clockwise, anything but convex."""
    turns = (np.arange(corners) + chance.uniform(0.1, 0.9, corners)) / corners * math.tau
    return [
        (r * math.cos(t), r * math.sin(t)) for r, t in zip(chance.uniform(inner, outer, corners), turns, strict=True)
    ]


def outline(chance: np.random.Generator) -> Outline:
    """A disc, a convex polygon, or rings: a wall round a yard, with a block in the yard."""
    size = float(chance.uniform(0.1, 1.2))
    match int(chance.integers(4)):
        case 0 | 1:
            return Circle(size)
        case 2:
            turns = np.sort(chance.uniform(0, math.tau, int(chance.integers(3, 8))))
            return Polygon(tuple((size * math.cos(t), 0.6 * size * math.sin(t)) for t in turns))
        case _:
            yard = tuple(reversed(_star(chance, 1.4 * size, 1.8 * size, 9)))
            return Rings(
                (tuple(_star(chance, 2.2 * size, 3 * size, 12)), yard, tuple(_star(chance, 0.3 * size, size, 5)))
            )


def pose(chance: np.random.Generator, half: float) -> Pose:
    """Somewhere in a square."""
    x, y = chance.uniform(-half, half, 2)
    return Pose(float(x), float(y), float(chance.uniform(-math.pi, math.pi)))


def _fan(chance: np.random.Generator) -> Fan:
    if chance.random() < 0.5:
        return Fan(np.arange(24) / 24 * math.tau - math.pi)
    return Fan(np.unique(chance.uniform(-2.5, 3.7, 17)))


# --- the comparison -------------------------------------------------------------------------------


def differences(poses: int, seed: int, loops: Callable[[], Loops | None] = compiled_loops) -> Iterator[float]:
    """For each pose the worst difference [m] of its rays; things move between poses. loops: as for `Scene`."""
    chance = np.random.default_rng(seed)
    for number in range(poses):
        if number % POSES_PER_WORLD == 0:
            count, half = int(chance.integers(1, 40)), float(chance.uniform(3, 12))
            outlines = [outline(chance) for _ in range(count)]
            start, heights = [pose(chance, half) for _ in outlines], [float(h) for h in chance.uniform(0, 1, count)]
            judge, scene = Judge(outlines, start, heights), Scene(outlines, start, heights, loops)
        for index in chance.integers(0, count, int(chance.integers(0, 4))):
            away = Pose(1000.0 * (1 + float(index)), 1000.0)
            judge.poses[index] = away if chance.random() < 0.3 else pose(chance, half)
            scene.place(int(index), judge.poses[index])
        yield _worst(chance, judge, scene, pose(chance, half), half)


def _worst(chance: np.random.Generator, judge: Judge, scene: Scene, at: Pose, half: float) -> float:
    fan, height, max_range = _fan(chance), float(chance.uniform(0, 0.7)), float(chance.choice([2.0, 5.0, 2 * half]))
    ranges = sweep(fan, at, height, max_range, scene)
    again, things = sweep_things(fan, at, height, max_range, scene)
    if (again != ranges).any() or ((things == -1) != (ranges == max_range)).any():
        return math.inf
    angles = np.asarray(fan.bearings, dtype=np.longdouble) + np.longdouble(at.theta)
    worst = float(np.abs(judge.ranges(at.x, at.y, angles, height, max_range) - ranges).max())
    hull = np.arange(8) / 8 * math.tau + at.theta
    x, y, high = at.x + 0.35 * np.cos(hull), at.y + 0.35 * np.sin(hull), chance.uniform(0, 0.7, 8)
    ranges, _ = cast(Rays(x, y, hull, high), max_range, scene)
    for k in range(8):
        right = judge.ranges(x[k], y[k], np.asarray(hull[k : k + 1], dtype=np.longdouble), high[k], max_range)
        worst = max(worst, abs(float(right[0] - ranges[k])))
    return worst


def main() -> None:
    """Print the number of poses and the worst difference."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--poses", type=int, default=10000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--arrays", action="store_true", help="without the compiled loops")
    asked = parser.parse_args()
    found = list(differences(asked.poses, asked.seed, (lambda: None) if asked.arrays else compiled_loops))
    print(f"{len(found)} poses: worst difference {max(found):.3g} m (allowed {TOLERANCE:g} m)")
    sys.exit(max(found) > TOLERANCE)


if __name__ == "__main__":
    main()
