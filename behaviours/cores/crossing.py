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


DISAGREE = "readings disagree"
"""The reason when a beacon is there and rocks too much."""


@dataclass(frozen=True, slots=True)
class Crossing:
    """bearing [rad] in the frame of the axes, NaN when there is none; reason: why there is none, "" otherwise."""

    bearing: float
    reason: str = ""


def crossing(fixations: Sequence[tuple[float, float]], settings: CrossingSettings) -> Crossing:
    """The zero of a line through (axis [rad], offset [rad]); axes unwrapped, offsets of the beacon left positive."""
    if len(fixations) < 2 * settings.side:
        return Crossing(math.nan, "too few readings")
    axes, offsets = np.array(fixations, dtype=np.float64).T
    spread_of_axes = float(np.ptp(axes))
    if not np.isfinite(offsets).all() or spread_of_axes == 0.0:
        return Crossing(math.nan, "too few readings")
    slope, intercept = map(float, np.polyfit(axes - axes.mean(), offsets, 1))
    if abs(slope + 1.0) > settings.max_slope_error:
        return Crossing(math.nan, "no plus-to-minus change")
    zero = float(axes.mean()) - intercept / slope
    before = int(np.count_nonzero((axes < zero) & (offsets > 0)))
    after = int(np.count_nonzero((axes > zero) & (offsets < 0)))
    if min(before, after) < settings.side:
        return Crossing(math.nan, "no plus-to-minus change")
    residuals = offsets - intercept - slope * (axes - axes.mean())
    if float(residuals.std()) > settings.max_error * math.sqrt(len(fixations)):
        return Crossing(math.nan, DISAGREE)
    return Crossing(zero)
