"""What a straight line knows nothing of: ends of walls, corners, dead ends, doors, and things that stand in the way.

Takes: points (n, 2) [m] in the robot frame, the wall to the right; what was touched last. Gives: where the wall ends,
the line to steer by while turning round a place, the wall behind it when it comes into sight, how far to turn away from
what bars the way, and how much room there is. Leaves alone: the steering, and walls to the left (in the mirror).

Round the end of a wall the robot goes on a circle about it, as if the wall had a tangent there. What bars the way is
found by a disc that is swept ahead; the place that it touches is turned about in the same manner. These are no parts of
Bayer 2012; they are what its conclusions ask for.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.random import Generator

from behaviours.cores.wall_fit import Fit, FitSettings, Line, acquire
from behaviours.interface import Floats, Vec2

HALF_A_TURN = math.pi
STEEPEST = 0.8
"""Sine of the steepest angle at which a wall that is far is approached."""
SHRINK = 0.85
BACK = math.radians(60)
"""Before a disc turns the robot by more, smaller ones are tried."""


@dataclass(frozen=True, slots=True)
class CornerSettings:
    """All chosen here; lengths [m], angles [rad].

    door: where the wall goes on behind an opening no wider, the opening is passed by; abreast: a pivot begins when the
    end of the wall is so near ahead; turned: a wall is followed when the heading is turned no more against it; leads,
    long, broken: it must go on so far ahead, be so long, and have no wider gaps; on: a place so near to a line lies on
    it; leap: the place of contact moves by no more from scan to scan; disc: radius of the disc that is swept, a share
    of the stand-off; sweep: how far it is swept, too; barred: from so much of a turn on what is ahead is followed;
    beside: what stands so little ahead of the robot or behind it bounds the room.
    """

    door: float = 1.2
    abreast: float = 0.05
    turned: float = math.radians(50)
    leads: float = 0.3
    long: float = 0.4
    broken: float = 0.2
    on: float = 0.15
    leap: float = 0.4
    disc: float = 0.85
    sweep: float = 0.9
    barred: float = math.radians(25)
    beside: float = 0.25


def tangent(at: Vec2) -> Line:
    """The line to steer by: through a place, square to the way there."""
    return Line(math.atan2(at[1], at[0]), math.hypot(*at))


def last_of(fit: Fit, points: Floats, door: float, spacing: float) -> tuple[float, Vec2]:
    """How far along the wall [m] it goes on from the robot with no opening wider than the door, and its last point.

    spacing [rad]: of the beams. Where they lie farther apart than the door, on a wall that is seen at a slant, that is
    no opening.
    """
    on = points[fit.inliers]
    stations = fit.line.stations(on)
    order = np.argsort(stations, kind="stable")
    sorted_ = stations[order]
    height = max(abs(fit.line.distance), 0.05)
    slant = 2.5 * spacing * (sorted_[1:] ** 2 + height**2) / height
    wide = (np.diff(sorted_) > np.maximum(door, slant)) & (sorted_[1:] > 0.0)
    last = int(np.argmax(wide)) if wide.any() else len(order) - 1
    x, y = on[order[last]]
    return float(sorted_[last]), (float(x), float(y))


def beyond(
    points: Floats, contact: Vec2, fit: FitSettings, corner: CornerSettings, reach: float, chance: Generator
) -> Fit | None:
    """The wall at the place of contact: it runs on ahead, and the robot is nearly along it."""
    near = np.hypot(points[:, 0] - contact[0], points[:, 1] - contact[1]) <= reach
    found = acquire(points[near], fit, chance, corner.turned)
    if found is None or abs(float(found.line.off(np.array([contact]))[0])) > corner.on:
        return None
    low, high, count = _run(found, points[near], contact, corner.broken)
    if high < corner.leads or high - low < corner.long or count < fit.least:
        return None
    inliers = np.zeros(len(points), dtype=np.bool_)
    inliers[np.flatnonzero(near)[found.inliers]] = True
    return Fit(found.line, inliers, found.residual)


def _run(fit: Fit, points: Floats, at: Vec2, broken: float) -> tuple[float, float, int]:
    """From where to where [m] the part of a wall reaches to which a place belongs, and how many points it has."""
    stations = np.sort(fit.line.stations(points[fit.inliers]))
    breaks = np.flatnonzero(np.diff(stations) > broken)
    middle = int(np.abs(stations - float(fit.line.stations(np.array([at]))[0])).argmin())
    after = int(np.searchsorted(breaks, middle))
    first = int(breaks[after - 1]) + 1 if after > 0 else 0
    last = int(breaks[after]) if after < len(breaks) else len(stations) - 1
    return float(stations[first]), float(stations[last]), last - first + 1


def anchored(points: Floats, contact: Vec2, leap: float) -> Vec2 | None:
    """The point nearest to the robot of those near to where the disc touched; None where there are none."""
    near = points[np.hypot(points[:, 0] - contact[0], points[:, 1] - contact[1]) <= leap]
    return nearest(near)


def nearest(points: Floats) -> Vec2 | None:
    """The point nearest to the robot; None without points."""
    if not len(points):
        return None
    x, y = points[int((points * points).sum(axis=1).argmin())]
    return float(x), float(y)


def room(points: Floats, stand_off: float, beside: float, least: float) -> float:
    """The stand-off [m] for which there is room: no more than half of the way between right and left."""
    level = points[np.abs(points[:, 0]) <= beside, 1]
    right, left = level[level < 0], level[level > 0]
    if not (right.size and left.size):
        return stand_off
    return max(least, min(stand_off, float(left.min() - right.max()) / 2))


def barred(points: Floats, wanted: float, radius: float, reach: float, least: float) -> tuple[float, Vec2 | None]:
    """How far [rad] to the left of the wanted direction a disc gets on for reach [m], and what is to its right then.

    A disc that would turn the robot far is made smaller, at the smallest `least` [m], lest a narrow way be taken for a
    dead end; where that has to turn far, too, the largest disc that fits anywhere counts.
    """
    distance = np.hypot(points[:, 0], points[:, 1])
    bearing = np.remainder(np.arctan2(points[:, 1], points[:, 0]) - wanted + math.pi, math.tau) - math.pi
    back: tuple[float, Vec2 | None] | None = None
    while True:
        turn, touched = _swept(distance, bearing, radius, reach)
        at = None if touched is None else (float(points[touched, 0]), float(points[touched, 1]))
        if wanted + turn <= BACK:
            return turn, at
        back = (turn, at) if back is None and turn < math.tau else back
        if radius <= least:
            return (HALF_A_TURN, at) if back is None else back
        radius = max(least, radius * SHRINK)


def _swept(distance: Floats, bearing: Floats, radius: float, reach: float) -> tuple[float, int | None]:
    """The turn, a whole one where there is no way; the point that bounds it. What is in the disc comes no nearer."""
    near = np.flatnonzero(distance < radius + reach)
    if not near.size:
        return 0.0, None
    r = np.maximum(distance[near], radius)
    at_the_end = np.arccos(np.clip((reach * reach + r * r - radius * radius) / (2.0 * reach * r), -1.0, 1.0))
    half = np.where(r * r - radius * radius <= reach * reach, np.arcsin(radius / r), at_the_end)
    middle = bearing[near]
    begins = np.concatenate([middle - half, middle - half + math.tau])
    order = np.argsort(begins, kind="stable")
    begins, ends = begins[order], np.concatenate([middle + half, middle + half + math.tau])[order]
    reached = np.maximum.accumulate(np.maximum(ends, 0.0))
    if begins[0] > 0.0:
        return 0.0, None
    first = int(np.argmax(np.append(begins[1:], math.inf) > reached))
    turn = float(reached[first])
    if turn <= 0.0:
        return 0.0, None
    return turn, int(near[order[int(ends[: first + 1].argmax())] % len(near)])
