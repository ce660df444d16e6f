"""Driving towards the wanted heading by VFH+, with commands that leave the hull free.

Takes: the channels `heading` (map frame) and `keep-off-recent-path`, what stands round the robot, where it is. Gives:
drive, and what it chose. Leaves alone: where the heading comes from.

Where it does not go on, it goes back along the way that it came and keeps off that place for a while.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from behaviours.cores.geometry import moved
from behaviours.cores.look_ahead import LookAheadSettings, carrot, way
from behaviours.cores.pilot import PilotSettings, Surrounds, may_turn, safe, towards
from behaviours.cores.steering import KEEP_OFF, Near, Place, sectors_view, wanted_heading
from behaviours.cores.vfh_plus import Choice, VfhPlus, VfhPlusSettings
from behaviours.cores.way_back import WayBack, WayBackSettings
from behaviours.interface import STOP, Channels, Command, Drive, Floats, Pose, Reading, Report, View, wrap

MAP = Pose(0.0, 0.0, 0.0)
LOOKS, CARROT = 0.2, 0.6  # [s] between two looks ahead; [m] to the place of the way that is made for
SQUEEZE = 0.35
"""Share of cruise out of where the hull cannot turn."""
BACKWARDS = (0.5, 0.25, 0.12)
"""Shares of cruise at which the way back is tried."""


@dataclass(frozen=True, slots=True)
class SteerSettings:
    """left: where to turn when nothing is open, and which of two equally good directions is taken. ahead: None for VFH+
    alone; else the way through what is seen is found first, and VFH+ goes along it. round [rad]: to what lies further
    aside it turns by the side `left`, and not by the shorter one.
    """

    choice: VfhPlusSettings = field(default_factory=VfhPlusSettings)
    pilot: PilotSettings = field(default_factory=PilotSettings)
    way_back: WayBackSettings = field(default_factory=WayBackSettings)
    left: bool = True
    ahead: LookAheadSettings | None = None
    round: float = math.pi


class SteerByVfhPlus:
    """trail: the points (n, 2) [m, robot frame] of the recent path that are far enough away to be kept off."""

    def __init__(
        self,
        settings: SteerSettings,
        near: Near,
        place: Place,
        known: Callable[[], bool],
        trail: Callable[[], Floats],
    ) -> None:
        self.settings = settings
        self._near, self._place, self._known, self._trail = near, place, known, trail
        self._begin()

    def _begin(self) -> None:
        self._vfh = VfhPlus(self.settings.choice, self.settings.left)
        self._way = WayBack(self.settings.way_back)
        self._out: float | None = None
        self._ahead: Floats = np.zeros((0, 2))
        self._looked = -math.inf
        self._shown: tuple[Choice, float] | None = None

    def start(self, reading: Reading, channels: Channels) -> None:
        self._begin()

    def stop(self) -> None:
        self._begin()

    def view(self) -> View | None:
        """The open directions of this tick, where it was stepped."""
        shown, self._shown = self._shown, None
        return None if shown is None else sectors_view(~shown[0].blocked, shown[1])

    def step(self, reading: Reading, channels: Channels) -> tuple[Command, Report]:
        heading = wanted_heading(channels)
        if heading is None:
            self._way.rest()
            return STOP, Report("failed", {"reason": "there is no heading"})
        if not self._known():
            return STOP, Report(details={"reason": "nothing has been measured yet"})
        told = reading.odometry
        now = Drive(told.speed, told.turn_rate / self.settings.pilot.slip)
        if self._way.goes_back:
            drive, doing = self._back(now, reading.stamp), "going back"
            if drive is not None:
                return self._command(drive), Report(details={"doing": doing})
        return self._forward(heading, now, reading.stamp, channels.get(KEEP_OFF) is True)

    def _forward(self, heading: float, now: Drive, stamp: float, keep_off: bool) -> tuple[Command, Report]:
        pose, pilot = self._place.pose, self.settings.pilot
        self._way.advance(pose, stamp)
        choice = self._choose(self._looked_ahead(heading, stamp), now, keep_off)
        direction = choice.direction
        if self._out is not None:
            return self._command(self._straight_out(now)), Report(details={"doing": "straight out"})
        if self._way.is_stalled(stamp):
            self._way.turn_back(pose, pose.theta if direction is None else direction, stamp)
        if direction is None:
            return self._command(self._blocked(now, stamp)), Report(details={"direction": None})
        seen = Surrounds(self._near.points, self._near.sees_all)
        drive = towards(self._aside(direction - pose.theta), now, seen, pilot)
        return self._command(drive), Report(details={"direction": round(direction, 3)})

    def _aside(self, direction: float) -> float:
        """How far [rad] to turn to a direction, to the left positive."""
        aside = wrap(direction)
        return aside if abs(aside) <= self.settings.round else math.copysign(aside, 1.0 if self.settings.left else -1.0)

    def _looked_ahead(self, heading: float, stamp: float) -> float:
        """The direction [rad, map frame] in which the way through what is seen begins."""
        if self.settings.ahead is None:
            return heading
        pose = self._place.pose
        here = np.array((pose.x, pose.y))
        if stamp - self._looked >= LOOKS:
            seen = moved(self._near.points, pose, MAP)
            points = np.concatenate([seen, self._way.dead_ends]) - here
            self._ahead = way(points, heading, self._ahead - here, self.settings.ahead) + here
            self._looked = stamp
        direction = carrot(self._ahead, pose, CARROT)
        return heading if direction is None else direction

    def _choose(self, heading: float, now: Drive, keep_off: bool) -> Choice:
        pose = self._place.pose
        kept_off = [self._near.points, moved(self._way.dead_ends, MAP, pose)]
        points = np.concatenate([*kept_off, self._trail()] if keep_off else kept_off)
        radius = abs(now.speed) / self.settings.pilot.max_turn_rate
        choice = self._vfh.choose(points, pose.theta, heading, radius)
        self._shown = choice, pose.theta
        return choice

    def _blocked(self, now: Drive, stamp: float) -> Drive | None:
        """Nothing is open: turn where that shows something new and the hull is free, else go back."""
        pilot = self.settings.pilot
        if self._near.sees_all or not may_turn(self._near.points, pilot):
            if self._way.is_known:
                self._way.turn_back(self._place.pose, self._place.heading, stamp)
                return None
            self._out = self._roomiest()
            return self._straight_out(now)
        return Drive(0.0, pilot.max_turn_rate / 2 if self.settings.left else -pilot.max_turn_rate / 2)

    def _roomiest(self) -> float:
        """1 for straight ahead or -1 for straight back, where the hull may go further."""
        points, half = self._near.points, self.settings.pilot.hull.half_width
        lane = points[np.abs(points[:, 1]) < half, 0]
        ahead, behind = lane[lane > 0.0].min(initial=math.inf), -lane[lane < 0.0].max(initial=-math.inf)
        return 1.0 if ahead > behind or not self._near.sees_all else -1.0

    def _straight_out(self, now: Drive) -> Drive | None:
        """Slowly on in the direction begun, until the hull may turn or must stop."""
        pilot = self.settings.pilot
        out = Drive((self._out or 0.0) * SQUEEZE * pilot.cruise, 0.0)
        if may_turn(self._near.points, pilot) or not safe(out, now, self._near.points, pilot):
            self._out = None
        return None if self._out is None else out

    def _back(self, now: Drive, stamp: float) -> Drive | None:
        """Backwards towards the next place of the way back; None when it has come to its end."""
        pose, pilot = self._place.pose, self.settings.pilot
        to = self._way.next_place(pose, stamp)
        if to is None:
            return None
        aside = wrap(math.atan2(to[1] - pose.y, to[0] - pose.x) - pose.theta - math.pi)
        turn = max(-pilot.max_turn_rate, min(pilot.max_turn_rate, 1.5 * aside))
        speeds = BACKWARDS if abs(aside) < pilot.on_the_spot else ()
        for wanted in (*(Drive(-pilot.cruise * share, turn * share * 2) for share in speeds), Drive(0.0, turn)):
            if safe(wanted, now, self._near.points, pilot):
                return wanted
        seen = Surrounds(self._near.points, self._near.sees_all)
        return towards(wrap(aside + math.pi), now, seen, pilot) or Drive(0.0, 0.0)

    def _command(self, drive: Drive | None) -> Command:
        """What the tracks are told; nothing: brake."""
        if drive is None:
            return STOP
        return Command(Drive(drive.speed, drive.turn_rate * self.settings.pilot.slip))
