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

from behaviours.interface import Drive, Odometry, Pose, wrap
from sim.sensors.build import OdometryBuild as OdometryBuild
from sim.sensors.truth import Truth

STILL = 1e-6  # [rad] of turning in a tick that counts as none
SAME = 1e-9  # [m, rad] by which wheels and hull may differ in a tick through rounding


class WheelOdometry:
    """Adds up what the wheels did. `update` is called after each tick."""

    def __init__(self, build: OdometryBuild, start: Pose, chance: Generator) -> None:
        self._build, self._chance, self._true = build, chance, start
        self._scale = 1.0 + build.scale_sd * chance.standard_normal()
        self.x = self.y = self.theta = 0.0
        self.speed = self.turn_rate = 0.0
        self.first = (Odometry(Pose(0.0, 0.0, 0.0), 0.0, 0.0, 0.0, False),)

    def update(self, truth: Truth) -> None:
        """Add up one tick."""
        self.add(truth.pose, truth.dt, truth.wheels)

    def measure(self, truth: Truth) -> tuple[Odometry]:
        """What has been added up so far."""
        pose = Pose(self.x, self.y, self.theta)
        return (Odometry(pose, self.speed, self.turn_rate, truth.time),)

    def add(self, true: Pose, dt: float, wheels: Drive | None) -> None:
        """One tick of length dt [s] that ended at this pose; wheels: None where they did what the hull did."""
        old, turn = self._true, wrap(true.theta - self._true.theta)
        middle = old.theta + turn / 2
        way = (true.x - old.x) * math.cos(middle) + (true.y - old.y) * math.sin(middle)
        if wheels is not None:
            turn, way = _said(turn, wheels.turn_rate * dt), _said(way, wheels.speed * dt)
        way *= self._scale
        if abs(turn) > STILL:
            turn += self._build.turn_sd * math.sqrt(dt) * self._chance.standard_normal()
        heading = self.theta + turn / 2
        self.x += way * math.cos(heading)
        self.y += way * math.sin(heading)
        self.theta, self._true = wrap(self.theta + turn), true
        self.speed, self.turn_rate = way / dt, turn / dt


def _said(hull: float, wheels: float) -> float:
    """What the wheels did in a tick; what the hull did where that is the same, free of the rounding of a rate."""
    return hull if abs(wheels - hull) <= SAME else wheels


class DeadReckoning:
    """Adds up what the hull did. `update` is called after each tick."""

    def __init__(self, build: OdometryBuild, start: Pose, chance: Generator) -> None:
        self._wheels = WheelOdometry(build, start, chance)

    def update(self, true: Pose, dt: float) -> None:
        """Take the true pose at the end of a tick of length dt [s]."""
        self._wheels.add(true, dt, None)

    @property
    def reading(self) -> Odometry:
        """What has been added up so far."""
        wheels = self._wheels
        return Odometry(Pose(wheels.x, wheels.y, wheels.theta), wheels.speed, wheels.turn_rate)
