"""Flippers out or home.

Takes: nothing. Gives: a command for the flippers alone. Leaves alone: when (the library `flippers`), and the drive.
"""

from __future__ import annotations

from behaviours.interface import Channels, Command, Flippers, Reading, Report


class SetFlippers:
    """deployed: out, or home."""

    def __init__(self, deployed: bool) -> None:
        self._command = Command(flippers=Flippers(deployed))

    def start(self, reading: Reading, channels: Channels) -> None:
        pass

    def step(self, reading: Reading, channels: Channels) -> tuple[Command, Report]:
        return self._command, Report()

    def stop(self) -> None:
        pass
