"""A compass: the heading, with noise and with what iron and cables do to the field of the earth.

Takes: the true pose, chance. Gives: `Compass`. Leaves alone: tilt, and things that move.

The bias is a smooth field over the world, b(x, y) = A (sin(2 pi x / L + p) + sin(2 pi y / L + q)), the same for all
compasses of a world that ask for the same rms A and wavelength L; p and q come from the seed. The peak is 2 A.
"""

from __future__ import annotations

import math

from numpy.random import Generator

from behaviours.interface import Compass, wrap
from sim.sensors.build import CompassBuild
from sim.sensors.truth import Truth

PERIOD = 0.1  # [s]


class MagneticCompass:
    """One compass of one robot."""

    def __init__(self, build: CompassBuild, chance: Generator, field: Generator) -> None:
        """field: draws the phases of the bias."""
        self._build, self._chance = build, chance
        self._p, self._q = map(float, field.uniform(0.0, math.tau, 2))

    def measure(self, truth: Truth) -> tuple[Compass]:
        """One heading."""
        pose = truth.pose
        noise = self._build.sd * float(self._chance.standard_normal())
        return (Compass(truth.time, True, wrap(pose.theta + self.bias(pose.x, pose.y) + noise)),)

    def bias(self, x: float, y: float) -> float:
        """How far the compass is turned at that place [m] of the world [rad]."""
        if not self._build.bias_rms:
            return 0.0
        k = math.tau / self._build.wavelength
        return self._build.bias_rms * (math.sin(k * x + self._p) + math.sin(k * y + self._q))
