"""Dead reckoning from the wheels and the steering.

Takes: true poses, tick by tick, and chance. Gives: `Odometry` in the frame of the first reading.
Leaves alone: wheel slip. A synchro drive steers all wheels in place and does not scrub, so its errors are small: a
scale error of distance that stays for the run (sd 0.5 %, wheel wear) and a random walk of the heading while it turns
(sd 0.002 rad per root second). A shove from the side moves the robot without its noticing.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from behaviours.interface import Odometry, Pose, wrap

STILL = 1e-6  # [rad] of turning in a tick that counts as none


@dataclass(frozen=True, slots=True)
class OdometryBuild:
    """scale_sd: of the distance, per run; turn_sd [rad/sqrt(s)]: of the heading while it turns."""

    scale_sd: float = 0.005
    turn_sd: float = 0.002


class DeadReckoning:
    """Adds up what the wheels did. `update` is called after each tick."""

    def __init__(self, build: OdometryBuild, start: Pose, chance: np.random.Generator) -> None:
        self._build, self._chance, self._true = build, chance, start
        self._scale = 1.0 + build.scale_sd * chance.standard_normal()
        self.reading = Odometry(Pose(0.0, 0.0, 0.0), 0.0, 0.0)

    def update(self, true: Pose, dt: float) -> None:
        """Take the true pose at the end of a tick of length dt [s]."""
        old, turn = self._true, wrap(true.theta - self._true.theta)
        middle = old.theta + turn / 2
        way = self._scale * ((true.x - old.x) * math.cos(middle) + (true.y - old.y) * math.sin(middle))
        if abs(turn) > STILL:
            turn += self._build.turn_sd * math.sqrt(dt) * self._chance.standard_normal()
        pose = self.reading.pose
        heading = pose.theta + turn / 2
        there = Pose(pose.x + way * math.cos(heading), pose.y + way * math.sin(heading), wrap(pose.theta + turn))
        self.reading, self._true = Odometry(there, way / dt, turn / dt), true
