"""Which wall is followed: a decaying tally of the orientations of lines in the world, and the heading along it.

Takes: lines of a scan, the robot's heading, the tally so far. Gives: the tally after it, the wall to follow, and the
wanted heading. Leaves alone: obstacles. All of it is for a wall to the left; a wall to the right is one to the left
seen in a mirror.

After Yamauchi 2005, sections 3 (equations 1 and 2), with these repairs: a bin holds its lower edge and not its upper
one, where the print excludes both, so that a line on an edge votes nowhere; the correction is clamped to both sides;
the orientation is that of the line and not the middle of its bin; a line that would send the robot back the way it
came (more than 135 degrees) does not vote, lest the far side of an alley wins.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from behaviours.cores.hough import Line
from behaviours.interface import Floats, wrap

BINS = 72
"""Of 5 degrees (printed)."""
BIN = math.tau / BINS
_ROUNDING = 1e-9
"""Bins: an orientation so little below an edge lies on it."""


@dataclass(frozen=True, slots=True)
class FollowSettings:
    """stand_off [m], gain [rad/m] and steepest [rad] are printed; decay, of a scan, and backwards [rad] chosen here."""

    stand_off: float = 1.5
    gain: float = math.pi / 8
    steepest: float = math.pi / 4
    decay: float = 0.2
    backwards: float = math.radians(135.0)


@dataclass(frozen=True, slots=True)
class Tracked:
    """The wall that is followed: orientation [rad] in the world, distance [m], and its line, if one is seen."""

    orientation: float
    distance: float
    line: Line | None


def no_votes() -> Floats:
    """The tally before the first scan (BINS,)."""
    return np.zeros(BINS)


def bin_of(orientation: float) -> int:
    """Which bin [i, i + 1) * 5 degrees holds an orientation [rad]."""
    return math.floor(orientation / BIN + _ROUNDING) % BINS


def along(line: Line) -> float:
    """The direction [rad] along a line that keeps it to the left, in the frame of the line."""
    return wrap(line.normal - math.pi / 2)


def tallied(tally: Floats, lines: Sequence[Line], heading: float, settings: FollowSettings) -> Floats:
    """The tally after a scan; lines in the robot frame, heading [rad] of the robot in the world."""
    voted = no_votes()
    for line in lines:
        if abs(along(line)) <= settings.backwards:
            voted[bin_of(heading + along(line))] += line.votes
    return (1.0 - settings.decay) * tally + settings.decay * voted


def tracked(tally: Floats, lines: Sequence[Line], heading: float, settings: FollowSettings) -> Tracked | None:
    """The strongest line of the strongest orientation and its neighbours. None: there has been no line yet."""
    best = int(tally.argmax())
    if tally[best] <= 0.0:
        return None
    near = [line for line in lines if _is_in(heading + along(line), best) and abs(along(line)) <= settings.backwards]
    if not near:
        return Tracked(wrap((best + 0.5) * BIN), settings.stand_off, None)
    line = max(near, key=lambda one: one.votes)
    return Tracked(wrap(heading + along(line)), line.rho, line)


def _is_in(orientation: float, best: int) -> bool:
    return (bin_of(orientation) - best + 1) % BINS <= 2


def correction(distance: float, settings: FollowSettings) -> float:
    """How far [rad] to turn towards a wall at a distance [m], negative away from it."""
    wanted = settings.gain * (distance - settings.stand_off)
    return max(-settings.steepest, min(settings.steepest, wanted))


def wanted_heading(wall: Tracked, settings: FollowSettings) -> float:
    """The heading [rad] in the world that leads to the stand-off and along the wall."""
    return wrap(wall.orientation + correction(wall.distance, settings))
