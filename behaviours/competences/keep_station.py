"""Holding the place where the robot stood, against being pushed.

Takes: odometry. Gives: a drive back to the place, forward or backward, whichever is quicker, and then to the heading.
Leaves alone: the head; obstacles on the way, which is short.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from behaviours.cores.geometry import bearing, distance
from behaviours.interface import STOP, Channels, Command, Drive, Pose, Reading, Report, wrap


@dataclass(frozen=True, slots=True)
class StationSettings:
    """slack [m], heading_slack [rad]: what is not corrected; gains [1/s]; speed [m/s] and turn rate [rad/s] at most."""

    slack: float = 0.05
    heading_slack: float = math.radians(3.0)
    gain: float = 0.8
    turn_gain: float = 1.5
    station_speed: float = 0.2
    station_turn_rate: float = 0.8


class KeepStation:
    """The place and heading are those at the start."""

    def __init__(self, settings: StationSettings) -> None:
        self._settings = settings
        self._place: Pose | None = None
        self._back = False

    def start(self, reading: Reading, channels: Channels) -> None:
        self._place = reading.odometry.pose
        self._back = False

    def step(self, reading: Reading, channels: Channels) -> tuple[Command, Report]:
        s, pose = self._settings, reading.odometry.pose
        place = self._place or pose
        off = distance(pose, place)
        self._back = off > (s.slack / 2 if self._back else s.slack)
        details = {"off": round(off, 3)}
        if self._back:
            return Command(self._towards(pose, place, off)), Report(details=details)
        turn = wrap(place.theta - pose.theta)
        if abs(turn) <= s.heading_slack:
            return STOP, Report(details=details)
        return Command(Drive(0.0, self._turn(turn))), Report(details=details)

    def stop(self) -> None:
        self._place = None

    def _towards(self, pose: Pose, place: Pose, off: float) -> Drive:
        s = self._settings
        ahead = wrap(bearing(pose, place) - pose.theta)
        backwards = abs(ahead) > math.pi / 2
        error = wrap(ahead + math.pi) if backwards else ahead
        speed = min(s.station_speed, s.gain * off) * max(0.0, math.cos(error)) ** 2
        return Drive(-speed if backwards else speed, self._turn(error))

    def _turn(self, error: float) -> float:
        s = self._settings
        return min(s.station_turn_rate, max(-s.station_turn_rate, s.turn_gain * error))
