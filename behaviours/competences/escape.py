"""Getting out of stasis: the way in backwards where it is known, then random motions, each for a while.

Takes: the way back, draws. Gives: a drive. Leaves alone: when the robot is stuck, and for how long (`Stasis`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from behaviours.interface import STOP, Channels, Command, Drive, Reading, Report


class Escape:
    """way_back: motions, one a tick; draw: a random motion; each [s]: how long one is tried; given_up: stand."""

    def __init__(
        self,
        way_back: Callable[[], Sequence[Drive]],
        draw: Callable[[], Drive],
        each: float,
        given_up: Callable[[], bool],
    ) -> None:
        self._way_back, self._draw, self._each, self._given_up = way_back, draw, each, given_up
        self._left: list[Drive] = []
        self._drawn: Drive | None = None
        self._since = 0.0
        self._tries = 0

    def start(self, reading: Reading, channels: Channels) -> None:
        self._left, self._drawn, self._tries = [*self._way_back()], None, 0

    def step(self, reading: Reading, channels: Channels) -> tuple[Command, Report]:
        if self._given_up():
            return STOP, Report("failed", {"asks": "an operator"})
        if self._left:
            return Command(self._left.pop(0)), Report(details={"way": "back"})
        if self._drawn is None or reading.stamp - self._since >= self._each - 1e-9:
            self._drawn, self._since = self._draw(), reading.stamp
            self._tries += 1
        return Command(self._drawn), Report(details={"way": "random", "tries": self._tries})

    def stop(self) -> None:
        self._left, self._drawn = [], None
