"""Where the robot is: the distance of odometry along the heading of the compass.

Takes: every reading. Gives: `pose` in the map frame, what odometry alone says, and how far the robot went. Leaves
alone: maps, and who uses the estimate.

The *map frame* has its origin where the first reading was made. With a compass its axes are those of the world
(`frame` is "map"), without one x is the heading of the first reading (`frame` is "odom"). A frame never changes: a
compass that comes to life later tells only turns. Where the compass says nothing, the heading turns as odometry does.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from behaviours.cores.hybrid import (
    THETA,
    Belief,
    HeadingModel,
    compared,
    first_belief,
    moved,
    signed_distance,
    step,
    turned,
)
from behaviours.interface import Channels, Odometry, Pose, Reading, Report, wrap


@dataclass(frozen=True, slots=True)
class LocalisationSettings:
    """compass: the heading is the compass's (hybrid localisation) and not odometry's.

    modern: the heading is filtered from compass, gyroscope and odometry by `model`, and distances lie along the
    heading in the middle of each tick; otherwise it is what the compass says, and they lie along that.
    """

    compass: bool = True
    modern: bool = False
    model: HeadingModel = field(default_factory=HeadingModel)


class Localisation:
    """The hybrid estimate of Yamauchi 2005. pose: in the map frame; odometry: what odometry alone says, there too.

    travelled [m]: the way made, forwards and backwards alike.
    """

    def __init__(self, settings: LocalisationSettings) -> None:
        self.settings = settings
        self.pose = self.odometry = Pose(0.0, 0.0, 0.0)
        self.frame = "odom"
        self.travelled = 0.0
        self._last: Odometry | None = None
        self._start = 0.0
        self._askew: float | None = None
        self._belief = Belief()
        self._stamp = 0.0

    @property
    def heading(self) -> float:
        """[rad] in the map frame."""
        return self.pose.theta

    def from_start(self) -> float:
        """Distance [m] of the pose from the first one."""
        return math.hypot(self.pose.x, self.pose.y)

    def update(self, reading: Reading, reports: Mapping[str, Report], channels: Channels) -> None:
        told = reading.odometry
        if not math.isfinite(told.pose.x + told.pose.y + told.pose.theta):
            told = self._last or Odometry(Pose(0.0, 0.0, 0.0), 0.0, 0.0)
        if self._last is None:
            self._begin(reading, told)
        else:
            self._move(reading, self._last, told)
        self._last, self._stamp = told, reading.stamp
        self.odometry = turned(told.pose, self._start)

    def _begin(self, reading: Reading, told: Odometry) -> None:
        heading = self._compass(reading)
        self.frame, self._askew = ("odom", None) if heading is None else ("map", 0.0)
        self._start = wrap((heading or 0.0) - told.pose.theta)
        self.pose = Pose(0.0, 0.0, heading or 0.0)
        self._belief = first_belief(heading or 0.0, self.settings.model, by_compass=heading is not None)

    def _move(self, reading: Reading, last: Odometry, told: Odometry) -> None:
        way, turn = signed_distance(last.pose, told.pose), wrap(told.pose.theta - last.pose.theta)
        compass = self._compass(reading)
        if compass is not None and self._askew is None:
            self._askew = wrap(compass - self.pose.theta - turn)
        compass = None if compass is None else wrap(compass - (self._askew or 0.0))
        if self.settings.modern:
            theta = self._filtered(reading, way, turn, compass)
            along = self.pose.theta + wrap(theta - self.pose.theta) / 2
        else:
            theta = along = wrap(self.pose.theta + turn) if compass is None else compass
        x, y = step((self.pose.x, self.pose.y), way, along)
        self.pose = Pose(x, y, theta)
        self.travelled += abs(way)

    def _filtered(self, reading: Reading, way: float, turn: float, compass: float | None) -> float:
        imu, model = reading.imu, self.settings.model
        gyro = imu.turn_rate if imu is not None and imu.fresh and math.isfinite(imu.turn_rate) else None
        self._belief = moved(self._belief, turn, way, gyro, max(reading.stamp - self._stamp, 0.0), model)
        if compass is not None:
            self._belief = compared(self._belief, compass, model)
        return wrap(float(self._belief.mean[THETA]))

    def _compass(self, reading: Reading) -> float | None:
        """What the compass says in this tick; None where it is not there, failed, or said nothing new."""
        compass = reading.compass
        if not self.settings.compass or compass is None or not math.isfinite(compass.heading):
            return None
        if self._last is not None and not compass.fresh:
            return None
        return compass.heading
