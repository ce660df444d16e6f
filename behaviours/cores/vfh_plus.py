"""VFH+: which direction to take, with openings, hysteresis and a memory of what was chosen.

Takes: points round the robot, a wanted direction, what was chosen before. Gives: a direction. Leaves alone: the speed,
and whether the hull gets there (`hull_paths.py`).

Source: Ulrich and Borenstein 1998, "VFH+: reliable obstacle avoidance for fast mobile robots". The histogram is fixed
to the map frame, so that hysteresis speaks of one and the same direction while the robot turns. A reading weighs 1 at
the robot and 0 at the window's edge, and blocks what lies within asin(clearance / range) of it. Chosen here: a wanted
direction that is open is always a candidate, so that a wall may be followed as near as the clearance allows; and where
nothing is open the window shrinks.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from behaviours.interface import Floats, wrap

Flags = NDArray[np.bool_]
ROUNDING = 1e-9
OPEN, BLOCKED = b"\0", b"\1"


@dataclass(frozen=True, slots=True)
class VfhPlusSettings:
    """Lengths [m], angles [rad].

    low, high: a direction becomes blocked above the one density and open below the other. wide: an opening wider than
    this has a candidate at either side, half of it from the edge. to_target, to_heading, to_previous: what a candidate
    costs per angle from the wanted direction, the robot's heading, and what was chosen before. shrink: the window is
    made smaller so often, by half each time, before the way counts as blocked.
    """

    directions: int = 72
    clearance: float = 0.4
    window: float = 4.0
    low: float = 0.1
    high: float = 0.3
    wide: float = math.radians(40.0)
    to_target: float = 5.0
    to_heading: float = 2.0
    to_previous: float = 2.0
    shrink: int = 2


def density(points: Floats, heading: float, window: float, settings: VfhPlusSettings) -> Floats:
    """How much stands in each direction of the map frame (directions,); points (n, 2) [m] in the robot frame."""
    n = settings.directions
    away = np.hypot(points[:, 0], points[:, 1])
    near = (away < window) & (away > ROUNDING)
    away = away[near]
    bearing = np.arctan2(points[near, 1], points[near, 0]) + heading
    half = np.arcsin(np.minimum(1.0, settings.clearance / away))
    width = math.tau / n
    first = np.ceil((bearing - half) / width - ROUNDING).astype(np.int64)
    last = np.floor((bearing + half) / width + ROUNDING).astype(np.int64)
    weight = 1.0 - away / window
    steps = np.bincount(first + 2 * n, weight, 5 * n + 1) - np.bincount(last + 2 * n + 1, weight, 5 * n + 1)
    total: Floats = np.cumsum(steps[: 5 * n]).reshape(5, n).sum(axis=0)
    return total


def hysteresis(total: Floats, before: Flags | None, settings: VfhPlusSettings) -> Flags:
    """Which directions are blocked; before: which were."""
    blocked: Flags = total > settings.high
    return blocked if before is None else blocked | (before & (total >= settings.low))


def masked(blocked: Flags, points: Floats, heading: float, radius: float, clearance: float) -> Flags:
    """Also blocked: what only a tighter turn than of this radius [m] would reach past the points.

    Straight behind is reached by either side.
    """
    if radius <= ROUNDING:
        return blocked
    x, y = points[:, 0], points[:, 1]
    near = np.flatnonzero((x > 0) & (x < radius + clearance))
    x, y = x[near], y[near]
    left = (y > 0) & (np.hypot(x, y - radius) < radius + clearance)
    right = (y < 0) & (np.hypot(x, y + radius) < radius + clearance)
    if not (left.any() or right.any()):
        return blocked
    bearing = np.arctan2(y, x)
    most_left = float(bearing[left].min(initial=math.pi))
    most_right = float(bearing[right].max(initial=-math.pi))
    n = len(blocked)
    off = np.remainder(np.arange(n) * math.tau / n - heading + math.pi, math.tau) - math.pi
    behind = np.abs(off) > math.pi - ROUNDING
    result: Flags = blocked | ((off > most_left) | (off < most_right)) & ~behind
    return result | (behind & bool(left.any() and right.any()))


def openings(blocked: Flags) -> list[tuple[int, int]]:
    """First and last direction of each run of open ones, counter-clockwise; last may be n and more."""
    n, flags = len(blocked), blocked.tobytes()
    if OPEN not in flags:
        return []
    if BLOCKED not in flags:
        return [(0, n - 1)]
    starts = [0] if flags[0] == 0 and flags[-1] == 1 else []
    at = flags.find(BLOCKED + OPEN)
    while at >= 0:
        starts.append(at + 1)
        at = flags.find(BLOCKED + OPEN, at + 1)
    twice = flags + flags
    return [(start, twice.index(BLOCKED, start) - 1) for start in starts]


def candidates(blocked: Flags, target: float, settings: VfhPlusSettings) -> list[float]:
    """Directions worth taking [rad, map frame]: the target where it is open, sides of wide openings, narrow middles."""
    n = len(blocked)
    width = math.tau / n
    result = [] if blocked[round(wrap(target) / width) % n] else [wrap(target)]
    if not blocked.any():
        return result
    for first, last in openings(blocked):
        if (last - first) * width <= settings.wide:
            result.append(wrap((first + last) / 2 * width))
        else:
            result += [wrap(first * width + settings.wide / 2), wrap(last * width - settings.wide / 2)]
    return result


def cost(direction: float, target: float, heading: float, previous: float | None, settings: VfhPlusSettings) -> float:
    """Of taking a direction; all in the map frame."""
    total = settings.to_target * abs(wrap(direction - target)) + settings.to_heading * abs(wrap(direction - heading))
    return total + (0.0 if previous is None else settings.to_previous * abs(wrap(direction - previous)))


@dataclass(frozen=True, slots=True)
class Choice:
    """direction [rad, map frame], None where the way is blocked; blocked: the masked histogram behind it."""

    direction: float | None
    blocked: Flags


def is_blocked(points: Floats, settings: VfhPlusSettings) -> bool:
    """Whether no direction is open, however small the window."""
    window = settings.window / 2**settings.shrink
    return bool((density(points, 0.0, window, settings) > settings.low).all())


class VfhPlus:
    """The histogram of the last tick, and what was chosen then. left: of two equally good ones, that to the left."""

    def __init__(self, settings: VfhPlusSettings, left: bool) -> None:
        self.settings, self._left = settings, left
        self.forget()

    def forget(self) -> None:
        """Begin afresh."""
        self._before: Flags | None = None
        self._previous: float | None = None

    def choose(self, points: Floats, heading: float, target: float, radius: float) -> Choice:
        """heading, target [rad, map frame]; radius [m] of the tightest turn at the speed now."""
        settings = self.settings
        self._before = hysteresis(density(points, heading, settings.window, settings), self._before, settings)
        blocked = masked(self._before, points, heading, radius, settings.clearance)
        found, window = candidates(blocked, target, settings), settings.window
        for _ in range(settings.shrink):
            if found:
                break
            window /= 2
            blocked = density(points, heading, window, settings) > settings.low
            found = candidates(blocked, target, settings)
        direction = self._best(found, heading, target)
        self._previous = direction
        return Choice(direction, blocked)

    def _best(self, found: list[float], heading: float, target: float) -> float | None:
        """The cheapest; of equally cheap ones that to the left of the target, or to its right."""
        side = 1.0 if self._left else -1.0

        def rank(direction: float) -> tuple[float, float]:
            price = cost(direction, target, heading, self._previous, self.settings)
            return (round(price, 6), -side * wrap(direction - target))

        return min(found, key=rank, default=None)
