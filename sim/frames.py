"""Places and angles in the plane, as the simulator needs them.

Takes and gives: plain numbers and `Pose`. Leaves alone: time and chance.
"""

from __future__ import annotations

import math

from behaviours.interface import Pose, Vec2, wrap

FOOT = 0.3048


def bearing(p_WB: Pose, point: Vec2) -> float:
    """Angle [rad] of the world point in the body frame, left positive."""
    return wrap(math.atan2(point[1] - p_WB.y, point[0] - p_WB.x) - p_WB.theta)


def approach(value: float, target: float, step: float) -> float:
    """`value` moved towards `target` by at most `step` >= 0; it arrives in spite of rounding."""
    if abs(target - value) <= step + 1e-12:
        return target
    return value + step if target > value else value - step


def distance_to_segment(point: Vec2, a: Vec2, b: Vec2) -> float:
    """Distance [m] of the point from the straight piece between a and b."""
    ux, uy = b[0] - a[0], b[1] - a[1]
    length2 = ux * ux + uy * uy
    along = 0.0 if length2 == 0 else ((point[0] - a[0]) * ux + (point[1] - a[1]) * uy) / length2
    along = min(1.0, max(0.0, along))
    return math.hypot(point[0] - a[0] - along * ux, point[1] - a[1] - along * uy)
