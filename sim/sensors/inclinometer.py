"""How the ground tilts the robot.

Takes: the true pose, the ground, chance. Gives: `Inclination`. Leaves alone: that braking and turning look like tilt.
"""

from __future__ import annotations

from numpy.random import Generator

from behaviours.interface import Inclination
from sim.sensors.build import InclinometerBuild
from sim.sensors.truth import Truth

PERIOD = 0.1  # [s]


class Inclinometer:
    """The inclinometer of one robot."""

    def __init__(self, build: InclinometerBuild, chance: Generator) -> None:
        self._build, self._chance = build, chance

    def measure(self, truth: Truth) -> tuple[Inclination]:
        """One reading."""
        pitch, roll = truth.ground.tilt(truth.pose)
        along, across = self._chance.standard_normal(2).tolist()
        return (Inclination(truth.time, True, pitch + self._build.sd * along, roll + self._build.sd * across),)
