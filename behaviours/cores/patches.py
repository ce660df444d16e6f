"""A map as a stream of small patches: what has changed round the robot since the last one, compressed.

Takes: an occupancy grid, and where the robot is. Gives: `Patch`es, and the map that comes of them. Leaves alone: when
they are made, and who listens.

A patch spans the cells that changed. A cell of it that did not change is `SAME`, so that it costs next to nothing. What
changes outside of the region round the robot is sent when the robot comes near.
"""

from __future__ import annotations

import base64
import math
import zlib
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from behaviours.cores.occupancy import MOST, UNKNOWN, Bytes, OccupancyGrid, Plane, Region

SAME = 254
"""In a patch: the cell is as it was."""


@dataclass(frozen=True, slots=True)
class Patch:
    """data: base64 of zlib of one byte a cell, rows upwards: 0 … 100 [%], `SAME` or `UNKNOWN`; cell [m]: side."""

    cell: float
    region: Region
    data: str

    @property
    def size(self) -> int:
        """Bytes of it when sent as they are, not as text."""
        return len(self.data) // 4 * 3 - self.data.count("=")


def packed(cell: float, region: Region, cells: Bytes) -> Patch:
    """The patch of these cells.

    Compressed by runs alone: that is as small, for most cells are `SAME`, and a twentieth of the work.
    """
    press = zlib.compressobj(9, strategy=zlib.Z_RLE)
    data = press.compress(cells.tobytes()) + press.flush()
    return Patch(cell, region, base64.b64encode(data).decode("ascii"))


def unpacked(patch: Patch) -> Bytes:
    """(rows, columns). Raises ValueError where the data are damaged or of another size; no bomb is unpacked."""
    rows, columns = patch.region.rows, patch.region.columns
    if not (0 < rows <= 2 * MOST and 0 < columns <= 2 * MOST):
        raise ValueError(f"a patch of {columns} times {rows} cells")
    stream = zlib.decompressobj()
    try:
        cells = stream.decompress(base64.b64decode(patch.data, validate=True), rows * columns)
    except (zlib.error, ValueError) as fault:
        raise ValueError(f"damaged data ({fault})") from fault
    if len(cells) != rows * columns:
        raise ValueError(f"{len(cells)} cells instead of {rows * columns}")
    return np.frombuffer(cells, dtype=np.uint8).reshape(rows, columns)


class PatchWriter:
    """Remembers what has been sent. side [m]: of the region round the robot."""

    def __init__(self, cell: float, side: float) -> None:
        self._cell, self._side = cell, side
        self.sent = Plane(np.uint8, UNKNOWN)

    def delta(self, grid: OccupancyGrid, x: float, y: float) -> Patch | None:
        """What changed round (x, y) [m] since it was last sent; None where nothing did."""
        region = around(x, y, self._side, self._cell)
        now, before = grid.percents(region), self.sent.copy(region)
        changed = now != before
        box = _box(changed)
        if box is None:
            return None
        rows, columns = box
        part = Region(region.column + columns.start, region.row + rows.start, _length(columns), _length(rows))
        self.sent.at(part)[:] = now[box]
        return packed(self._cell, part, np.where(changed[box], now[box], np.uint8(SAME)))

    def whole(self) -> Patch | None:
        """All that has been sent, for one who joins late; None before anything was."""
        return packed(self._cell, self.sent.region, self.sent.cells) if self.sent.cells.size else None


class PatchReader:
    """Puts a map together from patches. plane: its percents; cell [m], 0 before the first patch."""

    def __init__(self) -> None:
        self.plane, self.cell = Plane(np.uint8, UNKNOWN), 0.0

    def add(self, patch: Patch) -> None:
        """Take the next patch. Raises ValueError where it is damaged, or its cells are of another size."""
        if self.cell and patch.cell != self.cell:
            raise ValueError(f"cells of {patch.cell:g} m after cells of {self.cell:g} m")
        if not _is_kept(patch.region):
            raise ValueError("a patch outside of all maps")
        new = unpacked(patch)
        cells = self.plane.at(patch.region)
        np.copyto(cells, new, where=new != SAME)
        self.cell = patch.cell


def around(x: float, y: float, side: float, cell: float) -> Region:
    """The cells of the square with this side [m] round (x, y)."""
    count = math.ceil(side / cell)
    return Region(math.floor((x - side / 2) / cell), math.floor((y - side / 2) / cell), count, count)


def _is_kept(region: Region) -> bool:
    ends = region.column, region.row, region.column + region.columns, region.row + region.rows
    return all(abs(end) <= MOST for end in ends)


def _box(changed: NDArray[np.bool_]) -> tuple[slice, slice] | None:
    rows, columns = np.flatnonzero(changed.any(axis=1)), np.flatnonzero(changed.any(axis=0))
    if not rows.size:
        return None
    return slice(int(rows[0]), int(rows[-1]) + 1), slice(int(columns[0]), int(columns[-1]) + 1)


def _length(part: slice) -> int:
    return int(part.stop - part.start)
