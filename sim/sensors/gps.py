"""Satellite navigation: where the antenna is, with white noise and an error that wanders.

Takes: the true pose, where the antenna is mounted, chance. Gives: `Fix`. Leaves alone: reception; shade and
reflections are asked for as faults.

The wandering error is a Gauss-Markov process for each axis: it begins anywhere in its distribution, and over a time t
keeps exp(-t / drift_time) of itself.
"""

from __future__ import annotations

import math

from numpy.random import Generator

from behaviours.interface import Fix
from sim.sensors.build import GpsBuild, Mount
from sim.sensors.sensor import mounted
from sim.sensors.truth import Truth

PERIOD = 1.0  # [s]


class Gps:
    """The receiver of one robot."""

    def __init__(self, build: GpsBuild, mount: Mount, chance: Generator) -> None:
        self._build, self._mount, self._chance = build, mount, chance
        self._time = 0.0
        self._drift_x, self._drift_y = (build.drift_sd * float(number) for number in chance.standard_normal(2))

    def measure(self, truth: Truth) -> tuple[Fix]:
        """One fix."""
        place, sd = mounted(truth.pose, self._mount), self._build.sd
        walk_x, walk_y, x, y = self._chance.standard_normal(4).tolist()
        self._wander(truth.time, walk_x, walk_y)
        return (Fix(truth.time, True, place.x + self._drift_x + sd * x, place.y + self._drift_y + sd * y),)

    def _wander(self, time: float, x: float, y: float) -> None:
        lasting = self._build.drift_time
        kept = math.exp((self._time - time) / lasting) if lasting else 0.0
        fresh = self._build.drift_sd * math.sqrt(1.0 - kept * kept)
        self._drift_x, self._drift_y = kept * self._drift_x + fresh * x, kept * self._drift_y + fresh * y
        self._time = time
