"""Where the robot started.

Takes: the first reading. Gives: its pose. Leaves alone: everything else.
"""

from __future__ import annotations

from collections.abc import Mapping

from behaviours.interface import Channels, Pose, Reading, Report


class Home:
    """The pose of the first reading; None before it."""

    def __init__(self) -> None:
        self.pose: Pose | None = None

    def update(self, reading: Reading, reports: Mapping[str, Report], channels: Channels) -> None:
        if self.pose is None:
            self.pose = reading.odometry.pose
