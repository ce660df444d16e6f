"""The wall beside the robot and all that comes after it: ends, corners, dead ends, doors, clutter, curves.

Takes: every reading. Gives: what `FittedWall` gives, of a wall that is followed further than a line goes; what stands
round the robot, how far to turn away from what bars the way, and the stand-off for which there is room. Leaves alone:
steering.

All is computed for a wall to the right. Where no line is to be seen, what counts is the place of contact: the nearest
point of what was followed last, found again in each scan.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from behaviours.cores import corner
from behaviours.cores.corner import STEEPEST, CornerSettings
from behaviours.cores.geometry import moved
from behaviours.cores.wall_fit import Fit, acquire, track
from behaviours.cores.wall_loss import End
from behaviours.cores.wall_state import as_line, updated
from behaviours.estimators.fitted_wall import FittedWall, FittedWallSettings
from behaviours.interface import Channels, Floats, Pose, Reading, Report, Scan, Vec2, wrap

TOLD = 0.1
"""A scan of which a smaller share says anything is none."""
FEW = 3
"""Where there are fewer points than a wall has, so many must be what is turned about, lest it go on by chance."""
INSIDE = 0.05
"""[m] What lies so far within the hull is a mistake of the sensor."""
MOST = math.radians(120)
BESIDE = (math.radians(-170), math.radians(60))
"""Between these bearings lies what a lost wall may be found on again."""


@dataclass(frozen=True, slots=True)
class AroundSettings:
    """hull_radius, margin [m]; patience [s]: so long a wall is looked for that is lost."""

    hull_radius: float = 0.25
    margin: float = 0.06
    patience: float = 12.0
    corner: CornerSettings = field(default_factory=CornerSettings)


class WallAndCorners(FittedWall):
    """mode: also "corner" before what bars the way, and "search" for a wall that is out of sight.

    around: (n, 2) [m] what stands round the robot, with the wall to the right; turn [rad]: to the left, to get past
    what is ahead; direction [rad]: where to go then.
    """

    def __init__(self, settings: FittedWallSettings, around: AroundSettings) -> None:
        super().__init__(settings)
        self._here = around
        self.around: Floats = np.zeros((0, 2))
        self.turn = self.direction = 0.0
        self.stand_off = settings.law.stand_off
        self._contact: Vec2 = (0.0, 0.0)
        self._spacing = 0.01
        self._stamp = self._seen_at = 0.0

    # --- what others ask ------------------------------------------------------------------------------

    @property
    def is_found(self) -> bool:
        return self.mode in ("wall", "end", "corner")

    @property
    def bars(self) -> bool:
        """Something bars the way."""
        return self.mode == "corner" or self.turn > self._here.corner.barred

    def target(self) -> tuple[float, float, float] | None:
        match self.mode:
            case "end" | "corner":
                line = corner.tangent(self._contact)
                round_ = -1.0 / self.stand_off / self.settings.law.curvature_gain if self.mode == "end" else 0.0
                return line.distance, wrap(-line.normal - math.pi / 2), round_
            case "search":
                return self.stand_off, 0.0, -0.5 / self.stand_off / self.settings.law.curvature_gain
            case _:
                return super().target()

    # --- a tick ---------------------------------------------------------------------------------------

    def update(self, reading: Reading, reports: Mapping[str, Report], channels: Channels) -> None:
        before = self._last
        self._stamp = reading.stamp
        if before is not None:
            was, is_ = _mirrored(before.pose, self.settings.left), _mirrored(reading.odometry.pose, self.settings.left)
            self.around = moved(self.around, was, is_)
            ((x, y),) = moved(np.array([self._contact]), was, is_).tolist()
            self._contact = (x, y)
        super().update(reading, reports, channels)

    def _take(self, scan: Scan, points: Floats) -> None:
        """A scan that has come."""
        self.around = points
        self._spacing = float(scan.bearings[1] - scan.bearings[0]) if len(scan.bearings) > 1 else 0.01
        if not self._tells(scan, points):
            self.mode, self.state, self.end = "lost", None, None
            self.around = np.zeros((0, 2))
            self._show(None)
            return
        here = self._here
        least = here.hull_radius + here.margin
        self.stand_off = corner.room(points, self.settings.law.stand_off, here.corner.beside, least)
        self._look(points)
        self._bar(least)

    def _tells(self, scan: Scan, points: Floats) -> bool:
        """Whether enough of the beams say something that can be."""
        if len(points) < self.settings.fit.least and self.mode != "none" and not self._holds_on(points):
            return False
        says = np.count_nonzero(np.isfinite(scan.ranges) & (scan.ranges > scan.min_range))
        within = np.count_nonzero(np.hypot(points[:, 0], points[:, 1]) < self._here.hull_radius - INSIDE)
        return bool(says - within >= max(1.0, TOLD * len(scan.ranges)))

    def _holds_on(self, points: Floats) -> bool:
        """Whether the few points are those of the place that the robot turns about."""
        off = np.hypot(points[:, 0] - self._contact[0], points[:, 1] - self._contact[1])
        return self.mode in ("end", "corner") and int(np.count_nonzero(off <= self._here.corner.leap)) >= FEW

    def _bar(self, least: float) -> None:
        """Where to go past what bars the way; it is turned about if that is far aside."""
        here = self._here.corner
        rolls = self.mode in ("end", "corner")
        radius, reach = max(least, here.disc * self.stand_off), here.sweep * self.stand_off
        wanted = math.atan2(self._contact[1], self._contact[0]) if rolls else self._aim(reach)
        self.turn, touched = corner.barred(self.around, wanted, radius, reach, least)
        self.direction = wanted + self.turn
        if not self.is_found:
            return
        self._seen_at = self._stamp
        if touched is not None and (rolls or self.turn > here.barred):
            self._pivot_about(touched, "corner" if self.direction > here.barred else "end")
        if rolls:
            self.direction += max(0.0, radius - math.hypot(*self._contact))

    def _aim(self, reach: float) -> float:
        """The direction in which the law would come to an equilibrium."""
        target, law = self.target(), self.settings.law
        if target is None:
            return 0.0
        if self.mode == "search":
            return -reach / 2 / self.stand_off
        steep = max(-STEEPEST, min(STEEPEST, law.offset_gain / law.gain * (target[0] - self.stand_off)))
        return max(-MOST, min(MOST, wrap(-math.asin(steep) - target[1])))

    def _look(self, points: Floats) -> None:
        match self.mode:
            case "wall":
                self._follow(points)
            case "end" | "corner":
                self._turn_about(points)
            case "none" | "search" | "lost":
                self._seek(points)

    def _pivot_about(self, at: Vec2, mode: str) -> None:
        self.mode, self.state, self.end = ("end" if mode == "end" else "corner"), None, None
        self._contact = at
        self._show(None)

    def _turn_about(self, points: Floats) -> None:
        here = self._here
        contact = corner.anchored(points, self._contact, here.corner.leap)
        if contact is None:
            self.mode = "search"
            self._show(None)
            return
        self._contact = contact
        reach = 2.5 * self.settings.law.stand_off
        behind = corner.beyond(points, contact, self.settings.fit, here.corner, reach, self._chance)
        self._found(behind) if behind is not None else self._show(None)

    def _follow(self, points: Floats) -> None:
        settings, state = self.settings, self.state
        assert state is not None
        narrow = self._narrow = self._narrow or abs(state.angle) < settings.narrow
        held = points[settings.view.holds(points)] if narrow else points
        fit = track(held, as_line(state), settings.fit)
        if fit is None:
            self._lose()
            return
        self.state = updated(state, fit.line, settings.filter)
        self._points = held
        self._show(fit)
        if narrow:
            self._mind_the_end(fit, held)

    def _mind_the_end(self, fit: Fit, points: Floats) -> None:
        station, at = corner.last_of(fit, points, self._here.corner.door, self._spacing)
        self.end = End(station, self.settings.view.end_of(fit.line) - station, at)
        if station <= self._here.corner.abreast:
            self._pivot_about(at, "end")

    def _lose(self) -> None:
        """On round the last of the wall, or round what is nearest on its side."""
        at = self.end.point if self.end is not None else corner.nearest(self._beside())
        if at is not None and math.hypot(*at) <= 2.0 * self.settings.law.stand_off:
            self._pivot_about(at, "end")
        else:
            self.mode, self.state, self.end = "search", None, None
            self._show(None)

    def _beside(self) -> Floats:
        bearing = np.arctan2(self.around[:, 1], self.around[:, 0])
        return self.around[(bearing >= BESIDE[0]) & (bearing <= BESIDE[1])]

    def _seek(self, points: Floats) -> None:
        found = acquire(points, self.settings.fit, self._chance, self.settings.accept)
        near = corner.nearest(self._beside())
        if found is not None:
            self._found(found)
        elif near is not None and math.hypot(*near) <= 2.0 * self.settings.law.stand_off:
            self._pivot_about(near, "end")
        else:
            self._show(None)
            if self.mode == "search" and self._stamp - self._seen_at > self._here.patience:
                self.mode = "lost"


def _mirrored(pose: Pose, left: bool) -> Pose:
    return Pose(pose.x, -pose.y, -pose.theta) if left else pose
