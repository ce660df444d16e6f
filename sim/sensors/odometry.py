"""Dead reckoning from the wheels and the steering.

Takes: true poses and what the wheels did, tick by tick, and chance. Gives: `Odometry` in the frame of the first one.
Leaves alone: how wheels and tracks slip (the drives).

Where the wheels do just what the hull does, the motion of the hull is added up; where they do something else, theirs
is: tracks that scrub over-report the turn by their slip. A synchro drive steers all wheels in place and does not
scrub, so that its errors are small: a scale error of distance that stays for the run (sd 0.5 %, wheel wear) and a
random walk of the heading while it turns (sd 0.002 rad per root second). A shove from the side moves the robot
without its noticing.
"""

from __future__ import annotations

import math

from numpy.random import Generator

from behaviours.interface import Odometry, Pose, wrap
from sim.sensors.build import OdometryBuild
from sim.sensors.truth import Truth

STILL = 1e-6  # [rad] of turning in a tick that counts as none
SAME = 1e-9  # [m, rad] by which wheels and hull may differ in a tick through rounding


class WheelOdometry:
    """Adds up what the wheels did. `update` is called after each tick."""

    def __init__(self, build: OdometryBuild, start: Pose, chance: Generator) -> None:
        self._build, self._chance, self._true = build, chance, start
        self._scale = 1.0 + build.scale_sd * chance.standard_normal()
        self._x = self._y = self._theta = 0.0
        self._speed = self._turn_rate = 0.0
        self.first = (Odometry(Pose(0.0, 0.0, 0.0), 0.0, 0.0, 0.0, False),)

    def update(self, truth: Truth) -> None:
        """Add up one tick."""
        true, dt, old = truth.pose, truth.dt, self._true
        turn = wrap(true.theta - old.theta)
        middle = old.theta + turn / 2
        way = (true.x - old.x) * math.cos(middle) + (true.y - old.y) * math.sin(middle)
        turn = _said(turn, truth.wheels.turn_rate * dt)
        way = self._scale * _said(way, truth.wheels.speed * dt)
        if abs(turn) > STILL:
            turn += self._build.turn_sd * math.sqrt(dt) * self._chance.standard_normal()
        heading = self._theta + turn / 2
        self._x += way * math.cos(heading)
        self._y += way * math.sin(heading)
        if truth.aside:
            side = self._scale * truth.aside * dt
            self._x, self._y = self._x - side * math.sin(heading), self._y + side * math.cos(heading)
        self._theta, self._true = wrap(self._theta + turn), true
        self._speed, self._turn_rate = way / dt, turn / dt

    def measure(self, truth: Truth) -> tuple[Odometry]:
        """What has been added up so far."""
        pose = Pose(self._x, self._y, self._theta)
        return (Odometry(pose, self._speed, self._turn_rate, truth.time),)


def _said(hull: float, wheels: float) -> float:
    """What the wheels did in a tick; what the hull did where that is the same, free of the rounding of a rate."""
    return hull if abs(wheels - hull) <= SAME else wheels
