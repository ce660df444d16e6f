"""Steering along a wall, and how the wall curves.

Takes: offset and angle to the wall, points along it. Gives: a turn rate [rad/s], a curvature. Leaves alone: where they
come from.

Equation (2) of Bayer 2012 has four opening and three closing parentheses. Of the repairs by one character only
omega = v (-k sin(theta) - (y - T) + K) is stable: with y' = v sin(theta), V = (1 - cos(theta)) + (y - T)^2 / 2 has
V' = -k v sin(theta)^2 <= 0. With a gain on the offset V is (1 - cos(theta)) + offset_gain (y - T)^2 / 2. Where the
limit cuts the turn rate that says nothing.

Equation (3) sums a from -0.3 N to N / 2. Terms of a and -a cancel each other and a = 0 is 0 / 0, so that what is
printed is the sum beyond 0.3 N. It is a difference of slopes and no curvature; `per_metre` makes one of it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from behaviours.interface import Floats


@dataclass(frozen=True, slots=True)
class LawSettings:
    """gain: k of the paper; offset_gain: 1 in the paper, k^2 / 4 for critical damping; stand_off [m]; 1/m units."""

    gain: float = 3.0
    offset_gain: float = 1.0
    stand_off: float = 1.0
    curvature_gain: float = 1.0
    most: float = 1.5


NEAREST = 0.02
"""Points that lie nearer [m] along the wall say nothing about its slope."""
STEEPEST = 3.0


def turn_rate(offset: float, angle: float, curvature: float, speed: float, law: LawSettings) -> float:
    """[rad/s] for a wall to the right, within the greatest."""
    bend = -law.gain * math.sin(angle) - law.offset_gain * (offset - law.stand_off) + law.curvature_gain * curvature
    return max(-law.most, min(law.most, speed * bend))


def lyapunov(offset: float, angle: float, law: LawSettings) -> float:
    """What never grows under the law beside a straight wall at a speed ahead."""
    return (1.0 - math.cos(angle)) + law.offset_gain * (offset - law.stand_off) ** 2 / 2


def bend(stations: Floats, heights: Floats, *, per_metre: bool = False) -> float:
    """K of equation (3) for points along a wall: stations (n,) [m] in rising order, heights (n,) [m] towards the robot.

    Points that were invented come last, wherever they lie. A term whose outer points do not lie before and behind the
    middle is left out, so that there is no K once all that was invented lies behind. Positive where the wall curves
    towards the robot. per_metre: divided by the mean half span, a curvature [1/m].
    """
    count = len(stations)
    middle = (count - 1) // 2
    apart = np.arange(3 * count // 10 + 1, count // 2 + 1)
    apart = apart[(apart <= middle) & (middle + apart < count)]
    if not apart.size:
        return 0.0
    ahead, behind = stations[middle + apart] - stations[middle], stations[middle] - stations[middle - apart]
    sound = (ahead >= NEAREST) & (behind >= NEAREST)
    if not sound.any():
        return 0.0
    apart, ahead, behind = apart[sound], ahead[sound], behind[sound]
    slopes = (heights[middle + apart] - heights[middle]) / ahead - (heights[middle] - heights[middle - apart]) / behind
    if per_metre:
        return _clipped(float(slopes.mean()) / float((ahead + behind).mean() / 2))
    return _clipped(2.0 / count * float(slopes.sum()))


def _clipped(value: float) -> float:
    return max(-STEEPEST, min(STEEPEST, value))
