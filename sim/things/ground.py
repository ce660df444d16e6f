"""Ground that is not level: slopes, each over a region of the plane.

Takes: slopes. Gives: how a robot is tilted where it stands. Leaves alone: what the tilt does to drives and sensors.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from behaviours.interface import Pose

Box = tuple[float, float, float, float]


@dataclass(frozen=True, slots=True)
class Slope:
    """region [m] (xmin, ymin, xmax, ymax) that rises by `rise` [rad] towards the heading `uphill` [rad, world]."""

    region: Box
    rise: float
    uphill: float


@dataclass(frozen=True, slots=True)
class Ground:
    """The slopes of a world; where several lie over one another the first counts, where none lies it is level."""

    slopes: tuple[Slope, ...] = ()

    def tilt(self, pose: Pose) -> tuple[float, float]:
        """(pitch, roll) [rad] of a robot there: nose up and left side up positive."""
        for slope in self.slopes:
            xmin, ymin, xmax, ymax = slope.region
            if xmin <= pose.x <= xmax and ymin <= pose.y <= ymax:
                grade, turn = math.tan(slope.rise), slope.uphill - pose.theta
                return math.atan(grade * math.cos(turn)), math.atan(grade * math.sin(turn))
        return 0.0, 0.0
