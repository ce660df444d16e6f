"""A lidar taken for a ring of sonars: the nearest range of each sector, from the hull.

Takes: a scan, the radius of the hull. Gives: `Ranges` as a ring about the hull would give them. Leaves alone: the finer
bearings that the scan knows; what needs them takes the scan itself.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from behaviours.interface import Ranges, Reading, Scan

RingOf = Callable[[Reading], Ranges | None]
"""The ring that a reading holds, if it holds one."""
SECTORS = 24
"""As many as there are sonars at the waist."""
FINE = 120
"""For what moves and what is remembered the sectors of a lidar may be narrower."""


def waist(reading: Reading) -> Ranges | None:
    """The sonars at the waist."""
    return reading.sonar


def skirt(reading: Reading) -> Ranges | None:
    """The sonars at the skirt."""
    return reading.skirt


def sectors_of(scan: Scan, hull: float, count: int = SECTORS) -> Ranges:
    """Sector k is centred at k/count of a turn. hull [m]: its radius about the robot's origin.

    A sector into which no beam looks, or in which all failed, is NaN; one in which nothing was met has `max_range`,
    which is the farthest that the scan sees to every side. A range is never negative, also where the mount stands out.
    """
    bearings = np.arange(count) / count * math.tau
    bearings = np.where(bearings > math.pi, bearings - math.tau, bearings)
    far = max(0.0, scan.max_range - math.hypot(scan.mount.x, scan.mount.y) - hull)
    sound = np.isfinite(scan.ranges)
    angles, reach = scan.bearings[sound] + scan.mount.theta, scan.ranges[sound]
    x, y = scan.mount.x + reach * np.cos(angles), scan.mount.y + reach * np.sin(angles)
    away = np.clip(np.hypot(x, y) - hull, 0.0, far)
    away[reach >= scan.max_range] = far
    sector = np.rint(np.arctan2(y, x) / (math.tau / count)).astype(np.int64) % count
    nearest = np.full(count, math.inf)
    np.minimum.at(nearest, sector, away)
    ranges = np.where(np.isfinite(nearest), nearest, math.nan)
    return Ranges(scan.stamp, scan.fresh, bearings, ranges, far, hull)


class LidarRing:
    """The sectors of the lidar of a reading; each scan is reduced once. count: of sectors."""

    def __init__(self, hull: float, count: int = SECTORS) -> None:
        self._hull, self._count = hull, count
        self._last: Ranges | None = None

    def __call__(self, reading: Reading) -> Ranges | None:
        scan = reading.lidar
        if scan is None:
            return None
        last = self._last
        if last is None or last.stamp != scan.stamp:
            last = sectors_of(scan, self._hull, self._count)
        elif last.fresh != scan.fresh:
            last = Ranges(last.stamp, scan.fresh, last.bearings, last.ranges, last.max_range, last.mount_radius)
        self._last = last
        return last
