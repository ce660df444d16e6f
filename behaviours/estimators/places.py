"""Ways out of dead ends: where the robot has been, and a goal on the way to the goal.

Takes: poses, circles, the goal, and word of dead ends. Gives: the pose to plan for: the goal, or after a dead end a
place or frontier on the cheapest way round until the robot is nearer to the goal than ever before. Leaves alone: how
obstacles are passed, and what stands where.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

from behaviours.cores.circles import Circle
from behaviours.cores.geometry import distance
from behaviours.cores.places import (
    Atlas,
    Frontier,
    PlacesSettings,
    Way,
    as_way,
    frontiers,
    is_closed,
    is_seen,
    straight_to,
    visit,
    way_out,
)
from behaviours.interface import Pose

MOVED = 0.002
"""Who moves less between two sweeps [m] stands."""
CLOSE = 1.0
"""So near [m] to the goal nothing is a dead end."""


class Places:
    """The atlas, and the search for a way out; new_goal [m]: a goal that jumps by more is another one."""

    def __init__(self, settings: PlacesSettings, new_goal: float) -> None:
        self.settings, self._new_goal = settings, new_goal
        self.atlas = Atlas()
        self._last: tuple[float, Pose] | None = None
        self._spent = 0.0
        self._begin(None)

    def _begin(self, goal: Pose | None) -> None:
        """Nothing is known against any way to this goal."""
        self._goal, self._nearest = goal, math.inf
        self._entered: dict[int, int] = {}
        self._tried: tuple[Frontier, ...] = ()
        self._blocked: tuple[Way, ...] = ()
        self._stop()

    def _stop(self) -> None:
        self.is_searching = False
        self._path: tuple[int, ...] = ()
        self.target: Frontier | None = None
        self._best: tuple[float, float] = (math.inf, 0.0)

    def aim(self, pose: Pose, goal: Pose | None, circles: Sequence[Circle], now: float) -> Pose | None:
        """The pose to plan for after a sweep at stamp now [s]; None without a goal."""
        self._note(pose, circles, now)
        if goal is None or self._goal is None or distance(goal, self._goal) > self._new_goal:
            self._begin(goal)
        if goal is None:
            return None
        away = distance(pose, goal)
        if self.is_searching and (
            away < self._nearest - self.settings.nearer or straight_to(pose, goal, circles, self.settings)
        ):
            self._stop()
            self._entered = {}
        if not self.is_searching:
            self._nearest = min(self._nearest, away)
            return goal
        return self._on_the_way(pose, goal, circles, now)

    def dead_end(self, pose: Pose) -> None:
        """Progress has stopped or was turned back here."""
        if self._goal is None or distance(pose, self._goal) < CLOSE:
            return
        if self.is_searching:
            self._give_up()
        self.is_searching = True

    def _note(self, pose: Pose, circles: Sequence[Circle], now: float) -> None:
        if self._last is not None and distance(self._last[1], pose) > MOVED:
            self._spent += now - self._last[0]
        self._last = (now, pose)
        before = self.atlas.here
        self.atlas = visit(self.atlas, pose, circles, self._spent, self.settings)
        here = self.atlas.here
        if here is not None and here != before:
            self._spent = 0.0
            self._enter(here, pose)
        elif self._spent > self.settings.linger and not self.is_searching:
            self._spent = 0.0
            self.dead_end(pose)

    def _enter(self, here: int, pose: Pose) -> None:
        self._entered[here] = self._entered.get(here, 0) + 1
        if self._entered[here] > self.settings.turns and not self.is_searching:
            self.dead_end(pose)

    def _on_the_way(self, pose: Pose, goal: Pose, circles: Sequence[Circle], now: float) -> Pose:
        if self.target is not None and self._is_done_with(pose, self.target, circles):
            self._mark(self.target)
        if self.target is None:
            self._choose(pose, goal, now)
        elif self._is_stalled(pose, now):
            self._give_up()
            self._choose(pose, goal, now)
        if self.target is None:
            return goal
        return self._next(pose, self.target)

    def _is_done_with(self, pose: Pose, target: Frontier, circles: Sequence[Circle]) -> bool:
        """Whether the frontier is reached, or seen, or turns out to be none."""
        near = math.hypot(pose.x - target.x, pose.y - target.y) <= self.settings.same
        if near or target.place not in self.atlas.places or is_seen(self.atlas, target, self.settings):
            return True
        return not self._path and is_closed(self.atlas, target, circles, self.settings)

    def _choose(self, pose: Pose, goal: Pose, now: float) -> None:
        """The next frontier; where none is left, everything is forgiven and the goal tried again."""
        found = self._way_by(self.settings.sight, pose, goal) or self._way_by(self.settings.least, pose, goal)
        if found is None:
            self._begin(goal)
            return
        self._path, self.target = found
        self._best = (math.inf, now)

    def _way_by(self, least: float, pose: Pose, goal: Pose) -> tuple[tuple[int, ...], Frontier] | None:
        ends = frontiers(self.atlas, self._tried, least, self.settings)
        return way_out(self.atlas, ends, self._blocked, pose, goal, self.settings)

    def _next(self, pose: Pose, target: Frontier) -> Pose:
        """The first place of the path that is not yet reached, else the frontier."""
        here = self.atlas.here
        if here in self._path:
            self._path = self._path[self._path.index(here) + 1 :]
        self._path = tuple(number for number in self._path if number in self.atlas.places)
        if self._path:
            place = self.atlas.places[self._path[0]]
            return Pose(place.x, place.y)
        return Pose(target.x, target.y)

    def _left(self, pose: Pose, target: Frontier) -> float:
        """The way [m] that is left, by the places."""
        spots = [(self.atlas.places[n].x, self.atlas.places[n].y) for n in self._path if n in self.atlas.places]
        stops = [(pose.x, pose.y), *spots, (target.x, target.y)]
        return sum(math.dist(a, b) for a, b in itertools.pairwise(stops))

    def _is_stalled(self, pose: Pose, now: float) -> bool:
        assert self.target is not None
        left = self._left(pose, self.target)
        if left < self._best[0] - 0.3:
            self._best = (left, now)
        return now - self._best[1] > self.settings.patience

    def _give_up(self) -> None:
        """Block the way that is not to be driven, or call the frontier tried."""
        if self._path and self.atlas.here is not None and self._path[0] != self.atlas.here:
            self._blocked = (*self._blocked, as_way(self.atlas.here, self._path[0]))[-self.settings.most :]
        elif self.target is not None:
            self._mark(self.target)
        self.target = None

    def _mark(self, target: Frontier) -> None:
        """The frontier is not chosen again for this goal; no more are remembered than there are places."""
        self._tried, self.target = (*self._tried, target)[-self.settings.most :], None
