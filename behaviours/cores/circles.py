"""Obstacle circles: a bounded memory of echoes that forgets.

Takes: the circles so far and the echoes of one sweep. Gives: the circles after it.
Leaves alone: what they mean for the way.
Source: Bonasso, Antonisse and Slack 1992 (ten circles, five readings each, one from each of the last five cycles;
readings that would make a circle too large or that are far away are not aggregated).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from behaviours.interface import Vec2


@dataclass(frozen=True, slots=True)
class CircleSettings:
    """obstacles, readings: counts; half_cone [rad]; the others lengths [m]."""

    obstacles: int = 10
    readings: int = 5
    far: float = 3.0
    max_radius: float = 0.5
    pad: float = 0.05
    half_cone: float = math.radians(9.0)
    neighbours_near: float = 0.5


@dataclass(frozen=True, slots=True)
class Circle:
    """An obstacle: its name, its echoes as (x, y, sweep), and the circle around them with the pad [m]."""

    ident: int
    echoes: tuple[tuple[float, float, int], ...]
    x: float
    y: float
    radius: float


@dataclass(frozen=True, slots=True)
class Circles:
    """All that is remembered after a sweep. overflow counts the echoes for which there was no circle left."""

    circles: tuple[Circle, ...] = ()
    sweep: int = 0
    next_ident: int = 0
    overflow: int = 0


def enclose(points: Sequence[tuple[float, float, int]]) -> tuple[float, float, float]:
    """Centre and radius [m] of a circle about the points: the middle of their bounding box, the greatest distance."""
    xs = [p[0] for p in points]
    ys = [p[1] for p in points]
    x, y = (min(xs) + max(xs)) / 2, (min(ys) + max(ys)) / 2
    return x, y, max(math.hypot(p[0] - x, p[1] - y) for p in points)


def perceive(memory: Circles, echoes: Iterable[tuple[float, Vec2]], settings: CircleSettings) -> Circles:
    """The memory after one more sweep; echoes are (range [m], point), points in a frame that stands still."""
    sweep = memory.sweep + 1
    circles = [c for c in (_aged(c, sweep, settings) for c in memory.circles) if c is not None]
    taken = [False] * len(circles)
    next_ident, overflow = memory.next_ident, memory.overflow
    for reach, (x, y) in sorted(echoes):
        if not reach <= settings.far:
            break
        if _covered(circles, taken, x, y):
            continue
        at, grown = _adopter(circles, taken, (x, y, sweep), settings)
        if grown is not None:
            circles[at], taken[at] = grown, True
        elif len(circles) < settings.obstacles:
            circles.append(Circle(next_ident, ((x, y, sweep),), x, y, settings.pad))
            taken.append(True)
            next_ident += 1
        else:
            overflow += 1
    return Circles(tuple(circles), sweep, next_ident, overflow)


def _aged(circle: Circle, sweep: int, settings: CircleSettings) -> Circle | None:
    """The circle without the readings that are too old; None when nothing is left of it."""
    kept = tuple(e for e in circle.echoes if sweep - e[2] < settings.readings)
    if len(kept) == len(circle.echoes):
        return circle
    return _about(circle.ident, kept, settings.pad) if kept else None


def _about(ident: int, echoes: tuple[tuple[float, float, int], ...], pad: float) -> Circle:
    x, y, radius = enclose(echoes)
    return Circle(ident, echoes, x, y, radius + pad)


def _covered(circles: Sequence[Circle], taken: Sequence[bool], x: float, y: float) -> bool:
    return any(full and math.hypot(c.x - x, c.y - y) <= c.radius for c, full in zip(circles, taken, strict=True))


def _adopter(
    circles: Sequence[Circle], taken: Sequence[bool], echo: tuple[float, float, int], settings: CircleSettings
) -> tuple[int, Circle | None]:
    """The nearest circle that may still take the echo, as its place in the list and grown by it; (-1, None) if none."""
    candidates = sorted(
        (math.hypot(c.x - echo[0], c.y - echo[1]), i)
        for i, (c, full) in enumerate(zip(circles, taken, strict=True))
        if not full and abs(c.x - echo[0]) < 2 * settings.max_radius and abs(c.y - echo[1]) < 2 * settings.max_radius
    )
    for _, i in candidates:
        grown = _about(circles[i].ident, (*circles[i].echoes, echo), settings.pad)
        if grown.radius - settings.pad <= settings.max_radius:
            return i, grown
    return -1, None
