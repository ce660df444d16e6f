"""A lidar: one plane of beams round its mount.

Takes: the true pose, the scene, chance. Gives: `Scan`. Leaves alone: the motion of the robot during a sweep (all beams
are of one instant), reflections, glass.

The plane lies at the height of the mount: what is lower is not seen. The noise of a range has a constant part and one
that grows with the range; the noise of the angles is that a beam points elsewhere than its bearing says. What is nearer
than `min_range` reads `min_range`; a beam that meets nothing reads `max_range`.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.random import Generator

from behaviours.interface import Floats, Pose, Scan
from sim.raycast import Rays, cast
from sim.sensors.build import LidarBuild, Mount
from sim.sensors.sensor import mounted
from sim.sensors.truth import Truth

PERIOD = 0.1  # [s]


def beam_bearings(field_of_view: float, beams: int) -> Floats:
    """Bearings [rad], rising, straight ahead in their middle; a full turn ends at pi and leaves -pi out."""
    if field_of_view >= math.tau - 1e-9:
        bearings = np.arange(1, beams + 1) / beams * math.tau - math.pi
    else:
        bearings = np.linspace(-field_of_view / 2, field_of_view / 2, beams) if beams > 1 else np.zeros(1)
    bearings.setflags(write=False)
    return bearings


class Lidar:
    """One lidar of one robot."""

    def __init__(self, build: LidarBuild, mount: Mount, chance: Generator) -> None:
        self._build, self._mount, self._chance = build, mount, chance
        self._pose = Pose(mount.x, mount.y, mount.theta)
        self._bearings = beam_bearings(build.field_of_view, build.beams)
        self._heights = np.full(build.beams, mount.height)

    def measure(self, truth: Truth) -> tuple[Scan]:
        """One sweep."""
        build = self._build
        ranges = self._noisy(self._swept(truth))
        ranges.setflags(write=False)
        return (Scan(truth.time, True, self._pose, self._bearings, ranges, build.min_range, build.max_range),)

    def _swept(self, truth: Truth) -> Floats:
        build, eye = self._build, mounted(truth.pose, self._mount)
        angles = self._bearings + eye.theta
        if build.angle_sd:
            angles += build.angle_sd * self._chance.standard_normal(build.beams)
        x, y = np.full(build.beams, eye.x), np.full(build.beams, eye.y)
        ranges, _ = cast(Rays(x, y, angles, self._heights), build.max_range, truth.scene())
        return ranges

    def _noisy(self, ranges: Floats) -> Floats:
        build, chance = self._build, self._chance
        nothing = ranges >= build.max_range
        if build.sd or build.relative_sd:
            noise = chance.standard_normal(build.beams)
            noise *= build.sd + build.relative_sd * ranges if build.relative_sd else build.sd
            ranges = np.minimum(ranges + noise, build.max_range, out=noise)
        ranges = np.maximum(ranges, build.min_range)
        ranges[nothing] = build.max_range
        if build.dropout:
            ranges[chance.random(build.beams) < build.dropout] = math.nan
        return ranges
