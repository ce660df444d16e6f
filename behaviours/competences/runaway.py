"""Running away from what is too close.

Takes: the echoes of both rings. Gives: a drive out of danger. Leaves alone: the head, and when there is danger.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from behaviours.cores.runaway import Echo, RunawaySettings, flee, nearest
from behaviours.interface import Channels, Command, Drive, Reading, Report


class Runaway:
    """echoes: those of the latest sweeps."""

    def __init__(self, echoes: Callable[[], Sequence[Echo]], settings: RunawaySettings) -> None:
        self._echoes = echoes
        self._settings = settings

    def start(self, reading: Reading, channels: Channels) -> None:
        pass

    def step(self, reading: Reading, channels: Channels) -> tuple[Command, Report]:
        echoes = self._echoes()
        speed, turn_rate = flee(echoes, self._settings)
        details = {"nearest": round(nearest(echoes), 3)} if echoes else {}
        return Command(drive=Drive(speed, turn_rate)), Report(details=details)

    def stop(self) -> None:
        pass
