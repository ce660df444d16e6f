"""The recent path of the robot, as points that obstacle avoidance may take for obstacles.

Takes: where the robot believes to be: the hybrid pose, for odometry that over-reports turns would turn the remembered
path with every turn. Gives: `points` in the robot frame of this tick, with the places where something held the
robot. Leaves alone: who steers clear of them, and when; who finds out that the robot is held.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping

import numpy as np

from behaviours.cores.geometry import moved
from behaviours.cores.recent_path import Trace, TraceSettings
from behaviours.estimators.localisation import Localisation
from behaviours.interface import Channels, Floats, Pose, Reading, Report

MAP = Pose(0.0, 0.0, 0.0)
HELD = 20
"""How many places are remembered where the robot was held."""


class RecentPath:
    """points: (n, 2) [m] robot frame, without the near ones; is_back: the robot was here before, and went away."""

    def __init__(self, settings: TraceSettings, place: Localisation) -> None:
        self.settings = settings
        self.trace = Trace(settings)
        self._place = place
        self.points: Floats = np.zeros((0, 2))
        self.is_back = False
        self._held: deque[Floats] = deque(maxlen=HELD)

    def update(self, reading: Reading, reports: Mapping[str, Report], channels: Channels) -> None:
        pose = self._place.pose
        here = (pose.x, pose.y)
        self.trace.add(reading.stamp, here)
        self.points = moved(np.concatenate([self.trace.apart(here), *self._held]), MAP, pose)
        self.is_back = self.trace.is_back(here)

    def held_by(self, points: Floats) -> None:
        """Remember where something held the robot that no sensor sees: points (n, 2) [m], robot frame."""
        self._held.append(moved(points, self._place.pose, MAP))
