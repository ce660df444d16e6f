"""What importers have in common: what they are asked, what they give, and how they say that they cannot.

Takes: nothing. Gives: `Options`, `Imported`, `WorldFileError`, and numbers as documents carry them.
Leaves alone: files (`sources.py`) and formats.

A document is a scenario as plain data, key by key as in the YAML format; lengths are rounded to a tenth of a
millimetre, angles to a microradian, so that the text of a document says the same as the document.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from behaviours.interface import Vec2, wrap

Document = dict[str, Any]

MOST_METRES = 1e5
"""What lies farther out than this is a mistake in the file."""


@dataclass(frozen=True, slots=True)
class Options:
    """What the user wants of an import; what is left open the importer chooses, and says so.

    format: name of the format, empty to find it out. world: which of several. robot: name of the model that is the
    robot (Stage); model: the robot to put into worlds that have none, and start: where (x, y [m], heading [rad]).
    resolution [m]: side of a cell where the file does not say. least_area [m^2]: smaller specks are left out.
    """

    format: str = ""
    world: int | None = None
    robot: str = ""
    model: str = "jackal"
    start: tuple[float, float, float] | None = None
    resolution: float | None = None
    least_area: float = 0.0


@dataclass(frozen=True, slots=True)
class Imported:
    """A scenario as plain data, and what of the file is not in it, in words."""

    document: Document
    left_out: tuple[str, ...] = ()


class WorldFileError(Exception):
    """A file that cannot be imported: which, the line (0: none in particular), and what is wrong, in one line."""

    def __init__(self, file: str, line: int, message: str) -> None:
        self.file, self.line, self.message = file, line, message
        super().__init__(printable(f"{file}:{line}: {message}" if line else f"{file}: {message}", 400))


def metres(length: float) -> float:
    """A length [m] as documents carry it."""
    return round(length, 4) + 0.0


def place(point: Sequence[float]) -> list[float]:
    """A place [m] as documents carry it."""
    return [metres(point[0]), metres(point[1])]


def radians(angle: float) -> float:
    """An angle [rad] as documents carry it."""
    return round(wrap(angle), 6) + 0.0


def ring_text(ring: Iterable[Vec2]) -> str:
    """A ring as one text "x y, x y, …"; corners that fall together are one."""
    corners = list(dict.fromkeys(f"{_short(x)} {_short(y)}" for x, y in ring))
    return ", ".join(corners)


def ring_texts(rings: Iterable[Iterable[Vec2]]) -> list[str]:
    """Rings as texts, without those that enclose less than a square millimetre once they are rounded."""
    rounded = [[(metres(x), metres(y)) for x, y in ring] for ring in rings]
    return [ring_text(ring) for ring in rounded if enclosed(ring) >= 1e-6]


def enclosed(ring: Sequence[Vec2]) -> float:
    """What a ring encloses [m^2], whichever way it runs."""
    return abs(sum(a[0] * b[1] - b[0] * a[1] for a, b in pairwise((*ring, ring[0])))) / 2


def printable(text: str, most: int = 200) -> str:
    """The text on one line, without signs that cannot be shown, and not longer than that."""
    line = "".join(sign if sign.isprintable() else " " if sign.isspace() else "?" for sign in text)
    return line if len(line) <= most else line[: most - 1] + "…"


def _short(number: float) -> str:
    text = f"{number:.4f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def box_round(points: Iterable[Sequence[float]], margin: float) -> list[float]:
    """Bounds [m] (xmin, ymin, xmax, ymax) of all the points and a margin; there must be one."""
    xs, ys = zip(*((point[0], point[1]) for point in points), strict=True)
    low, high = (min(xs) - margin, min(ys) - margin), (max(xs) + margin, max(ys) + margin)
    return [*place(low), *place(high)]


def number(value: object, file: str, what: str, least: float = -MOST_METRES, most: float = MOST_METRES) -> float:
    """The value as a finite number within bounds. Raises WorldFileError."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise WorldFileError(file, 0, f"{what}: expected a number, got {shown(value)}")
    if not least <= value <= most or not math.isfinite(value):
        raise WorldFileError(file, 0, f"{what}: expected a number from {least:g} to {most:g}, got {shown(value)}")
    return float(value)


def shown(value: object) -> str:
    """The value as a message quotes it."""
    match value:
        case dict():
            return "a mapping"
        case list():
            return f"a list of {len(value)}"
        case None:
            return "nothing"
        case int() if abs(value) >= 10**15:
            return "a huge number"
        case _:
            text = repr(value)
            return text if len(text) <= 42 else text[:40] + "…"
