"""What a seed makes of a scenario: where everything stands.

Takes: a scenario and chance. Gives: a `Layout` without anything left to chance.
Leaves alone: motion (triggers and tracks go into the layout as they are).

Scattered things are drawn at random and kept if they are far enough from everything else, from the strips to keep
clear, and from the tracks of what moves; if the room does not suffice they are all drawn anew, a hundred times.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import count, pairwise

from numpy.random import Generator

from behaviours.interface import Pose, Vec2, wrap
from sim.frames import distance_to_segment
from sim.raycast import Circle, Outline, Polygon, Rings, reach
from sim.scenarios.scenario import (
    SCATTERED,
    Amount,
    Between,
    DonorSpec,
    KeepClear,
    Place,
    Put,
    Scatter,
    Scenario,
    Spot,
    ThingSpec,
    Vanish,
)
from sim.scenarios.schema import Problem, ScenarioError
from sim.things.thing import Placed, Travel

DONOR = "donor"
ATTEMPTS, DRAWS = 100, 200
MOST_WORK = 300_000  # corners that are looked at for one group of scattered things
Strip = tuple[Vec2, Vec2, float]


@dataclass(frozen=True, slots=True)
class Layout:
    """Where everything stands at the start; the donors are the first of the things."""

    start: Pose
    things: tuple[Placed, ...]


def lay_out(scenario: Scenario, chance: Generator) -> Layout:
    """Draw what the scenario leaves open. Raises ScenarioError where scattered things find no room."""
    start = Pose(*_spot(scenario.robot.start, chance), wrap(_drawn(scenario.robot.heading, chance)))
    things = [_donor(spec) for spec in scenario.donors]
    for spec in scenario.things:
        there, heading, at = chance.random() < spec.present, _drawn(spec.heading, chance), _spot(spec.at, chance)
        if there:
            things.append(_placed(spec, at, heading))
    for scatter in scenario.scatter:
        things += _scattered(scatter, scenario, start, things, chance)
    things = _named(things)
    _check_start(scenario, start, things)
    changing = {event.what.thing for event in scenario.events if isinstance(event.what, Vanish | Put)}
    return Layout(start, tuple(replace(thing, changes=thing.id in changing) for thing in things))


def _check_start(scenario: Scenario, start: Pose, things: list[Placed]) -> None:
    for thing in things:
        if distance((start.x, start.y), thing.outline, thing.pose) < _inner(scenario.robot.build.hull):
            raise ScenarioError(
                [Problem(scenario.name, 1, 1, "robot.start", f"the robot stands in {thing.id!r} there")]
            )


def _inner(hull: Outline) -> float:
    """Radius [m] of the circle round the origin that the hull encloses."""
    match hull:
        case Circle(radius):
            return radius
        case Polygon(vertices):
            return min(distance_to_segment((0.0, 0.0), a, b) for a, b in pairwise((*vertices, vertices[0])))
        case Rings():
            return 0.0


def _drawn(amount: Amount, chance: Generator) -> float:
    match amount:
        case Between(low, high):
            return float(chance.uniform(low, high))
        case _:
            return amount


def _spot(spot: Spot, chance: Generator) -> Vec2:
    return _drawn(spot[0], chance), _drawn(spot[1], chance)


def _donor(spec: DonorSpec) -> Placed:
    return Placed(spec.id, DONOR, Circle(spec.radius), Pose(*spec.at, 0.0), spec.height, motion=spec.move)


def _placed(spec: ThingSpec, at: Vec2, heading: float) -> Placed:
    return Placed(
        spec.id,
        spec.kind,
        spec.outline,
        Pose(*at, wrap(heading)),
        spec.height,
        spec.mass,
        spec.motion,
        charges=spec.charges,
    )


def _named(things: list[Placed]) -> list[Placed]:
    """Those without a name get their kind and the next number that is free."""
    taken = {thing.id for thing in things}
    numbers: dict[str, Iterator[int]] = {}
    named = []
    for thing in things:
        if not thing.id:
            free = numbers.setdefault(thing.kind, count(1))
            name = next(name for number in free if (name := f"{thing.kind}-{number}") not in taken)
            thing = replace(thing, id=name)
        named.append(thing)
    return named


def _scattered(
    scatter: Scatter, scenario: Scenario, start: Pose, before: list[Placed], chance: Generator
) -> list[Placed]:
    strips = [*_strips(scatter.keep_clear, scenario, start), *_lanes(before)]
    robot = Placed("robot", "robot", Circle(scenario.robot.build.radius), Pose(start.x, start.y), 1.0)
    wanted = int(chance.integers(scatter.count[0], scatter.count[1] + 1))
    work = _Work(MOST_WORK)
    for _ in range(ATTEMPTS):
        new: list[Placed] = []
        while len(new) < wanted and (one := _one(scatter, strips, [robot, *before, *new], chance, work)):
            new.append(one)
        if len(new) == wanted:
            return new
    message = (
        f"no room for {wanted} scattered things in {list(scatter.region)}: make the region wider or min_gap smaller"
    )
    raise ScenarioError([Problem(scenario.name, 1, 1, "scatter", message)])


@dataclass(slots=True)
class _Work:
    """How many corners may still be looked at."""

    left: int

    def do(self, outline: Outline) -> bool:
        """Look at an outline; whether there was any left for it."""
        match outline:
            case Circle():
                self.left -= 1
            case Polygon(vertices):
                self.left -= len(vertices)
            case Rings(rings):
                self.left -= sum(map(len, rings))
        return self.left >= 0


def _one(scatter: Scatter, strips: list[Strip], others: list[Placed], chance: Generator, work: _Work) -> Placed | None:
    spec = SCATTERED[scatter.kinds[int(chance.integers(len(scatter.kinds)))]]
    xmin, ymin, xmax, ymax = scatter.region
    for _ in range(DRAWS):
        at = float(chance.uniform(xmin, xmax)), float(chance.uniform(ymin, ymax))
        radius = reach(spec.outline)
        if all(distance_to_segment(at, a, b) >= by + radius for a, b, by in strips) and all(
            work.do(other.outline) and distance(at, other.outline, other.pose) - radius >= scatter.min_gap
            for other in others
        ):
            return _placed(spec, at, 0.0)
    return None


def _strips(keep_clear: tuple[KeepClear, ...], scenario: Scenario, start: Pose) -> Iterator[Strip]:
    for strip in keep_clear:
        yield _point(strip.start, scenario, start), _point(strip.end, scenario, start), strip.by


def _point(place: Place, scenario: Scenario, start: Pose) -> Vec2:
    if not isinstance(place, str):
        return place
    if place == "robot":
        return start.x, start.y
    if scenario.donor is None:
        raise ScenarioError([Problem(scenario.name, 1, 1, "scatter", "keeps clear of a donor, and there is none")])
    return scenario.donor.at


def _lanes(things: list[Placed]) -> Iterator[Strip]:
    """The tracks of what travels, as wide as it is."""
    for thing in things:
        if isinstance(thing.motion, Travel):
            track, half_width = thing.motion.track, _half_width(thing.outline)
            ends = track if thing.motion.then == "loop" else track[:-1]
            for index, a in enumerate(ends):
                b = track[(index + 1) % len(track)]
                yield (a.x, a.y), (b.x, b.y), half_width


def _half_width(outline: Outline) -> float:
    match outline:
        case Circle(radius):
            return radius
        case Polygon(vertices):
            return max(abs(y) for _, y in vertices)
        case Rings():
            return reach(outline)


def distance(point: Vec2, outline: Outline, pose: Pose) -> float:
    """Distance [m] of the point from the outline at a pose; within a polygon or rings 0, within a circle less."""
    match outline:
        case Circle(radius):
            return math.dist(point, (pose.x, pose.y)) - radius
        case Polygon(vertices):
            return _distance_to_rings(point, (vertices,), pose)
        case Rings(rings):
            return _distance_to_rings(point, rings, pose)


def _distance_to_rings(point: Vec2, rings: tuple[tuple[Vec2, ...], ...], pose: Pose) -> float:
    c, s = math.cos(pose.theta), math.sin(pose.theta)
    dx, dy = point[0] - pose.x, point[1] - pose.y
    x, y = c * dx + s * dy, c * dy - s * dx
    pairs = [pair for ring in rings for pair in pairwise((*ring, ring[0]))]
    inside = sum((a[1] > y) != (b[1] > y) and x < a[0] + (y - a[1]) * (b[0] - a[0]) / (b[1] - a[1]) for a, b in pairs)
    return 0.0 if inside % 2 else min(distance_to_segment((x, y), a, b) for a, b in pairs)
