"""Along a wall that says where to head: whatever steers clear of obstacles is told that heading.

Takes: the heading along the wall, a competence that steers towards the channel `heading`. Gives: its drive commands;
STOP once the wall is lost. Leaves alone: both.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

from behaviours.cores.steering import KEEP_OFF
from behaviours.interface import STOP, Channels, Command, Competence, Reading, Report


class LinedWall(Protocol):
    """The wall; mode: what is known of it; offset [m], angle [rad]."""

    @property
    def mode(self) -> str: ...

    @property
    def offset(self) -> float: ...

    @property
    def angle(self) -> float: ...


class FollowHeading:
    """Follow the wall."""

    def __init__(self, wall: LinedWall, heading: Callable[[], float], steer: Competence) -> None:
        self._wall, self._heading, self._steer = wall, heading, steer

    def start(self, reading: Reading, channels: Channels) -> None:
        self._steer.start(reading, channels)

    def stop(self) -> None:
        self._steer.stop()

    def step(self, reading: Reading, channels: Channels) -> tuple[Command, Report]:
        """One tick."""
        if self._wall.mode in ("none", "lost"):
            return STOP, Report("failed", {"mode": self._wall.mode})
        told = {**channels, "heading": self._heading(), KEEP_OFF: False}
        command, report = self._steer.step(reading, told)
        details = {"mode": self._wall.mode, "offset": self._wall.offset, "angle": self._wall.angle}
        return command, Report(report.status, {**report.details, **details})
