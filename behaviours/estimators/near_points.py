"""What stands near the robot, also where its lidar does not look now.

Takes: the points of this tick, the field of view of the lidar, where the robot believes to be. Gives: those points and
the ones seen lately that have left the field of view; whether it is known what stands behind. Leaves alone: maps.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from behaviours.cores.geometry import moved
from behaviours.estimators.localisation import Localisation
from behaviours.estimators.surroundings import Surroundings
from behaviours.interface import Channels, Floats, Pose, Reading, Report, Scan

MAP = Pose(0.0, 0.0, 0.0)
KEPT, CELL = 30.0, 0.04  # [s], [m]: of two points nearer than this one is kept
WHOLE_TURN = math.radians(350.0)


class NearPoints:
    """reach [m]: how near. points: (n, 2) [m] robot frame; sees_all: the sensors look to every side."""

    def __init__(self, around: Surroundings, place: Localisation, reach: float = 1.5) -> None:
        self._around, self._place, self._reach = around, place, reach
        self._kept: Floats = np.zeros((0, 3))
        self.points: Floats = np.zeros((0, 2))
        self.sees_all = True

    def update(self, reading: Reading, reports: Mapping[str, Report], channels: Channels) -> None:
        scan = None if self._around.settings.sonar else reading.lidar
        self.sees_all = scan is None or _span(scan) >= WHOLE_TURN
        if self.sees_all or scan is None:
            self.points = self._around.points
            return
        pose = self._place.pose
        hidden = moved(self._kept[:, :2], MAP, pose)
        if self._around.fresh:
            stays = ~_in_view(hidden, scan) & (np.hypot(hidden[:, 0], hidden[:, 1]) < self._reach)
            stays &= reading.stamp - self._kept[:, 2] < KEPT
            self._remember(np.concatenate([self._kept[stays], self._seen_near(pose, reading.stamp)]))
            hidden = hidden[stays]
        else:
            hidden = hidden[~_in_view(hidden, scan)]
        self.points = np.concatenate([self._around.points, hidden])

    def _seen_near(self, pose: Pose, stamp: float) -> Floats:
        seen = self._around.points
        near = moved(seen[np.hypot(seen[:, 0], seen[:, 1]) < self._reach], pose, MAP)
        return np.column_stack([near, np.full(len(near), stamp)])

    def _remember(self, points: Floats) -> None:
        """The last of the points in each cell."""
        cells = np.floor(points[::-1, :2] / CELL).astype(np.int64)
        _, first = np.unique(cells[:, 0] * 1_000_003 + cells[:, 1], return_index=True)
        self._kept = points[::-1][np.sort(first)]


def _span(scan: Scan) -> float:
    return float(scan.bearings[-1] - scan.bearings[0]) if len(scan.bearings) else 0.0


def _in_view(points: Floats, scan: Scan) -> NDArray[np.bool_]:
    """Which points the lidar looks at."""
    bearing = np.arctan2(points[:, 1] - scan.mount.y, points[:, 0] - scan.mount.x) - scan.mount.theta
    bearing = np.remainder(bearing + math.pi, math.tau) - math.pi
    seen: NDArray[np.bool_] = (bearing >= scan.bearings[0]) & (bearing <= scan.bearings[-1])
    return seen
