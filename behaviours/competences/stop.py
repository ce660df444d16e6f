"""Standing still.

Takes: nothing. Gives: the safe command. Leaves alone: the head.
"""

from __future__ import annotations

from behaviours.interface import STOP, Channels, Command, Reading, Report


class Stop:
    def start(self, reading: Reading, channels: Channels) -> None:
        pass

    def step(self, reading: Reading, channels: Channels) -> tuple[Command, Report]:
        return STOP, Report()

    def stop(self) -> None:
        pass
