"""The wall of the directed Hough transform, in the words in which followers of a fitted wall speak.

Takes: the walls of the perimeter, the points round the robot. Gives: whether a wall is followed, was lost, or ends,
offset and angle, and whether something bars the way. Leaves alone: which wall it is, and steering.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from behaviours.cores import corner
from behaviours.cores.corner import CornerSettings
from behaviours.cores.wall_fit import Fit, Line
from behaviours.estimators.surroundings import Surroundings
from behaviours.estimators.walls import SHOWN_BAND, Walls
from behaviours.interface import Channels, Reading, Report, wrap

FEW = 3
"""Who sees fewer points does not go on."""
INSIDE = 0.05
"""[m] What lies so far within the hull is a mistake of the sensor; a scan most of which does is none."""
Mode = Literal["none", "wall", "search", "lost"]


@dataclass(frozen=True, slots=True)
class SoughtSettings:
    """hull_radius, margin [m]; patience [s]: so long a lost wall is looked for; ends: so many stand-offs ahead."""

    hull_radius: float = 0.25
    margin: float = 0.06
    patience: float = 12.0
    ends: float = 1.5
    corner: CornerSettings = field(default_factory=CornerSettings)


class WallOfLines:
    """mode: "none" before the first wall, "search" while none is seen, "lost" when it was not seen for long.

    offset [m], angle [rad]: of the wall; 0 where it is not seen. All of it in the mirror for a wall to the left.
    """

    def __init__(self, settings: SoughtSettings, walls: Walls, around: Surroundings) -> None:
        self.settings = settings
        self._walls, self._around = walls, around
        self.mode: Mode = "none"
        self.offset = self.angle = 0.0
        self.ends = self.bars = False
        self._seen_at = 0.0

    @property
    def is_found(self) -> bool:
        """A wall is followed."""
        return self.mode == "wall"

    def update(self, reading: Reading, reports: Mapping[str, Report], channels: Channels) -> None:
        if not self._walls.fresh:
            return
        flip = 1.0 if self._walls.settings.right else -1.0
        points, seen = self._around.points * (1.0, flip), self._walls.line
        within = np.count_nonzero(np.hypot(points[:, 0], points[:, 1]) < self.settings.hull_radius - INSIDE)
        if within > len(points) / 2 or (len(points) < FEW and self.mode != "none"):
            self.mode, self.offset, self.angle, self.ends = "lost", 0.0, 0.0, False
            return
        here, stand_off = self.settings, self._walls.settings.follow.stand_off
        least = here.hull_radius + here.margin
        radius = max(least, here.corner.disc * corner.room(points, stand_off, here.corner.beside, least))
        turn, _ = corner.barred(points, 0.0, radius, here.corner.sweep * stand_off, least)
        self.bars = turn > here.corner.barred
        if seen is None:
            self._miss(reading.stamp)
            return
        line = Line(flip * seen.normal, seen.rho)
        self.mode, self._seen_at = "wall", reading.stamp
        self.offset, self.angle = line.distance, wrap(-line.normal - math.pi / 2)
        fit = Fit(line, np.abs(line.off(points)) <= SHOWN_BAND, 0.0)
        self.ends = bool(fit.inliers.any()) and self._end(fit, points, reading) <= here.ends * stand_off

    def _end(self, fit: Fit, points: np.typing.NDArray[np.float64], reading: Reading) -> float:
        scan = reading.lidar
        spacing = float(scan.bearings[1] - scan.bearings[0]) if scan is not None and len(scan.bearings) > 1 else 0.01
        return corner.last_of(fit, points, self.settings.corner.door, spacing)[0]

    def _miss(self, stamp: float) -> None:
        self.offset = self.angle = 0.0
        self.ends = False
        if self.mode in ("wall", "search"):
            self.mode = "lost" if stamp - self._seen_at > self.settings.patience else "search"
