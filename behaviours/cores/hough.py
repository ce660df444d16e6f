"""The directed Hough transform: straight lines in a scan.

Takes: points. Gives: the strongest lines, each with the direction in which it lies, its distance, and how many points
voted for it. Leaves alone: which of them is a wall.

A line is its *normal*, the bearing of its nearest point, and `rho` > 0, the distance of that point. The normal goes
round the whole circle, so a line is directed: a wall to the left and one to the right never share a normal.

After Ballard and Brown 1982. Yamauchi 2005 prints no resolution; the bins are chosen here. The values of a bin alone
(2 degrees, 0.1 m) would hold a robot at up to 0.09 m beside its stand-off, so a line is fitted to its points by least
squares, in the second round to those within `band`; `refine` false leaves the middle of the bin.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from behaviours.interface import Floats, wrap

if TYPE_CHECKING:
    from numpy.typing import NDArray

HALF = 90
"""Normals over half a turn: 2 degrees apart, 180 in all."""
BIN = 0.1
"""[m] of rho."""
RANGES = 100
"""Bins of rho: up to 10 m."""
NEAR_NORMALS, NEAR_RANGES = 8, 4
"""A weaker peak within 16 degrees and 0.4 m of a stronger one is the same line."""

_STEP = math.pi / HALF
_ROW = 2 * RANGES + 2
"""Of the votes for one normal and its opposite: too far, RANGES, RANGES, too far."""
_FAR = np.float32(RANGES)


def _normals() -> tuple[Floats, Floats]:
    """Cosines and sines of all normals, so that those of mirrored and opposite ones are the same to the last bit."""
    quarter = np.arange(HALF // 2 + 1) * _STEP
    c, s = np.cos(quarter), np.sin(quarter)
    c[-1], s[-1] = 0.0, 1.0
    half_c, half_s = np.concatenate([c, -c[-2:0:-1]]), np.concatenate([s, s[-2:0:-1]])
    return np.concatenate([half_c, -half_c]), np.concatenate([half_s, -half_s])


_COS, _SIN = _normals()
_BLOCK = 30
_TABLES = [
    np.array([_COS[first : first + _BLOCK], _SIN[first : first + _BLOCK]], dtype=np.float32) / np.float32(BIN)
    for first in range(0, HALF, _BLOCK)
]
_OFFSETS = (np.arange(_BLOCK) * _ROW + RANGES + 1).astype(np.int32)


@dataclass(frozen=True, slots=True)
class HoughSettings:
    """least_votes: fewer make no line; peaks: the most lines; band [m]: half the width of what is fitted."""

    least_votes: int = 12
    peaks: int = 6
    refine: bool = True
    band: float = 0.06


@dataclass(frozen=True, slots=True)
class Line:
    """normal [rad] in the frame of the points, wrapped; rho > 0 [m]; votes: points on it."""

    normal: float
    rho: float
    votes: int


def votes(points: Floats) -> NDArray[np.int32]:
    """How many points lie in each bin (2 * HALF normals, RANGES); points (n, 2) [m].

    A few normals at a time, so that no array is so large that the memory for it has to be fetched anew.
    """
    narrow = points.astype(np.float32)
    counted = np.empty((2 * HALF, RANGES), dtype=np.int32)
    offsets = np.tile(_OFFSETS, (len(points), 1))
    for first, table in zip(range(0, HALF, _BLOCK), _TABLES, strict=True):
        signed = narrow @ table
        np.clip(signed, -_FAR, _FAR, out=signed)
        cells = signed.astype(np.int32)
        cells += signed.view(np.int32) >> 31  # bin 0 of the opposite normal is -1
        cells += offsets
        block = np.bincount(cells.ravel(), minlength=_BLOCK * _ROW).reshape(_BLOCK, _ROW)
        counted[first : first + _BLOCK] = block[:, RANGES + 1 : -1]
        counted[first + HALF : first + HALF + _BLOCK] = block[:, RANGES:0:-1]
    return counted


def lines(points: Floats, settings: HoughSettings) -> tuple[Line, ...]:
    """The strongest lines through the points (n, 2) [m], the strongest first."""
    if len(points) < settings.least_votes:
        return ()
    peaks = _peaks(votes(points), settings)
    if not peaks:
        return ()
    normals = [peak[0] for peak in peaks]
    n, rho = np.stack([_COS[normals], _SIN[normals]], axis=1), np.array([(peak[1] + 0.5) * BIN for peak in peaks])
    if settings.refine:
        moments = _moments(points)
        for band in (BIN, settings.band):
            n, rho = _fitted(moments, n, rho, band)
    bearings = np.arctan2(n[:, 1], n[:, 0]).tolist()
    found = zip(bearings, rho.tolist(), peaks, strict=True)
    return tuple(Line(wrap(bearing), r, peak[2]) for bearing, r, peak in found if r > 0.0)


def _peaks(counted: NDArray[np.int32], settings: HoughSettings) -> list[tuple[int, int, int]]:
    """Normal, bin of rho and votes of the strongest bins, each far enough from all before it."""
    found: list[tuple[int, int, int]] = []
    flat = counted.reshape(-1)
    while len(found) < settings.peaks:
        at = int(flat.argmax())
        strength = int(flat[at])
        if strength < settings.least_votes:
            break
        normal, reach = divmod(at, RANGES)
        found.append((normal, reach, strength))
        _clear(counted, normal, reach)
    return found


def _clear(counted: NDArray[np.int32], normal: int, reach: int) -> None:
    """Take the votes near a peak away. A line close by the robot lies on the other side, too, at little more."""
    _wipe(counted, normal, max(0, reach - NEAR_RANGES), reach + NEAR_RANGES + 1)
    if reach < NEAR_RANGES:
        _wipe(counted, normal + HALF, 0, NEAR_RANGES - reach)


def _wipe(counted: NDArray[np.int32], normal: int, first: int, end: int) -> None:
    """No votes for normals near one, around the circle, and for these bins of rho."""
    low = (normal - NEAR_NORMALS) % (2 * HALF)
    high = low + 2 * NEAR_NORMALS + 1
    counted[low:high, first:end] = 0
    if high > 2 * HALF:
        counted[: high - 2 * HALF, first:end] = 0


def _moments(points: Floats) -> Floats:
    """(6, m): 1, x, y, xx, xy, yy of each point."""
    made = np.empty((6, len(points)))
    made[0] = 1.0
    made[1:3] = points.T
    np.multiply(made[1], made[1:3], out=made[3:5])
    np.multiply(made[2], made[2], out=made[5])
    return made


def _fitted(moments: Floats, n: Floats, rho: Floats, band: float) -> tuple[Floats, Floats]:
    """Lines of least squares through the points within `band` of lines; n (k, 2) unit normals, rho (k,).

    A line that has lost its points gets rho 0.
    """
    off = n @ moments[1:3]
    off -= rho[:, None]
    near = (np.abs(off, out=off) <= band).astype(np.float64)
    sums = moments @ near.T
    count = sums[0]
    sums[3] -= sums[5]
    mx, my, spread, sxy = sums[1:5] / np.maximum(count, 1.0)
    along = 0.5 * np.arctan2(2.0 * (sxy - mx * my), spread - mx * mx + my * my)
    fitted = np.empty((2, len(rho)))
    np.negative(np.sin(along), out=fitted[0])
    np.cos(along, out=fitted[1])
    reach = fitted[0] * mx + fitted[1] * my
    return (fitted * np.copysign(1.0, reach)).T, np.where(count < 3.0, 0.0, np.abs(reach))
