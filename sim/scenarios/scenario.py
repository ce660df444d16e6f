"""Scenarios: a world, a robot, a donor and what shall happen, as frozen values and as YAML.

Takes: YAML text. Gives: `Scenario`. Leaves alone: what the seed decides (`layout.py`) and the stepping of it.
The file format is what `SCENARIO` at the end says; keys carry the names of the dataclasses' fields.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeVar

import yaml

from behaviours.interface import Vec2
from sim.raycast import Circle, Outline, box
from sim.robots.synchro import Build
from sim.scenarios.schema import (
    Key,
    Problem,
    Report,
    ScenarioError,
    Spec,
    Wrong,
    by_kind,
    choice,
    either,
    listed,
    place,
    quantity,
    read,
    record,
    row,
    whole,
    word,
)
from sim.sensors.infrared import InfraredBuild, Weather
from sim.sensors.odometry import OdometryBuild
from sim.sensors.sonar import SonarBuild
from sim.sensors.stereo import StereoBuild
from sim.things.thing import At, Motion, RobotLeft, RobotWithin, Roll, Shift, Travel, Trigger, Waypoint

T = TypeVar("T")
Box = tuple[float, float, float, float]


@dataclass(frozen=True, slots=True)
class Between:
    """A number that the seed draws, evenly between two."""

    low: float
    high: float

    def __post_init__(self) -> None:
        if self.low > self.high:
            raise ValueError("the first of the two numbers must not be the greater")


Amount = float | Between


@dataclass(frozen=True, slots=True)
class RobotSpec:
    """start [m]; heading [rad, world]."""

    start: Vec2
    heading: Amount = 0.0
    build: Build = field(default_factory=Build)
    sonar: SonarBuild = field(default_factory=SonarBuild)
    infrared: InfraredBuild = field(default_factory=InfraredBuild)
    stereo: StereoBuild = field(default_factory=StereoBuild)
    odometry: OdometryBuild = field(default_factory=OdometryBuild)


@dataclass(frozen=True, slots=True)
class DonorSpec:
    """at [m]; reach [m] of its arm, hull to hull; hand_over [s]; move: it goes elsewhere once."""

    at: Vec2
    radius: float = 0.25
    height: float = 0.9
    reach: float = 0.92
    hand_over: float = 15.0
    move: Shift | None = None


@dataclass(frozen=True, slots=True)
class ThingSpec:
    """A thing; present: the chance that it is there; id: empty for its kind and a number."""

    kind: str
    outline: Outline
    height: float
    at: Vec2
    heading: Amount = 0.0
    mass: float = 0.0
    motion: Motion | None = None
    present: float = 1.0
    id: str = ""


Place = Vec2 | str


@dataclass(frozen=True, slots=True)
class KeepClear:
    """The straight strip between two places (points, "robot" or "donor") and `by` [m] to either side."""

    start: Place
    end: Place
    by: float


@dataclass(frozen=True, slots=True)
class Scatter:
    """Things that the seed puts somewhere: kinds to choose from, how many, region [m], least gap [m] between hulls."""

    kinds: tuple[str, ...]
    count: tuple[int, int]
    region: Box
    min_gap: float = 0.0
    keep_clear: tuple[KeepClear, ...] = ()


@dataclass(frozen=True, slots=True)
class Scenario:
    """A world to do a task in. bounds [m]: xmin, ymin, xmax, ymax of what is shown; time_limit [s]."""

    name: str
    bounds: Box
    robot: RobotSpec
    donor: DonorSpec
    things: tuple[ThingSpec, ...] = ()
    scatter: tuple[Scatter, ...] = ()
    weather: Weather = field(default_factory=Weather)
    time_limit: float = 1800.0


def load(path: Path) -> Scenario:
    """The scenario in a YAML file. Raises ScenarioError with every problem; OSError where it cannot be read."""
    try:
        text = path.read_bytes().decode("utf-8")
    except UnicodeDecodeError as fault:
        raise ScenarioError([Problem(path.name, 1, 1, "", "not a text in UTF-8")]) from fault
    return loads(text, path.name)


def loads(text: str, name: str = "scenario") -> Scenario:
    """The scenario in a YAML text; `name` stands for the file in messages. Raises ScenarioError."""
    return read(text, name, SCENARIO)


# --- kinds of things ------------------------------------------------------------------------------

CAR_SIZE = (4.4, 1.8)
CAR_HEIGHT = 1.4
SCATTERED = {
    "trashcan": ThingSpec("trashcan", Circle(0.3), 0.9, (0.0, 0.0), mass=8.0),
    "post": ThingSpec("post", Circle(0.15), 1.0, (0.0, 0.0)),
    "person": ThingSpec("person", Circle(0.25), 1.75, (0.0, 0.0)),
}
"""What may be scattered, as it is without any wish; persons that are scattered stand."""


def _wall(start: Vec2, end: Vec2, thickness: float, height: float, id: str) -> ThingSpec:
    length = math.dist(start, end)
    if length == 0:
        raise ValueError("'from' and 'to' must be two places")
    middle = (start[0] + end[0]) / 2, (start[1] + end[1]) / 2
    heading = math.atan2(end[1] - start[1], end[0] - start[0])
    return ThingSpec("wall", box(length, thickness), height, middle, heading, id=id)


def _parked_car(at: Vec2, heading: Amount, size: Vec2, present: float, id: str) -> ThingSpec:
    return ThingSpec("parked-car", box(*size), CAR_HEIGHT, at, heading, present=present, id=id)


def _distinct(track: tuple[Waypoint, ...]) -> None:
    ends = [*track[1:], track[0]]
    if any((a.x, a.y) == (b.x, b.y) for a, b in zip(track, ends, strict=True)):
        raise ValueError("one waypoint of the track after the other must be at another place")


def _car(track: tuple[Waypoint, ...], speed: float, starts: Trigger, size: Vec2, then: str, id: str) -> ThingSpec:
    _distinct(track)
    travel = Travel(track, speed, starts, then, look_ahead=3.0, heeds_all=True)
    heading = math.atan2(track[1].y - track[0].y, track[1].x - track[0].x)
    return ThingSpec("car", box(*size), CAR_HEIGHT, (track[0].x, track[0].y), heading, motion=travel, id=id)


def _person(
    at: Vec2 | None, track: tuple[Waypoint, ...] | None, speed: float, starts: Trigger, then: str, id: str
) -> ThingSpec:
    if track is not None and at is None:
        _distinct(track)
        travel = Travel(track, speed, starts, then, look_ahead=0.6)
        return ThingSpec("person", Circle(0.25), 1.75, (track[0].x, track[0].y), motion=travel, id=id)
    if at is None or track is not None:
        raise ValueError("a person has either 'at' (it stands) or 'track' (it walks)")
    return ThingSpec("person", Circle(0.25), 1.75, at, id=id)


def _trashcan(at: Vec2, radius: float, roll: Roll | None, id: str) -> ThingSpec:
    return ThingSpec("trashcan", Circle(radius), 0.9, at, mass=8.0, motion=roll, id=id)


def _post(at: Vec2, radius: float, height: float, id: str) -> ThingSpec:
    return ThingSpec("post", Circle(radius), height, at, id=id)


# --- the format -----------------------------------------------------------------------------------

coordinate = quantity("length")
positive = quantity("length", above=0)
moment = quantity("time", least=0)
duration = quantity("time", above=0)
angle = quantity("angle")


def _pair(x: float, y: float) -> Vec2:
    return x, y


point = row(_pair, "a place [x, y]", coordinate, coordinate)
share = quantity("number", least=0, most=1)
spread = quantity("number", least=0)


def _ordered(least: int, most: int) -> tuple[int, int]:
    if least > most:
        raise ValueError("the first of the two numbers must not be the greater")
    return least, most


def _region(xmin: float, ymin: float, xmax: float, ymax: float) -> Box:
    if xmin >= xmax or ymin >= ymax:
        raise ValueError("the region is empty: expected xmin < xmax and ymin < ymax")
    return xmin, ymin, xmax, ymax


region = row(_region, "a region [xmin, ymin, xmax, ymax]", *[coordinate] * 4)
size = row(_pair, "a size [length, width]", positive, positive)


def _between(between: Between) -> Between:
    return between


amount_of_angle = either(angle, record(_between, between=Key(row(Between, "two angles [from, to]", angle, angle))))
waypoint = row(Waypoint, "a waypoint [x, y] or [x, y, seconds to wait]", coordinate, coordinate, moment, optional=1)
track = listed(waypoint, 2, "a list of waypoints")


def _trigger(at: float | None, every: float, robot_within: float | None, robot_left: float | None) -> Trigger:
    given = [name for name in (at, robot_within, robot_left) if name is not None]
    if len(given) != 1:
        raise ValueError("give one of at, robot_within and robot_left")
    if at is not None:
        return At(at, every)
    return RobotLeft(given[0]) if robot_within is None else RobotWithin(given[0])


trigger = record(
    _trigger,
    at=Key(moment, None),
    every=Key(duration, math.inf),
    robot_within=Key(quantity("length", least=0), None),
    robot_left=Key(quantity("length", least=0), None),
)
speed = quantity("speed", above=0, most=10)
roll = record(
    Roll, starts=Key(trigger, goes_to="start"), speed=Key(speed, 1.0), gap=Key(quantity("length", least=0), 0.1)
)
then = choice("vanish", "stay", "loop")
identity = Key(word, "", goes_to="id")

THINGS: dict[str, Spec] = {
    "wall": record(
        _wall,
        **{"from": Key(point, goes_to="start"), "to": Key(point, goes_to="end")},
        thickness=Key(positive, 0.2),
        height=Key(positive, 2.0),
        id=identity,
    ),
    "parked-car": record(
        _parked_car,
        at=Key(point),
        heading=Key(amount_of_angle, 0.0),
        size=Key(size, CAR_SIZE),
        present=Key(share, 1.0),
        id=identity,
    ),
    "car": record(
        _car,
        track=Key(track),
        speed=Key(speed),
        starts=Key(trigger, At(0.0)),
        size=Key(size, CAR_SIZE),
        then=Key(then, "vanish"),
        id=identity,
    ),
    "person": record(
        _person,
        at=Key(point, None),
        track=Key(track, None),
        speed=Key(speed, 0.8),
        starts=Key(trigger, At(0.0)),
        then=Key(then, "loop"),
        id=identity,
    ),
    "trashcan": record(_trashcan, at=Key(point), radius=Key(positive, 0.3), roll=Key(roll, None), id=identity),
    "post": record(_post, at=Key(point), radius=Key(positive, 0.15), height=Key(positive, 1.0), id=identity),
}


def _like(sample: T, **specs: Spec) -> Spec:
    """A mapping of fields of a dataclass; those that are not named are as in the sample."""
    return record(type(sample), **{name: Key(spec, getattr(sample, name)) for name, spec in specs.items()})


def _robot(
    start: Vec2,
    heading: Amount,
    sonar: SonarBuild,
    infrared: InfraredBuild,
    stereo: StereoBuild,
    odometry: OdometryBuild,
    **build: float,
) -> RobotSpec:
    return RobotSpec(start, heading, Build(**build), sonar, infrared, stereo, odometry)


positive_number = quantity("number", above=0)
robot = record(
    _robot,
    start=Key(point),
    heading=Key(amount_of_angle, 0.0),
    radius=Key(positive, Build().radius),
    max_speed=Key(speed, Build().max_speed),
    max_turn_rate=Key(positive_number, Build().max_turn_rate),
    acceleration=Key(positive_number, Build().acceleration),
    turn_acceleration=Key(positive_number, Build().turn_acceleration),
    sonar=Key(_like(SonarBuild(), sd=spread, dropout=share), SonarBuild()),
    infrared=Key(_like(InfraredBuild(), period=duration, sd=spread, offset_sd=angle), InfraredBuild()),
    stereo=Key(
        _like(StereoBuild(), period=duration, camera_height=positive, linear=spread, quadratic=spread), StereoBuild()
    ),
    odometry=Key(_like(OdometryBuild(), scale_sd=spread, turn_sd=spread), OdometryBuild()),
)
move = record(
    Shift,
    starts=Key(trigger, goes_to="start"),
    by=Key(row(_pair, "a way [dx, dy]", coordinate, coordinate)),
    speed=Key(speed, 0.3),
)
donor = record(
    DonorSpec,
    at=Key(point),
    radius=Key(positive, 0.25),
    height=Key(positive, 0.9),
    reach=Key(positive, 0.92),
    hand_over=Key(moment, 15.0),
    move=Key(move, None),
)
strip = record(
    KeepClear,
    **{"from": Key(place(("robot", "donor"), point), goes_to="start")},
    to=Key(place(("robot", "donor"), point), goes_to="end"),
    by=Key(quantity("length", least=0)),
)
scatter = record(
    Scatter,
    kinds=Key(listed(choice(*SCATTERED), 1)),
    count=Key(row(_ordered, "how many [least, most]", whole(0, 100), whole(0, 100))),
    region=Key(region),
    min_gap=Key(quantity("length", least=0), 0.0),
    keep_clear=Key(listed(strip), ()),
)


def _things(report: Report, node: yaml.Node, path: str) -> tuple[ThingSpec, ...] | Wrong:
    """Things whose ids differ."""
    things: tuple[ThingSpec, ...] | Wrong = listed(by_kind(THINGS))(report, node, path)
    taken = ["robot", "donor"]
    for index, thing in enumerate(() if isinstance(things, str) else things):
        if thing.id in taken:
            report.wrong(node.value[index], f"{path}[{index}].id", f"the name {thing.id!r} is taken")
        taken += [thing.id] if thing.id else []
    return things


SCENARIO = record(
    Scenario,
    name=Key(word),
    bounds=Key(region),
    robot=Key(robot),
    donor=Key(donor),
    things=Key(_things, ()),
    scatter=Key(listed(scatter), ()),
    weather=Key(_like(Weather(), sun=angle, jitter=angle, gust=angle, gusts=share), Weather()),
    time_limit=Key(duration, 1800.0),
)
