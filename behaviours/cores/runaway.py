"""Running away: the drive that leaves danger by the shortest turn.

Takes: echoes (range from the hull, bearing). Gives: speed and turn rate. Leaves alone: when danger begins and ends.
Source: Bonasso, Antonisse and Slack 1992 (inverse square summation over the readings within the safety radius,
forward or backward, whichever is quicker); the answer to a symmetric pinch is our own.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from behaviours.interface import wrap

Echo = tuple[float, float]
"""range [m] from the hull, bearing [rad, robot frame]."""


@dataclass(frozen=True, slots=True)
class RunawaySettings:
    """Lengths [m], speed [m/s], gain [1/s], turn rate [rad/s]; pinch: a ratio."""

    safety_radius: float = 0.2
    release: float = 0.02
    max_speed: float = 0.2
    steering_gain: float = 1.5
    max_turn_rate: float = 0.8
    min_range: float = 0.05
    pinch: float = 0.05


def nearest(echoes: Sequence[Echo]) -> float:
    """The smallest range [m]; infinite without echoes. A range that is not a number counts as nothing heard."""
    return min((r for r, _ in echoes if not math.isnan(r)), default=math.inf)


def flee(echoes: Sequence[Echo], settings: RunawaySettings) -> tuple[float, float]:
    """Speed [m/s] and turn rate [rad/s] away from the echoes within the safety radius and its release margin.

    Both are zero where there is no such echo. The heading is the x axis of the robot frame.
    """
    radius = settings.safety_radius + settings.release
    weights = [(max(r, settings.min_range) ** -2, b) for r, b in echoes if r < radius]
    x = -sum(w * math.cos(b) for w, b in weights)
    y = -sum(w * math.sin(b) for w, b in weights)
    total = sum(w for w, _ in weights)
    if not weights:
        return 0.0, 0.0
    if math.hypot(x, y) < settings.pinch * total:
        return _squeeze_out(echoes, radius, settings)
    away = math.atan2(y, x)
    if abs(away) <= math.pi / 2:
        return _drive(away, 1.0, settings)
    return _drive(wrap(away - math.pi), -1.0, settings)


def _drive(turn: float, sign: float, settings: RunawaySettings) -> tuple[float, float]:
    limit = settings.max_turn_rate
    rate = min(limit, max(-limit, settings.steering_gain * turn))
    return sign * settings.max_speed * max(0.0, math.cos(turn)), rate


def _squeeze_out(echoes: Sequence[Echo], radius: float, settings: RunawaySettings) -> tuple[float, float]:
    """Pinched from both sides: turn to the widest gap, and go once it is open and ahead."""
    widest, gap = max(((r, b) for r, b in echoes if not math.isnan(r)), key=lambda echo: (echo[0], -abs(echo[1])))
    speed, rate = _drive(gap, 1.0, settings)
    return (speed if widest > radius and abs(gap) < math.pi / 6 else 0.0), rate
