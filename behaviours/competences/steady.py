"""Driving at a steady speed, whatever the sensors say: ahead, back, or on the spot.

Takes: nothing. Gives: the same twist each tick. Leaves alone: the head and the flippers.
"""

from __future__ import annotations

from behaviours.interface import Channels, Command, Drive, Reading, Report


class Steady:
    """speed [m/s], turn_rate [rad/s]."""

    def __init__(self, speed: float, turn_rate: float) -> None:
        self._command = Command(Drive(speed, turn_rate))

    def start(self, reading: Reading, channels: Channels) -> None:
        pass

    def step(self, reading: Reading, channels: Channels) -> tuple[Command, Report]:
        return self._command, Report()

    def stop(self) -> None:
        pass
