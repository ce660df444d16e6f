"""The wall beside the robot, fitted to every scan and followed from one to the next.

Takes: every reading. Gives: `wall`, offset and angle filtered, how the wall curves, where it ends, and what lies ahead;
what to look at. Leaves alone: steering.

All is computed for a wall to the right; for one to the left the scan is mirrored before, and who steers mirrors the
turn. After Bayer 2012; `WallAndCorners` goes on where the wall does not.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.random import Generator, default_rng

from behaviours.cores.view_path import ViewPath
from behaviours.cores.wall_fit import Fit, FitSettings, acquire, track
from behaviours.cores.wall_law import LawSettings, bend
from behaviours.cores.wall_loss import GAP, End, end_of, invented
from behaviours.cores.wall_state import FilterSettings, WallState, as_line, begun, predicted, updated
from behaviours.estimators.surroundings import scan_points
from behaviours.interface import Channels, Floats, Odometry, Reading, Report, Scan, View, wrap

Mode = Literal["none", "wall", "end", "corner", "search", "lost"]
NOTHING = np.zeros((0, 2))
SHOWN = 60
"""So many points of a wall are shown at most."""


@dataclass(frozen=True, slots=True)
class FittedWallSettings:
    """left: the wall is to the left. narrow [rad]: the view is restricted once the robot is so well along the wall.

    accept [rad]: a wall that is found may be turned so far; loss: points are invented where the wall ends; curve: the
    curvature counts; lane, early [m]: what lies in half such a width ahead bars the way, so much before the stand-off.
    """

    left: bool = False
    loss: bool = True
    curve: bool = True
    per_metre: bool = False
    lane: float = 0.35
    early: float = 0.35
    narrow: float = math.radians(30)
    accept: float = math.radians(135)
    shown_every: int = 5
    seed: int = 0
    fit: FitSettings = field(default_factory=FitSettings)
    view: ViewPath = field(default_factory=ViewPath)
    filter: FilterSettings = field(default_factory=FilterSettings)
    law: LawSettings = field(default_factory=LawSettings)


class FittedWall:
    """mode: "wall" while one is followed, "none" before the first, "lost" after the last.

    state: offset and angle; curvature: K of the law; end: where the wall ends; front [m]: what is ahead in the lane.
    """

    def __init__(self, settings: FittedWallSettings) -> None:
        self.settings = settings
        self._chance: Generator = default_rng(settings.seed)
        self.mode: Mode = "none"
        self.state: WallState | None = None
        self.curvature = 0.0
        self.end: End | None = None
        self.front = math.inf
        self._points: Floats = NOTHING
        self._fit: Fit | None = None
        self._added: Floats = NOTHING
        self._last: Odometry | None = None
        self._scans = 0
        self._new = self._narrow = False

    # --- what others ask ----------------------------------------------------------------------------

    @property
    def is_found(self) -> bool:
        """A wall is followed."""
        return self.mode == "wall"

    @property
    def ends(self) -> bool:
        """The wall ends within the view."""
        return self.mode == "end" or (self.end is not None and GAP < self.end.gap < math.inf)

    def target(self) -> tuple[float, float, float] | None:
        """Offset [m], angle [rad] and curvature to steer by."""
        if self.mode != "wall" or self.state is None:
            return None
        return self.state.offset, self.state.angle, self.curvature

    # --- a tick ---------------------------------------------------------------------------------------

    def update(self, reading: Reading, reports: Mapping[str, Report], channels: Channels) -> None:
        self._move(reading.odometry)
        if reading.lidar is None or not reading.lidar.fresh:
            return
        points = scan_points(reading.lidar)
        if self.settings.left:
            points = points[::-1] * (1.0, -1.0)
        self._points, self._added = points, NOTHING
        self._scans += 1
        self._new = self._scans % self.settings.shown_every == 0
        self._take(reading.lidar, points)

    def _take(self, scan: Scan, points: Floats) -> None:
        """A scan that has come, and its points with the wall to the right."""
        self.front = self._nearest_ahead(points)
        self._look(points)

    def _move(self, told: Odometry) -> None:
        last, self._last = self._last, told
        if last is None:
            return
        turn = wrap(told.pose.theta - last.pose.theta)
        way = math.hypot(told.pose.x - last.pose.x, told.pose.y - last.pose.y)
        way = -way if told.speed < 0 else way
        turn = -turn if self.settings.left else turn
        if self.state is not None:
            self.state = predicted(self.state, way, turn, 1.0, self.settings.filter)

    def _nearest_ahead(self, points: Floats) -> float:
        lane = (points[:, 0] > 0) & (np.abs(points[:, 1]) <= self.settings.lane)
        return float(points[lane, 0].min()) if lane.any() else math.inf

    @property
    def bars(self) -> bool:
        """Something bars the way where the robot should turn."""
        return self.front <= self.settings.law.stand_off + self.settings.early

    def _look(self, points: Floats) -> None:
        match self.mode:
            case "wall":
                self._follow(points)
            case "none":
                self._search(points)
            case _:
                pass

    def _search(self, points: Floats) -> None:
        found = acquire(points, self.settings.fit, self._chance, self.settings.accept)
        if found is not None:
            self._found(found)
        else:
            self._show(None)

    def _found(self, fit: Fit) -> None:
        self.mode, self.state, self.curvature, self.end = "wall", begun(fit.line, self.settings.filter), 0.0, None
        self._narrow = False
        self._show(fit)

    def _follow(self, points: Floats) -> None:
        settings, state = self.settings, self.state
        assert state is not None
        narrow = self._narrow = self._narrow or abs(state.angle) < settings.narrow
        if narrow:
            points = points[settings.view.holds(points)]
        fit = track(points, as_line(state), settings.fit)
        if fit is None:
            self._lose()
            return
        self.state = updated(state, fit.line, settings.filter)
        self._points = points
        self._show(fit)
        self.end = end_of(fit, points, settings.view) if narrow else None
        if self.end is not None and settings.loss:
            self._added = invented(fit, points, self.end, settings.view)
        self.curvature = self._curvature(fit, points) if narrow and settings.curve else 0.0

    def _lose(self) -> None:
        self.mode, self.state, self.curvature, self.end = "lost", None, 0.0, None
        self._show(None)

    def _curvature(self, fit: Fit, points: Floats) -> float:
        """Of the points on the wall from behind to ahead, and after them what was invented."""
        on = points[fit.inliers]
        on = on[np.argsort(fit.line.stations(on), kind="stable")]
        cluster = np.concatenate([on, self._added])
        return bend(fit.line.stations(cluster), -fit.line.off(cluster), per_metre=self.settings.per_metre)

    # --- what to look at --------------------------------------------------------------------------------

    def _show(self, fit: Fit | None) -> None:
        self._fit = fit

    def line_view(self) -> View | None:
        """The wall as a line beside the robot."""
        if not self._new:
            return None
        if self.state is None or not self.is_found:
            return {"kind": "lines", "frame": "robot", "at": []}
        line = as_line(self.state)
        (nx, ny), (ux, uy) = line.n, line.along
        x, y = nx * line.distance, ny * line.distance
        ends = [x - 1.5 * ux, y - 1.5 * uy, x + 3.0 * ux, y + 3.0 * uy]
        return {"kind": "lines", "frame": "robot", "at": [self._mirrored(ends)]}

    def inliers_view(self) -> View | None:
        """Some of the points that lie on it."""
        if not self._new:
            return None
        whole = self._fit is not None and len(self._fit.inliers) == len(self._points)
        on = self._points[self._fit.inliers] if self._fit is not None and whole else NOTHING
        return self._points_view(on[:: max(1, math.ceil(len(on) / SHOWN))])

    def added_view(self) -> View | None:
        """The points that were invented."""
        return self._points_view(self._added[:1]) if self._new else None

    def _points_view(self, points: Floats) -> View:
        return {"kind": "points", "frame": "robot", "at": [self._mirrored(point) for point in points.tolist()]}

    def _mirrored(self, values: list[float]) -> list[float]:
        flip = -1.0 if self.settings.left else 1.0
        return [round(value * (flip if k % 2 else 1.0), 3) for k, value in enumerate(values)]
