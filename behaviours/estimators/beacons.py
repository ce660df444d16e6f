"""What has been heard of beacons, and where it is worth listening next.

Takes: every fixation of the IR reader, whoever moves the head. Gives: where each beacon is that was heard, by name, and
how likely the others are where. Leaves alone: which of them are wanted, and driving.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from behaviours.cores.beacon import BeaconModel, expected
from behaviours.cores.beacon_grid import FLOOR, BearingRange, Estimate, disc, faintly, missed
from behaviours.interface import Channels, Floats, IrReading, Pose, Reading, Report, wrap


@dataclass(frozen=True, slots=True)
class BeaconSettings:
    """farthest [m]: no donor is farther from home; cell [m] of the grid; lost_after: fixations that contradict a place.

    moved [rad]: a bearing that differs by more contradicts. faint: signals below the threshold count; a beacon that is
    heard with a signal above `drowns` hides them.
    """

    farthest: float = 20.0
    cell: float = 1.0
    moved: float = math.radians(8.0)
    lost_after: int = 3
    drowns: float = 0.3
    faint: bool = True
    model: BeaconModel = field(default_factory=BeaconModel)


class Beacons:
    """heard: name -> grid, in the order in which they were heard first. cells, logs: where one may be that was not."""

    def __init__(self, settings: BeaconSettings) -> None:
        self.settings = settings
        self.heard: dict[str, BearingRange] = {}
        self._estimates: dict[str, Estimate] = {}
        self._against: dict[str, int] = {}
        self.cells = disc(Pose(0.0, 0.0), settings.farthest, settings.cell)
        self._missed: Floats = np.zeros_like(self.cells.x)
        self._faint: Floats = np.zeros_like(self.cells.x)
        self.latest = ""
        self._placed = False

    def update(self, reading: Reading, reports: Mapping[str, Report], channels: Channels) -> None:
        if not self._placed:
            self.cells = disc(reading.odometry.pose, self.settings.farthest, self.settings.cell)
            self._placed = True
        ir, self.latest = reading.ir, ""
        if ir is None or not ir.fresh:
            return
        if ir.detected and math.isfinite(ir.offset):
            self._hear(ir, reading.odometry.pose)
        else:
            self._miss(ir, reading.odometry.pose)

    def estimate(self, beacon: str) -> Estimate | None:
        """Where this beacon is; None where it was never heard."""
        if beacon not in self.heard:
            return None
        if beacon not in self._estimates:
            self._estimates[beacon] = self.heard[beacon].estimate()
        return self._estimates[beacon]

    def logs(self) -> Floats:
        """Log weights of the cells for a beacon that was not heard yet."""
        return np.asarray(np.maximum(self._missed, FLOOR) + (self._faint if self.settings.faint else 0.0))

    def forget(self, beacon: str) -> None:
        """It is no longer where it was."""
        self.heard.pop(beacon, None)
        self._estimates.pop(beacon, None)

    def _hear(self, ir: IrReading, pose: Pose) -> None:
        name = self.latest = ir.beacon
        axis = wrap(pose.theta + ir.pan + ir.offset)
        if self._contradicts(name, axis, pose):
            self.forget(name)
        if name not in self.heard:
            self.heard[name] = BearingRange(pose, axis)
            self._faint = np.zeros_like(self._faint)
            self._against[name] = 0
        self.heard[name].hear(pose, ir.pan, ir.offset, ir.strength, self.settings.model)
        self._estimates.pop(name, None)

    def _contradicts(self, name: str, axis: float, pose: Pose) -> bool:
        at = self.estimate(name)
        if at is None:
            return False
        away = math.hypot(at.x - pose.x, at.y - pose.y)
        error = wrap(math.atan2(at.y - pose.y, at.x - pose.x) - axis)
        allowed = max(self.settings.moved, math.atan2(3 * at.spread, away))
        self._against[name] = self._against[name] + 1 if abs(error) > allowed else 0
        return self._against[name] >= self.settings.lost_after

    def _miss(self, ir: IrReading, pose: Pose) -> None:
        model = self.settings.model
        self._missed = self._missed + missed(self.cells, pose, ir.pan, model)
        if self.settings.faint and not self._is_drowned(ir, pose):
            self._faint = self._faint + faintly(self.cells, pose, ir.pan, ir.strength, model)

    def _is_drowned(self, ir: IrReading, pose: Pose) -> bool:
        """Whether a beacon that is known already makes this signal."""
        return any(self._signal_of(name, ir, pose) > self.settings.drowns for name in self.heard)

    def _signal_of(self, name: str, ir: IrReading, pose: Pose) -> float:
        at = self.estimate(name)
        if at is None:
            return 0.0
        away = math.hypot(at.x - pose.x, at.y - pose.y)
        offset = wrap(math.atan2(at.y - pose.y, at.x - pose.x) - pose.theta - ir.pan)
        return float(expected(np.array(away), np.array(offset), self.settings.model))
