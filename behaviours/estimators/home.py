"""Where the robot started, and where to look for that place when odometry has drifted.

Takes: the first reading; later whether the robot waits there with an object that nobody takes off. Gives: the pose, and
the place to wait at. Leaves alone: the way.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

from behaviours.cores.geometry import along, distance
from behaviours.interface import Channels, Pose, Reading, Report

PLACES = 6
AROUND = 0.8  # [m] from where it started
STANDS, THERE = 0.01, 0.7
"""Below this speed [m/s] the robot stands; so near [m] to the place it waits there."""


class Home:
    """The pose of the first reading; None before it.

    place: where to wait. Where nobody has taken the object within `patience` [s], the next of six places `AROUND`
    the pose, which itself comes after them again.
    """

    def __init__(self, patience: float = math.inf) -> None:
        self.pose: Pose | None = None
        self._patience = patience
        self._tried = 0
        self._since = 0.0

    @property
    def place(self) -> Pose | None:
        """Where to wait at home."""
        turn = self._tried % (PLACES + 1)
        if self.pose is None or turn == 0:
            return self.pose
        return along(self.pose, self.pose.theta + turn * math.tau / PLACES, AROUND)

    def update(self, reading: Reading, reports: Mapping[str, Report], channels: Channels) -> None:
        if self.pose is None:
            self.pose = reading.odometry.pose
        if not reading.object_on_board:
            self._tried = 0
        if not (reading.object_on_board and self._waits(reading)):
            self._since = reading.stamp
        elif reading.stamp - self._since > self._patience:
            self._tried, self._since = self._tried + 1, reading.stamp

    def _waits(self, reading: Reading) -> bool:
        place = self.place
        near = place is not None and distance(reading.odometry.pose, place) <= THERE
        return near and abs(reading.odometry.speed) < STANDS
