"""Whether the task was done, how long it took, and what was touched on the way.

Takes: the world after each tick (the truth, not what the robot believes). Gives: the stage now, and a `Verdict`.
Leaves alone: how the robot did it.

Tasks: fetch the donor's object and bring it home; reach the goal; or none, then the run lasts until its time is over.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from sim.world import Touch, World

Stage = Literal["to the donor", "hand-over", "return", "to the goal", "touched", "no task", "done"]
Task = Literal["fetch", "reach", "none"]
AT_START = 0.3  # [m] from the start: what counts as not yet gone
ONE_CONTACT = 1.0  # [s] within which touches of one thing are one contact

PHRASES: dict[Stage, str] = {
    "to the donor": "on the way to the donor",
    "hand-over": "during the hand-over",
    "return": "on the way back",
    "to the goal": "on the way to the goal",
    "touched": "on the way to the goal, which must be reached without a contact",
    "no task": "without a task",
    "done": "when all was done",
}


@dataclass(frozen=True, slots=True)
class Times:
    """Moments [s]; None for what has not happened.

    departure: the last one within 0.3 m of home before arrival; arrival: standing within the donor's reach for the
    first time, or at the goal; loaded: the first object is on board; home: the last one has been brought.
    """

    departure: float | None = None
    arrival: float | None = None
    loaded: float | None = None
    home: float | None = None


@dataclass(frozen=True, slots=True)
class Verdict:
    """What is to be said of a run. duration [s]; distance [m] driven; smallest_clearance [m] from the hull, truly.

    deliveries: moments [s] at which an object had been brought home. reason: in words, why it is not done; empty when
    it is. A run without a task is done when its time is over.
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
        self._clearance = world.clearance()
        self._contacts: list[Touch] = []
        self._last_touch: dict[str, float] = {}
        self._in_reach = False
        self._failed = False

    @property
    def done(self) -> bool:
        """Whether the task is done."""
        return (self._home if self._world.scenario.goal is None else self._arrival) is not None

    @property
    def over(self) -> bool:
        """Whether nothing more can come of it."""
        return self.done or self._failed

    @property
    def task(self) -> Task:
        """What the scenario asks for."""
        if self._world.scenario.goal is not None:
            return "reach"
        return "fetch" if self._world.donors else "none"

    @property
    def stage(self) -> Stage:
        """Where the task stands now."""
        if self.done:
            return "done"
        if self._world.scenario.goal is not None:
            return "touched" if self._failed else "to the goal"
        if not self._world.donors:
            return "no task"
        if self._world.errand.on_board:
            return "return"
        return "hand-over" if self._in_reach else "to the donor"

    def observe(self) -> None:
        """Take the world as it is now."""
        world = self._world
        pose, self._time = world.robot.pose, world.time
        self._distance += ((pose.x - self._place.x) ** 2 + (pose.y - self._place.y) ** 2) ** 0.5
        self._place = pose
        self._clearance = min(self._clearance, world.clearance(below=self._clearance))
        self._watch_contacts(world)
        if self._arrival is None and world.home_distance <= AT_START:
            self._departure = world.time
        self._watch_goal(world)
        self._watch_errand(world)

    def _watch_goal(self, world: World) -> None:
        goal = world.scenario.goal
        if goal is None:
            return
        pose = world.robot.pose
        self._failed = self._failed or (goal.no_contact and bool(self._contacts))
        near = (pose.x - goal.at[0]) ** 2 + (pose.y - goal.at[1]) ** 2 <= goal.within**2
        if self._arrival is None and near and not self._failed:
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
        for touch in world.begun:
            if touch.time - self._last_touch.get(touch.thing, -ONE_CONTACT) >= ONE_CONTACT:
                self._contacts.append(touch)
        for touch in (*world.begun, *world.touches):
            self._last_touch[touch.thing] = world.time

    def verdict(self, stopped: str = "") -> Verdict:
        """What is to be said now. stopped: why the run ended, if not because it was done or out of time."""
        time = self._time
        done = self.done or (self.stage == "no task" and not stopped)
        why = stopped or (f"a contact at {time:.1f} s" if self._failed else f"out of time at {time:.0f} s")
        return Verdict(
            task=self.task,
            done=done,
            reason="" if done else f"{why} {PHRASES[self.stage]}",
            stage=self.stage,
            times=Times(None if self._arrival is None else self._departure, self._arrival, self._loaded, self._home),
            duration=time,
            distance=self._distance,
            contacts=tuple(self._contacts),
            smallest_clearance=self._clearance,
            deliveries=self._world.errand.deliveries,
        )
