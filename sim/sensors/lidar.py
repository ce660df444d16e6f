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
from sim.raycast import Fan, Rays, cast, sweep
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
    return bearings


class Lidar:
    """One lidar of one robot."""

    def __init__(self, build: LidarBuild, mount: Mount, chance: Generator) -> None:
        self._build, self._mount, self._chance = build, mount, chance
        self._pose = Pose(mount.x, mount.y, mount.theta)
        self._sd, self._near, self._far = (
            np.full(build.beams, n) for n in (build.sd, build.min_range, build.max_range)
        )
        self._fan = Fan(beam_bearings(build.field_of_view, build.beams))

    def measure(self, truth: Truth) -> tuple[Scan]:
        """One sweep."""
        build = self._build
        ranges = self._noisy(self._swept(truth))
        ranges.setflags(write=False)
        return (Scan(truth.time, True, self._pose, self._fan.bearings, ranges, build.min_range, build.max_range),)

    def _swept(self, truth: Truth) -> Floats:
        build, eye, height = self._build, mounted(truth.pose, self._mount), self._mount.height
        if not build.angle_sd:
            return sweep(self._fan, eye, height, build.max_range, truth.scene())
        askew = self._fan.bearings + build.angle_sd * self._chance.standard_normal(build.beams)
        x, y, heights = (np.full(build.beams, number) for number in (eye.x, eye.y, height))
        ranges, _ = cast(Rays(x, y, askew + eye.theta, heights), build.max_range, truth.scene())
        return ranges

    def _noisy(self, ranges: Floats) -> Floats:
        """Arrays of one number stand for the number: numpy is faster with them."""
        build, chance = self._build, self._chance
        if build.sd or build.relative_sd:
            noisy = chance.standard_normal(build.beams)
            noisy *= self._sd + build.relative_sd * ranges if build.relative_sd else self._sd
            noisy += ranges
            np.minimum(noisy, self._far, out=noisy)
        else:
            noisy = ranges.copy()
        np.maximum(noisy, self._near, out=noisy)
        np.copyto(noisy, self._far, where=ranges >= self._far)
        if build.dropout:
            noisy[chance.random(build.beams) < build.dropout] = math.nan
        return noisy
