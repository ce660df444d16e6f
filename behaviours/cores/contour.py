"""The way along a contour: a disc of the stand-off rolls along the points.

Takes: points, and the place where the disc touched last. Gives: the direction in which it rolls on, and where it
touches then. Leaves alone: what the points belong to. All of it is for a contour to the left.

Chosen here. Gaps that the disc does not fit through are passed by; at the end of a wall it rolls round the corner,
before a wall ahead it turns away in time, and what it touched last tells which contour is followed. Nearer to it or
farther from it than the stand-off, the law of Yamauchi 2005 leads back, with the nearest point for the wall; too near,
the disc rolls from the place where it would just touch.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from behaviours.cores.corner import room
from behaviours.cores.hough import Line
from behaviours.interface import Floats, Vec2, wrap


@dataclass(frozen=True, slots=True)
class ContourSettings:
    """look_ahead, snap, leap, least [m]; regain [rad/m]; steepest [rad].

    look_ahead: how far the disc is swept; regain, steepest: how the stand-off is regained; snap: points so near to a
    line lie on it; leap: the place of contact may move by so much from scan to scan; shrink: a disc that fits nowhere
    is made smaller by this share until one fits, at the smallest `least`. back [rad]: before a disc turns the robot
    away from the contour by more, smaller ones are tried, since what the disc would roll on along may stand alone, and
    it would not come back from there; two whole turns: never. widest [m]: the disc is no larger than this, though the
    stand-off be, so that openings that are twice as wide are gone into. beside [m]: half of the way between what stands
    to the right and to the left, so little ahead of the robot or behind it, bounds the stand-off; 0: nothing does.
    """

    look_ahead: float = 2.5
    regain: float = 1.2
    steepest: float = math.pi / 4
    snap: float = 0.07
    leap: float = 1.0
    shrink: float = 0.15
    least: float = 0.3
    back: float = 2.0 * math.tau
    widest: float = math.inf
    beside: float = 0.0


NO_LENGTH = 1e-6
BESIDE = math.radians(200.0)
"""The contour lies between straight ahead and so far to the left."""


@dataclass(frozen=True, slots=True)
class Rolled:
    """direction [rad] to go; contact: where the disc touches then; nearest: the nearest point of the contour."""

    direction: float
    contact: Vec2
    nearest: Vec2


def snapped(points: Floats, lines: tuple[Line, ...], near: float) -> Floats:
    """The points (n, 2), those within `near` [m] of a line on it: what is left of their noise lies along it."""
    result = points.copy()
    free = np.ones(len(points), dtype=bool)
    for line in lines:
        normal = np.array([math.cos(line.normal), math.sin(line.normal)])
        off = points @ normal - line.rho
        on = free & (np.abs(off) <= near)
        result[on] -= off[on, None] * normal
        free &= ~on
    return result


def anchored(points: Floats, contact: Vec2, leap: float) -> Vec2 | None:
    """The point nearest to where the disc touched; None where all are farther than `leap` [m] from it."""
    if len(points) == 0:
        return None
    off = np.hypot(points[:, 0] - contact[0], points[:, 1] - contact[1])
    best = int(off.argmin())
    return (float(points[best, 0]), float(points[best, 1])) if off[best] <= leap else None


def rolled(points: Floats, contact: Vec2, stand_off: float, settings: ContourSettings) -> Rolled:
    """On along the contour of points (n, 2) [m], robot frame, from where the disc of radius stand_off [m] touched."""
    reach = np.hypot(points[:, 0], points[:, 1])
    if settings.beside > 0.0:
        stand_off = room(points, stand_off, settings.beside, settings.least)
    ahead, touched = _roll(points, reach, contact, min(stand_off, settings.widest), settings)
    touches = contact if touched is None else _at(points, touched)
    beside = (np.arctan2(points[:, 1], points[:, 0]) - ahead) % math.tau <= BESIDE
    if not beside.any():
        return Rolled(wrap(ahead), touches, touches)
    nearest = _at(points, int(np.where(beside, reach, math.inf).argmin()))
    off = settings.regain * (math.hypot(*nearest) - stand_off)
    tangent = math.atan2(nearest[1], nearest[0]) - math.pi / 2 + max(-settings.steepest, min(settings.steepest, off))
    direction = tangent if wrap(tangent - ahead) < 0.0 else ahead
    return Rolled(wrap(direction), touches, nearest)


def _at(points: Floats, index: int) -> Vec2:
    return float(points[index, 0]), float(points[index, 1])


def _roll(
    points: Floats, reach: Floats, contact: Vec2, stand_off: float, s: ContourSettings
) -> tuple[float, int | None]:
    """Direction in which the disc gets past the contour, and the point that it touches; smaller where it fits nowhere.

    Farther away than the stand-off the disc is as large as leads there no steeper than `steepest`.
    """
    nearest = int(reach.argmin())
    gap = float(reach[nearest])
    radius = max(stand_off, min(gap, math.hypot(*contact)) - s.look_ahead * math.sin(s.steepest))
    back: tuple[float, int | None] | None = None
    while True:
        away = max(0.0, radius - gap) / max(gap, NO_LENGTH) * points[nearest]
        x, y = (points + away).T
        start = math.atan2(contact[1] + away[1], contact[0] + away[0])
        swept, touched = _swept(np.hypot(x, y), np.arctan2(y, x), start, radius, s.look_ahead)
        if swept < math.tau and swept - _to_the_left(start) <= s.back:
            return start - swept, touched
        if swept < math.tau and back is None:
            back = start - swept, touched
        if radius <= s.least:
            return back or (start - math.pi / 2, None)
        radius = max(s.least, radius * (1.0 - s.shrink))


def _to_the_left(bearing: float) -> float:
    """The bearing [rad] of a place of contact, as far to the left as the contour lies: up to `BESIDE`."""
    return BESIDE - (BESIDE - bearing) % math.tau


def _swept(reach: Floats, bearing: Floats, start: float, radius: float, step: float) -> tuple[float, int | None]:
    """How far clockwise [rad] from `start` the first direction lies in which the disc is free for a step.

    From a full turn up there is none. A point that is within the disc already must not come nearer.
    """
    near = np.flatnonzero(reach < radius + step)
    r = np.maximum(reach[near], radius)
    beyond = np.arccos(np.clip((step * step + r * r - radius * radius) / (2.0 * step * r), -1.0, 1.0))
    half = np.where(r * r - radius * radius <= step * step, np.arcsin(radius / r), beyond)
    middle = (start - bearing[near]) % math.tau
    begins = np.concatenate([middle - half, middle - math.tau - half])
    ends = np.concatenate([middle + half, middle - math.tau + half])
    order = np.argsort(begins, kind="stable")
    begins, ends = begins[order], ends[order]
    reached = np.maximum.accumulate(np.maximum(ends, 0.0)) if len(ends) else ends
    open_after = np.flatnonzero(np.append(begins[1:], math.inf) > reached) if len(ends) else ends
    if len(open_after) == 0 or (begins[0] > 0.0):
        return 0.0, None
    last = int(open_after[0])
    best = int(ends[: last + 1].argmax())
    touched = int(near[order[best] % len(near)]) if ends[best] > 0.0 else None
    return float(reached[last]), touched
