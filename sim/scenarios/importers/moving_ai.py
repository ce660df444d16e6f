"""Grid maps of the Moving AI benchmarks (.map): `type`, `height`, `width`, `map`, and one character a cell.

Takes: the file; '.', 'G' and 'S' can be passed, '@', 'O', 'T' and 'W' cannot. Gives: `Imported`, a cell 1 m wide unless
a resolution is asked for. Leaves alone: scenario files (.scen) with starts and goals. Source: Sturtevant 2012.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from sim.scenarios.grid import MOST_CELLS
from sim.scenarios.importers.chart import Chart, charted
from sim.scenarios.importers.imported import Imported, Options, WorldFileError
from sim.scenarios.importers.sources import read_text

BLOCKED, PASSABLE = "@OTW", ".GS"


def read(path: Path, options: Options) -> Imported:
    """The map in the file. Raises WorldFileError."""
    lines = read_text(path).splitlines()
    height, width, first = _header(path.name, lines)
    rows = lines[first : first + height]
    if len(rows) < height:
        raise WorldFileError(path.name, len(lines), f"the map ends after {len(rows)} of {height} rows")
    for number, row in enumerate(rows, first + 1):
        _check(path.name, number, row.rstrip("\r"), width)
    table = np.frombuffer("".join(row[:width] for row in rows).encode("ascii"), dtype=np.uint8).reshape(height, width)
    occupied = np.isin(table, np.frombuffer(BLOCKED.encode(), dtype=np.uint8))
    document = charted(Chart(path.name, path.stem, occupied, ~occupied, options.resolution or 1.0), options)
    swamp = int((table == ord("S")).sum())
    return Imported(document, (f"swamp ({swamp:,} cells): it is free",) if swamp else ())


def _header(file: str, lines: list[str]) -> tuple[int, int, int]:
    """Height, width, and the index of the first row."""
    sizes: dict[str, int] = {}
    for index, line in enumerate(lines[:20]):
        words = line.split()
        if words == ["map"]:
            return _size(file, sizes), sizes["width"], index + 1
        if len(words) == 2 and words[0] in ("height", "width"):
            if not words[1].isascii() or not words[1].isdigit() or len(words[1]) > 9 or int(words[1]) < 1:
                raise WorldFileError(file, index + 1, f"{words[0]}: expected a number of cells, got {words[1][:40]!r}")
            sizes[words[0]] = int(words[1])
        elif words and words[0] != "type":
            raise WorldFileError(file, index + 1, "expected type, height, width or map")
    raise WorldFileError(file, 1, "the line 'map' is missing from the head of the file")


def _size(file: str, sizes: dict[str, int]) -> int:
    missing = [key for key in ("height", "width") if key not in sizes]
    if missing:
        raise WorldFileError(file, 1, f"{missing[0]}: this line is missing from the head of the file")
    if sizes["height"] * sizes["width"] > MOST_CELLS:
        size = f"{sizes['width']:,} x {sizes['height']:,}"
        raise WorldFileError(file, 1, f"the map has {size} cells; at most {MOST_CELLS:,} are read")
    return sizes["height"]


def _check(file: str, line: int, row: str, width: int) -> None:
    if len(row) != width:
        raise WorldFileError(file, line, f"this row has {len(row)} cells, the map is {width} wide")
    rest = row.strip(BLOCKED + PASSABLE).translate(str.maketrans("", "", BLOCKED + PASSABLE))
    if rest:
        raise WorldFileError(file, line, f"no cell is written {rest[0]!r}; known: {' '.join(PASSABLE + BLOCKED)}")
