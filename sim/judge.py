"""Whether the task was done, how long it took, and what was touched on the way.

Takes: the world after each tick (the truth, not what the robot believes). Gives: the stage now, and a `Verdict`.
Leaves alone: how the robot did it.

Tasks: fetch the donor's object and bring it home; reach the goal; go round a place; or none, then the run lasts until
its time is over. Curbs that the robot's drive can climb are ground: touching one is no contact, and clearance is not
measured from them.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from behaviours.interface import Pose, Vec2, wrap
from sim.raycast import Circle, Outline, Polygon, Rings
from sim.scenarios.layout import distance
from sim.scenarios.scenario import Round
from sim.things.thing import Thing
from sim.world import FAR, Touch, World

Stage = Literal["to the donor", "hand-over", "return", "to the goal", "going round", "touched", "no task", "done"]
Task = Literal["fetch", "reach", "round", "none"]
AT_START = 0.3  # [m] from the start: what counts as not yet gone
ROUNDING = 1e-9  # [rad] that a whole turn may lack
ONE_CONTACT = 1.0  # [s] within which touches of one thing are one contact

PHRASES: dict[Stage, str] = {
    "to the donor": "before it came to the donor",
    "hand-over": "during the hand-over",
    "return": "on the way back",
    "to the goal": "on the way to the goal",
    "going round": "on the way round",
    "touched": "on the way to the goal, which must be reached without a contact",
    "no task": "without a task",
    "done": "when all was done",
}


@dataclass(frozen=True, slots=True)
class Times:
    """Moments [s]; None for what has not happened.

    departure: the last one within 0.3 m of home before arrival; arrival: standing within the donor's reach for the
    first time, at the goal, or back from the way round; loaded: the first object is on board; home: the last one has
    been brought.
    """

    departure: float | None = None
    arrival: float | None = None
    loaded: float | None = None
    home: float | None = None


@dataclass(frozen=True, slots=True)
class Verdict:
    """What is to be said of a run. duration [s]; distance [m] driven; smallest_clearance [m] from the hull, truly.

    deliveries: moments [s] at which an object had been brought home. reason: in words, why it is not done; empty when
    it is. A run without a task is done when its time is over. share: of the way round, as the robot has wound about the
    place in one sense; None where that is not the task.
    """

    task: Task
    done: bool
    reason: str
    stage: Stage
    times: Times
    duration: float
    distance: float
    contacts: tuple[Touch, ...]
    smallest_clearance: float
    deliveries: tuple[float, ...] = ()
    share: float | None = None

    @property
    def one_way(self) -> float | None:
        """From departure to arrival [s]."""
        return _between(self.times.departure, self.times.arrival)

    @property
    def round_trip(self) -> float | None:
        """From departure to home [s]."""
        return _between(self.times.departure, self.times.home)

    @property
    def driven_into(self) -> int:
        """How often the robot drove into something."""
        return sum(touch.driven_into for touch in self.contacts)


def _between(start: float | None, end: float | None) -> float | None:
    return None if start is None or end is None else end - start


class Judge:
    """Watches a run. `observe` is called after each tick of the world."""

    def __init__(self, world: World) -> None:
        self._world = world
        self._place, self._time = world.robot.pose, world.time
        self._departure = 0.0
        self._arrival: float | None = None
        self._loaded: float | None = None
        self._home: float | None = None
        self._distance = 0.0
        self._winding = None if world.scenario.round is None else Winding(world.scenario.round, world.robot.pose)
        self._climbed = tuple(thing for thing in world.things if world.can_climb(thing))
        self._clearance = self._clearance_now(FAR)
        self._contacts: list[Touch] = []
        self._last_touch: dict[str, float] = {}
        self._in_reach = False
        self._failed = False

    @property
    def done(self) -> bool:
        """Whether the task is done."""
        return (self._home if self.task == "fetch" else self._arrival) is not None

    @property
    def over(self) -> bool:
        """Whether nothing more can come of it."""
        return self.done or self._failed

    @property
    def task(self) -> Task:
        """What the scenario asks for."""
        if self._world.scenario.goal is not None:
            return "reach"
        if self._winding is not None:
            return "round"
        return "fetch" if self._world.donors else "none"

    @property
    def stage(self) -> Stage:
        """Where the task stands now."""
        if self.done:
            return "done"
        match self.task:
            case "reach":
                return "touched" if self._failed else "to the goal"
            case "round":
                return "touched" if self._failed else "going round"
            case "none":
                return "no task"
            case "fetch":
                return self._stage_of_errand()

    def _stage_of_errand(self) -> Stage:
        if self._world.errand.on_board:
            return "return"
        return "hand-over" if self._in_reach else "to the donor"

    def observe(self) -> None:
        """Take the world as it is now."""
        world = self._world
        pose, self._time = world.robot.pose, world.time
        self._distance += ((pose.x - self._place.x) ** 2 + (pose.y - self._place.y) ** 2) ** 0.5
        self._place = pose
        self._clearance = min(self._clearance, self._clearance_now(self._clearance))
        self._watch_contacts(world)
        if self._arrival is None and world.home_distance <= AT_START:
            self._departure = world.time
        self._watch_goal(world)
        self._watch_round(world)
        self._watch_errand(world)

    def _clearance_now(self, below: float) -> float:
        """Clearance [m] of all but climbed curbs, or `below` where it is certainly more."""
        world = self._world
        if not self._climbed:
            return world.clearance(below=below)
        others = [t for t in world.things if t.present and t not in self._climbed and _least_gap(world, t) < below]
        if not others or world.clearance(below=below) >= below:
            return below
        return min([below, *(_gap(world, thing) for thing in others)])

    def _watch_goal(self, world: World) -> None:
        goal = world.scenario.goal
        if goal is None:
            return
        pose = world.robot.pose
        self._failed = self._failed or (goal.no_contact and bool(self._contacts))
        near = (pose.x - goal.at[0]) ** 2 + (pose.y - goal.at[1]) ** 2 <= goal.within**2
        if self._arrival is None and near and not self._failed:
            self._arrival = world.time

    def _watch_round(self, world: World) -> None:
        winding, task = self._winding, world.scenario.round
        if winding is None or task is None:
            return
        self._failed = self._failed or (task.no_contact and bool(self._contacts))
        winding.observe(world.robot.pose)
        back = winding.share >= 1 and world.home_distance <= task.within
        if self._arrival is None and back and not self._failed:
            self._arrival = world.time

    def _watch_errand(self, world: World) -> None:
        if not world.donors:
            return
        errand = world.errand
        self._in_reach = world.robot.standing and errand.in_reach(world.donor_gaps)
        if self._arrival is None and self._in_reach:
            self._arrival = world.time
        if self._loaded is None and errand.on_board:
            self._loaded = world.time
        if self._home is None and errand.done:
            self._home = world.time

    def _watch_contacts(self, world: World) -> None:
        ground = [thing.placed.id for thing in self._climbed]
        for touch in world.begun:
            if (
                touch.thing not in ground
                and touch.time - self._last_touch.get(touch.thing, -ONE_CONTACT) >= ONE_CONTACT
            ):
                self._contacts.append(touch)
        for touch in (*world.begun, *world.touches):
            self._last_touch[touch.thing] = world.time

    def verdict(self, stopped: str = "") -> Verdict:
        """What is to be said now. stopped: why the run ended, if not because it was done or out of time."""
        time = self._time
        done = self.done or (self.stage == "no task" and not stopped)
        return Verdict(
            task=self.task,
            done=done,
            reason="" if done else self._reason(stopped),
            stage=self.stage,
            times=Times(None if self._arrival is None else self._departure, self._arrival, self._loaded, self._home),
            duration=time,
            distance=self._distance,
            contacts=tuple(self._contacts),
            smallest_clearance=self._clearance,
            deliveries=self._world.errand.deliveries,
            share=None if self._winding is None else min(1.0, self._winding.share),
        )

    def _reason(self, stopped: str) -> str:
        time, stage = self._time, PHRASES[self.stage]
        why = stopped or (f"a contact at {time:.1f} s" if self._failed else f"out of time at {time:.0f} s")
        if self._winding is None:
            return f"{why} {stage}"
        rule = ", which must be driven without a contact" if self._failed else ""
        if self._winding.share >= 1 and not rule:
            return f"{why} after the way round, {self._world.home_distance:.1f} m from the start"
        return f"{why} {PHRASES['going round']}{rule}: {min(1.0, self._winding.share):.0%} of it done"


class Winding:
    """How far a robot has gone round a place."""

    def __init__(self, task: Round, pose: Pose) -> None:
        self._task = task
        self._bearing = self._bearing_of(pose)
        self._wound = 0.0  # [rad], counter-clockwise

    @property
    def share(self) -> float:
        """Of all turns; what was gone one way and back again is taken off."""
        return (abs(self._wound) + ROUNDING) / (math.tau * self._task.turns)

    def observe(self, pose: Pose) -> None:
        """Where the robot is now."""
        bearing = self._bearing_of(pose)
        self._wound += wrap(bearing - self._bearing)
        self._bearing = bearing

    def _bearing_of(self, pose: Pose) -> float:
        return math.atan2(pose.y - self._task.about[1], pose.x - self._task.about[0])


def _least_gap(world: World, thing: Thing) -> float:
    """Distance [m] between the circles round the hulls: `_gap` is no less."""
    pose = world.robot.pose
    return math.hypot(thing.x - pose.x, thing.y - pose.y) - world.robot.build.radius - thing.reach


def _gap(world: World, thing: Thing) -> float:
    """Distance [m] between the hulls; 0 where they overlap, unless both are round."""
    hull, pose, outline = world.robot.build.hull, world.robot.pose, thing.placed.outline
    theirs = [distance(corner, hull, pose) - rim for corner, rim in _corners(outline, thing.pose)]
    return min([*theirs, *(distance(corner, outline, thing.pose) - rim for corner, rim in _corners(hull, pose))])


def _corners(outline: Outline, pose: Pose) -> Iterator[tuple[Vec2, float]]:
    """Corners in the world and how far the hull reaches round each; of a circle its centre and radius."""
    match outline:
        case Circle(radius):
            yield (pose.x, pose.y), radius
        case Polygon(vertices):
            yield from ((_in_world(corner, pose), 0.0) for corner in vertices)
        case Rings(rings):
            yield from ((_in_world(corner, pose), 0.0) for ring in rings for corner in ring)


def _in_world(place: Vec2, pose: Pose) -> Vec2:
    c, s = math.cos(pose.theta), math.sin(pose.theta)
    return pose.x + c * place[0] - s * place[1], pose.y + s * place[0] + c * place[1]
