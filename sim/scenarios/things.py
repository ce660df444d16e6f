"""The things of a scenario: walls, cars, people, and what is shaped as the writer wishes.

Takes: nothing. Gives: `THINGS`, what each kind of thing is told by. Leaves alone: how things move; see sim/things.
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import yaml

from behaviours.interface import Vec2
from sim.raycast import Circle, Outline, box
from sim.scenarios.measures import (
    amount_of_angle,
    coordinate,
    corners,
    duration,
    length,
    mass,
    moment,
    point,
    positive,
    rings,
    share,
    size,
    speed,
    spot,
    track,
)
from sim.scenarios.scenario import CAR_HEIGHT, CAR_SIZE, Amount, Spot, ThingSpec
from sim.scenarios.schema import Key, Report, Spec, Wrong, choice, listed, quantity, record, row, word
from sim.scenarios.shapes import Ring, convex, is_convex, solid
from sim.things.thing import At, Keyframe, Keyframes, RobotLeft, RobotWithin, Roll, Travel, Trigger, Waypoint


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
