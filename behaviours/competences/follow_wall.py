"""Along a wall: a set speed, and the turn rate of the law.

Takes: the wall as an estimator sees it. Gives: drive commands; it stands where no wall is followed. Leaves alone: how
the wall is found. With corners, what is close ahead slows the robot down, and it turns away from it on the spot.
"""

from __future__ import annotations

from dataclasses import dataclass

from behaviours.cores.wall_law import turn_rate
from behaviours.estimators.fitted_wall import FittedWall
from behaviours.interface import STOP, Channels, Command, Drive, Reading, Report


@dataclass(frozen=True, slots=True)
class PaceSettings:
    """speed [m/s]; with corners: stop [m] before what is ahead, from the middle of the robot, and slow down from slow
    [m] on; away [rad/s]: the turn on the spot."""

    speed: float = 0.48
    stop: float = 0.45
    slow: float = 1.0
    away: float = 0.8


class FollowWall:
    """Follow the wall."""

    def __init__(self, wall: FittedWall, pace: PaceSettings) -> None:
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
        speed = self._speed()
        if speed <= 0.0:
            return Command(drive=Drive(0.0, flip * self._pace.away)), Report("running", details)
        turn = turn_rate(offset, angle, curvature, speed, self._wall.settings.law)
        return Command(drive=Drive(speed, flip * turn)), Report("running", details)

    def _speed(self) -> float:
        pace = self._pace
        if not self._wall.settings.corners:
            return pace.speed
        share = (self._wall.front - pace.stop) / (pace.slow - pace.stop)
        return pace.speed * min(1.0, max(0.3, share)) if share > 0 else 0.0
