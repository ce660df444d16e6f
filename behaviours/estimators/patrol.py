"""A round of four places, and a place to charge at.

Takes: odometry and the battery. Gives: the next place of the round, how many rounds were made, the place of the
charger, the level of the battery. Leaves alone: the way there, and when to charge (a plan decides).

The round is a rectangle that lies ahead of where the robot started: straight ahead, to the left, back, and home.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from behaviours.cores.geometry import distance
from behaviours.interface import Channels, Pose, Reading, Report


@dataclass(frozen=True, slots=True)
class PatrolSettings:
    """length [m] ahead and width [m] to the left of the round; within [m] of a place it has been visited; charger_x,
    charger_y [m], from the start: where to stand for charging."""

    length: float = 6.0
    width: float = 4.0
    within: float = 0.6
    charger_x: float = 0.0
    charger_y: float = -1.5


class Patrol:
    """The round. Before the first reading it begins at the origin."""

    def __init__(self, settings: PatrolSettings) -> None:
        self.settings = settings
        self._start: Pose | None = None
        self._visited = 0
        self.level = 1.0
        self.is_charging = False

    def update(self, reading: Reading, reports: Mapping[str, Report], channels: Channels) -> None:
        pose = reading.odometry.pose
        self._start = self._start or pose
        if reading.battery is not None:
            self.level, self.is_charging = reading.battery.level, reading.battery.charging
        if distance(pose, self.next_place()) <= self.settings.within:
            self._visited += 1

    def next_place(self) -> Pose:
        """Where to go next, in the odometry frame."""
        length, width = self.settings.length, self.settings.width
        x, y = ((length, 0.0), (length, width), (0.0, width), (0.0, 0.0))[self._visited % 4]
        return self._from_start(x, y)

    def charger(self) -> Pose:
        """Where to stand for charging, in the odometry frame."""
        return self._from_start(self.settings.charger_x, self.settings.charger_y)

    def rounds(self) -> float:
        """How many whole rounds were made."""
        return float(self._visited // 4)

    def _from_start(self, x: float, y: float) -> Pose:
        start = self._start or Pose(0.0, 0.0)
        c, s = math.cos(start.theta), math.sin(start.theta)
        return Pose(start.x + c * x - s * y, start.y + s * x + c * y, start.theta)
