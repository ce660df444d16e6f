"""Where something was heard and where nothing was: a grid about the robot that remembers longer than circles do.

Takes: sweeps of a ring of ranges and the robot's pose in a frame that stands still. Gives: which echoes come from a
place that was free a moment ago (something moves there), and circles about what stands. Leaves alone: the way.

The grid is a torus: what is farther apart than its side shares cells, so it holds only what is younger than the time
in which the robot could drive half that far. Memory is bounded by its size. The arrays are changed in place.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from behaviours.cores.circles import Circle
from behaviours.interface import Floats, Pose, Ranges, Vec2, wrap

SIDE = 256
FIRST_IDENT = 1_000_000
"""The names of circles from the grid begin here."""
NEVER = -1e9
FARTHEST = 12.0
"""Beams free nothing beyond [m]."""


@dataclass(frozen=True, slots=True)
class EvidenceSettings:
    """cell, reach, before, radius [m]; keep, was_free [s]; kept_obstacles: the greatest number of circles.

    before: a beam frees nothing nearer to its echo. was_free: so long a place that was free makes an echo one of
    something that moves. sure: when so many sweeps in a row go through a place, it is forgotten. reach: circles are
    given within it about the robot.
    """

    cell: float = 0.3
    reach: float = 8.0
    before: float = 0.4
    radius: float = 0.05
    keep: float = 120.0
    was_free: float = 8.0
    kept_obstacles: int = 120
    sure: int = 4


class Evidence:
    """The grid of one robot."""

    def __init__(self, settings: EvidenceSettings) -> None:
        self._settings = settings
        self._heard = np.full((SIDE, SIDE), NEVER)
        self._freed = np.full((SIDE, SIDE), NEVER)
        self._run = np.zeros((SIDE, SIDE), dtype=np.int64)
        self._last = np.full((SIDE, SIDE), -2, dtype=np.int64)
        self._sweep = 0
        self._x = np.zeros((SIDE, SIDE))
        self._y = np.zeros((SIDE, SIDE))
        self._window: tuple[float, NDArray[np.int64], NDArray[np.int64]] | None = None

    def sweep(self, ring: Ranges, pose: Pose, echoes: Sequence[tuple[float, Vec2]], now: float) -> list[bool]:
        """Take a sweep and what it heard; for each echo whether it comes from where it was free a moment ago."""
        moving = self._were_free(ring, pose, [point for _, point in echoes], now)
        self._sweep += 1
        self._free(ring, pose, now)
        return moving

    def hear(self, points: Sequence[Vec2], now: float) -> None:
        """Something stands at these points."""
        for x, y in points:
            at = self._place(x, y)
            self._heard[at], self._x[at], self._y[at], self._run[at] = now, x, y, 0

    def circles(self, pose: Pose, now: float) -> tuple[Circle, ...]:
        """About what stands, the nearest first."""
        s = self._settings
        flat = np.flatnonzero(self._heard > now - s.keep)
        xs, ys = self._x.ravel()[flat], self._y.ravel()[flat]
        away = np.hypot(xs - pose.x, ys - pose.y)
        order = np.argsort(away, kind="stable")
        chosen = order[away[order] < s.reach][: s.kept_obstacles]
        rows = zip(flat[chosen].tolist(), xs[chosen].tolist(), ys[chosen].tolist(), strict=True)
        return tuple(Circle(FIRST_IDENT + ident, ((x, y, 0),), x, y, s.radius) for ident, x, y in rows)

    def _place(self, x: float, y: float) -> tuple[int, int]:
        cell = self._settings.cell
        return math.floor(x / cell) % SIDE, math.floor(y / cell) % SIDE

    def _were_free(self, ring: Ranges, pose: Pose, points: Sequence[Vec2], now: float) -> list[bool]:
        """For each point whether the whole arc on which the echo may lie was free."""
        if not points:
            return []
        x, y = np.array(points).T
        away, axis = np.hypot(x - pose.x, y - pose.y), np.arctan2(y - pose.y, x - pose.x)
        half, since = math.pi / len(ring.ranges), now - self._settings.was_free
        free = np.ones(len(points), dtype=bool)
        for turn in (-half, 0.0, half):
            rows, columns = self._places(pose.x + away * np.cos(axis + turn), pose.y + away * np.sin(axis + turn))
            free &= self._freed[rows, columns] > since
        return [bool(one) for one in free.tolist()]

    def _places(self, x: Floats, y: Floats) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        cell = self._settings.cell
        return np.floor(x / cell).astype(np.int64) % SIDE, np.floor(y / cell).astype(np.int64) % SIDE

    def _free(self, ring: Ranges, pose: Pose, now: float) -> None:
        """What the beams went through: free when two sweeps in a row say so, forgotten when `sure` do."""
        rows, columns, away, bearings = self._around(ring, pose)
        count = len(ring.ranges)
        sector = np.rint((bearings - ring.bearings[0]) / (math.tau / count)).astype(np.int64) % count
        through = away < (ring.mount_radius + ring.ranges - self._settings.before)[sector]
        rows, columns = rows[through], columns[through]
        run = np.where(self._last[rows, columns] == self._sweep - 1, self._run[rows, columns], 0) + 1
        self._run[rows, columns], self._last[rows, columns] = run, self._sweep
        again = run >= 2
        self._freed[rows[again], columns[again]] = now
        sure = run >= self._settings.sure
        self._heard[rows[sure], columns[sure]] = NEVER

    def _around(self, ring: Ranges, pose: Pose) -> tuple[NDArray[np.int64], NDArray[np.int64], Floats, Floats]:
        """Rows and columns of the cells within hearing, their distances and bearings [rad, robot frame]."""
        cell, far = self._settings.cell, min(ring.max_range, FARTHEST) + ring.mount_radius
        if self._window is None or self._window[0] != far:
            n = math.ceil(far / cell)
            i, j = np.mgrid[-n : n + 1, -n : n + 1]
            near = np.hypot(i, j) * cell <= far
            self._window = (far, i[near], j[near])
        _, i, j = self._window
        row, column = math.floor(pose.x / cell), math.floor(pose.y / cell)
        dx, dy = (row + i + 0.5) * cell - pose.x, (column + j + 0.5) * cell - pose.y
        return (row + i) % SIDE, (column + j) % SIDE, np.hypot(dx, dy), np.arctan2(dy, dx) - wrap(pose.theta)
