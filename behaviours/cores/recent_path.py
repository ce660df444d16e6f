"""A trace of where a robot has been lately, so that it need not go there again.

Takes: places and stamps. Gives: the trace, by time or by distance, without what lies near. Leaves alone: frames, and
what the points are taken for. Source: Yamauchi 2005, "Wayfarer", section 4.2 (100 points, one in 0.2 s); what is near
enough to be left out is not printed.
"""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass

import numpy as np

from behaviours.interface import Floats, Vec2

SLACK = 1e-9
"""[s], [m]: what rounding may take from a sampling step."""


@dataclass(frozen=True, slots=True)
class TraceSettings:
    """sample [s]: one point in this time; points: how many are kept; ignored [m]: nearer ones are not given.

    spacing [m]: by_distance, one point in this distance instead. here [m]: a point so near is "here".
    """

    sample: float = 0.2
    points: int = 100
    ignored: float = 1.0
    here: float = 1.0
    spacing: float = 0.1
    by_distance: bool = False


class Trace:
    """A ring of places (x, y) [m] with the way [m] driven until each, oldest first."""

    def __init__(self, settings: TraceSettings) -> None:
        self.settings = settings
        self._ring: deque[tuple[float, float, float]] = deque(maxlen=settings.points)
        self._sampled = -math.inf
        self._way = 0.0
        self._last: Vec2 | None = None
        self._array: Floats = np.zeros((0, 3))

    @property
    def places(self) -> Floats:
        """(n, 2) [m], oldest first."""
        places: Floats = self._array[:, :2]
        return places

    def add(self, stamp: float, place: Vec2) -> None:
        """Take where the robot is at a stamp [s]; it is kept where it is time (or far enough) for a point."""
        if self._last is not None:
            self._way += math.dist(self._last, place)
        self._last = place
        s = self.settings
        at, step = (self._way, s.spacing) if s.by_distance else (stamp, s.sample)
        if at - self._sampled >= step - SLACK:
            self._sampled = at
            self._ring.append((*place, self._way))
            self._array = np.array(self._ring)

    def apart(self, place: Vec2) -> Floats:
        """The places (n, 2) [m] that are not nearer to this one than `ignored`."""
        kept: Floats = self.places[self._away(place) >= self.settings.ignored]
        return kept

    def is_back(self, place: Vec2) -> bool:
        """Whether the robot has been here before: a point is here, and the way since is longer than a turn here."""
        here = self.settings.here
        return bool(np.any((self._away(place) < here) & (self._way - self._array[:, 2] > math.pi * here)))

    def _away(self, place: Vec2) -> Floats:
        away: Floats = np.hypot(self._array[:, 0] - place[0], self._array[:, 1] - place[1])
        return away
