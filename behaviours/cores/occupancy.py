"""An occupancy grid: for each cell of the plane how likely something stands in it.

Takes: scans and where they were made, in one frame. Gives: the grid, as log-odds and as probabilities in percent.
Leaves alone: where the poses come from, and who gets the map.

Source: Moravec and Elfes 1985; Yamauchi 2005 (cells of 0.2 m, prior 0.5). One scan changes a cell once: where a beam
ends, something stands; where one passes and none ends, nothing does. A beam that met nothing passes all its range.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from behaviours.interface import Pose, Scan

Singles = NDArray[np.float32]
Bytes = NDArray[np.uint8]

UNKNOWN = 255
"""Among percents: no scan has told of the cell."""

UNEVEN = 1.0001
"""Beams that pass weigh this much more, so that no evidence adds up to just 0, which stands for none."""

TILE = 64
"""Cells by which the grid grows, to each side that needs it."""

FEW = 64
"""So many beams are followed at once: small arrays cost no new pages of memory."""

MOST = 2048
"""A cell so many cells from the origin along x or y is not kept, 410 m with cells of 0.2 m: the memory is bounded."""


@dataclass(frozen=True, slots=True)
class OccupancySettings:
    """cell: side [m]. reach [m]: what lies beyond is left out.

    hit, passed: the probability of a cell in which a beam ended, or through which it went, if that is all that is
    known. surest: no cell gets nearer to 0 or 1 than this is to 1. spare: so many cells before its end a beam stops to
    free what it passes, so that beams that graze a wall do not wipe it out.
    """

    cell: float = 0.2
    hit: float = 0.7
    passed: float = 0.4
    surest: float = 0.97
    reach: float = 20.0
    spare: float = 0.0


@dataclass(frozen=True, slots=True)
class Region:
    """A rectangle of cells: the lowest column and row (cell k begins at k * cell [m]), and how many of each."""

    column: int
    row: int
    columns: int
    rows: int


def logit(p: float) -> float:
    """Log-odds of a probability in (0, 1)."""
    return math.log(p / (1.0 - p))


class Plane:
    """An array of cells that grows by whole tiles where it is written. region: what it spans; cells: row 0 lowest."""

    def __init__(self, kind: type[np.float32] | type[np.uint8], empty: float) -> None:
        self.region = Region(0, 0, 0, 0)
        self.cells: NDArray[Any] = np.zeros((0, 0), dtype=kind)
        self._empty = empty

    def at(self, region: Region) -> NDArray[Any]:
        """The cells of the region, to be changed in place; the plane grows to hold them."""
        self._reach(region)
        return self.cells[self._where(region)]

    def copy(self, region: Region) -> NDArray[Any]:
        """The cells of a region that may go beyond the plane."""
        told = np.full((region.rows, region.columns), self._empty, dtype=self.cells.dtype)
        common = _common(region, self.region)
        if common is not None:
            rows = slice(common.row - region.row, common.row - region.row + common.rows)
            columns = slice(common.column - region.column, common.column - region.column + common.columns)
            told[rows, columns] = self.cells[self._where(common)]
        return told

    def _where(self, region: Region) -> tuple[slice, slice]:
        row, column = region.row - self.region.row, region.column - self.region.column
        return slice(row, row + region.rows), slice(column, column + region.columns)

    def _reach(self, region: Region) -> None:
        wanted = _union(region, self.region) if self.cells.size else region
        if wanted == self.region:
            return
        column, row = TILE * (wanted.column // TILE), TILE * (wanted.row // TILE)
        columns = TILE * -(-(wanted.column + wanted.columns - column) // TILE)
        rows = TILE * -(-(wanted.row + wanted.rows - row) // TILE)
        old, here = self.cells, self.region
        self.region = Region(column, row, columns, rows)
        self.cells = np.full((rows, columns), self._empty, dtype=old.dtype)
        if old.size:
            self.cells[self._where(here)] = old


class OccupancyGrid:
    """Grows as scans come. odds: log-odds, 0 where unknown; known: so many cells scans have told of."""

    def __init__(self, settings: OccupancySettings) -> None:
        self.settings = settings
        self.odds = Plane(np.float32, 0.0)
        self.known = 0
        self._hit, self._passed = np.float32(logit(settings.hit)), np.float32(UNEVEN * logit(settings.passed))
        self._most = np.float32(logit(settings.surest))

    @property
    def area(self) -> float:
        """[m^2] of which scans have told."""
        return self.known * self.settings.cell**2

    def add(self, scan: Scan, p_MR: Pose) -> None:
        """Take a scan that was made with the robot at p_MR, in the frame of the map."""
        eye, bearings, ranges, ended = _beams(scan, p_MR, self.settings.reach)
        window = _within(eye, float(ranges.max(initial=0.0)), self.settings.cell)
        if window is None or not ranges.size:
            return
        cell = self.settings.cell
        x0, y0 = eye[0] / cell - window.column, eye[1] / cell - window.row
        changes = np.zeros(window.rows * window.columns, dtype=np.float32)
        free = np.where(ended, np.maximum(ranges / cell - self.settings.spare, 0), ranges / cell).astype(np.float32)
        for some in range(0, ranges.size, FEW):
            part = slice(some, some + FEW)
            changes[_passed(x0, y0, bearings[part], free[part], window)] = self._passed
        changes[_ends(x0, y0, bearings[ended], ranges[ended] / cell, window)] = self._hit
        odds = self.odds.at(window)
        told = changes.reshape(window.rows, window.columns)
        self.known += int(np.count_nonzero((odds == 0) & (told != 0)))
        odds += told
        np.clip(odds, -self._most, self._most, out=odds)

    def percents(self, region: Region) -> Bytes:
        """(rows, columns) of probabilities [%], `UNKNOWN` where no scan told; the region may go beyond the grid."""
        odds = self.odds.copy(region)
        some = np.rint(100.0 / (1.0 + np.exp(-odds))).astype(np.uint8)
        return np.where(odds == 0.0, np.uint8(UNKNOWN), some)


def _beams(scan: Scan, p_MR: Pose, reach: float) -> tuple[tuple[float, float], Singles, Singles, NDArray[np.bool_]]:
    """The eye, and of each beam that worked: its bearing in the frame of the map, its range, whether it ended there."""
    c, s = math.cos(p_MR.theta), math.sin(p_MR.theta)
    eye = p_MR.x + c * scan.mount.x - s * scan.mount.y, p_MR.y + s * scan.mount.x + c * scan.mount.y
    worked = np.isfinite(scan.ranges)
    ranges, bearings = scan.ranges[worked], scan.bearings[worked]
    ended = (ranges < scan.max_range) & (ranges <= reach)
    turn = p_MR.theta + scan.mount.theta
    return eye, (bearings + turn).astype(np.float32), np.minimum(ranges, reach).astype(np.float32), ended


def _within(eye: tuple[float, float], far: float, cell: float) -> Region | None:
    """The cells that beams of this length may touch; None where they lie outside of what is kept."""
    if not (max(abs(eye[0]), abs(eye[1])) + far) / cell < MOST - TILE:
        return None
    column, row = (math.floor((value - far) / cell) - 1 for value in eye)
    side = math.ceil(2 * far / cell) + 3
    return Region(column, row, side, side)


def _passed(x0: float, y0: float, bearings: Singles, reach: Singles, window: Region) -> NDArray[np.intp]:
    """Which cells of the window the beams went through, in lengths of a cell; points each half cell, some twice."""
    counts = np.ceil(2 * reach).astype(np.intp)
    ends = np.cumsum(counts)
    along = np.arange(ends[-1], dtype=np.float32)
    along -= np.repeat((ends - counts).astype(np.float32), counts)
    along *= np.float32(0.5)
    x, y = np.repeat(np.cos(bearings), counts), np.repeat(np.sin(bearings), counts)
    x *= along
    y *= along
    return _cells(x, y, x0, y0, window)


def _ends(x0: float, y0: float, bearings: Singles, reach: Singles, window: Region) -> NDArray[np.intp]:
    return _cells(reach * np.cos(bearings), reach * np.sin(bearings), x0, y0, window)


def _cells(x: Singles, y: Singles, x0: float, y0: float, window: Region) -> NDArray[np.intp]:
    """Indices of the cells (x0 + x, y0 + y) of the window, which the sums lie in; changes x and y."""
    x += np.float32(x0)
    y += np.float32(y0)
    cells = y.astype(np.intp)
    cells *= window.columns
    cells += x.astype(np.intp)
    return cells


def _common(a: Region, b: Region) -> Region | None:
    column, row = max(a.column, b.column), max(a.row, b.row)
    columns = min(a.column + a.columns, b.column + b.columns) - column
    rows = min(a.row + a.rows, b.row + b.rows) - row
    return Region(column, row, columns, rows) if columns > 0 and rows > 0 else None


def _union(a: Region, b: Region) -> Region:
    column, row = min(a.column, b.column), min(a.row, b.row)
    columns = max(a.column + a.columns, b.column + b.columns) - column
    rows = max(a.row + a.rows, b.row + b.rows) - row
    return Region(column, row, columns, rows)
