"""The latest reading, for percepts that only look at it.

Takes: every reading. Gives: the latest one. Leaves alone: everything else.
"""

from __future__ import annotations

from collections.abc import Mapping

from behaviours.interface import Channels, Odometry, Pose, Reading, Report


class Latest:
    """The latest reading; before the first one a robot that stands at its origin at time 0."""

    def __init__(self) -> None:
        self.reading = Reading(0.0, 0, Odometry(Pose(0.0, 0.0), 0.0, 0.0))

    def update(self, reading: Reading, reports: Mapping[str, Report], channels: Channels) -> None:
        self.reading = reading

    def speed(self) -> float:
        """[m/s] along the drive heading."""
        return self.reading.odometry.speed

    def time_since_start(self) -> float:
        """[s]"""
        return self.reading.stamp

    def object_on_board(self) -> bool:
        """Whether the object lies on the platform."""
        return self.reading.object_on_board
