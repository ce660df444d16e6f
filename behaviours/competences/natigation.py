"""Going to the goal by navigation templates.

Takes: the channel `goal`, a plan among the obstacles, the waist ring. Gives: drive, a head that looks where the goal
pose looks, and the plan for inspection. Leaves alone: what is remembered of obstacles, and when the goal is reached.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from behaviours.cores.geometry import along, bearing
from behaviours.cores.nat import NatPlan, NatSettings, drive
from behaviours.interface import STOP, Channels, Command, Drive, Head, Pose, Reading, Report, wrap


@dataclass(frozen=True, slots=True)
class GazeSettings:
    """beyond [m]: how far past the goal the head looks; angles [rad]: least step of the pan, and its limit."""

    gaze_beyond: float = 1.0
    pan_step: float = math.radians(5.0)
    pan_limit: float = math.radians(90.0)


class Natigate:
    """plan_to: the plan for (pose, goal, stamp [s]).

    The head looks at a point beyond the goal, in the direction of the goal pose, and is moved only by steps: a head
    that follows every turn never settles, and then no beacon is read.
    """

    def __init__(
        self, plan_to: Callable[[Pose, Pose, float], NatPlan], settings: NatSettings, gaze: GazeSettings
    ) -> None:
        self._plan_to = plan_to
        self._settings = settings
        self._gaze_settings = gaze
        self._pan: float | None = None
        self._told: tuple[NatPlan, Mapping[str, object]] | None = None

    def start(self, reading: Reading, channels: Channels) -> None:
        self._pan = None

    def step(self, reading: Reading, channels: Channels) -> tuple[Command, Report]:
        goal = channels.get("goal")
        if not isinstance(goal, Pose):
            return STOP, Report("failed", {"reason": "there is no goal"})
        pose = reading.odometry.pose
        plan = self._plan_to(pose, goal, reading.stamp)
        error = wrap(plan.heading - pose.theta)
        nearest = math.inf if reading.sonar is None else float(reading.sonar.ranges.min())
        speed, turn_rate = drive(error, nearest, self._settings)
        return Command(Drive(speed, turn_rate), self._look_at(pose, goal)), Report(details=self._tell(plan))

    def stop(self) -> None:
        self._pan = None

    def _look_at(self, pose: Pose, goal: Pose) -> Head:
        s = self._gaze_settings
        pan = wrap(bearing(pose, along(goal, goal.theta, s.gaze_beyond)) - pose.theta)
        pan = min(s.pan_limit, max(-s.pan_limit, pan))
        if self._pan is None or abs(pan - self._pan) > s.pan_step:
            self._pan = pan
        return Head(self._pan, 0.0)

    def _tell(self, plan: NatPlan) -> Mapping[str, object]:
        """The plan as plain values; the same object as long as it is the same plan."""
        if self._told is None or self._told[0] is not plan:
            self._told = (plan, as_details(plan))
        return self._told[1]


def as_details(plan: NatPlan) -> dict[str, object]:
    """Circles [x, y, radius, group], groups, interval, heading, goal: odometry frame, [m] to the cm.

    left, right, interval [rad] are relative to the direction of the goal, heading [rad] is not; a circle of no
    group (it lies beyond the goal) has group -1.
    """
    group_of = {ident: at for at, group in enumerate(plan.groups) for ident in group.idents}
    return {
        "circles": [
            [round(c.x, 2), round(c.y, 2), round(c.radius, 2), group_of.get(c.ident, -1)] for c in plan.circles
        ],
        "groups": [
            {
                "spin": g.spin,
                "left": round(g.left, 3),
                "right": round(g.right, 3),
                "distance": round(g.distance, 2),
                "heeded": g.heeded,
            }
            for g in plan.groups
        ],
        "interval": [round(plan.interval[0], 3), round(plan.interval[1], 3)],
        "heading": round(plan.heading, 3),
        "goal": [round(plan.goal.x, 2), round(plan.goal.y, 2)],
    }
