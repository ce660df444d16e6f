"""What stands, lies and moves in a world, as data, and a thing's body once it is in the world.

Takes: outlines, poses and intentions. Gives: `Placed` (a thing as a scenario lays it out) and `Thing` (the same thing
with its pymunk body). Leaves alone: stepping, and when an intention is acted upon (the files of this folder that are
named after a motion do that).
"""

from __future__ import annotations

import math
from bisect import bisect_left
from dataclasses import dataclass
from itertools import pairwise

import pymunk

from behaviours.interface import Pose, Vec2, wrap
from sim.raycast import Circle, Outline, Polygon, Rings, reach

ROBOT, OTHER = 1, 2  # collision types
FRICTION = 0.2  # between hulls; nothing climbs or sticks in the plane
AWAY = 1000.0  # [m] where things wait that are not in the world


@dataclass(frozen=True, slots=True)
class At:
    """From a moment [s] on; where `every` [s] is given, again and again."""

    time: float
    every: float = math.inf


@dataclass(frozen=True, slots=True)
class RobotWithin:
    """When the robot comes within this distance [m] of the thing for the first time, hull to hull."""

    distance: float


@dataclass(frozen=True, slots=True)
class RobotLeft:
    """When the robot is this far [m] from where it started for the first time."""

    distance: float


Trigger = At | RobotWithin | RobotLeft


@dataclass(frozen=True, slots=True)
class Waypoint:
    """A corner of a track [m] and how long [s] to wait there."""

    x: float
    y: float
    wait: float = 0.0


@dataclass(frozen=True, slots=True)
class Travel:
    """Along a track at a speed [m/s], from its first waypoint on.

    then: "vanish" (in the world only while it travels), "stay" at the end, or "loop" (back to the first waypoint).
    look_ahead [m]: it brakes for what stands in its lane so near; heeds_all: for whatever it is, otherwise for
    the robot alone.
    """

    track: tuple[Waypoint, ...]
    speed: float
    start: Trigger = At(0.0)
    then: str = "loop"
    look_ahead: float = 0.6
    heeds_all: bool = False
    acceleration: float = 2.0
    turn_rate: float = 1.0


@dataclass(frozen=True, slots=True)
class Roll:
    """Once, towards the robot at a speed [m/s], until the gap [m] between the hulls is `gap`."""

    start: Trigger
    speed: float = 1.0
    gap: float = 0.1


@dataclass(frozen=True, slots=True)
class Shift:
    """Once, by a way [m, world] at a speed [m/s]."""

    start: Trigger
    by: Vec2
    speed: float = 0.3


@dataclass(frozen=True, slots=True)
class Keyframe:
    """Where to be [m] at a moment [s]."""

    time: float
    x: float
    y: float


def _moment_of(frame: Keyframe) -> float:
    return frame.time


@dataclass(frozen=True, slots=True)
class Keyframes:
    """From place to place at set times, straight and evenly in between, and from the last back to the first at once."""

    frames: tuple[Keyframe, ...]

    def at(self, time: float) -> Vec2:
        """The place [m] at a moment [s]."""
        time = self._phase(time)
        index = bisect_left(self.frames, time, key=_moment_of)
        if index == 0 or index == len(self.frames):
            end = self.frames[min(index, len(self.frames) - 1)]
            return end.x, end.y
        before, after = self.frames[index - 1], self.frames[index]
        share = (time - before.time) / (after.time - before.time)
        return before.x + share * (after.x - before.x), before.y + share * (after.y - before.y)

    def begins_anew(self, before: float, after: float) -> bool:
        """Whether the track begins anew between two moments [s], at another place than where it ends."""
        ends = self.frames[0], self.frames[-1]
        return self._phase(after) < self._phase(before) and (ends[0].x, ends[0].y) != (ends[1].x, ends[1].y)

    def _phase(self, time: float) -> float:
        first, last = self.frames[0].time, self.frames[-1].time
        return first + (time - first) % (last - first) if time > last else time


Motion = Travel | Roll | Shift | Keyframes


@dataclass(frozen=True, slots=True)
class Placed:
    """A thing where a scenario puts it. mass [kg]: 0 for what cannot be pushed; height [m] above the ground.

    changes: something will happen to it at a set time. charges [m]: the gap between the hulls at which it charges a
    robot that stands; 0 for what is no charger.
    """

    id: str
    kind: str
    outline: Outline
    pose: Pose
    height: float
    mass: float = 0.0
    motion: Motion | None = None
    changes: bool = False
    charges: float = 0.0

    @property
    def moves(self) -> bool:
        """Whether it can ever be elsewhere."""
        return self.mass > 0 or self.motion is not None or self.changes


class Thing:
    """A thing in the world: `placed` and the body that carries its shape.

    x, y [m], theta, vx, vy [m/s], turn [rad/s] are what is so; the body is told of it (`tell`) before the space is
    asked or stepped, and asked (`ask`) afterwards.
    """

    def __init__(self, index: int, placed: Placed, space: pymunk.Space) -> None:
        self.index, self.placed, self.reach = index, placed, reach(placed.outline)
        self.x, self.y, self.theta = placed.pose.x, placed.pose.y, placed.pose.theta
        self.vx = self.vy = self.turn = 0.0
        self.body, self._space = _body(placed), space
        self.body.position, self.body.angle = (self.x, self.y), self.theta
        self.shapes = _shapes(placed.outline, self.body)
        for shape in self.shapes:
            shape.friction, shape.collision_type = FRICTION, OTHER
        space.add(self.body, *self.shapes)
        self.present = True
        self._told = True

    @property
    def pose(self) -> Pose:
        """Where it is now; meaningless while it is not present."""
        return Pose(self.x, self.y, wrap(self.theta))

    @property
    def speed(self) -> float:
        """[m/s]"""
        return math.hypot(self.vx, self.vy)

    def put(self, x: float, y: float, theta: float) -> None:
        """Into the world at a place, at rest."""
        self._set(x, y, theta, True)

    def remove(self) -> None:
        """Out of the world, to where nothing meets it."""
        self._set(AWAY * (1 + self.index), AWAY, 0.0, False)

    def _set(self, x: float, y: float, theta: float, present: bool) -> None:
        self.x, self.y, self.theta, self.present = x, y, theta, present
        self.vx = self.vy = self.turn = 0.0
        self._told = False
        self.tell()

    def go(self, vx: float, vy: float, turn: float = 0.0) -> None:
        """Move so from now on [m/s, rad/s]."""
        if vx != self.vx or vy != self.vy or turn != self.turn or not self._told:
            self.vx, self.vy, self.turn, self._told = vx, vy, turn, False

    def glide(self, dt: float) -> None:
        """Where its velocity takes it in dt [s], if nothing is in the way."""
        self.x, self.y, self.theta = self.x + self.vx * dt, self.y + self.vy * dt, self.theta + self.turn * dt
        self._told = False

    def tell(self) -> None:
        """The body what is so."""
        if not self._told:
            body = self.body
            body.position, body.angle = (self.x, self.y), self.theta
            body.velocity, body.angular_velocity = (self.vx, self.vy), self.turn
            self._space.reindex_shapes_for_body(body)
            self._told = True

    def ask(self) -> None:
        """The body what is so."""
        body = self.body
        (self.x, self.y), self.theta = body.position, body.angle
        (self.vx, self.vy), self.turn = body.velocity, body.angular_velocity


def _body(placed: Placed) -> pymunk.Body:
    if placed.mass > 0:
        return pymunk.Body(placed.mass, _inertia(placed.mass, placed.outline))
    kinematic = placed.motion is not None
    return pymunk.Body(body_type=pymunk.Body.KINEMATIC if kinematic else pymunk.Body.STATIC)


def _inertia(mass: float, outline: Outline) -> float:
    match outline:
        case Polygon(vertices):
            return float(pymunk.moment_for_poly(mass, vertices))
        case _:
            return float(pymunk.moment_for_circle(mass, 0.0, reach(outline)))


def _shapes(outline: Outline, body: pymunk.Body) -> tuple[pymunk.Shape, ...]:
    match outline:
        case Circle(radius):
            return (pymunk.Circle(body, radius),)
        case Polygon(vertices):
            return (pymunk.Poly(body, vertices),)
        case Rings(rings):
            edges = [pair for ring in rings for pair in pairwise((*ring, ring[0]))]
            return tuple(pymunk.Segment(body, a, b, 0.0) for a, b in edges)
