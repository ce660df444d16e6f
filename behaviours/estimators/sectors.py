"""Which directions are open round the robot, this tick.

Takes: the points round the robot, those of its recent path if they are to be kept off. Gives: blocked directions and
whether the way is blocked. Leaves alone: which direction is taken.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from behaviours.cores.steering import KEEP_OFF
from behaviours.cores.svfh import SvfhSettings, histogram
from behaviours.estimators.surroundings import Surroundings
from behaviours.interface import Channels, Floats, Reading, Report


class Sectors:
    """trail: the points (n, 2) [m, robot frame] of the recent path that are far enough away to be kept off."""

    def __init__(self, settings: SvfhSettings, around: Surroundings, trail: Callable[[], Floats]) -> None:
        self.settings = settings
        self._around, self._trail = around, trail
        self._keeps_off = False
        self._made: dict[bool, NDArray[np.bool_]] = {}

    def update(self, reading: Reading, reports: Mapping[str, Report], channels: Channels) -> None:
        self._keeps_off = channels.get(KEEP_OFF) is True
        self._made = {}

    def open(self, keep_off: bool) -> NDArray[np.bool_]:
        """The directions that are open now (directions,)."""
        if keep_off not in self._made:
            self._made[keep_off] = histogram(self.points(keep_off), self.settings) < self.settings.threshold
        return self._made[keep_off]

    def points(self, keep_off: bool) -> Floats:
        """All that is to be kept off (n, 2) [m, robot frame]."""
        return np.concatenate([self._around.points, self._trail()]) if keep_off else self._around.points

    @property
    def is_blocked(self) -> bool:
        """No direction is open; the recent path counts if it did in the last tick."""
        return not bool(self.open(self._keeps_off).any())
