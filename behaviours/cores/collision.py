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
    """horizon [s]: collisions later do not count; keep_off [m]: hulls nearer than this count as one; step [s]."""

    horizon: float = 6.0
    keep_off: float = 0.4
    step: float = 0.2


Moving = tuple[Vec2, Vec2]
"""A point [m] and its velocity [m/s]."""


def gate(
    robot: Pose,
    speed: float,
    max_speed: float,
    radius: float,
    moving: Sequence[Moving],
    settings: GateSettings,
) -> float:
    """The first of the speeds v, v/2, 0, -max/2, -max [m/s] that meets nothing, else the one that meets it last.

    speed [m/s]: what is wanted; radius [m] of the robot.
    """
    if not moving:
        return speed
    best, latest = speed, -1.0
    for choice in (speed, speed / 2, 0.0, -max_speed / 2, -max_speed):
        meets = time_to_collision(robot, choice, radius, moving, settings)
        if meets > settings.horizon:
            return choice
        if meets > latest + settings.step / 2:
            best, latest = choice, meets
    return best


def time_to_collision(
    robot: Pose, speed: float, radius: float, moving: Sequence[Moving], settings: GateSettings
) -> float:
    """When [s] the robot that drives so comes too near to a point; infinite if it does not within the horizon.

    It drives straight: turn rates of navigation are short-lived. What comes nearer only because of the robot's being
    near already does not count while the gap grows.
    """
    times = np.arange(1, round(settings.horizon / settings.step) + 1) * settings.step
    x, y = straight(robot, speed, times)
    points = np.array([point for point, _ in moving])
    speeds = np.array([speed for _, speed in moving])
    dx = x[:, None] - points[:, 0] - times[:, None] * speeds[:, 0]
    dy = y[:, None] - points[:, 1] - times[:, None] * speeds[:, 1]
    gaps = np.hypot(dx, dy).min(axis=1) - radius
    now = float(np.hypot(robot.x - points[:, 0], robot.y - points[:, 1]).min()) - radius
    falling = np.diff(gaps, prepend=now) < 0.0
    met = np.flatnonzero((gaps < settings.keep_off) & falling)
    return float(times[met[0]]) if len(met) else math.inf


def straight(robot: Pose, speed: float, times: Floats) -> tuple[Floats, Floats]:
    """Where the robot is at these times [s] if it goes straight on."""
    heading = wrap(robot.theta)
    return robot.x + speed * times * math.cos(heading), robot.y + speed * times * math.sin(heading)
