"""ROS maps: a YAML file with resolution, origin and thresholds, and the picture that it names.

Takes: the YAML file (`read`), or a picture alone, dark is solid (`read_picture_alone`). Gives: `Imported`.
Leaves alone: what is unknown in a map: it is free.

Values as map_server has them: p = (255 - grey) / 255, with `negate` grey / 255. trinary: p > occupied_thresh is
solid, p < free_thresh is free. scale: between the two it grows from 0 to 1, and from 0.5 on it is solid; what is
transparent is unknown. raw: grey 0 to 100 is the occupancy in percent, more is unknown.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
import yaml
from numpy.typing import NDArray

from behaviours.interface import Pose
from sim.scenarios.grid import Bools
from sim.scenarios.importers.chart import Chart, charted
from sim.scenarios.importers.imported import MOST_METRES, Imported, Options, WorldFileError
from sim.scenarios.importers.sources import Grey, read_picture, read_text

MODES: Final = ("trinary", "scale", "raw")
DARK = 127
"""Pixels of a picture alone up to this grey are solid."""

Nodes = dict[str, yaml.Node]


def read(path: Path, options: Options) -> Imported:
    """The map in a YAML file and its picture. Raises WorldFileError."""
    nodes = _nodes(path)
    resolution = _number(path, nodes, "resolution", 1e-6, MOST_METRES)
    origin = _origin(path, nodes)
    mode = _word(path, nodes, "mode", "trinary")
    if mode not in MODES:
        raise WorldFileError(path.name, _line(nodes, "mode"), f"mode: expected one of {', '.join(MODES)}, got {mode!r}")
    occupied_from = _number(path, nodes, "occupied_thresh", 0, 1)
    free_below = _number(path, nodes, "free_thresh", 0, 1)
    grey = _picture(path, nodes)
    limits = _Limits(mode, bool(_number(path, nodes, "negate", 0, 1, 0.0)), occupied_from, free_below)
    occupied, free = _cells(grey, limits)
    chart = Chart(path.name, path.stem, occupied, free, options.resolution or resolution, origin)
    unknown = int(occupied.size - occupied.sum() - free.sum())
    left_out = (f"cells of which the map says nothing ({unknown:,}): they are free",) if unknown else ()
    return Imported(charted(chart, options), left_out)


def read_picture_alone(path: Path, options: Options) -> Imported:
    """A picture as a map: dark is solid. Raises WorldFileError."""
    occupied = dark(path)
    resolution = options.resolution or 0.05
    left_out = () if options.resolution else (f"the size of a cell, which the picture does not say: {resolution} m",)
    return Imported(charted(Chart(path.name, path.stem, occupied, ~occupied, resolution), options), left_out)


def dark(path: Path) -> Bools:
    """Which pixels of a picture are dark; transparent ones are not. Raises WorldFileError."""
    return np.asarray(read_picture(path) <= DARK)


@dataclass(frozen=True, slots=True)
class _Limits:
    """What grey means."""

    mode: str
    negate: bool
    occupied_from: float
    free_below: float


def _cells(grey: Grey, limits: _Limits) -> tuple[Bools, Bools]:
    """Which cells are solid and which are free; the others are unknown."""
    if grey.dtype == np.uint8:
        solid, open_ = _judged(np.arange(256, dtype=np.float32), limits)
        return solid[grey], open_[grey]
    return _judged(np.asarray(grey, dtype=np.float32), limits)


def _judged(grey: NDArray[np.float32], limits: _Limits) -> tuple[Bools, Bools]:
    high, low = limits.occupied_from, limits.free_below
    grey = 255 - grey if limits.negate else grey
    if limits.mode == "raw":
        return np.asarray((grey >= 100 * high) & (grey <= 100)), np.asarray(grey < 100 * low)
    share = (255 - grey).astype(np.float64) / 255
    if limits.mode == "scale":
        middle = max(low, (high + low) / 2)
        return np.asarray(share >= middle), np.asarray(share < middle)
    return np.asarray(share > high), np.asarray(share < low)


def _picture(path: Path, nodes: Nodes) -> Grey:
    image = _word(path, nodes, "image", "")
    if not image:
        raise WorldFileError(path.name, 0, "image: this key is missing")
    try:
        return read_picture(path.parent / image)
    except WorldFileError as fault:
        line = _line(nodes, "image")
        raise WorldFileError(path.name, line, f"image: {str(fault)[:200]}") from fault


def _nodes(path: Path) -> Nodes:
    text = read_text(path, 2**20)
    try:
        whole = yaml.compose(text, Loader=yaml.SafeLoader)
    except yaml.MarkedYAMLError as fault:
        line = fault.problem_mark.line + 1 if fault.problem_mark else 0
        raise WorldFileError(path.name, line, f"not YAML: {fault.problem}") from fault
    except (yaml.YAMLError, RecursionError, ValueError) as fault:
        raise WorldFileError(path.name, 0, "not a YAML text") from fault
    if not isinstance(whole, yaml.MappingNode):
        raise WorldFileError(path.name, 0, "expected a mapping with image, resolution and origin")
    return {str(key.value): value for key, value in whole.value if isinstance(key, yaml.ScalarNode)}


def _line(nodes: Nodes, key: str) -> int:
    return nodes[key].start_mark.line + 1 if key in nodes else 0


def _word(path: Path, nodes: Nodes, key: str, default: str) -> str:
    node = nodes.get(key)
    if node is None:
        return default
    if not isinstance(node, yaml.ScalarNode):
        raise WorldFileError(path.name, _line(nodes, key), f"{key}: expected a word")
    return str(node.value)


def _number(path: Path, nodes: Nodes, key: str, least: float, most: float, default: float | None = None) -> float:
    if key not in nodes and default is not None:
        return default
    if key not in nodes:
        raise WorldFileError(path.name, 0, f"{key}: this key is missing")
    return _scalar(path, nodes[key], key, least, most)


def _scalar(path: Path, node: yaml.Node, key: str, least: float, most: float) -> float:
    text = str(node.value) if isinstance(node, yaml.ScalarNode) else "?"
    try:
        value = {"true": 1.0, "false": 0.0}.get(text.lower()) if least == 0 else None
        value = float(text) if value is None else value
    except ValueError:
        value = math.nan
    if not least <= value <= most:
        line = node.start_mark.line + 1
        raise WorldFileError(path.name, line, f"{key}: expected a number from {least:g} to {most:g}, got {text[:40]!r}")
    return value


def _origin(path: Path, nodes: Nodes) -> Pose:
    node = nodes.get("origin")
    if not isinstance(node, yaml.SequenceNode) or not 2 <= len(node.value) <= 3:
        raise WorldFileError(path.name, _line(nodes, "origin"), "origin: expected [x, y, yaw]")
    return Pose(*(_scalar(path, part, "origin", -MOST_METRES, MOST_METRES) for part in node.value))
