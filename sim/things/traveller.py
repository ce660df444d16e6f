"""Cars that drive and people who walk: along a track, braking for what stands in their way.

Takes: a thing with a `Travel` and, tick by tick, its surroundings. Gives: the velocity of its body for the tick.
Leaves alone: things that cannot move (a track must not lead through them), and the stepping.
"""

from __future__ import annotations

import math

from behaviours.interface import wrap
from sim.frames import approach
from sim.raycast import Circle, Polygon, Rings
from sim.things.surroundings import Disc, Surroundings, goes_off
from sim.things.thing import At, Thing, Travel

ELBOW_ROOM = 0.1  # [m] to either side of the hull that belongs to the lane


class Traveller:
    """One travelling thing. `prepare` is called once before each tick."""

    def __init__(self, thing: Thing, travel: Travel) -> None:
        self._thing, self._travel = thing, travel
        self._half_length, self._half_width = _half_sizes(thing)
        self._start = travel.start
        self._travelling = False
        self._leg, self._along, self._speed, self._wait_until = 0, 0.0, 0.0, 0.0
        if travel.then == "vanish":
            thing.remove()

    def prepare(self, around: Surroundings) -> None:
        """Set the velocity of the body for this tick."""
        if not self._travelling and goes_off(self._start, self._thing, around):
            self._set_out(around.time)
        if self._travelling:
            self._advance(around)

    def _set_out(self, time: float) -> None:
        first, heading = self._travel.track[0], self._direction(0)
        self._travelling, self._leg, self._along, self._speed = True, 0, 0.0, 0.0
        self._wait_until = time + first.wait
        if self._travel.then == "vanish":
            self._thing.put(first.x, first.y, heading)
            self._speed = self._travel.speed
        if isinstance(self._start, At):
            self._start = At(self._start.time + self._start.every, self._start.every)
        else:
            self._start = At(math.inf)

    def _advance(self, around: Surroundings) -> None:
        blocked = around.time < self._wait_until or self._is_blocked(around)
        goal = 0.0 if blocked else self._travel.speed
        self._speed = approach(self._speed, goal, self._travel.acceleration * around.dt)
        self._along += self._speed * around.dt
        if self._along >= self._length(self._leg):
            self._turn_corner(around.time)
        if self._travelling:
            self._set_velocity(around.dt)

    def _turn_corner(self, time: float) -> None:
        track = self._travel.track
        self._leg, self._along = (self._leg + 1) % len(track), 0.0
        self._wait_until = time + track[self._leg].wait
        self._speed = 0.0 if track[self._leg].wait > 0 else self._speed
        if self._leg == len(track) - 1 and self._travel.then != "loop":
            self._arrive()

    def _arrive(self) -> None:
        self._travelling = False
        self._thing.go(0.0, 0.0)
        if self._travel.then == "vanish":
            self._thing.remove()

    def _set_velocity(self, dt: float) -> None:
        """So that the thing is at its place on the track when the tick is over."""
        thing, a, heading = self._thing, self._travel.track[self._leg], self._direction(self._leg)
        x, y = a.x + self._along * math.cos(heading), a.y + self._along * math.sin(heading)
        most = self._travel.turn_rate
        turn = max(-most, min(most, wrap(heading - thing.theta) / dt))
        thing.go((x - thing.x) / dt, (y - thing.y) / dt, turn)

    def _is_blocked(self, around: Surroundings) -> bool:
        heading, thing = self._direction(self._leg), self._thing
        c, s = math.cos(heading), math.sin(heading)
        heeded = (around.robot, *around.others()) if self._travel.heeds_all else (around.robot,)
        return any(self._in_lane(disc, thing.x, thing.y, c, s) for disc in heeded if disc.index != thing.index)

    def _in_lane(self, disc: Disc, x: float, y: float, c: float, s: float) -> bool:
        ahead = c * (disc.x - x) + s * (disc.y - y)
        aside = abs(c * (disc.y - y) - s * (disc.x - x))
        gap = ahead - self._half_length - disc.radius
        return ahead > 0 and gap < self._travel.look_ahead and aside < self._half_width + disc.radius + ELBOW_ROOM

    def _next(self, leg: int) -> int:
        return (leg + 1) % len(self._travel.track)

    def _direction(self, leg: int) -> float:
        a, b = self._travel.track[leg], self._travel.track[self._next(leg)]
        return math.atan2(b.y - a.y, b.x - a.x)

    def _length(self, leg: int) -> float:
        a, b = self._travel.track[leg], self._travel.track[self._next(leg)]
        return math.hypot(b.x - a.x, b.y - a.y)


def _half_sizes(thing: Thing) -> tuple[float, float]:
    match thing.placed.outline:
        case Circle(radius):
            return radius, radius
        case Polygon(vertices):
            return max(x for x, _ in vertices), max(y for _, y in vertices)
        case Rings():
            return thing.reach, thing.reach
