"""Corners that a straight line knows nothing of: pivots about the end of a wall, and walls that bar the way.

Takes: points (n, 2) [m] in the robot frame, the wall to the right; where the followed wall ends. Gives: the line to
steer by while turning round an end, the wall behind it when it comes into sight, and the wall ahead. Leaves alone:
the steering, and walls to the left, which are in the mirror.

Round the end of a wall the robot goes on a circle about it, as if the wall had a tangent there. These are no parts of
Bayer 2012; they are what its conclusions ask for.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.random import Generator

from behaviours.cores.wall_fit import Fit, FitSettings, Line, acquire
from behaviours.interface import Floats

Point = tuple[float, float]


@dataclass(frozen=True, slots=True)
class CornerSettings:
    """All chosen here.

    abreast [m]: a pivot begins when the end of the wall is so near ahead; near [m]: the new wall lies so near to the
    end of the old one; turned [rad]: it is followed when the heading is turned no more against it; leads [m]: it must
    go on so far ahead; early [m]: a wall ahead is followed when it is so much beyond the stand-off; lane [m]: half the
    width of what bars the way.
    """

    abreast: float = 0.05
    near: float = 1.0
    turned: float = math.radians(50)
    leads: float = 0.3
    early: float = 0.35
    lane: float = 0.35


def tangent(end: Point) -> Line:
    """The line to steer by: through the end of the wall, square to the way there."""
    return Line(math.atan2(end[1], end[0]), math.hypot(*end))


def beyond(points: Floats, end: Point, fit: FitSettings, corner: CornerSettings, chance: Generator) -> Fit | None:
    """The wall that goes on behind the end: it passes near to it, runs on ahead, and the robot is nearly along it."""
    near = np.hypot(points[:, 0] - end[0], points[:, 1] - end[1]) <= 2.5 * corner.near
    found = acquire(points[near], fit, chance, corner.turned)
    if found is None:
        return None
    on = points[near][found.inliers]
    stations = found.line.stations(on)
    gaps = np.hypot(on[:, 0] - end[0], on[:, 1] - end[1])
    if float(stations.max()) < corner.leads or float(gaps.min()) > corner.near:
        return None
    return _over(found, near)


def ahead(points: Floats, fit: FitSettings, corner: CornerSettings, stand_off: float, chance: Generator) -> Fit | None:
    """The wall that bars the way and is near enough to be followed from now on."""
    most = stand_off + corner.early
    lane = (points[:, 0] > 0) & (np.abs(points[:, 1]) <= corner.lane) & (points[:, 0] <= 2.0 * most)
    if np.count_nonzero(lane) < fit.least // 2:
        return None
    front = (points[:, 0] > 0) & (np.abs(points[:, 1]) <= 2.0 * most) & (points[:, 0] <= 2.5 * most)
    found = acquire(points[front], fit, chance)
    if found is None or not found.line.distance <= most:
        return None
    x, y = found.line.n
    if x < math.sin(math.radians(25)):  # it runs beside the robot
        return None
    on = points[front][found.inliers]
    crossing = found.line.distance / x  # where the way meets it
    spread = on[:, 1]
    meets = float(spread.min()) - corner.lane <= 0.0 <= float(spread.max()) + corner.lane
    return _over(found, front) if meets and crossing <= 2.0 * most and abs(y) < 1.0 else None


def _over(found: Fit, part: np.ndarray[tuple[int], np.dtype[np.bool_]]) -> Fit:
    """The fit over all points, of which it was made on a part."""
    inliers = np.zeros(len(part), dtype=np.bool_)
    inliers[np.flatnonzero(part)[found.inliers]] = True
    return Fit(found.line, inliers, found.residual)
