"""The scaled vector field histogram: the open direction nearest to the wanted one.

Takes: points round the robot, a wanted direction. Gives: a histogram of blocked directions, a direction that is open,
speed and turn rate towards it. Leaves alone: where the points come from, and whether the hull is round.

Source: Yamauchi 2005, "Autonomous urban reconnaissance using man-portable UGVs" and "Wayfarer". A reading at range r
blocks all directions within k / r of its own: it is widened by a clearance of k metres. Direction i of n is a wedge of
360 / n degrees, centred on i * 360 / n degrees, so that straight ahead is the middle of one and left and right are
mirror images. A wedge is blocked where any part of it is: what is wanted may lie anywhere in it, and would otherwise
lead nearer to a reading than the clearance.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from behaviours.interface import Drive, Floats, wrap

Counts = NDArray[np.int64]
ROUNDING = 1e-9


@dataclass(frozen=True, slots=True)
class SvfhSettings:
    """Lengths [m], angles [rad], speeds [m/s, rad/s].

    clearance: the k of the spread, a clearance in disguise. threshold: so many readings block a direction. window:
    readings beyond it do not count. deflected: share of the speed while the wanted direction is not taken.
    stop_range, slow_range: nothing at the first, full speed from the second on, both from the robot's middle to what
    stands up to `front` to either side. gain [1/s], max_turn_rate: of the turn towards the direction.
    blocked_turn_rate: on the spot when no direction is open.
    """

    directions: int = 72
    clearance: float = 0.4
    threshold: int = 1
    window: float = 4.0
    cruise: float = 0.5
    deflected: float = 0.7
    stop_range: float = 0.3
    slow_range: float = 0.9
    front: float = math.radians(30.0)
    gain: float = 2.0
    max_turn_rate: float = 1.0
    blocked_turn_rate: float = 0.5


def histogram(points: Floats, settings: SvfhSettings) -> Counts:
    """How many of the points (n, 2) [m, robot frame] block each direction: (directions,)."""
    n = settings.directions
    x, y = points[:, 0], points[:, 1]
    away = np.hypot(x, y)
    near = (away <= settings.window) & (away > ROUNDING)
    away, bearing = away[near], np.arctan2(y[near], x[near])
    width = math.tau / n
    half = np.minimum(settings.clearance / away + width / 2, math.pi)
    first = np.ceil((bearing - half) / width - ROUNDING).astype(np.int64)
    last = np.minimum(np.floor((bearing + half) / width + ROUNDING).astype(np.int64), first + n - 1)
    steps = np.bincount(first + n, minlength=3 * n + 1) - np.bincount(last + n + 1, minlength=3 * n + 1)
    counts: Counts = np.cumsum(steps[: 3 * n]).reshape(3, n).sum(axis=0)
    return counts


def chosen_direction(open_: NDArray[np.bool_], wanted: float, left: bool) -> float | None:
    """The wanted direction [rad, robot frame] where it is open, else the middle of the nearest open one, or None.

    open_: (n,). left: which of two equally near ones; those that differ by no more than one direction are equally near,
    or a robot before a wall would change its mind with every tick.
    """
    n = len(open_)
    width = math.tau / n
    if open_[round(wrap(wanted) / width) % n]:
        return wrap(wanted)
    (free,) = np.nonzero(open_)
    if not free.size:
        return None
    off = np.remainder(free * width - wanted + math.pi, math.tau) - math.pi
    to_left, to_right = off[off > 0.0].min(initial=math.inf), -off[off < 0.0].max(initial=-math.inf)
    tie = abs(to_left - to_right) <= width + ROUNDING
    goes_left = left if tie else to_left < to_right
    return wrap(wanted + float(to_left if goes_left else -to_right))


def front_range(points: Floats, settings: SvfhSettings) -> float:
    """Range [m] from the robot's middle to the nearest point ahead."""
    x, y = points[:, 0], points[:, 1]
    ahead = np.abs(y) <= x * math.tan(settings.front)
    return float(np.hypot(x[ahead], y[ahead]).min(initial=math.inf))


def drive(direction: float | None, deflected: bool, front: float, left: bool, settings: SvfhSettings) -> Drive:
    """Speed and turn rate towards a direction [rad, robot frame]; None: on the spot, to the left or the right."""
    if direction is None:
        return Drive(0.0, settings.blocked_turn_rate if left else -settings.blocked_turn_rate)
    turn = max(-settings.max_turn_rate, min(settings.max_turn_rate, settings.gain * direction))
    speed = settings.cruise * max(0.0, math.cos(direction)) * (settings.deflected if deflected else 1.0)
    slowed = (front - settings.stop_range) / (settings.slow_range - settings.stop_range)
    return Drive(speed * max(0.0, min(1.0, slowed)), turn)
