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
    """side: least fixations on either side of the crossing. max_spread: of residuals [rad]. max_slope_error: ratio."""

    side: int = 3
    max_spread: float = math.radians(2.0)
    max_slope_error: float = 0.5


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
    if float(residuals.std()) > settings.max_spread:
        return Crossing(math.nan, "readings disagree")
    return Crossing(zero)
