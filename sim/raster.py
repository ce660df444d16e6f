"""Outlines on a grid of cells, for maps.

Takes: closed rings of corners in the world, and the region. Gives: `Raster`, which cells are covered. Leaves alone:
sensing and touching, which look at the outlines themselves.

A cell is covered where its middle lies inside (the rings of one thing are filled by the even-odd rule, so that holes
stay holes) or where an edge passes through it, so that walls thinner than a cell are there too.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from behaviours.interface import Floats

Ring = Sequence[tuple[float, float]]
Box = tuple[float, float, float, float]

MOST = 400
"""Cells along a side at most."""
FINEST = 0.05
"""No cell is smaller than this [m]."""


@dataclass(frozen=True, slots=True)
class Raster:
    """x, y [m]: corner of the first cell; cell [m]: its side; cells (rows, columns): 1 where covered, rows upwards."""

    x: float
    y: float
    cell: float
    cells: NDArray[np.uint8]


def rasterise(things: Sequence[Sequence[Ring]], region: Box) -> Raster:
    """The region with these things, each given by its rings."""
    xmin, ymin, xmax, ymax = region
    cell = max(FINEST, max(xmax - xmin, ymax - ymin) / MOST)
    shape = min(MOST, math.ceil((ymax - ymin) / cell)), min(MOST, math.ceil((xmax - xmin) / cell))
    cells = np.zeros(shape, dtype=np.uint8)
    for rings in things:
        edges = _edges(rings)
        if edges.size:
            edges = (edges - np.array([xmin, ymin, xmin, ymin])) / cell  # in cells from here on
            _draw(cells, edges)
    return Raster(xmin, ymin, cell, cells)


def _edges(rings: Sequence[Ring]) -> Floats:
    """(n, 4): from x, y to x, y."""
    corners = [np.array(ring, dtype=float).reshape(-1, 2) for ring in rings]
    return np.concatenate([np.hstack([ring, np.roll(ring, -1, axis=0)]) for ring in corners] or [np.zeros((0, 4))])


def _draw(cells: NDArray[np.uint8], edges: Floats) -> None:
    """One thing, on the part of the grid that it lies in."""
    rows, columns = cells.shape
    ends = edges.reshape(-1, 2)
    low, high = np.floor(ends.min(axis=0)), np.ceil(ends.max(axis=0)) + 1
    left, right = (int(np.clip(x, 0, columns)) for x in (low[0], high[0]))
    bottom, top = (int(np.clip(y, 0, rows)) for y in (low[1], high[1]))
    if left < right and bottom < top:
        part, moved = cells[bottom:top, left:right], edges - np.array([left, bottom, left, bottom])
        _fill(part, moved)
        _trace(part, moved)


def _fill(cells: NDArray[np.uint8], edges: Floats) -> None:
    """Row by row: each edge that the line through the middles crosses changes inside to outside."""
    rows, columns = cells.shape
    ax, ay, bx, by = edges.T
    first = np.clip(np.ceil(np.minimum(ay, by) - 0.5), 0, rows).astype(int)
    number = np.maximum(np.clip(np.ceil(np.maximum(ay, by) - 0.5), 0, rows).astype(int) - first, 0)
    edge = np.repeat(np.arange(len(edges)), number)
    row = np.arange(len(edge)) - np.repeat(np.cumsum(number) - number, number) + first[edge]
    slope = (bx - ax)[edge] / (by - ay)[edge]
    x = ax[edge] + (row + 0.5 - ay[edge]) * slope
    column = np.clip(np.ceil(x - 0.5), 0, columns).astype(int)
    changes = np.zeros((rows, columns + 1), dtype=np.uint8)
    np.add.at(changes, (row, column), 1)
    cells |= np.cumsum(changes, axis=1, dtype=np.uint32)[:, :-1].astype(np.uint8) & np.uint8(1)


def _trace(cells: NDArray[np.uint8], edges: Floats) -> None:
    """Points along each edge, four to a cell; what lies outside the region is left out."""
    rows, columns = cells.shape
    inside = edges[_touches(edges, rows, columns)]
    span = np.abs(inside[:, 2:] - inside[:, :2]).max(axis=1, initial=0.0)
    number = np.minimum(np.ceil(4 * span), 16 * MOST).astype(int) + 1
    edge = np.repeat(np.arange(len(inside)), number)
    step = np.arange(len(edge)) - np.repeat(np.cumsum(number) - number, number)
    share = (step / np.maximum(number[edge] - 1, 1))[:, None]
    points = inside[edge, :2] + share * (inside[edge, 2:] - inside[edge, :2])
    column, row = np.floor(points).astype(int).T
    there = (column >= 0) & (column < columns) & (row >= 0) & (row < rows)
    cells[row[there], column[there]] = 1


def _touches(edges: Floats, rows: int, columns: int) -> NDArray[np.bool_]:
    ax, ay, bx, by = edges.T
    return np.asarray(
        (np.maximum(ax, bx) >= 0)
        & (np.minimum(ax, bx) <= columns)
        & (np.maximum(ay, by) >= 0)
        & (np.minimum(ay, by) <= rows)
    )
