"""Standing in place and looking where a search wants to look.

Takes: where to look, and how to turn first. Gives: a command that does so without leaving the place.
Leaves alone: the search, which its estimator keeps.
"""

from __future__ import annotations

from collections.abc import Callable

from behaviours.interface import Channels, Command, Drive, Head, Reading, Report


class Fixate:
    """look: where to look, given the reading; progress: what to report; turn_rate [rad/s]: how to turn."""

    def __init__(
        self,
        look: Callable[[Reading], Head],
        progress: Callable[[], dict[str, object]],
        turn_rate: Callable[[Reading], float] = lambda reading: 0.0,
    ) -> None:
        self._look = look
        self._progress = progress
        self._turn_rate = turn_rate

    def start(self, reading: Reading, channels: Channels) -> None:
        pass

    def step(self, reading: Reading, channels: Channels) -> tuple[Command, Report]:
        drive = Drive(0.0, self._turn_rate(reading))
        return Command(drive, self._look(reading)), Report(details=self._progress())

    def stop(self) -> None:
        pass
