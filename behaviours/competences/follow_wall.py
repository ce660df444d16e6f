"""Along a wall: a set speed, and the turn rate of the law.

Takes: the wall as an estimator sees it. Gives: drive commands; STOP where no wall is followed. Leaves alone: how the
wall is found.

`FollowWall` does what Bayer 2012 prints. `FollowWallClear` turns away from what bars the way, is slower where there is
little room, and gives no command that would carry the hull into what is seen before the robot could brake.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np

from behaviours.cores.corner import STEEPEST
from behaviours.cores.hull_paths import Hull, Motors, least_distance, paths
from behaviours.cores.wall_law import LawSettings, turn_rate
from behaviours.interface import STOP, Channels, Command, Drive, Floats, Reading, Report


@dataclass(frozen=True, slots=True)
class PaceSettings:
    """speed [m/s]."""

    speed: float = 0.48


@dataclass(frozen=True, slots=True)
class ClearSettings:
    """All chosen here. hull_radius, margin [m]: kept between the hull and what is seen; away [1/s]: turn rate
    per turn; on_the_spot [rad]: a greater turn is made standing; roomy [m]: full speed with so much room; tight:
    share of it with none.
    """

    hull_radius: float = 0.25
    margin: float = 0.06
    away: float = 2.5
    on_the_spot: float = math.radians(60.0)
    roomy: float = 0.35
    tight: float = 0.35
    motors: Motors = field(default_factory=lambda: Motors(2.0, 8.0, 0.1, 0.1))


SHARES = np.array([1.0, 0.6, 0.3, 0.12, 0.0])
"""Of the speed, tried one after the other."""
SLACK = 0.003
"""[m]: where the hull is nearer to something than the margin, it comes nearer by no more than this."""


class SideAndLaw(Protocol):
    """left: the wall is to the left."""

    @property
    def left(self) -> bool: ...

    @property
    def law(self) -> LawSettings: ...


class SeenWall(Protocol):
    """The wall, as one to the right."""

    @property
    def settings(self) -> SideAndLaw: ...

    @property
    def mode(self) -> str:
        """What is known of it."""
        ...

    def target(self) -> tuple[float, float, float] | None:
        """Offset [m], angle [rad] and curvature to steer by; None where there is no wall."""
        ...


class SeenCorners(SeenWall, Protocol):
    """The wall with its ends and corners."""

    @property
    def stand_off(self) -> float:
        """[m], less where it is narrow."""
        ...

    @property
    def turn(self) -> float:
        """[rad] away from what bars the way."""
        ...

    @property
    def direction(self) -> float:
        """[rad, robot frame] past it."""
        ...

    @property
    def around(self) -> Floats:
        """What is near (n, 2) [m]."""
        ...


class FollowWall:
    """Follow the wall."""

    def __init__(self, wall: SeenWall, pace: PaceSettings) -> None:
        self._wall, self._pace = wall, pace

    def start(self, reading: Reading, channels: Channels) -> None:
        """It keeps nothing of its own."""

    def stop(self) -> None:
        """It keeps nothing of its own."""

    def step(self, reading: Reading, channels: Channels) -> tuple[Command, Report]:
        """One tick."""
        target = self._wall.target()
        if target is None:
            return STOP, Report("failed", {"mode": self._wall.mode})
        offset, angle, curvature = target
        flip = -1.0 if self._wall.settings.left else 1.0
        details = {"mode": self._wall.mode, "offset": offset, "angle": angle, "curvature": curvature}
        turn = turn_rate(offset, angle, curvature, self._pace.speed, self._wall.settings.law)
        return Command(drive=Drive(self._pace.speed, flip * turn)), Report("running", details)


class FollowWallClear:
    """Follow the wall, its ends and its corners, and touch nothing."""

    def __init__(self, wall: SeenCorners, pace: PaceSettings, clear: ClearSettings) -> None:
        self._wall, self._pace, self._clear = wall, pace, clear
        self._hull = Hull(radius=clear.hull_radius)

    def start(self, reading: Reading, channels: Channels) -> None:
        """It keeps nothing of its own."""

    def stop(self) -> None:
        """It keeps nothing of its own."""

    def step(self, reading: Reading, channels: Channels) -> tuple[Command, Report]:
        """One tick."""
        wall = self._wall
        target = wall.target()
        if target is None:
            return STOP, Report("failed", {"mode": wall.mode})
        flip = -1.0 if wall.settings.left else 1.0
        told = reading.odometry
        drive = self._safe(self._wanted(*target), Drive(told.speed, flip * told.turn_rate))
        details = {"mode": wall.mode, "offset": target[0], "angle": target[1], "turn": wall.turn}
        return Command(drive=Drive(drive.speed, flip * drive.turn_rate)), Report("running", details)

    def _wanted(self, offset: float, angle: float, curvature: float) -> Drive:
        """By the law, or past what bars the way, whichever leads more to the left."""
        wall, clear = self._wall, self._clear
        law = replace(wall.settings.law, stand_off=wall.stand_off)
        most = STEEPEST * law.gain / law.offset_gain
        offset = wall.stand_off + max(-most, min(most, offset - wall.stand_off))
        pace = self._pace.speed * self._share()
        along = turn_rate(offset, angle, curvature, max(pace, self._pace.speed / 2), law)
        aside = abs(wall.direction)
        past = max(-law.most, min(law.most, clear.away * wall.direction))
        if aside > clear.on_the_spot:
            return Drive(0.0, past)
        return Drive(pace * math.cos(aside), along if wall.mode == "wall" and wall.turn == 0.0 else past)

    def _share(self) -> float:
        """Of the speed, by the room ahead."""
        ahead = self._wall.around[self._wall.around[:, 0] > 0.0]
        away = float((ahead * ahead).sum(axis=1).min(initial=math.inf))
        room = math.sqrt(away) - self._clear.hull_radius - self._clear.margin
        return self._clear.tight + (1.0 - self._clear.tight) * max(0.0, min(1.0, room / self._clear.roomy))

    def _safe(self, wanted: Drive, now: Drive) -> Drive:
        """The fastest of the same curve that leaves the hull free; on the spot or to the left where none does."""
        clear, motors = self._clear, self._clear.motors
        far = clear.hull_radius + clear.margin + abs(now.speed) * 0.3 + wanted.speed * 0.3
        far += max(now.speed, wanted.speed) ** 2 / motors.acceleration
        points = self._wall.around
        points = points[(points * points).sum(axis=1) <= far * far]
        if not len(points):
            return wanted
        away = max(self._wall.settings.law.most / 2, wanted.turn_rate)
        tried = np.array([*((wanted.speed * s, wanted.turn_rate * max(s, 0.3)) for s in SHARES), (0.0, away)])
        gaps = least_distance(paths(now, tried, motors), points, self._hull)
        gap = math.sqrt(float((points * points).sum(axis=1).min())) - clear.hull_radius
        free = gaps >= min(clear.margin, gap - SLACK)
        if not free.any():
            return Drive(0.0, 0.0)
        best = int(np.argmax(free))
        # standing, it turns away from what bars the way and never towards it
        return Drive(0.0, away) if tried[best, 0] == 0.0 else Drive(float(tried[best, 0]), float(tried[best, 1]))
