"""Poses and points in the plane.

Takes and gives: `Pose`s and points of one frame. Leaves alone: which frame that is.
"""

from __future__ import annotations

import math

from behaviours.interface import Pose, Vec2


def distance(a: Pose, b: Pose) -> float:
    """Distance [m] of the two places."""
    return math.hypot(b.x - a.x, b.y - a.y)


def bearing(a: Pose, b: Pose) -> float:
    """Direction [rad] from a to b in their common frame."""
    return math.atan2(b.y - a.y, b.x - a.x)


def along(place: Pose, direction: float, length: float) -> Pose:
    """The pose `length` [m] from `place` in `direction` [rad], looking that way."""
    return Pose(place.x + length * math.cos(direction), place.y + length * math.sin(direction), direction)


def echo(robot: Pose, direction: float, reach: float) -> Vec2:
    """The point `reach` [m] from the robot at `direction` [rad, robot frame], in the frame of the pose."""
    angle = robot.theta + direction
    return robot.x + reach * math.cos(angle), robot.y + reach * math.sin(angle)
