"""Driving towards the wanted heading by the scaled vector field histogram.

Takes: the channels `heading` (map frame) and `keep-off-recent-path`, the open directions, where the robot is. Gives:
drive, and what it chose. Leaves alone: where the heading comes from.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from behaviours.cores.svfh import chosen_direction, drive, front_range
from behaviours.estimators.localisation import Localisation
from behaviours.estimators.sectors import KEEP_OFF, Sectors
from behaviours.estimators.surroundings import Surroundings
from behaviours.interface import STOP, Channels, Command, Reading, Report, View, wrap


def wanted_heading(channels: Channels) -> float | None:
    """The heading [rad, map frame] on the channel `heading`; None where there is none."""
    heading = channels.get("heading")
    if isinstance(heading, bool) or not isinstance(heading, int | float) or not math.isfinite(heading):
        return None
    return float(heading)


class SteerClear:
    """left: where to turn when nothing is open, and which of two equally good directions is taken."""

    def __init__(self, sectors: Sectors, around: Surroundings, place: Localisation, left: bool) -> None:
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


def sectors_view(open_: NDArray[np.bool_], turned: float = 0.0) -> View:
    """Direction i is centred on i / n of a turn, so the first begins half a sector to its right.

    turned [rad]: the robot frame against the one of the directions.
    """
    text = "".join("1" if free else "0" for free in open_.tolist())
    return {"kind": "sectors", "frame": "robot", "first": round(wrap(-math.pi / len(open_) - turned), 6), "open": text}
