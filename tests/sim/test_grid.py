"""From occupancy grids to rings: exact, closed, few, and never crossing."""

from __future__ import annotations

import math
from itertools import pairwise
from time import process_time

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray

from behaviours.interface import Pose
from sim.scenarios.grid import MOST_CELLS, GridError, Ring, trace

Bools = NDArray[np.bool_]
HERE = Pose(0.0, 0.0, 0.0)
small_grids = st.integers(1, 9).flatmap(
    lambda rows: st.integers(1, 9).flatmap(lambda columns: arrays(np.bool_, (rows, columns)))
)


def picture(*rows: str) -> Bools:
    return np.array([[sign == "#" for sign in row] for row in rows])


def area(ring: Ring) -> float:
    return sum(a[0] * b[1] - b[0] * a[1] for a, b in pairwise((*ring, ring[0]))) / 2


def segments(rings: tuple[Ring, ...]) -> NDArray[np.float64]:
    return np.array([[*a, *b] for ring in rings for a, b in pairwise((*ring, ring[0]))])


def within(rings: tuple[Ring, ...], points: NDArray[np.float64]) -> Bools:
    """By the even-odd rule."""
    if not rings:
        return np.zeros(len(points), dtype=np.bool_)
    ax, ay, bx, by = segments(rings).T
    x, y = points[:, :1], points[:, 1:]
    with np.errstate(divide="ignore", invalid="ignore"):
        met = ((ay > y) != (by > y)) & (x < ax + (y - ay) * (bx - ax) / (by - ay))
    return np.asarray(met.sum(axis=1) % 2 == 1)


def middles(grid: Bools) -> NDArray[np.float64]:
    rows, columns = np.mgrid[: grid.shape[0], : grid.shape[1]]
    return np.stack([columns.ravel() + 0.5, grid.shape[0] - rows.ravel() - 0.5], axis=1)


def touching(rings: tuple[Ring, ...]) -> int:
    """How many pairs of segments without a common end meet."""
    if not rings:
        return 0
    s = segments(rings)
    a, b, c, d = s[:, None, :2], s[:, None, 2:], s[None, :, :2], s[None, :, 2:]

    def turn(p: NDArray[np.float64], q: NDArray[np.float64], r: NDArray[np.float64]) -> NDArray[np.float64]:
        return (q - p)[..., 0] * (r - p)[..., 1] - (q - p)[..., 1] * (r - p)[..., 0]

    apart = np.maximum(np.minimum(a, b), np.minimum(c, d)) > np.minimum(np.maximum(a, b), np.maximum(c, d))
    met = (turn(a, b, c) * turn(a, b, d) <= 0) & (turn(c, d, a) * turn(c, d, b) <= 0) & ~apart.any(axis=-1)
    joined = (a == c).all(-1) | (a == d).all(-1) | (b == c).all(-1) | (b == d).all(-1)
    return int((met & ~joined).sum())


def test_a_block_is_its_four_corners_counter_clockwise() -> None:
    grid = picture("......", ".###..", ".###..", "......")
    (ring,) = trace(grid, 0.5, HERE)
    assert set(ring) == {(0.5, 0.5), (2.0, 0.5), (2.0, 1.5), (0.5, 1.5)}
    assert area(ring) == 1.5


def test_row_0_is_the_top_and_the_origin_the_lower_left_corner() -> None:
    (ring,) = trace(picture("#.", ".."), 1.0, Pose(10.0, 20.0, 0.0))
    assert set(ring) == {(10, 21), (11, 21), (11, 22), (10, 22)}
    (turned,) = trace(picture("#.", ".."), 1.0, Pose(0.0, 0.0, math.pi / 2))
    assert {(round(x, 9), round(y, 9)) for x, y in turned} == {(-1, 0), (-2, 0), (-2, 1), (-1, 1)}


def test_a_hole_runs_clockwise() -> None:
    outer, hole = trace(picture("###", "#.#", "###"), 1.0, HERE)
    assert (area(outer), area(hole)) == (9, -1)


def test_an_empty_grid_has_no_rings_and_a_full_one_has_one() -> None:
    assert trace(np.zeros((4, 5), dtype=bool), 1.0, HERE) == ()
    assert [area(ring) for ring in trace(np.ones((4, 5), dtype=bool), 1.0, HERE)] == [20]


@given(small_grids)
def test_unsimplified_rings_enclose_exactly_the_solid_cells(grid: Bools) -> None:
    rings = trace(grid, 1.0, HERE, tolerance=0.0)
    assert (within(rings, middles(grid)) == grid.ravel()).all()
    assert touching(rings) == 0


@given(small_grids)
@settings(max_examples=200)
def test_simplified_rings_never_meet_and_none_is_lost(grid: Bools) -> None:
    exact, rings = trace(grid, 1.0, HERE, tolerance=0.0), trace(grid, 1.0, HERE)
    assert touching(rings) == 0
    assert sorted(area(ring) > 0 for ring in rings) == sorted(area(ring) > 0 for ring in exact)
    assert sum(map(len, rings)) <= sum(map(len, exact))


@given(arrays(np.bool_, (8, 8)))
def test_simplified_rings_lie_within_the_tolerance(grid: Bools) -> None:
    exact, rings = trace(grid, 1.0, HERE, tolerance=0.0), trace(grid, 1.0, HERE)
    if not rings:
        return
    s = segments(rings)
    for corner in (corner for ring in exact for corner in ring):
        way, to = s[:, 2:] - s[:, :2], np.array(corner) - s[:, :2]
        share = np.clip((way * to).sum(1) / (way * way).sum(1), 0, 1)
        assert np.hypot(*(to - share[:, None] * way).T).min() <= 0.75


@pytest.mark.parametrize("tolerance", [0.0, 0.75])
def test_a_wall_of_diagonal_cells_has_no_gap(tolerance: float) -> None:
    grid = np.eye(30, dtype=bool)
    (ring,) = trace(grid, 1.0, HERE, tolerance=tolerance)
    shares = np.linspace(0.04, 0.96, 500)  # but for its ends
    across = np.stack([30 * shares, 30 - 30 * shares], axis=1)
    assert within((ring,), across).all()


def test_where_pieces_would_come_too_near_the_corners_that_were_left_out_are_taken_back(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    grid = np.eye(8, dtype=bool)
    exact = trace(grid, 1.0, HERE, tolerance=0.0)
    assert len(trace(grid, 1.0, HERE)[0]) < len(exact[0]) / 2
    monkeypatch.setattr("sim.scenarios.grid.APART", 3.0)
    assert [set(ring) for ring in trace(grid, 1.0, HERE)] == [set(ring) for ring in exact]


def test_a_diagonal_becomes_a_few_corners() -> None:
    rows, columns = np.mgrid[:100, :100]
    (ring,) = trace(columns < rows, 1.0, HERE)
    assert len(ring) <= 6


def test_a_one_cell_wall_keeps_its_thickness() -> None:
    grid = np.zeros((40, 40), dtype=bool)
    grid[20, 5:35] = True
    (ring,) = trace(grid, 0.1, HERE)
    assert len(ring) == 4
    assert area(ring) == pytest.approx(0.3)


def test_specks_stay_unless_they_are_smaller_than_asked() -> None:
    grid = picture("#....", ".....", "...##", "...##")
    assert len(trace(grid, 0.1, HERE)) == 2
    assert [area(ring) for ring in trace(grid, 0.1, HERE, least_area=0.02)] == pytest.approx([0.04])


def test_a_great_map_is_traced_in_little_time() -> None:
    rows, columns = np.mgrid[:2000, :2000]
    rooms = (rows % 250 < 4) | (columns % 300 < 4) | (np.hypot(rows % 500 - 250, columns % 400 - 200) < 40)
    begin = process_time()
    rings = trace(rooms, 0.05, HERE)
    assert process_time() - begin < 1.5
    assert sum(map(len, rings)) < 2500


def test_what_is_no_grid_is_refused() -> None:
    with pytest.raises(GridError, match="empty"):
        trace(np.zeros((0, 3), dtype=bool), 1.0, HERE)
    with pytest.raises(GridError, match="at most"):
        trace(np.broadcast_to(np.bool_(False), (MOST_CELLS, 2)), 1.0, HERE)
    with pytest.raises(GridError, match="size of a cell"):
        trace(np.ones((2, 2), dtype=bool), math.nan, HERE)
    with pytest.raises(GridError, match="tolerance"):
        trace(np.ones((2, 2), dtype=bool), 1.0, HERE, tolerance=2.0)
    with pytest.raises(GridError, match="noise"):
        trace((np.indices((1600, 1600)).sum(axis=0) % 2).astype(bool), 1.0, HERE)
