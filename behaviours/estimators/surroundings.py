"""What stands round the robot, as points: the latest scan of the lidar, or the echoes of the sonars.

Takes: every reading, and where the robot believes to be. Gives: `points` in the robot frame of this tick; between scans
they move as the robot does. Leaves alone: what they are taken for.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from behaviours.cores.geometry import moved
from behaviours.estimators.localisation import Localisation
from behaviours.interface import Channels, Floats, Ranges, Reading, Report, Scan


@dataclass(frozen=True, slots=True)
class SurroundingsSettings:
    """sonar: take the rings of sonars, and not the lidar."""

    sonar: bool = False


class Surroundings:
    """points: (n, 2) [m] robot frame; stamp [s]: when they were measured; fresh: measured since the last tick.

    known: something has been measured at all.
    """

    def __init__(self, settings: SurroundingsSettings, place: Localisation) -> None:
        self.settings = settings
        self._place = place
        self._seen: Floats = np.zeros((0, 2))
        self._from = place.pose
        self.points: Floats = np.zeros((0, 2))
        self.stamp = -math.inf
        self.fresh = self.known = False

    def update(self, reading: Reading, reports: Mapping[str, Report], channels: Channels) -> None:
        self.fresh = False
        if self.settings.sonar:
            rings = [ring for ring in (reading.sonar, reading.skirt) if ring is not None]
            if any(ring.fresh for ring in rings):
                self._take(np.concatenate([echo_points(ring) for ring in rings]), max(ring.stamp for ring in rings))
        elif reading.lidar is not None and reading.lidar.fresh:
            self._take(scan_points(reading.lidar), reading.lidar.stamp)
        self.points = moved(self._seen, self._from, self._place.pose)

    def _take(self, points: Floats, stamp: float) -> None:
        self._seen, self._from, self.stamp = points, self._place.pose, stamp
        self.fresh = self.known = True


def scan_points(scan: Scan) -> Floats:
    """Where the beams of a scan ended (n, 2) [m], robot frame; without those that failed or met nothing."""
    met = np.isfinite(scan.ranges) & (scan.ranges < scan.max_range) & (scan.ranges >= scan.min_range)
    reach, bearing = scan.ranges[met], scan.bearings[met] + scan.mount.theta
    return np.column_stack([scan.mount.x + reach * np.cos(bearing), scan.mount.y + reach * np.sin(bearing)])


def echo_points(ring: Ranges) -> Floats:
    """Where the echoes of a ring came from (n, 2) [m], robot frame, taken on the axes of the transducers."""
    heard = np.isfinite(ring.ranges) & (ring.ranges < ring.max_range)
    reach, bearing = ring.ranges[heard] + ring.mount_radius, ring.bearings[heard]
    return np.column_stack([reach * np.cos(bearing), reach * np.sin(bearing)])
