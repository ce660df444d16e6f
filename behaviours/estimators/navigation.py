"""Where the robot is to go, and whether it is there.

Takes: the `goal` channel of the last tick, odometry, the ring. Gives: the goal and arrival.
Leaves alone: the way.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from behaviours.cores.geometry import bearing, distance
from behaviours.cores.sectors import RingOf, waist
from behaviours.interface import Channels, Pose, Ranges, Reading, Report, wrap


@dataclass(frozen=True, slots=True)
class ArrivalSettings:
    """Lengths [m], angle [rad].

    The robot has arrived within `arrival` of the goal, or within `goal_tolerance` of it with something closer than
    `stand_off` to the hull, up to `stand_off_angle` to either side of the direction of the goal. It stays arrived up
    to `goal_tolerance` + `leave`.
    """

    goal_tolerance: float = 1.5 * 0.3048
    arrival: float = 0.15
    leave: float = 0.15
    stand_off: float = 0.32
    stand_off_angle: float = math.radians(90.0)
    same_goal: float = 0.1


class NavigationGoal:
    """The goal of the last tick, and arrival with hysteresis."""

    def __init__(self, settings: ArrivalSettings, ring_of: RingOf = waist) -> None:
        self.settings = settings
        self._ring_of = ring_of
        self.goal: Pose | None = None
        self.is_reached = False

    def update(self, reading: Reading, reports: Mapping[str, Report], channels: Channels) -> None:
        goal = as_goal(channels)
        if goal is None or self.goal is None or distance(goal, self.goal) > self.settings.same_goal:
            self.is_reached = False
        self.goal = goal
        if goal is not None:
            self.is_reached = self._is_reached(reading, goal)

    def exists(self) -> bool:
        """Whether there is a goal."""
        return self.goal is not None

    def _is_reached(self, reading: Reading, goal: Pose) -> bool:
        s = self.settings
        pose = reading.odometry.pose
        away = distance(pose, goal)
        if self.is_reached:
            return away <= s.goal_tolerance + s.leave
        if away <= s.arrival:
            return True
        return away <= s.goal_tolerance and self._is_blocked(
            self._ring_of(reading), wrap(bearing(pose, goal) - pose.theta)
        )

    def _is_blocked(self, ring: Ranges | None, direction: float) -> bool:
        if ring is None:
            return False
        s = self.settings
        return any(
            r < s.stand_off and abs(wrap(b - direction)) <= s.stand_off_angle
            for r, b in zip(ring.ranges.tolist(), ring.bearings.tolist(), strict=True)
        )


def as_goal(channels: Channels) -> Pose | None:
    """The pose on the channel `goal`; None where there is none."""
    goal = channels.get("goal")
    return goal if isinstance(goal, Pose) else None
