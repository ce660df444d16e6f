"""Where the donor is, for as long as that can be believed.

Takes: the direction of the IR search, the range of the stereo search, later IR readings. Gives: where the donor stands
and where to dock. Leaves alone: searching; it makes both searches forget when the donor is not where it was.

With `several` it keeps donors apart by the names of their beacons, counts what each has handed over, and turns to the
next one when a donor has nothing left.
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
    """Lengths [m], angles [rad], times [s], rates [rad/s]; readings, attempts, donors, trips: counts.

    several: donors are told apart; `donors` of them hand over `trips` objects each.
    """

    docking_distance: float = 0.65
    patience: float = 40.0
    moved_angle: float = math.radians(5.0)
    moved_distance: float = 0.4
    moved_readings: int = 3
    watch_beyond: float = 1.5
    watch_turn_rate: float = 0.1
    direction_holds_within: float = 0.25
    stereo_attempts: int = 2
    donors: int = 1
    trips: int = 1
    several: bool = False


class DonorMemory:
    """The donor's place in the odometry frame. why_forgotten: why the last one was dropped.

    name: of the beacon of the donor that is located; fronts: places by name, of those that are believed; served: how
    many objects each has handed over.
    """

    def __init__(self, settings: DonorSettings, ir: IrSearch, stereo: StereoSearch, goal: NavigationGoal) -> None:
        self.settings = settings
        self.front: Pose | None = None
        self.why_forgotten = ""
        self.name = ""
        self.fronts: dict[str, Pose] = {}
        self.served: dict[str, int] = {}
        self._on_board = False
        self._ir, self._stereo, self._goal = ir, stereo, goal
        self._errors: tuple[float, ...] = ()
        self._standing_since: float | None = None
        self._failures = 0
        self._had_failed = False
        if settings.several:
            ir.wants = self.wants

    def update(self, reading: Reading, reports: Mapping[str, Report], channels: Channels) -> None:
        self._locate()
        self._count_failures()
        if self.settings.several:
            self._watch_board(reading)
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

    def wants(self, beacon: str) -> bool:
        """Whether the donor with this beacon still has something to hand over."""
        return self.served.get(beacon, 0) < self.settings.trips

    def is_left(self) -> bool:
        """Whether a donor is left from which not everything was fetched."""
        return sum(count >= self.settings.trips for count in self.served.values()) < self.settings.donors

    def _watch_board(self, reading: Reading) -> None:
        """Count what is handed over; once it is unloaded, turn to the nearest donor that is wanted."""
        if reading.object_on_board and not self._on_board and self.front is not None:
            self.served[self.name] = self.served.get(self.name, 0) + 1
        self._on_board = reading.object_on_board
        if self.front is None or self._on_board or self.wants(self.name):
            return
        self.fronts.pop(self.name, None)
        self._forget()
        left = [name for name in self.fronts if self.wants(name)]
        if left:
            self.name = min(left, key=lambda name: distance(reading.odometry.pose, self.fronts[name]))
            self.front = self.fronts[self.name]

    def _locate(self) -> None:
        found, direction = self._stereo.found, self._ir.direction
        if self.front is None and found is not None:
            self.front = along(found.place, found.bearing if direction is None else direction.bearing, found.ground)
            self.name = "" if direction is None else direction.beacon
            self.fronts[self.name] = self.front
            self._errors = ()

    def _count_failures(self) -> None:
        failed = self._stereo.is_no_good()
        self._failures += failed and not self._had_failed
        self._had_failed = failed
        if self.front is not None or not self._ir.knows_direction():
            self._failures = 0

    def _forget(self) -> None:
        if self.front is not None:
            self.fronts.pop(self.name, None)
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
        if not self._is_of(ir.beacon):
            return False
        tolerance = self._tolerance(reading)
        if math.isinf(tolerance):
            self._errors = ()
            return False
        self._errors = (*self._errors, self._error(reading.odometry.pose, ir))[-self.settings.moved_readings :]
        low, high = min(self._errors), max(self._errors)
        return len(self._errors) == self.settings.moved_readings and (low > tolerance or high < -tolerance)

    def _is_of(self, beacon: str) -> bool:
        """Whether a beacon is that of the donor in question."""
        direction = self._ir.direction
        wanted = self.name if self.front is not None else "" if direction is None else direction.beacon
        return beacon == wanted or "" in (beacon, wanted)

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
