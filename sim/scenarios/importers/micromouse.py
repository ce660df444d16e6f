"""Micromouse mazes as text: posts 'o', walls '---' and '|', 'S' the start and 'G' the goal.

Takes: the file. Gives: `Imported`: exact walls 12 mm thick on cells of 180 mm, the outer lower left post at the origin,
a micromouse in the middle of the start looking out of it, and the middle of the goal cells to reach.
Leaves alone: rules of contests (search runs, penalties).
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from behaviours.interface import Pose, Vec2
from sim.scenarios.grid import trace
from sim.scenarios.importers.imported import (
    Document,
    Imported,
    Options,
    WorldFileError,
    box_round,
    metres,
    place,
    radians,
    ring_text,
)
from sim.scenarios.importers.sources import read_text

CELL, WALL, HEIGHT = 0.18, 0.012, 0.05
TIME_LIMIT = 600.0
MOST_CELLS_A_SIDE = 200
HEADINGS = ((0, 1, math.pi / 2), (1, 0, 0.0), (-1, 0, math.pi), (0, -1, -math.pi / 2))
"""Ways out of a cell, in the order in which they are tried: column, row, heading [rad]."""

Cell = tuple[int, int]


def read(path: Path, options: Options) -> Imported:
    """The maze in the file. Raises WorldFileError."""
    lines = [line.rstrip() for line in read_text(path, 2**20).splitlines()]
    while lines and not lines[-1]:
        lines.pop()
    columns, rows = _size(path.name, lines)
    solid = _solid(path.name, lines, columns, rows)
    starts, goals = _marked(lines, "S", columns, rows), _marked(lines, "G", columns, rows)
    document = _document(path.stem, solid, starts[0] if starts else (0, 0), goals)
    left_out = () if starts else ("no cell is marked S: the robot starts in the lower left one",)
    if options.start is not None:
        document["robot"] |= {"start": place(options.start), "heading": radians(options.start[2])}
    return Imported(document, left_out + (() if goals else ("no cell is marked G: there is no goal",)))


def _size(file: str, lines: list[str]) -> Cell:
    width = max(map(len, lines))
    columns, rows = (width - 1) // 4, (len(lines) - 1) // 2
    if width != 4 * columns + 1 or len(lines) != 2 * rows + 1 or not columns or not rows:
        raise WorldFileError(file, 1, f"no maze has {len(lines)} lines of {width}: expected 2 n + 1 lines of 4 m + 1")
    if max(columns, rows) > MOST_CELLS_A_SIDE:
        message = f"the maze has {columns} x {rows} cells; at most {MOST_CELLS_A_SIDE} a side are read"
        raise WorldFileError(file, 1, message)
    return columns, rows


def _solid(file: str, lines: list[str], columns: int, rows: int) -> NDArray[np.bool_]:
    """Posts and walls as a grid of 2 n + 1 lines and columns, row 0 at the top."""
    solid = np.zeros((2 * rows + 1, 2 * columns + 1), dtype=np.bool_)
    for row, line in enumerate(lines):
        line = line.ljust(4 * columns + 1)
        for column in range(2 * columns + 1):
            here = line[2 * column] if column % 2 == 0 else line[2 * column - 1 : 2 * column + 2]
            solid[row, column] = _is_solid(file, row, column, here)
    return solid


def _is_solid(file: str, row: int, column: int, here: str) -> bool:
    match row % 2, column % 2:
        case 0, 0:
            known = {"o": True, "+": True, " ": False, ".": False}
        case 0, _:
            known = {"---": True, "   ": False}
        case _, 0:
            known = {"|": True, " ": False}
        case _:
            return False
    if here not in known:
        expected = " or ".join(map(repr, known))
        raise WorldFileError(file, row + 1, f"column {2 * column + 1}: expected {expected}, got {here!r}")
    return known[here]


def _marked(lines: list[str], mark: str, columns: int, rows: int) -> list[Cell]:
    """Cells with the mark, column and row from the lower left."""
    return [
        (column, row)
        for row in range(rows)
        for column in range(columns)
        if mark in lines[2 * (rows - row) - 1].ljust(4 * columns + 1)[4 * column + 1 : 4 * column + 4]
    ]


def _document(name: str, solid: NDArray[np.bool_], start: Cell, goals: list[Cell]) -> Document:
    rings = [_stretched(ring) for ring in trace(solid, 1.0, Pose(0.0, 0.0, 0.0), tolerance=0.0)]
    middle = [CELL * (start[0] + 0.5), CELL * (start[1] + 0.5)]
    document: Document = {
        "name": name,
        "bounds": box_round([(0, 0), (CELL * (solid.shape[1] // 2), CELL * (solid.shape[0] // 2))], CELL / 2),
        "robot": {"model": "micromouse", "start": place(middle), "heading": radians(_way_out(solid, start))},
        "goal": _goal(goals),
        "things": [{"kind": "outline", "id": "walls", "height": HEIGHT, "rings": list(map(ring_text, rings))}],
        "time_limit": TIME_LIMIT,
    }
    return document if goals else {key: value for key, value in document.items() if key != "goal"}


def _stretched(ring: tuple[Vec2, ...]) -> list[Vec2]:
    return [(_along(x), _along(y)) for x, y in ring]


def _along(line: float) -> float:
    """Where a line of the grid lies [m]: those round a post are as far apart as a wall is thick."""
    cell, side = divmod(line, 2)
    return CELL * cell + (WALL / 2 if side else -WALL / 2)


def _goal(goals: list[Cell]) -> Document:
    if not goals:
        return {}
    xs, ys = zip(*goals, strict=True)
    middle = CELL * (min(xs) + max(xs) + 1) / 2, CELL * (min(ys) + max(ys) + 1) / 2
    within = CELL * min(max(xs) - min(xs) + 1, max(ys) - min(ys) + 1) / 2
    return {"at": place(middle), "within": metres(within)}


def _way_out(solid: NDArray[np.bool_], cell: Cell) -> float:
    row, column = solid.shape[0] - 2 - 2 * cell[1], 1 + 2 * cell[0]
    return next((heading for dx, dy, heading in HEADINGS if not solid[row - dy, column + dx]), math.pi / 2)
