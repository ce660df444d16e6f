"""A trace of where a robot has been lately, so that it need not go there again.

Takes: places and stamps. Gives: the trace, by time or by distance, without what lies near; dead ends. Leaves alone:
frames, and what the points are taken for. Source: Yamauchi 2005, "Wayfarer", section 4.2 (100 points, one in 0.2 s);
what is near enough to be left out is not printed.

By time, a robot that is shut in by its own trace waits until that is forgotten. By distance it would wait for ever, so
that a place where it makes no progress ends a dead end: the trace that led there is closed behind it as it comes out.
"""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass

import numpy as np

from behaviours.interface import Floats, Vec2

SLACK = 1e-9
"""[s], [m]: what rounding may take from a sampling step."""
DEAD_ENDS = 5
"""So many are remembered, the oldest is forgotten first."""


@dataclass(frozen=True, slots=True)
class TraceSettings:
    """sample [s]: one point in this time; points: how many are kept; ignored [m]: nearer ones are not given.

    here [m]: a point so near is "here". by_distance: one point in a `spacing` [m] instead; then a robot that has not
    left a circle of radius `progress` [m] for `patience` [s] is at the end of a dead end.
    """

    sample: float = 0.2
    points: int = 100
    ignored: float = 1.0
    here: float = 1.0
    spacing: float = 0.1
    by_distance: bool = False
    progress: float = 0.5
    patience: float = 5.0


class Trace:
    """A ring of places (x, y) [m] with the way [m] driven until each, oldest first."""

    def __init__(self, settings: TraceSettings) -> None:
        self.settings = settings
        self._ring: deque[tuple[float, float, float]] = deque(maxlen=settings.points)
        self._sampled = -math.inf
        self._way = 0.0
        self._last: Vec2 | None = None
        self._array: Floats = np.zeros((0, 3))
        self._anchor: tuple[float, Vec2] | None = None
        self._dead_ends: deque[DeadEnd] = deque(maxlen=DEAD_ENDS)

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
        if s.by_distance:
            self._look_for_dead_ends(stamp, place)

    def _look_for_dead_ends(self, stamp: float, place: Vec2) -> None:
        s = self.settings
        for one in self._dead_ends:
            one.retreat(place)
        if self._anchor is None or math.dist(self._anchor[1], place) > s.progress:
            self._anchor = stamp, place
        elif stamp - self._anchor[0] >= s.patience and len(self._ring) * s.spacing > 2 * s.ignored:
            self._dead_ends.append(DeadEnd(self.places, s))
            self._ring.clear()
            self._array, self._anchor = np.zeros((0, 3)), (stamp, place)

    def apart(self, place: Vec2) -> Floats:
        """The places (n, 2) [m] that are not nearer to this one than `ignored`."""
        places = np.concatenate([self.places, *(one.closed for one in self._dead_ends)])
        kept: Floats = places[distances(places, place) >= self.settings.ignored]
        return kept

    def is_back(self, place: Vec2) -> bool:
        """Whether the robot has been here before: a point is here, and the way since is longer than a turn here."""
        here = self.settings.here
        return bool(np.any((distances(self.places, place) < here) & (self._way - self._array[:, 2] > math.pi * here)))


class DeadEnd:
    """The trace into a dead end (n, 2) [m], from its mouth to its end. closed: as much of it as lies behind the robot.

    What lies between the robot and the mouth is its way out. Once it has left the trace all of it is closed.
    """

    def __init__(self, trace: Floats, settings: TraceSettings) -> None:
        self._trace, self._settings = trace, settings
        self._reached = len(trace)

    @property
    def closed(self) -> Floats:
        """(n, 2) [m]"""
        left = self._reached == 0
        closed: Floats = self._trace if left else self._trace[self._reached + self._gap :]
        return closed

    @property
    def _gap(self) -> int:
        return math.ceil(self._settings.ignored / self._settings.spacing)

    def retreat(self, place: Vec2) -> None:
        """The robot is here now."""
        away = distances(self._trace, place)
        nearest = int(np.argmin(away))
        out = self._reached < len(self._trace) - self._gap and away[nearest] > self._settings.ignored
        self._reached = 0 if out else min(self._reached, nearest)


def distances(places: Floats, place: Vec2) -> Floats:
    """From places (n, 2) to one [m]."""
    away: Floats = np.hypot(places[:, 0] - place[0], places[:, 1] - place[1])
    return away
