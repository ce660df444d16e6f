"""Where the robot is: the distance of odometry along the heading of the compass.

Takes: every reading. Gives: `pose` in the map frame, what odometry alone says, and how the robot moved. Leaves alone:
maps, and who uses the estimate.

The *map frame* has its origin where the first reading was made. With a compass its axes are those of the world
(`frame` is "map"), without one x is the heading of the first reading (`frame` is "odom").
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from behaviours.interface import Channels, Odometry, Pose, Reading, Report, wrap


@dataclass(frozen=True, slots=True)
class LocalisationSettings:
    """compass: the heading is the compass's (hybrid localisation) and not odometry's."""

    compass: bool = True


class Localisation:
    """The hybrid estimate of Yamauchi 2005. pose: in the map frame; odometry: what odometry alone says, there too."""

    def __init__(self, settings: LocalisationSettings) -> None:
        self.settings = settings
        self.pose = self.odometry = Pose(0.0, 0.0, 0.0)
        self.frame = "odom"
        self._last: Odometry | None = None
        self._start = 0.0

    @property
    def heading(self) -> float:
        """[rad] in the map frame."""
        return self.pose.theta

    def update(self, reading: Reading, reports: Mapping[str, Report], channels: Channels) -> None:
        told, last = reading.odometry, self._last
        heading = self._compass(reading)
        if last is None:
            self.frame = "odom" if heading is None else "map"
            self._start = wrap((heading or 0.0) - told.pose.theta)
            self.pose = Pose(0.0, 0.0, heading or 0.0)
        else:
            turned = self.pose.theta + told.pose.theta - last.pose.theta
            theta = wrap(turned if heading is None else heading)
            way = signed_distance(last.pose, told.pose)
            x, y = self.pose.x + way * math.cos(theta), self.pose.y + way * math.sin(theta)
            self.pose = Pose(x, y, theta)
        self._last = told
        self.odometry = _turned(told.pose, self._start)

    def _compass(self, reading: Reading) -> float | None:
        compass = reading.compass
        if not self.settings.compass or compass is None or not math.isfinite(compass.heading):
            return None
        if self._last is not None and not compass.fresh:
            return None
        return compass.heading


def signed_distance(before: Pose, after: Pose) -> float:
    """Distance [m] between two poses of odometry, negative where the robot went backwards."""
    middle = before.theta + wrap(after.theta - before.theta) / 2
    dx, dy = after.x - before.x, after.y - before.y
    return math.copysign(math.hypot(dx, dy), dx * math.cos(middle) + dy * math.sin(middle))


def _turned(pose: Pose, angle: float) -> Pose:
    c, s = math.cos(angle), math.sin(angle)
    return Pose(c * pose.x - s * pose.y, s * pose.x + c * pose.y, wrap(pose.theta + angle))
