"""Gyroscope and accelerometer in the origin of the robot frame.

Takes: true turn rate and acceleration, chance. Gives: `Imu`. Leaves alone: gravity, which is taken out, and the drift
of the bias: it stays for the run.
"""

from __future__ import annotations

from numpy.random import Generator

from behaviours.interface import Imu
from sim.sensors.build import ImuBuild
from sim.sensors.truth import Truth


class InertialUnit:
    """The unit of one robot."""

    def __init__(self, build: ImuBuild, chance: Generator) -> None:
        self._build, self._chance = build, chance
        self._bias = build.bias_sd * float(chance.standard_normal())

    def measure(self, truth: Truth) -> tuple[Imu]:
        """One reading."""
        build, (turn, along, across) = self._build, self._chance.standard_normal(3).tolist()
        ax, ay = truth.acceleration
        acceleration = ax + build.acceleration_sd * along, ay + build.acceleration_sd * across
        return (Imu(truth.time, True, truth.turn_rate + self._bias + build.turn_rate_sd * turn, acceleration),)
