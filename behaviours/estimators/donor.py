"""Where the donor is, for as long as that can be believed.

Takes: the direction of the IR search, the range of the stereo search, later IR readings. Gives: where the donor stands
and where to dock. Leaves alone: searching; it makes both searches forget when the donor is not where it was.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from behaviours.cores.geometry import along, bearing, distance
from behaviours.estimators.ir_search import IrSearch
from behaviours.estimators.navigation import NavigationGoal
from behaviours.estimators.stereo_search import StereoSearch
from behaviours.interface import Channels, IrReading, Pose, Reading, Report, wrap


@dataclass(frozen=True, slots=True)
class DonorSettings:
    """Lengths [m], angles [rad], times [s], rates [rad/s]; readings, attempts: counts."""

    docking_distance: float = 0.65
    patience: float = 40.0
    moved_angle: float = math.radians(5.0)
    moved_distance: float = 0.4
    moved_readings: int = 3
    watch_beyond: float = 1.5
    watch_turn_rate: float = 0.1
    direction_holds_within: float = 0.25
    stereo_attempts: int = 2


class DonorMemory:
    """The donor's place in the odometry frame. why_forgotten: why the last one was dropped."""

    def __init__(self, settings: DonorSettings, ir: IrSearch, stereo: StereoSearch, goal: NavigationGoal) -> None:
        self.settings = settings
        self.front: Pose | None = None
        self.why_forgotten = ""
        self._ir, self._stereo, self._goal = ir, stereo, goal
        self._errors: tuple[float, ...] = ()
        self._standing_since: float | None = None
        self._failures = 0
        self._had_failed = False

    def update(self, reading: Reading, reports: Mapping[str, Report], channels: Channels) -> None:
        self._locate()
        self._count_failures()
        reason = "" if reading.object_on_board else self._doubt(reading)
        if reason:
            self.why_forgotten = reason
            self._forget()

    def is_located(self) -> bool:
        """Whether the donor's place is known."""
        return self.front is not None

    def docking_pose(self) -> Pose | None:
        """Where to stand before the donor, looking at it; None while it is not located."""
        return None if self.front is None else along(self.front, self.front.theta, -self.settings.docking_distance)

    def _locate(self) -> None:
        found, direction = self._stereo.found, self._ir.direction
        if self.front is None and found is not None:
            self.front = along(found.place, found.bearing if direction is None else direction.bearing, found.ground)
            self._errors = ()

    def _count_failures(self) -> None:
        failed = self._stereo.is_no_good()
        self._failures += failed and not self._had_failed
        self._had_failed = failed
        if self.front is not None or not self._ir.knows_direction():
            self._failures = 0

    def _forget(self) -> None:
        self.front = None
        self._errors = ()
        self._standing_since = None
        self._ir.forget()
        self._stereo.forget()

    def _doubt(self, reading: Reading) -> str:
        """Why what is known must not be believed any longer; "" if it may."""
        if self._has_moved(reading):
            return "the donor has moved"
        if self._waits_in_vain(reading):
            return "the donor does not answer"
        if self.front is None and self._is_displaced(reading.odometry.pose):
            return "the robot was driven off before it knew the range"
        if self._failures >= self.settings.stereo_attempts and not self._stereo.is_no_good():
            return "nothing stands in that direction"
        return ""

    def _is_displaced(self, pose: Pose) -> bool:
        direction = self._ir.direction
        return direction is not None and distance(direction.place, pose) > self.settings.direction_holds_within

    def _has_moved(self, reading: Reading) -> bool:
        ir = reading.ir
        if ir is None or not (ir.fresh and ir.detected and math.isfinite(ir.offset)):
            return False
        tolerance = self._tolerance(reading)
        if math.isinf(tolerance):
            self._errors = ()
            return False
        self._errors = (*self._errors, self._error(reading.odometry.pose, ir))[-self.settings.moved_readings :]
        low, high = min(self._errors), max(self._errors)
        return len(self._errors) == self.settings.moved_readings and (low > tolerance or high < -tolerance)

    def _tolerance(self, reading: Reading) -> float:
        """How much [rad] a bearing may differ from the predicted one; infinite where it tells nothing."""
        s = self.settings
        turning = abs(reading.odometry.turn_rate) > s.watch_turn_rate
        if turning or (self.front is None and not self._ir.knows_direction()):
            return math.inf
        if self.front is None:
            return s.moved_angle
        away = distance(reading.odometry.pose, self.front)
        return math.inf if away < s.watch_beyond else max(s.moved_angle, math.atan2(s.moved_distance, away))

    def _error(self, pose: Pose, ir: IrReading) -> float:
        direction = self._ir.direction
        if self.front is not None:
            predicted = bearing(pose, self.front)
        else:
            predicted = pose.theta if direction is None else direction.bearing
        return wrap(pose.theta + ir.pan + ir.offset - predicted)

    def _waits_in_vain(self, reading: Reading) -> bool:
        dock, goal = self.docking_pose(), self._goal.goal
        waiting = dock is not None and goal is not None and self._goal.is_reached and distance(dock, goal) < 0.01
        if not waiting:
            self._standing_since = None
        elif self._standing_since is None:
            self._standing_since = reading.stamp
        return self._standing_since is not None and reading.stamp - self._standing_since > self.settings.patience
