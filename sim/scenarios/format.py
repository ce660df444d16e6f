"""The file format of scenarios: from YAML to `Scenario`, and the same as JSON Schema.

Takes: YAML text. Gives: `Scenario`, or every mistake with its place. Leaves alone: what the seed decides.
The format is what `SCENARIO` at the end says; keys carry the names of the dataclasses' fields. The schema in
`scenario.schema.json` is printed from it: `python -m sim.scenarios.format`.
"""

from __future__ import annotations

import json
import math
import sys
from dataclasses import asdict, fields, replace
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import yaml

from behaviours.interface import Pose, Vec2
from sim.raycast import Circle, Outline, box
from sim.robots.battery import BatteryBuild
from sim.robots.build import Ackermann, Build, Differential, DriveBuild, SkidSteer, Synchro
from sim.robots.models import MODELS
from sim.scenarios.scenario import (
    CAR_HEIGHT,
    CAR_SIZE,
    SCATTERED,
    Amount,
    Between,
    Box,
    Change,
    DonorSpec,
    Event,
    Goal,
    Jam,
    KeepClear,
    Put,
    RobotSpec,
    Round,
    Scatter,
    Scenario,
    Spot,
    ThingSpec,
    Vanish,
)
from sim.scenarios.schema import (
    Json,
    Key,
    Problem,
    Report,
    ScenarioError,
    Spec,
    Wrong,
    by_kind,
    choice,
    did_you_mean,
    flag,
    listed,
    mapping_or,
    quantity,
    read,
    record,
    row,
    scalar_or,
    whole,
    word,
)
from sim.scenarios.shapes import Ring, convex, from_text, is_convex, solid
from sim.sensors.build import (
    FAULTS,
    BumperBuild,
    CompassBuild,
    CurrentBuild,
    Fault,
    GpsBuild,
    ImuBuild,
    InclinometerBuild,
    InfraredBuild,
    Installed,
    LidarBuild,
    Mount,
    OdometryBuild,
    SensorBuild,
    SonarBuild,
    StereoBuild,
)
from sim.sensors.faults import wrong_fault
from sim.sensors.weather import Weather
from sim.things.ground import Ground, Slope
from sim.things.thing import (
    At,
    Keyframe,
    Keyframes,
    RobotLeft,
    RobotWithin,
    Roll,
    Shift,
    Travel,
    Trigger,
    Waypoint,
)

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

T = TypeVar("T")
D = TypeVar("D", bound="DataclassInstance")


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


# --- numbers and places -----------------------------------------------------------------------------

FARTHEST = 1e5  # [m]; also the longest
SHORTEST = 1e-3  # [m] of what has a size
LATEST = 1e7  # [s]

coordinate = quantity("length", least=-FARTHEST, most=FARTHEST)
positive = quantity("length", least=SHORTEST, most=FARTHEST)
length = quantity("length", least=0, most=FARTHEST)
moment = quantity("time", least=0, most=LATEST)
duration = quantity("time", least=1e-3, most=LATEST)
angle = quantity("angle", least=-100, most=100)
share = quantity("number", least=0, most=1)
spread = quantity("number", least=0, most=1e6)
positive_number = quantity("number", above=0, most=1e3)
mass = quantity("number", least=1e-3, most=1e6)
speed = quantity("speed", above=0, most=10)


def _pair(x: float, y: float) -> Vec2:
    return x, y


point = row(_pair, "a place [x, y]", coordinate, coordinate)
pose = row(Pose, "a pose [x, y] or [x, y, heading]", coordinate, coordinate, angle, optional=1)


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


between = record(_between, between=Key(row(Between, "two angles [from, to]", angle, angle)))
amount_of_angle: Spec[Amount] = mapping_or(between, angle)
metres_between = record(_between, between=Key(row(Between, "two lengths [from, to]", coordinate, coordinate)))
drawn_coordinate: Spec[Amount] = mapping_or(metres_between, coordinate)


def _spot(x: Amount, y: Amount) -> Spot:
    return x, y


spot = row(_spot, "a place [x, y]", drawn_coordinate, drawn_coordinate)
waypoint = row(Waypoint, "a waypoint [x, y] or [x, y, seconds to wait]", coordinate, coordinate, moment, optional=1)
track = listed(waypoint, 2, "a list of waypoints")
corners = listed(point, 3, "a list of corners [x, y]")


# --- what is shaped as the writer wishes --------------------------------------------------------------


def _shape(circle: float | None, box: Outline | None, polygon: Ring | None) -> Outline:
    if len([given for given in (circle, box, polygon) if given is not None]) != 1:
        raise ValueError("give one of circle, box and polygon")
    if polygon is not None:
        return convex(polygon)
    return Circle(circle) if circle is not None else box or Circle(1.0)


shape = record(
    _shape,
    circle=Key(positive, None, doc="radius"),
    box=Key(row(box, "a size [length, width]", positive, positive), None),
    polygon=Key(corners, None),
)


def _text_ring(report: Report, node: yaml.Node, path: str) -> Ring | Wrong:
    ring = from_text(str(node.value))
    return report.unexpected(node, path, "corners as text 'x y, x y, …', three or more") if ring is None else ring


text_ring: Spec[Ring] = Spec(_text_ring, {"type": "string", "description": "corners: x y, x y, …"})
rings = listed(scalar_or(text_ring, corners), 1, "a list of rings")


# --- things -----------------------------------------------------------------------------------------


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
    robot_within=Key(length, None),
    robot_left=Key(length, None),
)
roll = record(Roll, starts=Key(trigger, goes_to="start"), speed=Key(speed, 1.0), gap=Key(length, 0.1))
then = choice("vanish", "stay", "loop")
identity = Key(word, "", goes_to="id")


def _keyframes(frames: tuple[Keyframe, ...]) -> Keyframes:
    if any(a.time >= b.time for a, b in pairwise(frames)):
        raise ValueError("the times of keyframes must rise")
    return Keyframes(frames)


keyframe = row(Keyframe, "a keyframe [t, x, y]", moment, coordinate, coordinate)


def _checked_keyframes(report: Report, node: yaml.Node, path: str) -> Keyframes | Wrong:
    frames = listed(keyframe, 2, "a list of keyframes")(report, node, path)
    if isinstance(frames, str):
        return frames
    try:
        return _keyframes(frames)
    except ValueError as fault:
        return report.wrong(node, path, str(fault))


keyframes: Spec[Keyframes] = Spec(_checked_keyframes, listed(keyframe, 2).schema)


def _wall(start: Vec2, end: Vec2, thickness: float, height: float, id: str) -> ThingSpec:
    if math.dist(start, end) == 0:
        raise ValueError("'from' and 'to' must be two places")
    return _strip("wall", start, end, thickness, height, id)


def _curb(start: Vec2, end: Vec2, width: float, height: float, id: str) -> ThingSpec:
    if math.dist(start, end) == 0:
        raise ValueError("'from' and 'to' must be two places")
    return _strip("curb", start, end, width, height, id)


def _strip(kind: str, start: Vec2, end: Vec2, width: float, height: float, id: str) -> ThingSpec:
    middle = (start[0] + end[0]) / 2, (start[1] + end[1]) / 2
    heading = math.atan2(end[1] - start[1], end[0] - start[0])
    return ThingSpec(kind, box(math.dist(start, end), width), height, middle, heading, id=id)


def _parked_car(at: Spot, heading: Amount, size: Vec2, present: float, id: str) -> ThingSpec:
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
    at: Spot | None, track: tuple[Waypoint, ...] | None, speed: float, starts: Trigger, then: str, id: str
) -> ThingSpec:
    if track is not None and at is None:
        _distinct(track)
        travel = Travel(track, speed, starts, then, look_ahead=0.6)
        return ThingSpec("person", Circle(0.25), 1.75, (track[0].x, track[0].y), motion=travel, id=id)
    if at is None or track is not None:
        raise ValueError("a person has either 'at' (it stands) or 'track' (it walks)")
    return ThingSpec("person", Circle(0.25), 1.75, at, id=id)


def _trashcan(at: Spot, radius: float, roll: Roll | None, id: str) -> ThingSpec:
    return ThingSpec("trashcan", Circle(radius), 0.9, at, mass=8.0, motion=roll, id=id)


def _post(at: Spot, radius: float, height: float, id: str) -> ThingSpec:
    return ThingSpec("post", Circle(radius), height, at, id=id)


def _cart(at: Spot, heading: Amount, size: Vec2, height: float, mass: float, roll: Roll | None, id: str) -> ThingSpec:
    return ThingSpec("cart", box(*size), height, at, heading, mass, roll, id=id)


def _charger(at: Spot, radius: float, reach: float, id: str) -> ThingSpec:
    return ThingSpec("charger", Circle(radius), 0.6, at, id=id, charges=reach)


def _plain(
    kind: str,
    outline: Outline,
    at: Spot | None,
    heading: Amount,
    height: float,
    mass: float,
    keyframes: Keyframes | None,
    present: float,
    id: str,
) -> ThingSpec:
    if (at is None) == (keyframes is None):
        raise ValueError(f"a {kind} has either 'at' (it stands) or 'keyframes' (it moves)")
    if keyframes is not None and mass > 0:
        raise ValueError("what moves by keyframes cannot be pushed: leave 'mass' out")
    if at is None:
        assert keyframes is not None
        at = keyframes.frames[0].x, keyframes.frames[0].y
    return ThingSpec(kind, outline, height, at, heading, mass, keyframes, present, id)


def _disc(radius: float, **rest: Any) -> ThingSpec:
    return _plain("disc", Circle(radius), heading=0.0, **rest)


def _box(size: Vec2, **rest: Any) -> ThingSpec:
    return _plain("box", box(*size), **rest)


def _polygon(vertices: Ring, **rest: Any) -> ThingSpec:
    moves = rest["mass"] > 0 or rest["keyframes"] is not None
    return _plain("polygon", convex(vertices) if moves or is_convex(vertices) else solid((vertices,)), **rest)


def _outline(rings: tuple[Ring, ...], height: float, id: str) -> ThingSpec:
    return ThingSpec("outline", solid(rings), height, (0.0, 0.0), id=id)


place_of_thing = {
    "at": Key(spot, None),
    "height": Key(positive, 1.0),
    "mass": Key(quantity("number", least=0, most=1e6), 0.0, doc="kg; 0: it cannot be pushed"),
    "keyframes": Key(keyframes, None),
    "present": Key(share, 1.0),
    "id": identity,
}
ends = {"from": Key(point, goes_to="start"), "to": Key(point, goes_to="end")}
heading = Key(amount_of_angle, 0.0)

THINGS: dict[str, Spec[ThingSpec]] = {
    "wall": record(_wall, **ends, thickness=Key(positive, 0.2), height=Key(positive, 2.0), id=identity),
    "curb": record(_curb, **ends, width=Key(positive, 0.15), height=Key(positive, 0.15), id=identity),
    "parked-car": record(
        _parked_car, at=Key(spot), heading=heading, size=Key(size, CAR_SIZE), present=Key(share, 1.0), id=identity
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
        at=Key(spot, None),
        track=Key(track, None),
        speed=Key(speed, 0.8),
        starts=Key(trigger, At(0.0)),
        then=Key(then, "loop"),
        id=identity,
    ),
    "trashcan": record(_trashcan, at=Key(spot), radius=Key(positive, 0.3), roll=Key(roll, None), id=identity),
    "post": record(_post, at=Key(spot), radius=Key(positive, 0.15), height=Key(positive, 1.0), id=identity),
    "cart": record(
        _cart,
        at=Key(spot),
        heading=heading,
        size=Key(size, (0.9, 0.5)),
        height=Key(positive, 1.0),
        mass=Key(mass, 20.0),
        roll=Key(roll, None),
        id=identity,
    ),
    "charger": record(_charger, at=Key(spot), radius=Key(positive, 0.15), reach=Key(positive, 0.5), id=identity),
    "disc": record(_disc, radius=Key(positive), **place_of_thing),
    "box": record(_box, size=Key(size), heading=heading, **place_of_thing),
    "polygon": record(_polygon, vertices=Key(corners), heading=heading, **place_of_thing),
    "outline": record(_outline, rings=Key(rings), height=Key(positive, 2.0), id=identity),
}


# --- robots -----------------------------------------------------------------------------------------


def _of(sample: D, specs: dict[str, Spec[Any]]) -> Spec[D]:
    """A mapping of fields of a dataclass; those that are not named are as in the sample."""
    return record(type(sample), **{name: Key(spec, getattr(sample, name)) for name, spec in specs.items()})


drives = {
    "max_speed": speed,
    "max_turn_rate": positive_number,
    "acceleration": positive_number,
    "turn_acceleration": positive_number,
}
DRIVES: dict[str, Spec[DriveBuild]] = {
    "synchro": _of(Synchro(), drives),
    "differential": _of(Differential(), {**drives, "track": positive}),
    "skid-steer": _of(
        SkidSteer(),
        {
            **drives,
            "track": positive,
            "slip": quantity("number", least=1, most=10),
            "climbs": length,
            "climbs_deployed": length,
            "slope_speed_loss": spread,
        },
    ),
    "ackermann": _of(
        Ackermann(),
        {
            "max_speed": speed,
            "wheelbase": positive,
            "max_steering": quantity("angle", above=0, most=1.5),
            "steering_rate": positive_number,
            "acceleration": positive_number,
        },
    ),
}
beams = whole(1, 100_000)
turn = quantity("angle", above=0, most=math.tau + 1e-9)
BUILDS: dict[str, tuple[SensorBuild, dict[str, Spec[Any]]]] = {
    "sonar": (SonarBuild(), {"sd": spread, "dropout": share}),
    "lidar": (
        LidarBuild(),
        {
            "field_of_view": turn,
            "beams": beams,
            "min_range": length,
            "max_range": positive,
            "sd": length,
            "relative_sd": spread,
            "angle_sd": quantity("angle", least=0),
            "dropout": share,
        },
    ),
    "infrared": (InfraredBuild(), {"period": duration, "sd": spread, "offset_sd": angle}),
    "stereo": (
        StereoBuild(),
        {"period": duration, "camera_height": positive, "linear": spread, "quadratic": spread, "stuck": share},
    ),
    "odometry": (OdometryBuild(), {"scale_sd": spread, "turn_sd": spread}),
    "compass": (
        CompassBuild(),
        {"sd": quantity("angle", least=0), "bias_rms": quantity("angle", least=0), "wavelength": positive},
    ),
    "imu": (ImuBuild(), {"turn_rate_sd": spread, "acceleration_sd": spread, "bias_sd": spread}),
    "inclinometer": (InclinometerBuild(), {"sd": quantity("angle", least=0)}),
    "gps": (GpsBuild(), {"sd": length, "drift_sd": length, "drift_time": duration}),
    "currents": (CurrentBuild(), {"sd": spread, "smoothing": moment}),
    "bumper": (BumperBuild(), {"segments": whole(1, 1000)}),
}
"""Kind -> a sample with the defaults, and what its fields hold."""


def _mount(at: Pose, height: float) -> Mount:
    return Mount(at.x, at.y, at.theta, height)


def _sensor(kind: str) -> Spec[Installed]:
    sample, specs = BUILDS[kind]
    own = {name: Key(spec, getattr(sample, name)) for name, spec in specs.items()}
    common = {
        "name": Key(word, kind),
        "at": Key(pose, Pose(0.0, 0.0)),
        "height": Key(length, Mount().height, doc="above the ground: what is lower is not seen"),
        "period": Key(duration, 0.0),
        "latency": Key(moment, 0.0),
    }

    def make(name: str, at: Pose, height: float, latency: float, period: float = 0.0, **build: Any) -> Installed:
        if "period" in own:
            build, period = {**build, "period": period}, 0.0
        _check_ranges(build)
        return Installed(name, type(sample)(**build), _mount(at, height), period, latency)

    return record(make, **(common | own))


def _check_ranges(build: dict[str, Any]) -> None:
    if "min_range" in build and build["min_range"] >= build["max_range"]:
        raise ValueError("min_range must be less than max_range")


def _sensors(report: Report, node: yaml.Node, path: str) -> tuple[Installed, ...] | Wrong:
    """Sensors whose names differ."""
    sensors = sensor_list(report, node, path)
    if isinstance(sensors, str):
        return sensors
    taken: list[str] = []
    for index, sensor in enumerate(sensors):
        if sensor.name in taken:
            report.wrong(node.value[index], f"{path}[{index}].name", f"the name {sensor.name!r} is taken")
        taken.append(sensor.name)
    return sensors


sensor_list: Spec[tuple[Installed, ...]] = listed(by_kind({kind: _sensor(kind) for kind in BUILDS}))


def _changes(specs: dict[str, Spec[Any]]) -> Spec[dict[str, Any]]:
    """Some fields of a sensor of the model."""

    def make(**given: Any) -> dict[str, Any]:
        return {name: value for name, value in given.items() if value is not None}

    return record(make, **{name: Key(spec, None) for name, spec in specs.items()})


LIMITS = ("max_speed", "max_turn_rate", "acceleration", "turn_acceleration")


def _robot(
    start: Spot,
    heading: Amount,
    model: str | None,
    shape: Outline | None,
    radius: float | None,
    mass: float | None,
    height: float | None,
    drive: DriveBuild | None,
    sensors: tuple[Installed, ...] | None,
    battery: BatteryBuild | None,
    **rest: Any,
) -> RobotSpec:
    if shape is not None and radius is not None:
        raise ValueError("give 'shape' or 'radius', not both")
    base = MODELS[model or "denning"]
    own = model is None and (shape is not None or drive is not None)
    hull = shape or (Circle(radius) if radius is not None else base.build.hull)
    build = Build(
        hull,
        _limited(drive or base.build.drive, {name: rest[name] for name in LIMITS if rest[name] is not None}),
        base.build.mass if mass is None else mass,
        base.build.height if height is None else height,
    )
    if isinstance(build.drive, Synchro) and not isinstance(hull, Circle):
        raise ValueError("a synchro drive has a round hull: it does not turn with the steering")
    carried = sensors if sensors is not None else () if own else base.sensors
    for kind in BUILDS:
        if rest[kind] is not None:
            carried = _changed(carried, kind, rest[kind])
    return RobotSpec(start, heading, build, carried, battery)


def _limited(drive: DriveBuild, limits: dict[str, Any]) -> DriveBuild:
    known = [field.name for field in fields(drive)]
    for name in limits:
        if name not in known:
            raise ValueError(f"this drive has no {name}; it has {', '.join(known)}")
    return replace(drive, **limits)


def _changed(sensors: tuple[Installed, ...], kind: str, changes: dict[str, Any]) -> tuple[Installed, ...]:
    sample = type(BUILDS[kind][0])
    places = [index for index, sensor in enumerate(sensors) if isinstance(sensor.build, sample)]
    if not places:
        raise ValueError(f"this robot carries no {kind}: name it under 'sensors'")
    changed = replace(sensors[places[0]], build=replace(sensors[places[0]].build, **changes))
    _check_ranges(asdict(changed.build))
    return (*sensors[: places[0]], changed, *sensors[places[0] + 1 :])


robot = record(
    _robot,
    start=Key(spot, doc="home is there"),
    heading=heading,
    model=Key(choice(*MODELS), None),
    shape=Key(shape, None),
    radius=Key(positive, None),
    mass=Key(mass, None),
    height=Key(positive, None),
    drive=Key(by_kind(DRIVES), None),
    sensors=Key(Spec(_sensors, sensor_list.schema), None),
    battery=Key(_of(BatteryBuild(), {"lasts": duration, "charges_in": duration, "level": share}), None),
    **{name: Key(drives[name], None) for name in LIMITS},
    **{kind: Key(_changes(BUILDS[kind][1]), None) for kind in BUILDS},
)


# --- the task and the rest ----------------------------------------------------------------------------

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
    trips=Key(whole(1, 1000), 1, doc="how many objects it holds"),
    id=Key(word, "donor"),
)


def _home(unload: float) -> float:
    return unload


home = record(_home, unload=Key(duration, doc="of standing at home until an object is taken off"))
goal = record(Goal, at=Key(point), within=Key(positive, 1.0), no_contact=Key(flag, False))
around = record(
    Round, about=Key(point), turns=Key(whole(1, 1000), 1), within=Key(positive, 3.0), no_contact=Key(flag, False)
)
place = scalar_or(choice("robot", "donor"), point)
strip = record(KeepClear, **{"from": Key(place, goes_to="start")}, to=Key(place, goes_to="end"), by=Key(length))
scatter = record(
    Scatter,
    kinds=Key(listed(choice(*SCATTERED), 1)),
    count=Key(row(_ordered, "how many [least, most]", whole(0, 100), whole(0, 100))),
    region=Key(region),
    min_gap=Key(length, 0.0),
    keep_clear=Key(listed(strip), ()),
)
weather = _of(Weather(), {"sun": angle, "jitter": angle, "gust": angle, "gusts": share})
slope = record(Slope, region=Key(region), rise=Key(quantity("angle", above=0, most=1)), uphill=Key(angle))


def _ground(slopes: tuple[Slope, ...]) -> Ground:
    return Ground(slopes)


JAMS = ("free", "light-jam", "bad-jam", "worst-jam")


def _event(
    at: float, vanish: str | None, put: tuple[str, Pose] | None, weather: Weather | None, head: str | None
) -> Event:
    given = [what for what in (vanish, put, weather, head) if what is not None]
    if len(given) != 1:
        raise ValueError("give one of vanish, put, weather and head")
    if head is not None:
        return Event(at, Jam(JAMS.index(head)))
    if vanish is not None:
        return Event(at, Vanish(vanish))
    return Event(at, Put(*put)) if put is not None else Event(at, Change(weather or Weather()))


def _put(thing: str, at: Pose) -> tuple[str, Pose]:
    return thing, at


event = record(
    _event,
    at=Key(moment),
    vanish=Key(word, None, doc="the id of a thing"),
    put=Key(record(_put, thing=Key(word), at=Key(pose)), None),
    weather=Key(weather, None),
    head=Key(choice(*JAMS), None, doc="it gets stuck, or is freed"),
)


def _fault(sensor: str, kind: str, at: float, until: float, amount: float) -> Fault:
    if until <= at:
        raise ValueError("'until' must be later than 'at'")
    if kind == "dropout" and not 0 <= amount <= 1:
        raise ValueError("the amount of a dropout is a chance from 0 to 1")
    return Fault(sensor, kind, at, until, amount)


fault = record(
    _fault,
    sensor=Key(word, doc="its name"),
    kind=Key(choice(*FAULTS)),
    at=Key(moment, 0.0),
    until=Key(duration, math.inf),
    amount=Key(quantity("number", least=-1e6, most=1e6), 1.0),
)


def _things(report: Report, node: yaml.Node, path: str) -> tuple[ThingSpec, ...] | Wrong:
    """Things whose ids differ."""
    things = thing_list(report, node, path)
    taken = ["robot"]
    for index, thing in enumerate(() if isinstance(things, str) else things):
        if thing.id in taken:
            report.wrong(node.value[index], f"{path}[{index}].id", f"the name {thing.id!r} is taken")
        taken += [thing.id] if thing.id else []
    return things


thing_list: Spec[tuple[ThingSpec, ...]] = listed(by_kind(THINGS))


def _scenario(
    ground: tuple[Slope, ...], donor: DonorSpec | None, donors: tuple[DonorSpec, ...], home: float | None, **rest: Any
) -> Scenario:
    if donor is not None and donors:
        raise ValueError("give 'donor' or 'donors', not both")
    donors = donors if donor is None else (donor,)
    if donors and rest["goal"] is not None:
        raise ValueError("a scenario has either a donor or a goal")
    if rest["round"] is not None and (donors or rest["goal"] is not None):
        raise ValueError("a scenario with 'round' has neither a donor nor a goal")
    return Scenario(ground=Ground(ground), donors=donors, unload=home, **rest)


def _whole(report: Report, node: yaml.Node, path: str) -> Scenario | Wrong:
    """A scenario whose events and faults speak of what is there."""
    scenario = keys_of_scenario(report, node, path)
    if isinstance(scenario, str):
        return scenario
    sensors = [sensor.name for sensor in scenario.robot.sensors]
    for index, fault in enumerate(scenario.faults):
        if fault.sensor not in sensors:
            message = f"the robot has no sensor {fault.sensor!r}; {did_you_mean(fault.sensor, sensors)}"
            report.wrong(_part(node, "faults", index), f"faults[{index}].sensor", message)
        elif message := wrong_fault(fault, scenario.robot.sensors):
            report.wrong(_part(node, "faults", index), f"faults[{index}]", message)
    things = [spec.id for spec in scenario.donors]
    for index, name in enumerate(things):
        if name in ("robot", *things[:index]):
            report.wrong(node, f"donors[{index}].id", f"the name {name!r} is taken")
    for index, thing in enumerate(scenario.things):
        if thing.id in things:
            report.wrong(_part(node, "things", index), f"things[{index}].id", f"the name {thing.id!r} is taken")
    things += [thing.id for thing in scenario.things if thing.id]
    for index, event in enumerate(scenario.events):
        match event.what:
            case Vanish(thing=name) | Put(thing=name) if name not in things:
                hint = did_you_mean(name, things) if things else "none has an id"
                report.wrong(_part(node, "events", index), f"events[{index}]", f"there is no thing {name!r}; {hint}")
            case _:
                pass
    return scenario


def _part(node: yaml.Node, key: str, index: int) -> yaml.Node:
    """The item of a list under a key of a mapping; both are there."""
    part: yaml.Node = next(value for name, value in node.value if name.value == key).value[index]
    return part


keys_of_scenario: Spec[Scenario] = record(
    _scenario,
    name=Key(word),
    bounds=Key(region, doc="what is shown"),
    robot=Key(robot),
    donor=Key(donor, None, doc="the task: fetch its object"),
    donors=Key(listed(donor, 1), (), doc="several; their ids differ"),
    home=Key(home, None),
    goal=Key(goal, None, doc="the task: reach this place"),
    round=Key(around, None, doc="the task: go round this place and come back"),
    things=Key(Spec(_things, thing_list.schema), ()),
    scatter=Key(listed(scatter), ()),
    weather=Key(weather, Weather()),
    ground=Key(listed(slope), ()),
    events=Key(listed(event), ()),
    faults=Key(listed(fault), ()),
    time_limit=Key(duration, 1800.0),
    source=Key(word, ""),
    left_out=Key(listed(word), ()),
)
SCENARIO: Spec[Scenario] = Spec(_whole, keys_of_scenario.schema)


def schema() -> Json:
    """The format as JSON Schema (draft 2020-12)."""
    head = {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": "rplan scenario"}
    return {**head, **SCENARIO.schema}


if __name__ == "__main__":
    sys.stdout.write(json.dumps(schema(), indent=1) + "\n")
