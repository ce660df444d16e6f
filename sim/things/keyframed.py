"""Things that are where their keyframes say, whatever stands in the way.

Takes: a thing with `Keyframes` and, tick by tick, its surroundings. Gives: the velocity of its body for the tick.
Leaves alone: its heading.
"""

from __future__ import annotations

from sim.things.surroundings import Surroundings
from sim.things.thing import Keyframes, Thing


class Keyframed:
    """One keyframed thing. `prepare` is called once before each tick."""

    def __init__(self, thing: Thing, keyframes: Keyframes) -> None:
        self._thing, self._keyframes = thing, keyframes
        thing.put(*keyframes.at(0.0), thing.placed.pose.theta)

    def prepare(self, around: Surroundings) -> None:
        """So that it is in its place when the tick is over."""
        thing = self._thing
        x, y = self._keyframes.at(around.time + around.dt)
        if self._keyframes.begins_anew(around.time, around.time + around.dt):
            thing.put(x, y, thing.theta)
        thing.go((x - thing.x) / around.dt, (y - thing.y) / around.dt)
