"""Where the offset of a beacon changes from plus to minus as the head sweeps over it.

Takes: fixations (axis, offset). Gives: the bearing of the beacon, or why there is none. Leaves alone: moving the head.
Source: Bonasso, Antonisse and Slack 1992 demand the plus-to-minus change; line fit and thresholds are our own, since
the paper's description of the search is lost.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, slots=True)
class CrossingSettings:
    """side: least fixations on either side of the crossing. max_slope_error: ratio.

    max_error [rad]: of the bearing, as the standard error of a mean of so many fixations that scatter so much. It is
    small against the two degrees that the search for the range covers.
    """

    side: int = 3
    max_error: float = math.radians(0.75)
    max_slope_error: float = 0.5


TOO_FEW, NO_CHANGE = "too few readings", "no plus-to-minus change"
DISAGREE = "readings disagree"
"""The reason when a beacon is there and rocks too much."""


@dataclass(frozen=True, slots=True)
class Crossing:
    """bearing [rad] in the frame of the axes, NaN when there is none; reason: why there is none, "" otherwise.

    error [rad]: standard error of the bearing, NaN where there were too few readings to tell.
    """

    bearing: float
    reason: str = ""
    error: float = math.nan


def crossing(fixations: Sequence[tuple[float, float]], settings: CrossingSettings) -> Crossing:
    """The zero of a line through (axis [rad], offset [rad]); axes unwrapped, offsets of the beacon left positive."""
    if len(fixations) < 2 * settings.side:
        return Crossing(math.nan, TOO_FEW)
    axes, offsets = np.array(fixations, dtype=np.float64).T
    spread_of_axes = float(np.ptp(axes))
    if not np.isfinite(offsets).all() or spread_of_axes == 0.0:
        return Crossing(math.nan, TOO_FEW)
    slope, intercept = map(float, np.polyfit(axes - axes.mean(), offsets, 1))
    if abs(slope + 1.0) > settings.max_slope_error:
        return Crossing(math.nan, NO_CHANGE)
    zero = float(axes.mean()) - intercept / slope
    before = int(np.count_nonzero((axes < zero) & (offsets > 0)))
    after = int(np.count_nonzero((axes > zero) & (offsets < 0)))
    if min(before, after) < settings.side:
        return Crossing(math.nan, NO_CHANGE)
    residuals = offsets - intercept - slope * (axes - axes.mean())
    error = float(residuals.std()) / math.sqrt(len(fixations))
    return Crossing(math.nan, DISAGREE, error) if error > settings.max_error else Crossing(zero, "", error)
