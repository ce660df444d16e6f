"""A synchro drive: a disc whose wheels all steer together, with turret, sensor rings and head on the steering.

Takes: a `Drive`. Gives: the motion of its body in the space, and its true pose and speed. The robot frame turns with
the steering, so it moves like a unicycle; the hull is round, so that turning touches nothing.
Leaves alone: what stops it. Drive and hull meet obstacles through `velocity_func`, where the contact solver still
corrects the velocity; a velocity that is set before the step pushes the hull into walls.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import pymunk

from behaviours.interface import Drive, Pose, wrap
from sim.frames import approach
from sim.things.thing import FRICTION, ROBOT

MASS = 120.0  # [kg]


@dataclass(frozen=True, slots=True)
class Build:
    """What the drive can do: radius [m]; speeds [m/s, rad/s]; accelerations [m/s^2, rad/s^2]. The Denning's."""

    radius: float = 0.35
    max_speed: float = 0.2
    max_turn_rate: float = 0.8
    acceleration: float = 0.5
    turn_acceleration: float = 2.0


class SynchroDrive:
    """The robot in the space. `pose`, `speed`, `velocity` are true, and as of the end of the last tick."""

    def __init__(self, space: pymunk.Space, start: Pose, build: Build) -> None:
        self.build = build
        self.body = pymunk.Body(MASS, math.inf)
        self.body.position, self.body.angle = (start.x, start.y), start.theta
        self.body.velocity_func = self._drive
        self.shape = pymunk.Circle(self.body, build.radius)
        self.shape.friction, self.shape.collision_type = FRICTION, ROBOT
        self.shape.filter = pymunk.ShapeFilter(group=ROBOT)
        space.add(self.body, self.shape)
        self._wanted, self._speed, self._turn_rate = Drive(0.0, 0.0), 0.0, 0.0
        self.read()

    def command(self, drive: Drive) -> None:
        """What to do until the next command; clipped to what the drive can do."""
        build = self.build
        self._wanted = Drive(
            max(-build.max_speed, min(build.max_speed, drive.speed)),
            max(-build.max_turn_rate, min(build.max_turn_rate, drive.turn_rate)),
        )

    def read(self) -> None:
        """Take pose and velocity over from the space."""
        (x, y), (vx, vy) = self.body.position, self.body.velocity
        self.pose = Pose(x, y, wrap(self.body.angle))
        self.speed = math.hypot(vx, vy)
        self.turn_rate = self._turn_rate

    @property
    def standing(self) -> bool:
        """Slower than 2 cm/s."""
        return self.speed < 0.02

    def _drive(self, body: pymunk.Body, _gravity: tuple[float, float], _damping: float, dt: float) -> None:
        self._speed = approach(self._speed, self._wanted.speed, self.build.acceleration * dt)
        self._turn_rate = approach(self._turn_rate, self._wanted.turn_rate, self.build.turn_acceleration * dt)
        angle = body.angle + self._turn_rate * dt / 2  # the middle of the arc that the next sub-step will drive
        body.velocity = self._speed * math.cos(angle), self._speed * math.sin(angle)
        body.angular_velocity = self._turn_rate
