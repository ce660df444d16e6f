"""The map that a robot makes of its world as it goes.

Takes: every fresh scan, and where the robot believes to be. Gives: an occupancy grid, and patches of what changed.
Leaves alone: where the robot is, and who looks at the map.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from behaviours.cores.occupancy import OccupancyGrid, OccupancySettings
from behaviours.cores.patches import Patch, PatchWriter
from behaviours.estimators.localisation import Localisation
from behaviours.interface import Channels, Pose, Reading, Report

LATE = 1e-6
"""[s] by which stamps may be off their period."""


@dataclass(frozen=True, slots=True)
class MapperSettings:
    """by_odometry: scans lie where odometry alone says.

    region [m]: side of the square round the robot that is sent; every [s]: so often.
    """

    by_odometry: bool = False
    region: float = 40.0
    every: float = 1.0
    grid: OccupancySettings = field(default_factory=OccupancySettings)


class Mapper:
    """grid: the map. patch: what this tick sends of it, if anything; bytes_sent: compressed, before base64."""

    def __init__(self, settings: MapperSettings, place: Localisation) -> None:
        self.settings = settings
        self._place = place
        self.grid = OccupancyGrid(settings.grid)
        self._writer = PatchWriter(settings.grid.cell, settings.region)
        self.patch: Patch | None = None
        self.bytes_sent = 0
        self._due = -math.inf
        self._since = math.nan
        self._now = math.nan

    @property
    def frame(self) -> str:
        """In which the map lies."""
        return self._place.frame

    def rate(self) -> float:
        """Mean of what has been sent [bytes/s]; 0 at first."""
        time = self._now - self._since + self.settings.every
        return self.bytes_sent / time if time > 0 else 0.0

    def update(self, reading: Reading, reports: Mapping[str, Report], channels: Channels) -> None:
        pose = self._pose()
        if reading.lidar is not None and reading.lidar.fresh:
            self.grid.add(reading.lidar, pose)
        self.patch, self._now = None, reading.stamp
        if reading.stamp >= self._due - LATE:
            self._send(reading.stamp, pose)

    def _send(self, stamp: float, pose: Pose) -> None:
        self._since = stamp if math.isnan(self._since) else self._since
        self._due = stamp + self.settings.every
        self.patch = self._writer.delta(self.grid, pose.x, pose.y)
        self.bytes_sent += 0 if self.patch is None else self.patch.size

    def _pose(self) -> Pose:
        return self._place.odometry if self.settings.by_odometry else self._place.pose
