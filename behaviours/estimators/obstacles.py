"""Obstacles around the robot, and the side on which each is passed.

Takes: every fresh sweep of the ring, odometry, last tick's `goal`. Gives: circles, and the plan towards a goal.
Leaves alone: driving. It goes on whoever drives, so that a plan survives a tick of running away.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from behaviours.cores.circles import Circles, CircleSettings
from behaviours.cores.commitment import CommitmentSettings, Locks, commit, inherit, turned, were_reversed
from behaviours.cores.geometry import distance
from behaviours.cores.nat import Memory, NatPlan, NatSettings, contradicted, make_plan, opposite
from behaviours.cores.sectors import RingOf, waist
from behaviours.estimators.navigation import as_goal
from behaviours.estimators.perception import Perception, PerceptionSettings
from behaviours.estimators.places import Places
from behaviours.interface import Channels, Pose, Reading, Report


@dataclass(frozen=True, slots=True)
class DeadlockSettings:
    """A robot that has not left a circle of `progress` [m] within `patience` [s] of driving passes a group on the other
    side, and keeps to that for `lock` [s]. A goal that jumps by more than `new_goal` [m] is planned for anew."""

    progress: float = 0.3
    patience: float = 15.0
    lock: float = 10.0
    new_goal: float = 0.5


class Obstacles:
    """The circles, and the latest plan among them.

    driver: the competence whose lack of progress counts. commitment: None flips spins as the paper does. places: None
    plans for the goal alone.
    """

    def __init__(
        self,
        circles: CircleSettings,
        nat: NatSettings,
        deadlock: DeadlockSettings,
        driver: str,
        perception: PerceptionSettings | None = None,
        commitment: CommitmentSettings | None = None,
        ring_of: RingOf = waist,
        places: Places | None = None,
    ) -> None:
        self._nat, self._deadlock, self._commitment, self._ring_of = nat, deadlock, commitment, ring_of
        self.perception = Perception(circles, perception or PerceptionSettings())
        self.plan: NatPlan | None = None
        self._spins: Memory = {}
        self._locks: Locks = {}
        self._driver = driver
        self.places = places
        self._wanted: Pose | None = None
        self._aim: Pose | None = None
        self._since: tuple[float, Pose] | None = None

    @property
    def memory(self) -> Circles:
        """The circles that forget."""
        return self.perception.memory

    def update(self, reading: Reading, reports: Mapping[str, Report], channels: Channels) -> None:
        pose = reading.odometry.pose
        ring = self._ring_of(reading)
        fresh = ring is not None and ring.fresh
        if ring is not None and fresh:
            self.perception.take(ring, pose, reading.stamp)
        goal = as_goal(channels)
        if fresh or goal != self._wanted:
            self._wanted, self._aim = goal, self._aim_for(pose, goal, reading.stamp)
        if self._aim is None:
            self._forget_plan()
        elif fresh or self.plan is None or self.plan.goal != self._aim:
            self._replan(pose, self._aim, reading.stamp)
        self._mind_progress(reading, self._driver in reports and goal is not None)

    def plan_to(self, pose: Pose, goal: Pose, now: float) -> NatPlan:
        """The plan from the robot to the goal at stamp now [s]: the latest one if that is its goal."""
        if goal == self._wanted and self._aim is not None:
            goal = self._aim
        if self.plan is not None and self.plan.goal == goal:
            return self.plan
        return self._make(pose, goal, now)

    def _aim_for(self, pose: Pose, goal: Pose | None, now: float) -> Pose | None:
        """What to plan for: the goal, or a way out of a dead end."""
        return goal if self.places is None else self.places.aim(pose, goal, self.perception.circles, now)

    def _make(self, pose: Pose, goal: Pose, now: float) -> NatPlan:
        same = self.plan is not None and distance(self.plan.goal, goal) <= self._deadlock.new_goal
        before = self.plan.grouping if self.plan is not None else {}
        spins = self._spins if same else {}
        return make_plan(self.perception.circles, pose, goal, before, spins, now, self._nat)

    def _replan(self, pose: Pose, goal: Pose, now: float) -> None:
        if self.plan is not None and distance(self.plan.goal, goal) > self._deadlock.new_goal:
            self._locks = {}
        self.plan = self._make(pose, goal, now)
        self._spins = self.plan.spins()
        if self._commitment is not None:
            moving = self.perception.velocities()
            before = self._locks
            self._locks = commit(self.plan, before, distance(pose, goal), moving, self._commitment)
            if self.places is not None and goal == self._wanted and were_reversed(before, self._locks):
                self.places.dead_end(pose)
            self._spins = inherit(self._spins, self._locks)

    def _forget_plan(self) -> None:
        self.plan = None
        self._spins, self._locks = {}, {}

    def _mind_progress(self, reading: Reading, driving: bool) -> None:
        pose = reading.odometry.pose
        if not driving:
            self._since = None
        elif self._since is None or distance(self._since[1], pose) > self._deadlock.progress:
            self._since = (reading.stamp, pose)
        elif reading.stamp - self._since[0] > self._deadlock.patience:
            self._since = (reading.stamp, pose)
            self._turn_about(reading)

    def _turn_about(self, reading: Reading) -> None:
        group = contradicted(self.plan, self._nat) if self.plan is not None else None
        if self.places is not None:
            self.places.dead_end(reading.odometry.pose)
        if self.plan is None or group is None:
            return
        pose, goal = reading.odometry.pose, self.plan.goal
        if self._commitment is not None:
            self._locks = turned(group, self._locks, distance(pose, goal), self._commitment)
            self._spins = inherit(self._spins, self._locks)
        else:
            locked = (opposite(group.spin), reading.stamp + self._deadlock.lock)
            self._spins = {**self._spins, **dict.fromkeys(group.idents, locked)}
        self._replan(pose, goal, reading.stamp)
