"""Going to the goal by navigation templates.

Takes: the channel `goal`, a plan among the obstacles, the ring, what moves. Gives: drive, a head that looks where the
goal pose looks, and the plan for inspection. Leaves alone: what is remembered of obstacles, when the goal is reached.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from behaviours.cores.collision import GateSettings, Moving, gate
from behaviours.cores.geometry import along, bearing
from behaviours.cores.nat import Group, NatPlan, NatSettings, drive
from behaviours.cores.sectors import RingOf, waist
from behaviours.interface import STOP, Channels, Command, Drive, Head, Pose, Ranges, Reading, Report, Vec2, wrap


@dataclass(frozen=True, slots=True)
class GazeSettings:
    """beyond [m]: how far past the goal the head looks; angles [rad]: least step of the pan, and its limit."""

    gaze_beyond: float = 1.0
    pan_step: float = math.radians(5.0)
    pan_limit: float = math.radians(90.0)


@dataclass(frozen=True, slots=True)
class Traffic:
    """What moves: points with velocities at a stamp [s], and the velocities of circles."""

    points: Callable[[float], list[Moving]]
    velocities: Callable[[], Mapping[int, Vec2]]
    gate: GateSettings


class Natigate:
    """plan_to: the plan for (pose, goal, stamp [s]). traffic: what moves; None heeds nothing but the ranges.

    The head looks at a point beyond the goal, in the direction of the goal pose, and is moved only by steps: a head
    that follows every turn never settles, and then no beacon is read.
    """

    def __init__(
        self,
        plan_to: Callable[[Pose, Pose, float], NatPlan],
        settings: NatSettings,
        gaze: GazeSettings,
        ring_of: RingOf = waist,
        traffic: Traffic | None = None,
    ) -> None:
        self._plan_to, self._ring_of, self._traffic = plan_to, ring_of, traffic
        self._settings = settings
        self._gaze_settings = gaze
        self._pan: float | None = None
        self._given_way = math.inf
        self._told: tuple[NatPlan, Mapping[str, object]] | None = None

    def start(self, reading: Reading, channels: Channels) -> None:
        self._pan, self._given_way = None, math.inf

    def step(self, reading: Reading, channels: Channels) -> tuple[Command, Report]:
        goal = channels.get("goal")
        if not isinstance(goal, Pose):
            return STOP, Report("failed", {"reason": "there is no goal"})
        pose = reading.odometry.pose
        plan = self._plan_to(pose, goal, reading.stamp)
        error = wrap(plan.heading - pose.theta)
        ring = self._ring_of(reading)
        nearest = math.inf if ring is None else nearest_within(ring, error, self._settings.minds)
        speed, turn_rate = drive(error, nearest, self._settings)
        if self._traffic is not None:
            speed = self._give_way(pose, speed, ring, self._traffic.points(reading.stamp))
        return Command(Drive(speed, turn_rate), self._look_at(pose, goal)), Report(details=self._tell(plan))

    def stop(self) -> None:
        self._pan, self._given_way = None, math.inf

    def _give_way(self, pose: Pose, speed: float, ring: Ranges | None, moving: list[Moving]) -> float:
        """The speed that does not meet what moves; never backwards into what stands."""
        assert self._traffic is not None
        s = self._settings
        gates = self._traffic.gate
        chosen = gate(pose, speed, s.max_speed, s.robot_width / 2, moving, gates, self._given_way)
        self._given_way = chosen if chosen < speed else math.inf
        return 0.0 if chosen < 0.0 and ring is not None and behind(ring) < s.clearance + s.stop_distance else chosen

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
            self._told = (plan, as_details(plan, self._traffic.velocities() if self._traffic is not None else {}))
        return self._told[1]


def nearest_within(ring: Ranges, direction: float, half: float) -> float:
    """The nearest range [m] up to `half` [rad] to either side of a direction [rad, robot frame]."""
    if half >= math.pi:
        return float(np.nanmin(ring.ranges, initial=math.inf))
    aside = np.abs(np.remainder(ring.bearings - direction + math.pi, math.tau) - math.pi)
    return float(np.nanmin(ring.ranges[aside <= half], initial=math.inf))


def behind(ring: Ranges) -> float:
    """The nearest range [m] in the quarter turn behind the robot."""
    back = np.abs(ring.bearings) >= math.pi * 3 / 4 - 1e-9
    return float(np.nanmin(ring.ranges[back], initial=math.inf))


def as_details(plan: NatPlan, velocities: Mapping[int, Vec2]) -> dict[str, object]:
    """Circles [x, y, radius, group], groups, interval, heading, goal: odometry frame, [m] to the cm.

    left, right, interval [rad] are relative to the direction of the goal, heading [rad] is not; a circle of no
    group (it lies beyond the goal) has group -1. A group that moves has a velocity [m/s, odometry frame].
    velocities: of circles.
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
                **_velocity(g, velocities),
            }
            for g in plan.groups
        ],
        "interval": [round(plan.interval[0], 3), round(plan.interval[1], 3)],
        "heading": round(plan.heading, 3),
        "goal": [round(plan.goal.x, 2), round(plan.goal.y, 2)],
    }


def _velocity(group: Group, velocities: Mapping[int, Vec2]) -> dict[str, object]:
    """The mean over its circles that move."""
    known = [velocities[ident] for ident in group.idents if ident in velocities]
    if not known:
        return {}
    return {"velocity": [round(sum(v[axis] for v in known) / len(known), 2) for axis in (0, 1)]}
