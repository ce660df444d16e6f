"""The search for the direction of the beacon, and that direction.

Takes: IR fixations, and the reports of the two competences that sweep the head. Gives: how far the search is, where to
look next, the direction once found, and why there is none. Leaves alone: moving the head; whether the direction still
holds. A search whose competences lose their turn is dropped: the next one starts from scratch.

With `roam` a search first listens all round in wide steps, turns to what it has heard, and sweeps only there.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Literal

from behaviours.cores.beacon import BeaconModel, range_by_strength, suspects_sun
from behaviours.cores.crossing import DISAGREE, NO_CHANGE, TOO_FEW, Crossing, CrossingSettings, crossing
from behaviours.interface import Channels, Head, IrReading, Pose, Reading, Report, wrap

Phase = Literal["idle", "running", "done"]
START, CONTINUE = "start-ir-search", "continue-ir-search"
SILENT = "the reader does not answer"


@dataclass(frozen=True, slots=True)
class IrSettings:
    """Angles [rad], time [s], gain [1/s], turn rate [rad/s]; misses: fixations without an answer that end the search.

    A head that reaches only to the sides cannot find what is behind: after `turn_after` sweeps in a row without a
    beacon, and again after as many, the robot first turns by `turn`, so that three sweeps cover the circle.
    roam: listen all round in steps of `listen_step` and then sweep `fine_sweep` to either side of what was heard.
    """

    sweep: float = math.radians(90.0)
    step: float = math.radians(2.0)
    pan_tolerance: float = math.radians(0.5)
    fixation_timeout: float = 15.0
    misses: int = 3
    turn_after: int = 2
    turn: float = math.radians(120.0)
    turn_tolerance: float = math.radians(3.0)
    steering_gain: float = 1.5
    max_turn_rate: float = 0.8
    listen_step: float = math.radians(15.0)
    fine_sweep: float = math.radians(16.0)
    crossing: CrossingSettings = field(default_factory=CrossingSettings)
    beacon: BeaconModel = field(default_factory=BeaconModel)
    roam: bool = False

    def angles(self) -> tuple[float, ...]:
        """Pan angles [rad] from right to left."""
        return across(self.sweep, self.step)

    def circle(self) -> tuple[float, ...]:
        """Pan angles [rad] all round, from right to left, none twice."""
        count = max(1, round(math.tau / self.listen_step))
        return tuple(-math.pi + (i + 0.5) * math.tau / count for i in range(count))


def across(half: float, step: float) -> tuple[float, ...]:
    """Angles [rad] from -half to half."""
    return tuple(-half + i * step for i in range(round(2 * half / step) + 1))


@dataclass(frozen=True, slots=True)
class Direction:
    """bearing [rad] of the beacon and the place it was taken from, in the odometry frame; error [rad]: standard error.

    beacon: its name; reach [m]: how far it is by the strength of its signal, NaN where that tells nothing.
    """

    place: Pose
    bearing: float
    beacon: str = ""
    reach: float = math.nan
    error: float = math.nan


class IrSearch:
    """One sweep of the head over the beacon, fixation by fixation. wants: which beacons it looks for, by name."""

    def __init__(self, settings: IrSettings) -> None:
        self.settings = settings
        self.phase: Phase = "idle"
        self.direction: Direction | None = None
        self.reason = ""
        self.suspects_sun = False
        self.wants: Callable[[str], bool] = lambda beacon: True
        self._failures = 0
        self._facing: float | None = None
        self._restart(0.0)

    def update(self, reading: Reading, reports: Mapping[str, Report], channels: Channels) -> None:
        if START in reports:
            self._face(reading.odometry.pose.theta)
            self.phase = "running"
            self.direction = None
            self._restart(reading.stamp)
        elif self.phase == "running" and CONTINUE not in reports:
            self.forget()
        if self.phase == "running" and self._is_facing(reading):
            self._take(reading)

    def forget(self) -> None:
        """Drop the search and its result."""
        self.phase = "idle"
        self.direction = None

    def is_running(self) -> bool:
        """Whether a sweep is going on."""
        return self.phase == "running"

    def is_finished(self) -> bool:
        """Whether the last sweep came to its end."""
        return self.phase == "done"

    def is_no_good(self) -> bool:
        """Whether it came to its end without a direction."""
        return self.phase == "done" and self.direction is None

    def failed_by(self, reason: str) -> bool:
        """Whether it came to its end without a direction for this reason."""
        return self.is_no_good() and self.reason == reason

    def failed_by_sun(self) -> bool:
        """Whether it came to its end without a direction and the sun may be to blame."""
        return self.is_no_good() and self.suspects_sun

    def knows_direction(self) -> bool:
        """Whether a direction is known and was not invalidated since."""
        return self.direction is not None

    def first_look(self, reading: Reading) -> Head:
        """Where a search begins."""
        return Head(self._first_angles()[0], 0.0)

    def look(self, reading: Reading) -> Head:
        """Where to look now."""
        return Head(self._angles[min(self._index, len(self._angles) - 1)], 0.0)

    def turn_rate(self, reading: Reading) -> float:
        """How to turn [rad/s], left positive, before the sweep."""
        if self._facing is None:
            return 0.0
        limit = self.settings.max_turn_rate
        wanted = self.settings.steering_gain * wrap(self._facing - reading.odometry.pose.theta)
        return min(limit, max(-limit, wanted))

    def progress(self) -> dict[str, object]:
        """For reports."""
        return {"fixation": self._index, "of": len(self._angles), "heard": len(self._heard)}

    def last_result(self) -> dict[str, object]:
        """How the search before came to its end, for the report of the next."""
        return {"failed": self.reason, "sun_suspected": self.suspects_sun} if self.is_no_good() else {}

    def _first_angles(self) -> tuple[float, ...]:
        return self.settings.circle() if self.settings.roam else self.settings.angles()

    def _restart(self, stamp: float) -> None:
        self._listening = self.settings.roam
        self._beacon = ""
        self._strengths: list[float] = []
        self._sweep(self._first_angles(), stamp)

    def _sweep(self, angles: tuple[float, ...], stamp: float) -> None:
        self._angles = angles
        self._index = 0
        self._since = stamp
        self._misses = 0
        self._heard: list[IrReading] = []

    def _face(self, heading: float) -> None:
        """Turn away first, if sweeps this way have failed often enough."""
        in_vain = self._failures > 0 and self._failures % self.settings.turn_after == 0
        turn = in_vain and self.is_no_good() and not self.settings.roam
        self._facing = wrap(heading + self.settings.turn) if turn else None

    def _is_facing(self, reading: Reading) -> bool:
        if self._facing is None:
            return True
        self._since = reading.stamp
        if abs(wrap(self._facing - reading.odometry.pose.theta)) <= self.settings.turn_tolerance:
            self._facing = None
        return False

    def _take(self, reading: Reading) -> None:
        ir = reading.ir
        target = self._angles[self._index]
        if ir is not None and ir.fresh and abs(wrap(ir.pan - target)) <= self.settings.pan_tolerance:
            self._strengths.append(ir.strength)
            if self._counts(ir):
                self._heard.append(ir)
            self._advance(reading)
        elif reading.stamp - self._since > self.settings.fixation_timeout:
            self._misses += 1
            self._advance(reading)

    def _counts(self, ir: IrReading) -> bool:
        if not (ir.detected and math.isfinite(ir.offset)):
            return False
        return self.wants(ir.beacon) if self._listening or not self._beacon else ir.beacon == self._beacon

    def _advance(self, reading: Reading) -> None:
        self._index += 1
        self._since = reading.stamp
        if self._misses >= self.settings.misses:
            self._finish(Crossing(math.nan, SILENT), reading.odometry.pose)
        elif self._index == len(self._angles) and self._listening and self._heard:
            self._turn_to(max(self._heard, key=lambda ir: ir.strength), reading)
        elif self._index == len(self._angles):
            heard = [(ir.pan, ir.offset) for ir in self._heard]
            self._finish(crossing(heard, self.settings.crossing), reading.odometry.pose)

    def _turn_to(self, ir: IrReading, reading: Reading) -> None:
        """Sweep about the strongest beacon, having turned to it."""
        self._listening = False
        self._beacon = ir.beacon
        self._facing = wrap(reading.odometry.pose.theta + ir.pan + ir.offset)
        self._sweep(across(self.settings.fine_sweep, self.settings.step), reading.stamp)

    def _finish(self, found: Crossing, pose: Pose) -> None:
        self.phase = "done"
        self.reason = found.reason
        self.suspects_sun = found.reason in (TOO_FEW, NO_CHANGE) and suspects_sun(self._strengths, self.settings.beacon)
        self._failures = 0 if found.reason in ("", DISAGREE) else self._failures + 1
        if not found.reason:
            reach = range_by_strength([(ir.offset, ir.strength) for ir in self._heard], self.settings.beacon)
            bearing = wrap(pose.theta + found.bearing)
            self.direction = Direction(pose, bearing, self._heard[-1].beacon, reach, found.error)
