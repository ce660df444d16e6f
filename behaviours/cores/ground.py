"""Looking along the ground for something that stands on it.

Takes: camera height and bearing. Gives: where to look, and whether a range is off the ground.
Leaves alone: moving the head, remembering.
Source: Bonasso, Antonisse and Slack 1992 (start at six feet, pan over the error of the bearing, tilt up by a step from
the least object size, discontinuity beyond the accountable errors); the error model's numbers are our own.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

FOOT = 0.3048


@dataclass(frozen=True, slots=True)
class GroundSettings:
    """Lengths [m], angles [rad]; error_linear and error_square [1/m] make the standard deviation of a slant range.

    The standard deviation is `error_linear * z + error_square * z**2`. A ray that meets the ground beyond `cut_off`
    is needed to tell an object that stands just before it, so rays go on to `reach`.
    """

    start: float = 6 * FOOT
    cut_off: float = 25 * FOOT
    reach: float = 9.5
    object_height: float = 0.25
    pan_span: float = math.radians(2.0)
    pans: int = 4
    error_linear: float = 0.01
    error_square: float = 0.002
    error_factor: float = 3.0


def ground_points(height: float, settings: GroundSettings) -> tuple[float, ...]:
    """Ground distances [m] of the rays, near to far: each still cuts an object that the ray before just missed.

    height [m] of the cameras, greater than the object height.
    """
    step = height / (height - settings.object_height)
    points = []
    at = settings.start
    while at <= settings.reach:
        points.append(at)
        at *= step
    return tuple(points)


def pans(settings: GroundSettings) -> tuple[float, ...]:
    """Pan angles [rad] about the bearing that cover its error, the likely ones in the middle first."""
    if settings.pans == 1:
        return (0.0,)
    across = [settings.pan_span * (2 * i / (settings.pans - 1) - 1) for i in range(settings.pans)]
    return tuple(sorted(across, key=abs))


def tilt(height: float, ground: float) -> float:
    """Downward tilt [rad] of the ray that meets the ground at `ground` [m]."""
    return math.atan2(height, ground)


def sigma(slant: float, settings: GroundSettings) -> float:
    """Standard deviation [m] of a slant range."""
    return settings.error_linear * slant + settings.error_square * slant**2


def off_the_ground(slant: float, height: float, tilted: float, settings: GroundSettings) -> bool:
    """Whether a slant range [m] differs from that of flat ground by more than the accountable errors; NaN does not."""
    expected = height / math.sin(tilted)
    return abs(slant - expected) > settings.error_factor * sigma(expected, settings)
