"""Standing still and looking where a search wants to look.

Takes: where to look. Gives: a command that stands and looks there. Leaves alone: the search, which its estimator keeps.
"""

from __future__ import annotations

from collections.abc import Callable

from behaviours.interface import Channels, Command, Drive, Head, Reading, Report


class Fixate:
    """look: where to look, given the reading; progress: what to report."""

    def __init__(self, look: Callable[[Reading], Head], progress: Callable[[], dict[str, object]]) -> None:
        self._look = look
        self._progress = progress

    def start(self, reading: Reading, channels: Channels) -> None:
        pass

    def step(self, reading: Reading, channels: Channels) -> tuple[Command, Report]:
        return Command(drive=Drive(0.0, 0.0), head=self._look(reading)), Report(details=self._progress())

    def stop(self) -> None:
        pass
