"""Freeing a head that is stuck: first by its tilt, then by both axes, and in the end by asking a person.

Takes: time. Gives: a head that jolts, a base that stands, and the plea in the report. Leaves alone: when it is stuck.
"""

from __future__ import annotations

from dataclasses import dataclass

from behaviours.interface import STOP, Channels, Command, Head, Reading, Report


@dataclass(frozen=True, slots=True)
class UnStickSettings:
    """tilting, homing [s]: how long the tilt alone is sent home, then both axes, before a person is asked."""

    tilting: float = 2.0
    homing: float = 4.0


class UnStick:
    """Three levels; the last lasts."""

    def __init__(self, settings: UnStickSettings) -> None:
        self._settings = settings
        self._since = 0.0
        self._pan = 0.0

    def start(self, reading: Reading, channels: Channels) -> None:
        self._since = reading.stamp
        self._pan = 0.0 if reading.head is None else reading.head.pan

    def step(self, reading: Reading, channels: Channels) -> tuple[Command, Report]:
        tried = reading.stamp - self._since
        if tried < self._settings.tilting:
            return self._send(self._pan, {"level": 1})
        if tried < self._settings.tilting + self._settings.homing:
            return self._send(0.0, {"level": 2})
        return self._send(0.0, {"level": 3, "asks": "a helpful tap at the head"})

    def stop(self) -> None:
        pass

    def _send(self, pan: float, details: dict[str, object]) -> tuple[Command, Report]:
        return Command(STOP.drive, Head(pan, 0.0)), Report(details=details)
