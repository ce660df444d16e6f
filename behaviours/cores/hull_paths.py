"""Whether a command carries the hull into something: its path for as long as it counts, and until the robot stands.

Takes: the motion now, commands, points in the robot frame, the outline of the hull. Gives: the path of each command and
how near it comes to the points. Leaves alone: which command is wanted.

A command that is held for `hold` seconds and then braked for must leave the hull free all the way: then, whatever the
next tick brings, the robot can still stop (passive safety, as in the dynamic window of Fox, Burgard and Thrun 1997).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from behaviours.interface import Drive, Floats

MOST_STEPS = 40


@dataclass(frozen=True, slots=True)
class Hull:
    """The outline round the robot's middle [m]: a rectangle, or a disc where `radius` is more than 0."""

    length: float = 0.69
    width: float = 0.52
    radius: float = 0.0

    @property
    def reach(self) -> float:
        """Radius [m] of the circle that it sweeps when it turns on the spot."""
        return self.radius or math.hypot(self.length, self.width) / 2

    @property
    def half_width(self) -> float:
        """[m] from the middle to the side."""
        return self.radius or self.width / 2

    def distance(self, x: Floats, y: Floats) -> Floats:
        """[m] from the outline to places in the robot frame, negative inside."""
        if self.radius:
            away: Floats = np.hypot(x, y) - self.radius
            return away
        along, across = np.abs(x) - self.length / 2, np.abs(y) - self.width / 2
        outside: Floats = np.hypot(np.maximum(along, 0.0), np.maximum(across, 0.0))
        return outside + np.minimum(np.maximum(along, across), 0.0)


@dataclass(frozen=True, slots=True)
class Motors:
    """How the drive answers. Accelerations [m/s^2, rad/s^2]; hold, step [s]: of a path."""

    acceleration: float = 1.0
    turn_acceleration: float = 4.0
    hold: float = 0.2
    step: float = 0.1


def paths(now: Drive, wanted: Floats, motors: Motors) -> Floats:
    """Poses (n, steps, 3) in the robot frame: each command (n, 2) is held for a while, then the robot brakes."""
    fastest = np.abs(wanted).max(axis=0, initial=0.0)
    braking = max(
        max(abs(now.speed), fastest[0]) / motors.acceleration,
        max(abs(now.turn_rate), fastest[1]) / motors.turn_acceleration,
    )
    steps = min(MOST_STEPS, math.ceil((motors.hold + braking) / motors.step))
    times = (np.arange(steps) + 0.5)[None, :] * motors.step
    speed = _ramp(now.speed, wanted[:, :1], motors.acceleration, motors.hold, times)
    turn = _ramp(now.turn_rate, wanted[:, 1:], motors.turn_acceleration, motors.hold, times)
    theta = np.cumsum(turn, axis=1) * motors.step
    middle = theta - turn * (motors.step / 2)
    x = np.cumsum(speed * np.cos(middle), axis=1) * motors.step
    y = np.cumsum(speed * np.sin(middle), axis=1) * motors.step
    return np.stack([x, y, theta], axis=2)


def _ramp(now: float, wanted: Floats, rate: float, hold: float, times: Floats) -> Floats:
    """Speeds (n, steps) at the times (1, steps)."""
    risen = rate * np.minimum(times, hold)
    held = now + np.clip(wanted - now, -risen, risen)
    left: Floats = np.maximum(0.0, np.abs(held) - rate * np.maximum(0.0, times - hold))
    return np.sign(held) * left


def least_distance(made: Floats, points: Floats, hull: Hull) -> Floats:
    """How near [m] each path (n, steps, 3) brings the hull to the points (m, 2); infinite without points."""
    if not len(points) or not made.size:
        return np.full(len(made), math.inf)
    x, y, theta = (made[:, :, axis, None] for axis in range(3))
    c, s = np.cos(theta), np.sin(theta)
    dx, dy = points[:, 0] - x, points[:, 1] - y
    gaps: Floats = hull.distance(c * dx + s * dy, c * dy - s * dx).min(axis=(1, 2))
    return gaps
