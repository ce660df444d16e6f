"""Driving towards the wanted heading by the scaled vector field histogram.

Takes: the channels `heading` (map frame) and `keep-off-recent-path`, the open directions, where the robot is. Gives:
drive, and what it chose. Leaves alone: where the heading comes from.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from behaviours.cores.steering import KEEP_OFF, Around, Place, sectors_view, wanted_heading
from behaviours.cores.svfh import SvfhSettings, chosen_direction, drive, front_range
from behaviours.interface import STOP, Channels, Command, Reading, Report, View, wrap


class OpenSectors(Protocol):
    """The directions that are open."""

    @property
    def settings(self) -> SvfhSettings: ...

    def open(self, keep_off: bool, /) -> NDArray[np.bool_]: ...


class SteerClear:
    """left: where to turn when nothing is open, and which of two equally good directions is taken."""

    def __init__(self, sectors: OpenSectors, around: Around, place: Place, left: bool) -> None:
        self._sectors, self._around, self._place, self._left = sectors, around, place, left
        self._shown: View | None = None

    def start(self, reading: Reading, channels: Channels) -> None:
        self._shown = None

    def step(self, reading: Reading, channels: Channels) -> tuple[Command, Report]:
        heading = wanted_heading(channels)
        if heading is None:
            return STOP, Report("failed", {"reason": "there is no heading"})
        if not self._around.known:
            return STOP, Report(details={"reason": "nothing has been measured yet"})
        wanted = wrap(heading - self._place.heading)
        open_ = self._sectors.open(channels.get(KEEP_OFF) is True)
        direction = chosen_direction(open_, wanted, self._left)
        deflected = direction is None or direction != wanted
        settings = self._sectors.settings
        told = drive(direction, deflected, front_range(self._around.points, settings), self._left, settings)
        self._shown = sectors_view(open_)
        return Command(told), Report(details={"direction": None if direction is None else round(direction, 3)})

    def stop(self) -> None:
        self._shown = None

    def view(self) -> View | None:
        """The open directions of this tick, where it was stepped."""
        shown, self._shown = self._shown, None
        return shown
