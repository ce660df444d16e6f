"""Maps as files: a picture of cells (PGM) with a YAML file that says where it lies, as ROS keeps them.

Takes: cells with the probability that they are occupied. Gives: files that `rplan import` and map_server read. Leaves
alone: how the map came about.

The picture is trinary: black (0) is occupied, white (254) free, grey (205) is not known, or not sure enough.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import yaml
from numpy.typing import NDArray
from PIL import Image

Bytes = NDArray[np.uint8]

OCCUPIED, FREE = 0.65, 0.196
"""Above the one probability a cell is occupied, below the other it is free: the limits of map_server."""

BLACK, GREY, WHITE = 0, 205, 254


@dataclass(frozen=True, slots=True, eq=False)
class CellMap:
    """percents: (rows, columns), row 0 lowest, 0 … 100, more where it is not known; resolution: side of a cell [m].

    x, y [m]: the lower left corner.
    """

    percents: Bytes
    resolution: float
    x: float
    y: float


def trinary(percents: Bytes) -> Bytes:
    """The greys of the cells."""
    grey = np.full(percents.shape, GREY, dtype=np.uint8)
    grey[percents < 100 * FREE] = WHITE
    grey[(percents > 100 * OCCUPIED) & (percents <= 100)] = BLACK
    return grey


def write_ros(some: CellMap, path: Path) -> tuple[Path, Path]:
    """Write the YAML file and the picture beside it; `path` is that of either. Gives both paths, the YAML file first.

    Raises OSError where they cannot be written.
    """
    about, picture = path.with_suffix(".yaml"), path.with_suffix(".pgm")
    Image.fromarray(np.ascontiguousarray(trinary(some.percents)[::-1])).save(picture, format="PPM")
    told = {
        "image": picture.name,
        "mode": "trinary",
        "resolution": some.resolution,
        "origin": [some.x, some.y, 0.0],
        "negate": 0,
        "occupied_thresh": OCCUPIED,
        "free_thresh": FREE,
    }
    about.write_text(yaml.safe_dump(told, sort_keys=False, default_flow_style=None), encoding="utf-8")
    return about, picture
