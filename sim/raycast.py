"""One caster for every range sensor: rays against the very outlines that collide.

Takes: rays, and a `Scene` of circles and convex polygons at their present poses. Gives: for each ray the distance
to the first thing and which thing that is, or every crossing with its way in and its way out.
Leaves alone: noise, and the robot itself (it is not in the scene).

Method. First a cull by angular extent: seen from the middle of all ray starts, a thing (widened by how far the starts
lie from there) fills an interval of angles, and only the rays in it can meet the thing. The pairs that are left are
computed exactly: circles by the chord, polygons by the half-planes of their edges (the last way in must come before the
first way out), so that no ray slips through a corner. A ray that starts inside a shape meets it at distance 0, as
pymunk has it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from behaviours.interface import Floats, Pose, Vec2

Ints = NDArray[np.intp]
MARGIN = 1e-9  # [m] by which enclosing circles are wider than need be, so that rounding loses no pair


@dataclass(frozen=True, slots=True)
class Circle:
    """A disc round the origin of its body: radius [m]."""

    radius: float


@dataclass(frozen=True, slots=True)
class Polygon:
    """A convex polygon: corners [m] in the body frame, counter-clockwise."""

    vertices: tuple[Vec2, ...]


@dataclass(frozen=True, slots=True)
class Rings:
    """Closed rings of corners [m] in the body frame, the solid on the left: outer ones counter-clockwise, holes clockwise.

    For what never moves, such as the walls of a map; need not be convex.
    """

    rings: tuple[tuple[Vec2, ...], ...]


Outline = Circle | Polygon | Rings


def box(length: float, width: float) -> Polygon:
    """The rectangle round the origin, `length` along x and `width` along y [m]."""
    x, y = length / 2, width / 2
    return Polygon(((-x, -y), (x, -y), (x, y), (-x, y)))


def reach(outline: Outline) -> float:
    """Radius [m] of the circle round the origin of the body that encloses the outline."""
    match outline:
        case Circle(radius):
            return radius
        case Polygon(vertices):
            return max(math.hypot(x, y) for x, y in vertices)
        case Rings(rings):
            return max(math.hypot(x, y) for ring in rings for x, y in ring)


@dataclass(frozen=True, slots=True)
class Rays:
    """Where rays start [m], where they point [rad, world], and how high above the ground they run [m]; each (n,)."""

    x: Floats
    y: Floats
    angle: Floats
    height: Floats


def ray(start: Vec2, angle: float, height: float = 0.0) -> Rays:
    """One ray."""
    return Rays(*(np.array([number]) for number in (start[0], start[1], angle, height)))


class Fan:
    """Rays from one origin, made once for a sensor.

    bearings: (n,) [rad] in the frame of the sensor, rising, over a full turn at most; evenly spaced or not. Raises
    ValueError where they are not.
    """

    def __init__(self, bearings: Floats) -> None:
        self.bearings = np.array(bearings, dtype=float)
        rising = self.bearings.ndim == 1 and bool((np.diff(self.bearings) > 0).all())
        if not rising or not self.bearings.size or not np.ptp(self.bearings) <= math.tau + MARGIN:
            raise ValueError("bearings of a fan must be finite and rise, over a full turn at most")
        self.bearings.setflags(write=False)


@dataclass(frozen=True, slots=True)
class Crossings:
    """Pairs of a ray and a thing on it, in the order of the things: distances [m] of the way in and the way out."""

    ray: Ints
    thing: Ints
    enter: Floats
    exit: Floats


class Scene:
    """The outlines of things at their present poses, laid out for `cast`."""

    def __init__(self, outlines: Sequence[Outline], poses: Sequence[Pose], heights: Sequence[float]) -> None:
        count = len(outlines)
        edges = max([len(o.vertices) for o in outlines if isinstance(o, Polygon)], default=3)
        self._outlines = tuple(outlines)
        self.x, self.y = np.zeros(count), np.zeros(count)
        self.height = np.array(heights, dtype=float)
        self.round = np.array([isinstance(o, Circle) for o in outlines], dtype=bool)
        self.radius = np.array([reach(o) for o in outlines], dtype=float)
        self.wide = self.radius + np.where(self.round, 0.0, MARGIN)
        self.normal_x, self.normal_y, self.offset = (np.zeros((edges, count)) for _ in range(3))
        for index, pose in enumerate(poses):
            self.place(index, pose)

    def place(self, index: int, pose: Pose) -> None:
        """Put thing `index` at a new pose."""
        self.x[index], self.y[index] = pose.x, pose.y
        outline = self._outlines[index]
        if isinstance(outline, Polygon):
            self._place_edges(index, outline, pose)

    def _place_edges(self, index: int, outline: Polygon, pose: Pose) -> None:
        """Edges as half-planes normal . p <= offset; the last edge fills the column up."""
        c, s = math.cos(pose.theta), math.sin(pose.theta)
        corners = [(pose.x + c * x - s * y, pose.y + s * x + c * y) for x, y in outline.vertices]
        last = len(corners) - 1
        for edge in range(len(self.offset)):
            (ax, ay), (bx, by) = corners[min(edge, last)], corners[(min(edge, last) + 1) % len(corners)]
            length = math.hypot(bx - ax, by - ay)
            nx, ny = (by - ay) / length, (ax - bx) / length
            self.normal_x[edge, index], self.normal_y[edge, index] = nx, ny
            self.offset[edge, index] = nx * ax + ny * ay


def crossings(rays: Rays, max_range: float, scene: Scene) -> Crossings:
    """Every thing, higher than the ray runs, that a ray meets within `max_range` [m]."""
    which, thing = _candidates(rays, max_range, scene)
    dx, dy = np.cos(rays.angle)[which], np.sin(rays.angle)[which]
    to_x, to_y = scene.x[thing] - rays.x[which], scene.y[thing] - rays.y[which]
    along, across = dx * to_x + dy * to_y, dx * to_y - dy * to_x
    near = (np.abs(across) <= scene.wide[thing]) & (rays.height[which] < scene.height[thing])
    which, thing, dx, dy = which[near], thing[near], dx[near], dy[near]
    enter, leave = _chords(along[near], across[near], scene.radius[thing])
    flat = np.nonzero(~scene.round[thing])[0]
    enter[flat], leave[flat] = _through_edges(rays, which[flat], dx[flat], dy[flat], scene, thing[flat])
    met = (enter <= leave) & (leave > 0) & (enter <= max_range)
    return Crossings(which[met], thing[met], np.maximum(enter[met], 0.0), leave[met])


def _candidates(rays: Rays, max_range: float, scene: Scene) -> tuple[Ints, Ints]:
    """Pairs of a ray and a thing that its angle does not rule out, thing by thing."""
    count = rays.x.size
    x, y = rays.x.sum() / count, rays.y.sum() / count
    spread = float(np.sqrt(((rays.x - x) ** 2 + (rays.y - y) ** 2).max()))
    to_x, to_y = scene.x - x, scene.y - y
    distance, size = np.hypot(to_x, to_y), scene.wide + (spread + MARGIN)
    things = np.nonzero(distance <= max_range + size)[0]
    half = np.arcsin(np.minimum(size[things] / np.maximum(distance[things], MARGIN), 1.0))
    half = np.where(distance[things] <= size[things], math.pi, half) + MARGIN
    low = np.mod(np.arctan2(to_y[things], to_x[things]) - half, math.tau)
    turned = np.mod(rays.angle, math.tau)
    order = np.argsort(turned, kind="stable")
    angles = np.concatenate([turned[order], turned[order] + math.tau, turned[order] + 2 * math.tau])
    first = np.searchsorted(angles, low)
    number = np.minimum(np.searchsorted(angles, low + 2 * half, side="right") - first, count)
    skipped = np.cumsum(number) - number
    place = np.arange(int(number.sum())) + np.repeat(first - skipped, number)
    return order[place % count], np.repeat(things, number)


def _chords(along: Floats, across: Floats, radius: Floats) -> tuple[Floats, Floats]:
    half = np.sqrt(np.maximum(radius * radius - across * across, 0.0))
    return along - half, along + half


def _through_edges(rays: Rays, which: Ints, dx: Floats, dy: Floats, scene: Scene, thing: Ints) -> tuple[Floats, Floats]:
    nx, ny = scene.normal_x.take(thing, axis=1), scene.normal_y.take(thing, axis=1)
    closing = nx * dx + ny * dy
    gap = scene.offset.take(thing, axis=1) - nx * rays.x[which] - ny * rays.y[which]
    parallel = closing == 0
    at = gap / np.where(parallel, 1.0, closing)
    enter = np.where(closing < 0, at, -np.inf).max(axis=0)
    leave = np.where(closing > 0, at, np.inf).min(axis=0)
    return enter, np.where((parallel & (gap < 0)).any(axis=0), -np.inf, leave)


def cast(rays: Rays, max_range: float, scene: Scene) -> tuple[Floats, Ints]:
    """Distance [m] to the first thing along each ray (`max_range` if there is none) and its index (-1 if none)."""
    met = crossings(rays, max_range, scene)
    ranges = np.full(rays.x.shape, max_range)
    np.minimum.at(ranges, met.ray, met.enter)
    things = np.full(rays.x.shape, -1, dtype=np.intp)
    first = np.nonzero(met.enter == ranges[met.ray])[0][::-1]
    things[met.ray[first]] = met.thing[first]
    return ranges, things


def sweep(fan: Fan, pose: Pose, height: float, max_range: float, scene: Scene) -> Floats:
    """Distance [m] to the first thing along each ray of a fan at a pose [m, rad; world], `height` [m] above ground."""
    return sweep_things(fan, pose, height, max_range, scene)[0]


def sweep_things(fan: Fan, pose: Pose, height: float, max_range: float, scene: Scene) -> tuple[Floats, Ints]:
    """As `sweep`, and the index of the thing that each ray meets first (-1 if none)."""
    x, y, high = (np.full(fan.bearings.shape, number) for number in (pose.x, pose.y, height))
    return cast(Rays(x, y, fan.bearings + pose.theta, high), max_range, scene)
