"""Poses and points in the plane.

Takes and gives: `Pose`s and points of one frame. Leaves alone: which frame that is.
"""

from __future__ import annotations

import math

import numpy as np

from behaviours.interface import Floats, Pose, Vec2


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


def moved(points: Floats, before: Pose, after: Pose) -> Floats:
    """Points in the robot frame of `before`, in that of `after`; both poses in one frame."""
    if before == after:
        return points
    turn = after.theta - before.theta
    c, s = math.cos(before.theta), math.sin(before.theta)
    dx, dy = after.x - before.x, after.y - before.y
    x, y = points[:, 0] - (c * dx + s * dy), points[:, 1] - (c * dy - s * dx)
    c, s = math.cos(turn), math.sin(turn)
    return np.column_stack([c * x + s * y, c * y - s * x])
