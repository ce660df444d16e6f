"""What the sensors say, for percepts: the last value of each that was sound, and how long ago.

Takes: every reading. Gives: ranges of the lidar by direction, heading, tilt, motor current, contact; before the first
sound value a harmless one. Leaves alone: sensors that search (infra-red, stereo) and the sonars.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from behaviours.interface import Channels, Floats, Reading, Report, Scan, wrap


@dataclass(frozen=True, slots=True)
class SensedSettings:
    """sector [rad]: half the angle of a direction; far [m]: the range where nothing was met; patience [s]."""

    sector: float = math.radians(15)
    far: float = 100.0
    patience: float = 1.0


class Sensed:
    """The last sound values."""

    def __init__(self, settings: SensedSettings) -> None:
        self.settings = settings
        self._time = self._scan_stamp = self._compass_stamp = 0.0
        self._bearings: Floats = np.zeros(0)
        self._ranges: Floats = np.zeros(0)
        self.heading = self.turn_rate = self.pitch = self.roll = self.current = 0.0
        self.bumped = False

    def update(self, reading: Reading, reports: Mapping[str, Report], channels: Channels) -> None:
        self._time, self.turn_rate = reading.stamp, reading.odometry.turn_rate
        if reading.lidar is not None and reading.lidar.fresh:
            self._take_scan(reading.lidar)
        if reading.compass is not None and math.isfinite(reading.compass.heading):
            self.heading, self._compass_stamp = reading.compass.heading, reading.compass.stamp
        if reading.imu is not None and math.isfinite(reading.imu.turn_rate):
            self.turn_rate = reading.imu.turn_rate
        if reading.inclination is not None and math.isfinite(reading.inclination.pitch + reading.inclination.roll):
            self.pitch, self.roll = reading.inclination.pitch, reading.inclination.roll
        if reading.currents is not None and math.isfinite(reading.currents.left + reading.currents.right):
            self.current = max(reading.currents.left, reading.currents.right)
        self.bumped = reading.bumper is not None and bool(reading.bumper.pressed.any())

    def _take_scan(self, scan: Scan) -> None:
        sound = np.isfinite(scan.ranges)
        if not sound.any():
            return
        bearings = scan.bearings + scan.mount.theta
        ranges = np.where(scan.ranges >= scan.max_range, self.settings.far, scan.ranges)
        self._bearings, self._ranges, self._scan_stamp = bearings[sound], ranges[sound], scan.stamp

    def range_towards(self, bearing: float) -> float:
        """Least range [m] of the lidar within the sector about a bearing [rad, robot frame]."""
        off = np.abs(np.mod(self._bearings - bearing + math.pi, math.tau) - math.pi)
        within = self._ranges[off <= self.settings.sector]
        return float(within.min()) if within.size else self.settings.far

    def nearest_range(self) -> float:
        """Least range [m] of the lidar."""
        return float(self._ranges.min()) if self._ranges.size else self.settings.far

    def nearest_bearing(self) -> float:
        """Bearing [rad, robot frame] of the least range of the lidar; 0 where there is none."""
        return wrap(float(self._bearings[self._ranges.argmin()])) if self._ranges.size else 0.0

    def lidar_is_lost(self) -> bool:
        """Whether no sound scan has come for longer than the patience."""
        return self._time - self._scan_stamp > self.settings.patience

    def compass_is_lost(self) -> bool:
        """Whether no sound heading has come for longer than the patience."""
        return self._time - self._compass_stamp > self.settings.patience
