"""The search for the direction of the beacon, and that direction.

Takes: IR fixations, and the reports of the two competences that sweep the head. Gives: how far the search is, where to
look next, the direction once found. Leaves alone: moving the head; whether the direction still holds.
A search whose competences lose their turn is dropped: the next one starts from scratch.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from behaviours.cores.crossing import DISAGREE, Crossing, CrossingSettings, crossing
from behaviours.interface import Channels, Head, Pose, Reading, Report, wrap

Phase = Literal["idle", "running", "done"]
START, CONTINUE = "start-ir-search", "continue-ir-search"


@dataclass(frozen=True, slots=True)
class IrSettings:
    """Angles [rad], time [s], gain [1/s], turn rate [rad/s]; misses: fixations without an answer that end the search.

    A head that reaches only to the sides cannot find what is behind: after `turn_after` sweeps in a row without a
    beacon, and again after as many, the robot first turns by `turn`, so that three sweeps cover the circle.
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
    crossing: CrossingSettings = field(default_factory=CrossingSettings)

    def angles(self) -> tuple[float, ...]:
        """Pan angles [rad] from right to left."""
        count = round(2 * self.sweep / self.step)
        return tuple(-self.sweep + i * self.step for i in range(count + 1))


@dataclass(frozen=True, slots=True)
class Direction:
    """bearing [rad] of the beacon and the place it was taken from, in the odometry frame."""

    place: Pose
    bearing: float


class IrSearch:
    """One sweep of the head over the beacon, fixation by fixation."""

    def __init__(self, settings: IrSettings) -> None:
        self.settings = settings
        self.phase: Phase = "idle"
        self.direction: Direction | None = None
        self.reason = ""
        self._angles = settings.angles()
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

    def knows_direction(self) -> bool:
        """Whether a direction is known and was not invalidated since."""
        return self.direction is not None

    def first_look(self, reading: Reading) -> Head:
        """Where a search begins."""
        return Head(self._angles[0], 0.0)

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

    def _restart(self, stamp: float) -> None:
        self._index = 0
        self._since = stamp
        self._misses = 0
        self._heard: list[tuple[float, float]] = []

    def _face(self, heading: float) -> None:
        """Turn away first, if sweeps this way have failed often enough."""
        in_vain = self._failures > 0 and self._failures % self.settings.turn_after == 0
        self._facing = wrap(heading + self.settings.turn) if in_vain and self.is_no_good() else None

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
            if ir.detected and math.isfinite(ir.offset):
                self._heard.append((ir.pan, ir.offset))
            self._advance(reading)
        elif reading.stamp - self._since > self.settings.fixation_timeout:
            self._misses += 1
            self._advance(reading)

    def _advance(self, reading: Reading) -> None:
        self._index += 1
        self._since = reading.stamp
        if self._misses >= self.settings.misses:
            self._finish(Crossing(math.nan, "the reader does not answer"), reading.odometry.pose)
        elif self._index == len(self._angles):
            self._finish(crossing(self._heard, self.settings.crossing), reading.odometry.pose)

    def _finish(self, found: Crossing, pose: Pose) -> None:
        self.phase = "done"
        self.reason = found.reason
        self._failures = 0 if found.reason in ("", DISAGREE) else self._failures + 1
        if not found.reason:
            self.direction = Direction(pose, wrap(pose.theta + found.bearing))
