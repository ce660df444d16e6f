"""A run: sense, think, act, step, for any brain.

Takes: a scenario, a seed, and a `Brain`. Gives: a `Verdict`; to an observer, tick by tick, the
truth as plain JSON values. Leaves alone: what the brain is, where recordings go, how progress is shown.

One tick: the world is sensed, the brain thinks, the observer looks (the state, what was sensed in it and what was
decided belong together), the world is stepped. The robot stands (`STOP`) before the first tick, after the last and when
the brain raises.
"""

from __future__ import annotations

import math
from typing import Protocol

from behaviours.interface import STOP, Command, Floats, Pose, Reading
from sim.judge import Judge, Verdict
from sim.raycast import Circle, Outline, Polygon
from sim.scenarios.scenario import Scenario
from sim.things.thing import Placed, Thing
from sim.world import TICK, World

Json = dict[str, object]


class Brain(Protocol):
    """Who decides."""

    def reset(self) -> None:
        """Before the first step of a run."""
        ...

    def step(self, reading: Reading) -> Command:
        """What to do now."""
        ...

    def note(self) -> str:
        """JSON text about the last step, for recordings ("null": nothing to say)."""
        ...


class Observer(Protocol):
    """Who watches: a recorder, a progress bar."""

    def observe(self, episode: Episode) -> None:
        """After the brain has decided, each tick, and once when the run is over; `episode.snapshot()` has the truth."""
        ...


class Episode:
    """One run of a scenario with a seed. Raises ScenarioError where the seed finds no layout."""

    def __init__(self, scenario: Scenario, seed: int) -> None:
        self.scenario, self.seed = scenario, seed
        self.world = World(scenario, seed)
        self.judge = Judge(self.world)
        self.command: Command = STOP
        self.note = "null"
        self.over = False

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self.world.time

    def tick(self, brain: Brain, observer: Observer | None = None) -> None:
        """Sense, think, show, step."""
        self.command = brain.step(self.world.sense())
        if observer is not None:
            self.note = brain.note()
            observer.observe(self)
        self.world.step(self.command)
        self.judge.observe()

    def run(self, brain: Brain, until_s: float | None = None, observer: Observer | None = None) -> Verdict:
        """Tick until the object is fetched or the time [s] is over (None: the scenario's limit).

        What the brain raises is raised again, once the robot has been stopped.
        """
        until = self.scenario.time_limit if until_s is None else until_s
        brain.reset()
        try:
            while not self.judge.done and self.time < until - TICK / 2:
                self.tick(brain, observer)
        finally:
            self._stop()
        if observer is not None:
            observer.observe(self)
        return self.judge.verdict()

    def _stop(self) -> None:
        self.command, self.note, self.over = STOP, "null", True
        self.world.step(STOP)

    # --- for recordings ---------------------------------------------------------------------------

    def header(self) -> Json:
        """What does not change: period, bounds, robot, home, donor, things that stand and things that move."""
        world = self.world
        return {
            "scenario": self.scenario.name,
            "seed": self.seed,
            "period": TICK,
            "bounds": list(self.scenario.bounds),
            "robot": {"radius": world.robot.build.radius},
            "home": _pose(world.start),
            "donor": _described(world.donor.placed) | {"reach": world.hand_over.reach},
            "things": [_described(thing.placed) for thing in world.things if not _in_snapshots(thing)],
            "movers": [_described(thing.placed) for thing in world.things if _in_snapshots(thing)],
        }

    def snapshot(self) -> Json:
        """What is so now: lengths to the millimetre, angles to 1e-4 rad, NaN as None."""
        world, reading = self.world, self.world.sense()
        head = world.head.state
        return {
            "t": round(self.time, 3),
            "stage": self.judge.stage,
            "robot": _pose(world.robot.pose),
            "odometry": _pose(reading.odometry.pose),
            "movers": {t.placed.id: _pose(t.pose) for t in world.things if _in_snapshots(t) and t.present},
            "contacts": [{"thing": touch.thing, "driven_into": touch.driven_into} for touch in world.touches],
            "head": [_angle(head.pan), _angle(head.tilt)],
            "command": _command(self.command),
            "on_board": reading.object_on_board,
        } | _sensed(reading)


def run(
    scenario: Scenario, seed: int, brain: Brain, until_s: float | None = None, observer: Observer | None = None
) -> Verdict:
    """A whole episode."""
    return Episode(scenario, seed).run(brain, until_s, observer)


def _in_snapshots(thing: Thing) -> bool:
    return thing.placed.moves or thing.index == 0


def _length(value: float) -> float | None:
    return round(value, 3) if math.isfinite(value) else None


def _angle(value: float) -> float | None:
    return round(value, 4) if math.isfinite(value) else None


def _pose(pose: Pose) -> list[float | None]:
    return [_length(pose.x), _length(pose.y), _angle(pose.theta)]


def _outline(outline: Outline) -> Json:
    match outline:
        case Circle(radius):
            return {"circle": radius}
        case Polygon(vertices):
            return {"polygon": [[x, y] for x, y in vertices]}


def _described(placed: Placed) -> Json:
    return {
        "id": placed.id,
        "kind": placed.kind,
        "shape": _outline(placed.outline),
        "pose": _pose(placed.pose),
        "height": placed.height,
    }


def _command(command: Command) -> Json:
    drive, head = command.drive, command.head
    parts: Json = {}
    if drive is not None:
        parts["drive"] = [_length(drive.speed), _angle(drive.turn_rate)]
    if head is not None:
        parts["head"] = [_angle(head.pan), _angle(head.tilt)]
    return parts


def _sensed(reading: Reading) -> Json:
    """Only what was measured at this tick."""
    parts: Json = {}
    if reading.sonar and reading.skirt and reading.sonar.fresh:
        parts["sonar"] = [*_rounded(reading.sonar.ranges), *_rounded(reading.skirt.ranges)]
    if reading.ir and reading.ir.fresh:
        ir = reading.ir
        parts["ir"] = {
            "pan": _angle(ir.pan),
            "detected": ir.detected,
            "offset": _angle(ir.offset),
            "strength": _length(ir.strength),
        }
    if reading.stereo and reading.stereo.fresh:
        stereo = reading.stereo
        parts["stereo"] = {"pan": _angle(stereo.pan), "tilt": _angle(stereo.tilt), "range": _length(stereo.range)}
    return parts


def _rounded(ranges: Floats) -> list[float]:
    return [round(value, 3) for value in ranges.tolist()]
