"""A wall as a straight line through points: found by random sample consensus, then followed from scan to scan.

Takes: points (n, 2) [m] in the robot frame, settings, chance. Gives: `Fit`, a line with the points that lie on it, or
None where no line has enough of them. Leaves alone: which points are looked at (`view_path.py`) and what the line means
for the robot (`wall_state.py`).

After Bayer 2012, with three repairs. The paper fits n.p = 1, whose residual has no dimension and grows with the
distance of the wall; here lines are fitted by total least squares and residuals are mean squares of distances [m^2].
Its bound of 0.01 would let almost any first guess pass; here it is 4e-4 (2 cm). "15 % of all points returned" leaves
no wall beyond two metres in a narrow view; here it is of the points looked at, and never fewer than the 20 of a
followed fit.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from behaviours.interface import Floats, wrap

Mask = NDArray[np.bool_]
SHORTEST, SLENDER = 0.005, 2.0
"""Points on a wall have a standard deviation [m] along it of no less, and of no fewer times that across it while it is
looked for (chosen here); a wall that is followed round a corner is in between as broad as long."""


@dataclass(frozen=True, slots=True)
class FitSettings:
    """iterations, share, least: as printed; residual [m^2]; acquire_band, track_band [m]: how near a point must lie.

    patient: look at all hypotheses and take the one with most points, also where an earlier one is straight enough.
    """

    iterations: int = 50
    share: float = 0.15
    least: int = 20
    residual: float = 4e-4
    acquire_band: float = 0.08
    track_band: float = 0.08
    patient: bool = False


@dataclass(frozen=True, slots=True)
class Line:
    """n.p = distance: normal [rad] of n in the robot frame; distance [m], negative where the robot has crossed it."""

    normal: float
    distance: float

    @property
    def n(self) -> tuple[float, float]:
        """The unit normal; it points from the robot to the wall."""
        return math.cos(self.normal), math.sin(self.normal)

    @property
    def along(self) -> tuple[float, float]:
        """The unit vector along the wall, with the wall to its right."""
        return -math.sin(self.normal), math.cos(self.normal)

    def off(self, points: Floats) -> Floats:
        """Signed distances [m] of points beyond the line, as the robot sees it."""
        x, y = self.n
        return np.asarray(points[:, 0] * x + points[:, 1] * y - self.distance)

    def stations(self, points: Floats) -> Floats:
        """How far [m] along the wall points lie from the foot of the robot, ahead positive."""
        x, y = self.along
        return np.asarray(points[:, 0] * x + points[:, 1] * y)


@dataclass(frozen=True, slots=True)
class Fit:
    """A line, which of the points lie on it (n,), and the mean square [m^2] of their distances."""

    line: Line
    inliers: Mask
    residual: float


def acquire(points: Floats, settings: FitSettings, chance: Generator, accept: float = math.pi) -> Fit | None:
    """The wall that sampling finds. accept [rad]: it may be turned so far from one that runs ahead on the right."""
    count = len(points)
    if count < max(2, settings.least):
        return None
    normals, distances = _hypotheses(points, settings.iterations, chance)
    near = np.abs(normals @ points.T - distances[:, None]) <= settings.acquire_band
    sums = near @ _moments(points)
    enough = sums[:, 0] >= max(settings.least, settings.share * count)
    best: tuple[float, float, Line, Mask] | None = None
    for k in np.flatnonzero(enough):
        straight = _best_line(sums[k].tolist(), SLENDER)
        if straight is None or abs(wrap(-straight[0].normal - math.pi / 2)) > accept:
            continue
        line, residual = straight
        at_once = residual <= settings.residual and not settings.patient
        if at_once or best is None or (-sums[k, 0], residual) < best[:2]:
            best = -float(sums[k, 0]), residual, line, near[k]
        if at_once:
            break
    return None if best is None else Fit(best[2], best[3], best[1])


def track(points: Floats, before: Line, settings: FitSettings) -> Fit | None:
    """The wall a scan later: the line through what lies near the line of before. Its normal keeps its sense."""
    near = np.abs(before.off(points)) <= settings.track_band
    count = int(np.count_nonzero(near))
    if count < max(2, settings.least):
        return None
    x, y = points[near].T
    sums = count, float(x.sum()), float(y.sum()), float(x @ x), float(x @ y), float(y @ y)
    best = _best_line(sums)
    if best is None:
        return None
    line, residual = best
    if math.cos(line.normal - before.normal) < 0:
        line = Line(wrap(line.normal + math.pi), -line.distance)
    return Fit(line, near, residual)


def _hypotheses(points: Floats, count: int, chance: Generator) -> tuple[Floats, Floats]:
    """Unit normals (k, 2) and distances (k,) of lines through two different points each."""
    first = chance.integers(0, len(points), count)
    second = (first + chance.integers(1, len(points), count)) % len(points)
    a, b = points[first], points[second]
    normals = np.column_stack([a[:, 1] - b[:, 1], b[:, 0] - a[:, 0]])
    lengths = np.hypot(normals[:, 0], normals[:, 1])
    apart = lengths > 0
    normals = normals[apart] / lengths[apart, None]
    return normals, np.einsum("ij,ij->i", normals, a[apart])


def _moments(points: Floats) -> Floats:
    """(n, 6): 1, x, y, xx, xy, yy."""
    x, y = points[:, 0], points[:, 1]
    return np.column_stack([np.ones(len(points)), x, y, x * x, x * y, y * y])


def _best_line(sums: Sequence[float], slender: float = 1.0) -> tuple[Line, float] | None:
    """Total least squares from the sums of 1, x, y, xx, xy, yy; the normal points away from the robot.

    None where the points are no line: all in one place, or not so many times longer than broad.
    """
    n, x, y, xx, xy, yy = sums
    mx, my = x / n, y / n
    cxx, cxy, cyy = xx / n - mx * mx, xy / n - mx * my, yy / n - my * my
    middle, half = (cxx + cyy) / 2, math.hypot((cxx - cyy) / 2, cxy)
    if middle + half < max(SHORTEST**2, slender**2 * (middle - half)):
        return None
    normal = 0.5 * math.atan2(2 * cxy, cxx - cyy) + math.pi / 2
    distance = mx * math.cos(normal) + my * math.sin(normal)
    if distance < 0:
        normal, distance = normal + math.pi, -distance
    return Line(wrap(normal), distance), max(0.0, middle - half)
