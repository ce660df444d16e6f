"""Whether the way of the robot and that of something moving meet, and at which speed they do not.

Takes: the robot's pose, the heading and speed it wants, and points that move. Gives: the speed to drive at.
Leaves alone: what stands (the heading keeps clear of that), and where the points come from.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from behaviours.interface import Floats, Pose, Vec2, wrap


@dataclass(frozen=True, slots=True)
class GateSettings:
    """horizon [s]: collisions later do not count; keep_off [m]: hulls nearer than this count as one; step [s].

    hysteresis [m]: a robot that gives way drives faster again only where the gap is wider by so much.
    """

    horizon: float = 6.0
    keep_off: float = 0.4
    step: float = 0.2
    hysteresis: float = 0.3


Moving = tuple[Vec2, Vec2]
"""A point [m] and its velocity [m/s]."""


def gate(
    robot: Pose,
    speed: float,
    max_speed: float,
    radius: float,
    moving: Sequence[Moving],
    settings: GateSettings,
    before: float = math.inf,
) -> float:
    """The first of the speeds v, v/2, 0, -max/2, -max [m/s] that meets nothing, else the one that keeps off farthest.

    speed [m/s]: what is wanted; radius [m] of the robot; before: the speed chosen last, infinite if it did not give
    way.
    """
    if not moving:
        return speed
    best, widest = speed, -math.inf
    for choice in (speed, speed / 2, 0.0, -max_speed / 2, -max_speed):
        gap = least_gap(robot, choice, radius, moving, settings)
        if gap >= settings.keep_off + (settings.hysteresis if choice > before else 0.0):
            return choice
        if gap > widest + 0.01:
            best, widest = choice, gap
    return best


def least_gap(robot: Pose, speed: float, radius: float, moving: Sequence[Moving], settings: GateSettings) -> float:
    """How near [m] a point comes to the hull within the horizon, of those moments in which it comes nearer.

    The robot is taken to go straight on. What is near already and goes away does not count: infinite.
    """
    times: Floats = np.arange(1, round(settings.horizon / settings.step) + 1, dtype=np.float64) * settings.step
    x, y = straight(robot, speed, times)
    points, speeds = np.array([point for point, _ in moving]), np.array([velocity for _, velocity in moving])
    dx = x[:, None] - points[:, 0] - times[:, None] * speeds[:, 0]
    dy = y[:, None] - points[:, 1] - times[:, None] * speeds[:, 1]
    gaps = np.hypot(dx, dy).min(axis=1) - radius
    now = float(np.hypot(robot.x - points[:, 0], robot.y - points[:, 1]).min()) - radius
    nearer = np.diff(gaps, prepend=now) < 0.0
    return float(gaps[nearer].min(initial=math.inf))


def straight(robot: Pose, speed: float, times: Floats) -> tuple[Floats, Floats]:
    """Where the robot is at these times [s] if it goes straight on."""
    heading = wrap(robot.theta)
    return robot.x + speed * times * math.cos(heading), robot.y + speed * times * math.sin(heading)
