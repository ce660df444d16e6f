"""Where the goal lies from here, by the believed pose.

Takes: localisation, and a goal in the frame of odometry, as all goals of plans are: x ahead of the start, y to its
left. Gives: the heading to it in the map frame, and the distance. Leaves alone: what stands between.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

from behaviours.estimators.localisation import Localisation
from behaviours.estimators.navigation import as_goal
from behaviours.interface import Channels, Pose, Reading, Report, wrap


class GoalHeading:
    """The goal of the channel `goal`."""

    def __init__(self, place: Localisation) -> None:
        self._place = place
        self._start = 0.0
        self._last: Pose | None = None

    def update(self, reading: Reading, reports: Mapping[str, Report], channels: Channels) -> None:
        self._start = wrap(self._place.odometry.theta - reading.odometry.pose.theta)
        self._last = as_goal(channels)

    def heading(self, channels: Channels) -> float | None:
        """[rad, map frame]; None without a goal."""
        goal = as_goal(channels)
        if goal is None:
            return None
        x, y = self._offset(goal)
        return math.atan2(y, x)

    def distance(self) -> float:
        """[m] to the goal of the last tick; 0 without one."""
        return 0.0 if self._last is None else math.hypot(*self._offset(self._last))

    def _offset(self, goal: Pose) -> tuple[float, float]:
        """From the robot to the goal [m], map frame."""
        c, s = math.cos(self._start), math.sin(self._start)
        at = self._place.pose
        return c * goal.x - s * goal.y - at.x, s * goal.x + c * goal.y - at.y
