"""Every experiment: one file each, with a `ROW` in it.

Takes: the files of this folder. Gives: rows in the order of their names. Leaves alone: running them. A row is added by
adding a file.
"""

from __future__ import annotations

import re
from functools import cache
from importlib import import_module
from pkgutil import iter_modules

from rplan.apps.reproduce.row import Row


@cache
def every_row() -> tuple[Row, ...]:
    """All of them; B10 comes after B9."""
    modules = (import_module(f"{__name__}.{found.name}") for found in iter_modules(__path__))
    rows: list[Row] = []
    for module in modules:
        assert isinstance(module.ROW, Row)
        rows.append(module.ROW)
    return tuple(sorted(rows, key=lambda row: _natural(row.name)))


def _natural(name: str) -> tuple[tuple[int, str], ...]:
    return tuple((int(part or 0), "") if part.isdigit() else (0, part) for part in re.split(r"(\d+)", name))


def row_named(name: str) -> Row:
    """The row of this name. Raises KeyError."""
    return {row.name: row for row in every_row()}[name]
