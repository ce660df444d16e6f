"""Corners that a writer of scenarios gives, made into outlines.

Takes: rings of corners. Gives: `Polygon` (convex) or `Rings`, wound as the world wants them. Raises ValueError for
rings that enclose nothing. Leaves alone: rings that cross themselves.
"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from behaviours.interface import Floats, Vec2
from sim.raycast import Polygon, Rings

Ring = tuple[Vec2, ...]
LARGEST = 1e6  # [m] that a corner may lie from the origin
SMALLEST = 1e-9  # [m^2] that a ring encloses


def from_text(text: str) -> Ring | None:
    """The corners in "x y, x y, …"; None where it is no such text."""
    try:
        numbers = np.array([pair.split() for pair in text.split(",")], dtype=float)
    except ValueError:
        return None
    if numbers.ndim != 2 or numbers.shape[0] < 3 or numbers.shape[1] != 2 or not np.isfinite(numbers).all():
        return None
    return tuple((float(x), float(y)) for x, y in numbers)


def area(ring: Ring) -> float:
    """What the ring encloses [m^2], positive where it runs counter-clockwise."""
    return sum(a[0] * b[1] - b[0] * a[1] for a, b in pairwise((*ring, ring[0]))) / 2


def convex(ring: Ring) -> Polygon:
    """The convex polygon with these corners."""
    if not is_convex(ring):
        raise ValueError("the polygon must be convex, since it can move")
    return Polygon(_outer(_cleaned(ring)))


def is_convex(ring: Ring) -> bool:
    """Whether it never turns back; raises ValueError where it encloses nothing."""
    ring = _outer(_cleaned(ring))
    turns = [_turn(a, b, c) for a, b, c in zip(ring, (*ring[1:], ring[0]), (*ring[2:], *ring[:2]), strict=True)]
    return min(turns) >= 0 and _winding(ring) == 1


def solid(rings: tuple[Ring, ...]) -> Rings:
    """The area within an odd number of the rings: outer ones counter-clockwise, holes clockwise."""
    cleaned = [_outer(_cleaned(ring)) for ring in rings]
    if len(cleaned) == 1:
        return Rings((cleaned[0],))
    starts = np.array([corner for ring in cleaned for corner in ring])
    ends = np.array([corner for ring in cleaned for corner in (*ring[1:], ring[0])])
    of = np.repeat(np.arange(len(cleaned)), [len(ring) for ring in cleaned])
    return Rings(tuple(_wound(ring, index, starts, ends, of) for index, ring in enumerate(cleaned)))


def _wound(ring: Ring, index: int, starts: Floats, ends: Floats, of: NDArray[np.intp]) -> Ring:
    """As an outer ring or as a hole, by how many of the others its first edge lies in."""
    x, y = (ring[0][0] + ring[1][0]) / 2, (ring[0][1] + ring[1][1]) / 2
    (ax, ay), (bx, by) = starts.T, ends.T
    across = (ay > y) != (by > y)
    with np.errstate(divide="ignore", invalid="ignore"):
        right = across & (x < ax + (y - ay) * (bx - ax) / (by - ay)) & (of != index)
    return ring if np.count_nonzero(right) % 2 == 0 else ring[::-1]


def _outer(ring: Ring) -> Ring:
    return ring if area(ring) > 0 else ring[::-1]


def _cleaned(ring: Ring) -> Ring:
    kept = tuple(b for a, b in pairwise((ring[-1], *ring)) if a != b)
    if len(kept) < 3 or abs(area(kept)) < SMALLEST:
        raise ValueError("a ring encloses nothing: give three or more corners that are not in line")
    if any(max(abs(x), abs(y)) > LARGEST for x, y in kept):
        raise ValueError(f"a corner lies more than {LARGEST:g} m from the origin")
    return kept


def _turn(a: Vec2, b: Vec2, c: Vec2) -> float:
    return (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0])


def _winding(ring: Ring) -> int:
    """How often the ring goes round."""
    sides = [math.atan2(b[1] - a[1], b[0] - a[0]) for a, b in pairwise((*ring, ring[0]))]
    turned = sum(math.remainder(after - before, math.tau) for before, after in pairwise((*sides, sides[0])))
    return round(abs(turned) / math.tau)
