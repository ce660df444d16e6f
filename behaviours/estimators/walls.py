"""The wall that is followed, and the heading along it.

Takes: the points round the robot and where it believes to be. Gives: the wanted heading in the map frame, the wall, and
whether the robot has come round to where it began. Leaves alone: obstacles beside the wall, and driving.

The whole of it follows a wall to the left. To follow one to the right it looks at the world in a mirror, so that the
two sides cannot differ.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from behaviours.cores.contour import ContourSettings, anchored, rolled, snapped
from behaviours.cores.geometry import distance, moved
from behaviours.cores.hough import HoughSettings, Line, lines
from behaviours.cores.orientation import FollowSettings, no_votes, tallied, tracked, wanted_heading
from behaviours.estimators.localisation import Localisation
from behaviours.estimators.surroundings import Surroundings
from behaviours.interface import Channels, Floats, Pose, Reading, Report, Vec2, wrap

SHOWN_BAND = 0.15
"""[m] A point so near to the line belongs to what is shown of the wall."""


@dataclass(frozen=True, slots=True)
class RoundSettings:
    """The robot has come round when it is back within `round_within` [m] of where it began, heading much as it did
    then, after `round_after` [m] and having been twice as far away."""

    round_within: float = 3.0
    round_after: float = 20.0


@dataclass(frozen=True, slots=True)
class WallsSettings:
    """right: the wall is kept to the right. contour: roll along what stands there, and not along one line alone.

    every [s]: at most so often a scan is looked at, and then alone the contour rolled along.
    """

    follow: FollowSettings = field(default_factory=FollowSettings)
    hough: HoughSettings = field(default_factory=HoughSettings)
    rounds: RoundSettings = field(default_factory=RoundSettings)
    right: bool = False
    contour: ContourSettings | None = None
    every: float = 0.0


class Walls:
    """line: of the tracked wall in the robot frame at the scan looked at last, None where it is not seen.

    fresh: a scan has been looked at since the last tick.
    """

    def __init__(self, settings: WallsSettings, place: Localisation, around: Surroundings) -> None:
        self.settings = settings
        self._place, self._around = place, around
        self._tally = no_votes()
        self._mirror = -1.0 if settings.right else 1.0
        self._wanted: float | None = None
        self.line: Line | None = None
        self.fresh = False
        self._looked = -math.inf
        self._round = _Round(settings.rounds)
        self._contour = None if settings.contour is None else _Contour(settings.contour, settings.follow.stand_off)

    def update(self, reading: Reading, reports: Mapping[str, Report], channels: Channels) -> None:
        self._round.go_on(self._place.pose)
        here = self._place.pose
        mirrored = here if self._mirror > 0 else Pose(here.x, -here.y, -here.theta)
        self.fresh = self._around.fresh and reading.stamp - self._looked >= self.settings.every
        wanted = self._look(mirrored) if self.fresh else None
        self._looked = reading.stamp if self.fresh else self._looked
        rolls = self._contour if self.fresh or not self.settings.every else None
        if rolls is not None and (rolling := rolls.go_on(mirrored)) is not None:
            wanted = rolling
        if wanted is not None:
            self._wanted = wrap(self._mirror * wanted)

    def _look(self, here: Pose) -> float | None:
        """Take a scan, seen so that the wall lies to the left; gives the wanted heading [rad] if there is a wall."""
        follow, points = self.settings.follow, self._around.points * (1.0, self._mirror)
        found = lines(points, self.settings.hough)
        self._tally = tallied(self._tally, found, here.theta, follow)
        wall = tracked(self._tally, found, here.theta, follow)
        line = None if wall is None else wall.line
        if self._contour is not None:
            line = self._contour.look(points, found, line, here)
        self.line = None if line is None else Line(wrap(self._mirror * line.normal), line.rho, line.votes)
        return None if wall is None else wanted_heading(wall, follow)

    @property
    def wanted(self) -> float:
        """The heading [rad] in the map frame; until there is a wall, that at which following began."""
        return self._round.begin(self._place.pose).theta if self._wanted is None else self._wanted

    @property
    def distance(self) -> float:
        """[m] to the tracked wall; the stand-off where none is seen."""
        return self.settings.follow.stand_off if self.line is None else self.line.rho

    @property
    def has_come_round(self) -> bool:
        """Whether it is back where following began; from then on."""
        return self._round.is_done

    def follow(self) -> float:
        """The wanted heading; the first call is where following begins."""
        self._round.begin(self._place.pose)
        return self.wanted

    def seen(self) -> list[float] | None:
        """The tracked wall as [x, y, x, y] in the robot frame [m], when a scan has just come."""
        if self.line is None or not self.fresh:
            return None
        return extent(self.line, self._around.points)


class _Contour:
    """What the disc of the stand-off rolls along; all of it seen so that it lies to the left."""

    def __init__(self, settings: ContourSettings, stand_off: float) -> None:
        self._settings, self._stand_off = settings, stand_off
        self._points: Floats = np.zeros((0, 2))
        self._from = Pose(0.0, 0.0)
        self._contact: Vec2 | None = None

    def look(self, points: Floats, found: tuple[Line, ...], first: Line | None, here: Pose) -> Line | None:
        """Take a scan. The contour begins at the line `first`; gives the line on which it is, if it is on one."""
        self._points, self._from = snapped(points, found, self._settings.snap), here
        contact = (
            None
            if self._contact is None
            else anchored(self._points, to_robot(self._contact, here), self._settings.leap)
        )
        if contact is None and first is not None:
            contact = nearest_on(first, self._points)
        self._contact = None if contact is None else to_map(contact, here)
        if contact is None:
            return None
        near = [line for line in found if abs(offset(line, contact)) <= self._settings.snap]
        return max(near, key=lambda line: line.votes, default=None)

    def go_on(self, here: Pose) -> float | None:
        """The heading [rad] in the map frame along the contour; None where there is none."""
        if self._contact is None:
            return None
        points = moved(self._points, self._from, here)
        way = rolled(points, to_robot(self._contact, here), self._stand_off, self._settings)
        self._contact = to_map(way.contact, here)
        return wrap(here.theta + way.direction)


def offset(line: Line, point: Vec2) -> float:
    """Distance [m] of a point beyond a line."""
    return point[0] * math.cos(line.normal) + point[1] * math.sin(line.normal) - line.rho


def nearest_on(line: Line, points: Floats) -> Vec2 | None:
    """The nearest of the points that lie on a line."""
    on = points[np.abs(points @ (math.cos(line.normal), math.sin(line.normal)) - line.rho) <= SHOWN_BAND]
    if len(on) == 0:
        return None
    x, y = on[int(np.hypot(on[:, 0], on[:, 1]).argmin())]
    return float(x), float(y)


def to_map(point: Vec2, here: Pose) -> Vec2:
    """A point [m] in the robot frame of a pose, in the frame of that pose."""
    c, s = math.cos(here.theta), math.sin(here.theta)
    return here.x + c * point[0] - s * point[1], here.y + s * point[0] + c * point[1]


def to_robot(point: Vec2, here: Pose) -> Vec2:
    """A point [m] in the frame of a pose, in the robot frame there."""
    c, s = math.cos(here.theta), math.sin(here.theta)
    dx, dy = point[0] - here.x, point[1] - here.y
    return c * dx + s * dy, c * dy - s * dx


class _Round:
    """Whether the robot has come back to where it began."""

    def __init__(self, settings: RoundSettings) -> None:
        self._settings = settings
        self._from: Pose | None = None
        self._last: Pose | None = None
        self._way = self._away = 0.0
        self.is_done = False

    def begin(self, pose: Pose) -> Pose:
        """Where it began: the pose of the first call."""
        if self._from is None:
            self._from = self._last = pose
        return self._from

    def go_on(self, pose: Pose) -> None:
        if self._from is None or self._last is None:
            return
        s, off = self._settings, distance(pose, self._from)
        self._way += distance(pose, self._last)
        self._away, self._last = max(self._away, off), pose
        same_way = abs(wrap(pose.theta - self._from.theta)) <= math.pi / 2
        far = self._way >= s.round_after and self._away > 2.0 * s.round_within
        self.is_done = self.is_done or (far and off <= s.round_within and same_way)


def extent(line: Line, points: Floats) -> list[float]:
    """From where to where the points lie on a line: [x, y, x, y] [m]."""
    c, s = math.cos(line.normal), math.sin(line.normal)
    off = points[:, 0] * c + points[:, 1] * s - line.rho
    beside = (points[:, 1] * c - points[:, 0] * s)[np.abs(off) <= SHOWN_BAND]
    ends = (float(beside.min()), float(beside.max())) if len(beside) else (0.0, 0.0)
    return [coordinate for b in ends for coordinate in (line.rho * c - b * s, line.rho * s + b * c)]
