"""Maps as scenarios: walls as rings, and a robot where there is room.

Takes: a `Chart`, which cells are solid and which are free, how large and where. Gives: the document of a scenario.
Leaves alone: how maps are stored (the files named after the formats).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from behaviours.interface import Pose
from sim.scenarios.grid import TOLERANCE, Bools, GridError, trace
from sim.scenarios.importers.imported import Document, Options, WorldFileError, metres, place, radians, ring_texts

WALL_HEIGHT = 2.0
DEVIATION = 0.05  # [m] that a simplified wall may lie from the map
ORIGIN = Pose(0.0, 0.0, 0.0)
LEAST_RESOLUTION, MOST_RESOLUTION = 0.001, 100.0
ENOUGH = 4_000_000  # [cells] on which room for the robot is looked for; finer grids are made coarser


@dataclass(frozen=True, slots=True)
class Chart:
    """occupied, free: (rows, columns), row 0 at the top; resolution: side of a cell [m]; origin: of the lower left."""

    file: str
    name: str
    occupied: Bools
    free: Bools
    resolution: float
    origin: Pose = ORIGIN


def charted(chart: Chart, options: Options) -> Document:
    """The document of a map: its walls, and the robot that was asked for. Raises WorldFileError."""
    if not LEAST_RESOLUTION <= chart.resolution <= MOST_RESOLUTION:
        message = f"cells must be from {LEAST_RESOLUTION:g} to {MOST_RESOLUTION:g} m wide, not {chart.resolution:g} m"
        raise WorldFileError(chart.file, 0, message)
    try:
        tolerance = tolerated(chart.resolution)
        rings = trace(chart.occupied, chart.resolution, chart.origin, tolerance, options.least_area)
    except GridError as fault:
        raise WorldFileError(chart.file, 0, str(fault)) from fault
    start = options.start or _start(chart)
    walls = {"kind": "outline", "id": "walls", "height": WALL_HEIGHT, "rings": ring_texts(rings)}
    return {
        "name": chart.name,
        "bounds": _bounds(chart),
        "robot": {"model": options.model, "start": place(start), "heading": radians(start[2])},
        "things": [walls] if walls["rings"] else [],
    }


def tolerated(resolution: float) -> float:
    """How far [cells of this size] rings may be simplified: coarse maps are taken at their word."""
    return min(TOLERANCE, DEVIATION / resolution)


def _world(chart: Chart, column: float, row: float) -> tuple[float, float]:
    """The place of a lattice point, counted from the upper left."""
    c, s = math.cos(chart.origin.theta), math.sin(chart.origin.theta)
    x, y = column * chart.resolution, (chart.occupied.shape[0] - row) * chart.resolution
    return chart.origin.x + c * x - s * y, chart.origin.y + s * x + c * y


def _bounds(chart: Chart) -> list[float]:
    rows, columns = chart.occupied.shape
    corners = [_world(chart, column, row) for column in (0, columns) for row in (0, rows)]
    xs, ys = zip(*corners, strict=True)
    return [metres(min(xs)), metres(min(ys)), metres(max(xs)), metres(max(ys))]


def _start(chart: Chart) -> tuple[float, float, float]:
    found = roomiest(chart.free if chart.free.any() else ~chart.occupied)
    if found is None:
        raise WorldFileError(chart.file, 0, "no cell is free: there is no room for a robot")
    column, row = found
    return *_world(chart, column, row), chart.origin.theta


def roomiest(free: Bools) -> tuple[float, float] | None:
    """Column and row [cells, from the upper left] of the middle of the largest free square; None if nothing is free.

    Of several as large the one nearest to the middle of the grid.
    """
    coarse = max(1, math.isqrt(free.size // ENOUGH))
    if coarse > 1:
        rows, columns = (length // coarse for length in free.shape)
        blocks = free[: rows * coarse, : columns * coarse].reshape(rows, coarse, columns, coarse)
        free = np.asarray(blocks.all(axis=(1, 3)))
    sums = np.pad(free.astype(np.int32).cumsum(axis=0, dtype=np.int32).cumsum(axis=1, dtype=np.int32), ((1, 0), (1, 0)))
    low, high = 0, min(free.shape)
    while low < high:
        middle = (low + high + 1) // 2
        low, high = (middle, high) if _squares(sums, middle).any() else (low, middle - 1)
    if not low:
        return None
    rows_of, columns_of = np.nonzero(_squares(sums, low))
    off = np.hypot(rows_of + low / 2 - free.shape[0] / 2, columns_of + low / 2 - free.shape[1] / 2)
    best = int(off.argmin())
    return (float(columns_of[best]) + low / 2) * coarse, (float(rows_of[best]) + low / 2) * coarse


def _squares(sums: NDArray[np.int32], side: int) -> Bools:
    """Where the upper left corner of a free square of this side lies."""
    whole = sums[side:, side:] - sums[:-side, side:] - sums[side:, :-side] + sums[:-side, :-side]
    return np.asarray(whole == side * side)
