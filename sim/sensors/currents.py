"""What the two drive motors draw.

Takes: the true load, tick by tick, chance. Gives: `Currents`. Leaves alone: how a load comes about (the drives).

A low-pass of first order keeps inrush out; it is advanced each tick, whatever the period of the readings.
"""

from __future__ import annotations

import math

from numpy.random import Generator

from behaviours.interface import Currents
from sim.sensors.build import CurrentBuild
from sim.sensors.truth import Truth


class MotorCurrents:
    """The two sensors of one robot. `update` is called after each tick."""

    def __init__(self, build: CurrentBuild, chance: Generator) -> None:
        self._build, self._chance = build, chance
        self._left = self._right = 0.0

    def update(self, truth: Truth) -> None:
        """Let the low-pass follow for one tick."""
        gain = 1.0 - math.exp(-truth.dt / self._build.smoothing) if self._build.smoothing else 1.0
        self._left += gain * (truth.load.left - self._left)
        self._right += gain * (truth.load.right - self._right)

    def measure(self, truth: Truth) -> tuple[Currents]:
        """One reading."""
        left, right = self._chance.standard_normal(2).tolist()
        sd = self._build.sd
        return (Currents(truth.time, True, self._left + sd * left, self._right + sd * right),)
