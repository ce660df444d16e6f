"""A thing that is rolled towards the robot and comes to rest close to its hull.

Takes: a thing with a `Roll`. Gives: the velocity of its body while it rolls. Leaves alone: friction afterwards, and
what it bumps into on its way (it then gives up after `PATIENCE`).
"""

from __future__ import annotations

import math

import pymunk

from sim.things.surroundings import Surroundings, goes_off
from sim.things.thing import Roll, Thing

PATIENCE = 10.0  # [s]


class Roller:
    """One rolled thing. `prepare` is called once before each tick."""

    def __init__(self, thing: Thing, roll: Roll) -> None:
        self._thing, self._roll = thing, roll
        self._until = math.inf
        self._velocity = (0.0, 0.0)
        self._done = False

    @property
    def rolling(self) -> bool:
        """Whether it is on its way."""
        return self._until < math.inf and not self._done

    def prepare(self, around: Surroundings) -> None:
        """Begin, go on, or come to rest."""
        if self._done:
            return
        if self._until == math.inf and goes_off(self._roll.start, self._thing, around):
            self._until = around.time + PATIENCE
            self._thing.body.velocity_func = self._drive
        if self._until < math.inf:
            self._steer(around)

    def _steer(self, around: Surroundings) -> None:
        x, y = self._thing.x, self._thing.y
        way = around.gap_to_robot((x, y), self._thing.reach) - self._roll.gap
        if way <= 0 or around.time >= self._until:
            self._come_to_rest()
            return
        speed, angle = min(self._roll.speed, way / around.dt), math.atan2(around.robot.y - y, around.robot.x - x)
        self._velocity = speed * math.cos(angle), speed * math.sin(angle)

    def _come_to_rest(self) -> None:
        self._done = True
        self._thing.go(0.0, 0.0, self._thing.turn)
        self._thing.body.velocity_func = pymunk.Body.update_velocity

    def _drive(self, body: pymunk.Body, _gravity: tuple[float, float], _damping: float, _dt: float) -> None:
        body.velocity = self._velocity
