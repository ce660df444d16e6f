"""A thing that goes elsewhere once, on a straight way.

Takes: a thing with a `Shift`. Gives: the velocity of its body. Leaves alone: what stands on the way.
"""

from __future__ import annotations

import math

from sim.things.surroundings import Surroundings, goes_off
from sim.things.thing import Shift, Thing


class Shifter:
    """One shifted thing. `prepare` is called once before each tick."""

    def __init__(self, thing: Thing, shift: Shift) -> None:
        self._thing, self._shift = thing, shift
        self._goal = thing.placed.pose.x + shift.by[0], thing.placed.pose.y + shift.by[1]
        self._going = False
        self._done = False

    def prepare(self, around: Surroundings) -> None:
        """Wait, go on, or stand still for good."""
        if self._done:
            return
        self._going = self._going or goes_off(self._shift.start, self._thing, around)
        if self._going:
            self._go(around.dt)

    def _go(self, dt: float) -> None:
        thing = self._thing
        dx, dy = self._goal[0] - thing.x, self._goal[1] - thing.y
        left = math.hypot(dx, dy)
        self._done = left < 1e-9
        share = 0.0 if self._done else min(self._shift.speed, left / dt) / left
        thing.go(dx * share, dy * share)
