"""Where a robot is beside its wall: offset and angle, filtered.

Takes: fitted lines, speed and turn rate. Gives: offset y [m] from the wall and angle theta [rad] of the heading against
it. Leaves alone: the fitting and the steering.

The wall lies to the right and is the x-axis; the robot is at y > 0, and theta > 0 leads away from the wall. A wall to
the left is one to the right in the mirror. State (y, theta) of Bayer 2012, whose filter is not printed: an extended
Kalman filter with y+ = y + v dt sin(theta), theta+ = theta + omega dt.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from behaviours.cores.wall_fit import Line
from behaviours.interface import wrap


@dataclass(frozen=True, slots=True)
class FilterSettings:
    """Variances: of the motion a step, of what a fit says, and at the start; all chosen here."""

    offset_drift: float = 1e-4
    angle_drift: float = 4e-4
    offset_noise: float = 1e-3
    angle_noise: float = 1e-3
    start: float = 0.05


@dataclass(frozen=True, slots=True)
class WallState:
    """offset [m], angle [rad]; a, b, c: their covariance [[a, b], [b, c]]."""

    offset: float
    angle: float
    a: float
    b: float
    c: float


def measured(line: Line) -> tuple[float, float]:
    """Offset [m] and angle [rad] that a line says."""
    return line.distance, wrap(-line.normal - math.pi / 2)


def begun(line: Line, settings: FilterSettings) -> WallState:
    """The state when a wall has been found."""
    return WallState(*measured(line), settings.start, 0.0, settings.start)


def predicted(state: WallState, speed: float, turn_rate: float, dt: float, settings: FilterSettings) -> WallState:
    """dt [s] later."""
    offset = state.offset + speed * dt * math.sin(state.angle)
    slope = speed * dt * math.cos(state.angle)
    b = state.b + slope * state.c
    a = state.a + slope * (state.b + b) + settings.offset_drift
    return WallState(offset, wrap(state.angle + turn_rate * dt), a, b, state.c + settings.angle_drift)


def updated(state: WallState, line: Line, settings: FilterSettings) -> WallState:
    """With what a fit says."""
    offset, angle = measured(line)
    e, f = offset - state.offset, wrap(angle - state.angle)
    a, b, c = state.a + settings.offset_noise, state.b, state.c + settings.angle_noise
    det = a * c - b * b
    # gain = P S^-1, row by row
    g11, g12 = (state.a * c - b * b) / det, (b * a - state.a * b) / det
    g21, g22 = (b * c - state.c * b) / det, (state.c * a - b * b) / det
    return WallState(
        state.offset + g11 * e + g12 * f,
        wrap(state.angle + g21 * e + g22 * f),
        (1 - g11) * state.a - g12 * state.b,
        (1 - g11) * state.b - g12 * state.c,
        (1 - g22) * state.c - g21 * state.b,
    )


def as_line(state: WallState) -> Line:
    """The line that the state tells of."""
    return Line(wrap(-state.angle - math.pi / 2), state.offset)
