"""Sun and wind.

Takes: nothing. Gives: `Weather`. Leaves alone: what they do to sensors.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Weather:
    """sun: its bearing [rad, world], None when it does not shine.

    jitter, gust [rad]: sd of what the wind does to the beacon's bearing; gusts: chance of a gust at a fixation.
    """

    sun: float | None = None
    jitter: float = 0.0
    gust: float = 0.0
    gusts: float = 0.0
