"""The part of a scan that a wall follower looks at: a strip that leads away from the robot.

Takes: points (n, 2) [m] in the robot frame. Gives: which of them lie in the strip, and where lines leave it. Leaves
alone: what stands there. After Bayer 2012: "given by a view angle from the robot's x-axis and a path width".
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from behaviours.cores.wall_fit import Line
from behaviours.interface import Floats


@dataclass(frozen=True, slots=True)
class ViewPath:
    """angle [rad] of its middle in the robot frame; width [m]; reach [m]: how far the sensor sees."""

    angle: float = math.radians(-60)
    width: float = 1.5
    reach: float = 4.0

    def holds(self, points: Floats) -> NDArray[np.bool_]:
        """Which points lie in it."""
        c, s = math.cos(self.angle), math.sin(self.angle)
        x, y = points[:, 0], points[:, 1]
        return np.asarray((np.abs(c * y - s * x) <= self.width / 2) & (c * x + s * y >= 0))

    def end_of(self, line: Line) -> float:
        """How far [m] along the wall from the foot of the robot the line leaves the strip ahead; inf: nowhere."""
        c, s = math.cos(self.angle), math.sin(self.angle)
        (nx, ny), (ux, uy) = line.n, line.along
        across, growth = (c * ny - s * nx) * line.distance, c * uy - s * ux
        side = math.inf if growth == 0 else (math.copysign(self.width / 2, growth) - across) / growth
        return min(side, math.sqrt(max(0.0, self.reach**2 - line.distance**2)))

    def edge_beyond(self, point: tuple[float, float]) -> tuple[float, float]:
        """The last point of the ray from the robot through the point that lies in the strip and within reach."""
        c, s = math.cos(self.angle), math.sin(self.angle)
        far = math.hypot(*point)
        aside = abs(c * point[1] - s * point[0])
        times = self.reach / far if far > 0 else 0.0
        times = min(times, self.width / 2 / aside) if aside > 0 else times
        return point[0] * times, point[1] * times
