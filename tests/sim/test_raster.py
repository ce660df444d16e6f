"""Maps cover what stands: middles inside, walls thinner than a cell, holes left open, and never too many cells."""

from __future__ import annotations

import math

import numpy as np

from sim.raster import FINEST, MOST, rasterise

SQUARE = [(1.0, 1.0), (3.0, 1.0), (3.0, 3.0), (1.0, 3.0)]
HOLE = [(1.6, 1.6), (1.6, 2.4), (2.4, 2.4), (2.4, 1.6)]


def covered(things: list[list[list[tuple[float, float]]]], x: float, y: float, size: float = 4.0) -> bool:
    raster = rasterise(things, (0.0, 0.0, size, size))
    return bool(raster.cells[int((y - raster.y) / raster.cell), int((x - raster.x) / raster.cell)])


def test_a_square_covers_its_area() -> None:
    raster = rasterise([[SQUARE]], (0.0, 0.0, 4.0, 4.0))
    assert raster.cell == FINEST
    assert raster.cells.shape == (80, 80)
    assert raster.cells.sum() * raster.cell**2 == np.clip(raster.cells.sum() * raster.cell**2, 4.0, 4.5)
    assert covered([[SQUARE]], 2.0, 2.0)
    assert not covered([[SQUARE]], 0.5, 2.0)
    assert not covered([[SQUARE]], 2.0, 3.5)


def test_rows_go_upwards_and_columns_to_the_right() -> None:
    raster = rasterise([[[(3.0, 0.0), (4.0, 0.0), (4.0, 1.0), (3.0, 1.0)]]], (0.0, 0.0, 4.0, 4.0))
    assert raster.cells[5, 70]
    assert not raster.cells[70, 5]


def test_a_hole_stays_open_and_things_over_one_another_do_not_make_one() -> None:
    assert not covered([[SQUARE, HOLE]], 2.0, 2.0)
    assert covered([[SQUARE, HOLE]], 1.2, 2.0)
    assert covered([[SQUARE], [HOLE]], 2.0, 2.0)


def test_a_wall_thinner_than_a_cell_is_there() -> None:
    wall = [(0.5, 1.001), (3.5, 1.001), (3.5, 1.002), (0.5, 1.002)]
    assert all(covered([[wall]], x, 1.0015) for x in (0.6, 1.7, 3.4))


def test_what_lies_outside_or_reaches_out_does_no_harm() -> None:
    far = [(x + 100.0, y) for x, y in SQUARE]
    wide = [(-1000.0, 1.0), (1000.0, 1.0), (1000.0, 2.0), (-1000.0, 2.0)]
    assert rasterise([[far]], (0.0, 0.0, 4.0, 4.0)).cells.sum() == 0
    assert covered([[wide]], 0.1, 1.5)
    assert covered([[wide]], 3.9, 1.5)
    assert not covered([[wide]], 2.0, 2.5)
    assert rasterise([[], [[]]], (0.0, 0.0, 4.0, 4.0)).cells.sum() == 0


def test_a_large_world_gets_larger_cells() -> None:
    raster = rasterise([], (-500.0, 0.0, 500.0, 10.0))
    assert raster.cell == 1000.0 / MOST
    assert raster.cells.shape == (math.ceil(10.0 / raster.cell), MOST)


def test_against_points_in_a_polygon() -> None:
    chance = np.random.default_rng(5)
    for _ in range(20):
        turns = np.sort(chance.uniform(0, math.tau, 9))
        reach = chance.uniform(0.3, 1.9, 9)
        star = [(2 + r * math.cos(a), 2 + r * math.sin(a)) for a, r in zip(turns.tolist(), reach.tolist(), strict=True)]
        raster = rasterise([[star]], (0.0, 0.0, 4.0, 4.0))
        middles = (np.arange(80) + 0.5) * raster.cell
        inside = np.array([[_inside(star, x, y) for x in middles] for y in middles])
        assert (raster.cells.astype(bool) >= inside).all(), "every middle inside is covered"
        extra = (raster.cells.astype(bool) & ~inside).sum()
        assert extra <= 9 * 2 * 1.9 * 2 / raster.cell, "beyond them only cells that an edge passes through"


def _inside(ring: list[tuple[float, float]], x: float, y: float) -> bool:
    crossed = False
    for (ax, ay), (bx, by) in zip(ring, ring[1:] + ring[:1], strict=True):
        if (ay > y) != (by > y) and x < ax + (y - ay) / (by - ay) * (bx - ax):
            crossed = not crossed
    return crossed
