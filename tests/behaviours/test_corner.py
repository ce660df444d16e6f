"""Ends of walls, openings, and what bars the way: the geometry, without a robot."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from behaviours.cores import corner
from behaviours.cores.corner import CornerSettings
from behaviours.cores.wall_fit import FitSettings, acquire, track

FIT = FitSettings(patient=True)


def wall(x0, x1, y, step=0.03):
    """Points of a wall along x."""
    x = np.arange(x0, x1, step)
    return np.column_stack([x, np.full(len(x), float(y))])


def front(x, y0, y1, step=0.03):
    """Points of a wall across."""
    return wall(y0, y1, x, step)[:, ::-1]


def fit_of(points):
    found = acquire(points, FIT, np.random.default_rng(0), math.radians(50))
    assert found is not None
    return track(points, found.line, FIT)


def last(points, door=1.2):
    return corner.last_of(fit_of(points), points, door, math.radians(0.36))


def test_a_wall_goes_on_behind_a_gap_and_a_door():
    gap = np.concatenate([wall(-0.5, 0.5, -1), wall(0.8, 2, -1)])
    door = np.concatenate([wall(-0.5, 0.5, -1), wall(1.5, 3, -1)])
    assert last(gap)[0] == pytest.approx(2.0, abs=0.05)
    assert last(door)[0] == pytest.approx(3.0, abs=0.05)


def test_behind_a_wide_opening_there_is_another_wall():
    station, at = last(np.concatenate([wall(-0.5, 0.5, -1), wall(2.5, 3.5, -1)]))
    assert station == pytest.approx(0.5, abs=0.05)
    assert at == pytest.approx((0.5, -1.0), abs=0.05)


def test_an_opening_behind_the_robot_ends_no_wall():
    assert last(np.concatenate([wall(-3.5, -2.5, -1), wall(0.0, 2.0, -1)]))[0] == pytest.approx(2.0, abs=0.05)


def test_beams_that_lie_apart_at_a_slant_are_no_opening():
    bearings = np.arange(-90, 0, 4.0)[:-3]
    x = 1.0 / np.tan(-np.radians(bearings))
    points = np.column_stack([x, np.full(len(x), -1.0)])
    whole = track(points, fit_of(wall(-1, 2, -1)).line, FitSettings(least=2))
    assert corner.last_of(whole, points, 0.3, math.radians(4))[0] == pytest.approx(float(x.max()))


def turn(points, wanted=0.0, radius=0.6, reach=0.6, least=0.3):
    return corner.barred(points, wanted, radius, reach, least)


def test_nothing_bars_an_empty_way():
    assert turn(np.zeros((0, 2))) == (0.0, None)
    assert turn(wall(-2, 2, -1.0))[0] == 0.0


def test_a_wall_across_is_turned_along():
    angle, at = turn(np.concatenate([wall(-2, 0.35, -0.8), front(0.35, -0.8, 3)]))
    assert 80 < math.degrees(angle) < 150
    assert at is not None and at[0] == pytest.approx(0.35)


def test_a_dead_end_turns_the_robot_back():
    blind = np.concatenate([wall(-1, 0.7, -0.7), front(0.7, -0.7, 0.7), wall(-1, 0.7, 0.7)])
    assert math.degrees(turn(blind)[0]) > 120


def test_a_narrow_way_is_no_dead_end():
    narrow = np.concatenate([wall(-1, 3, -0.45), wall(-1, 3, 0.45)])
    assert turn(narrow)[0] < math.radians(10)


def test_where_nothing_fits_half_a_turn_is_made():
    angle = np.linspace(-math.pi, math.pi, 200)
    ring = 0.5 * np.column_stack([np.cos(angle), np.sin(angle)])
    assert turn(ring)[0] == math.pi


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 10_000))
def test_after_the_turn_the_disc_gets_on(seed):
    """What is swept is free of the points, but for those that lie within the disc already."""
    chance = np.random.default_rng(seed)
    points = chance.uniform(-2, 2, (12, 2))
    points = points[np.hypot(points[:, 0], points[:, 1]) > 0.6]
    angle, _ = turn(points, least=0.6)
    if angle == math.pi:
        return
    ahead = np.array([math.cos(angle), math.sin(angle)])
    along = np.clip(points @ ahead, 0.0, 0.6)
    assert np.hypot(*(points - along[:, None] * ahead).T).min(initial=9) >= 0.6 - 1e-6


def test_the_room_between_two_walls_halves_the_stand_off():
    both = np.concatenate([wall(-1, 1, -0.4), wall(-1, 1, 0.8)])
    assert corner.room(both, 1.0, 0.25, 0.3) == pytest.approx(0.6)
    assert corner.room(wall(-1, 1, -0.4), 1.0, 0.25, 0.3) == 1.0
    assert corner.room(both * 0.2, 1.0, 0.25, 0.3) == 0.3


def test_the_tangent_is_square_to_the_way():
    line = corner.tangent((0.0, -0.7))
    assert (line.normal, line.distance) == pytest.approx((-math.pi / 2, 0.7))


def behind(points, contact):
    return corner.beyond(points, contact, FIT, CornerSettings(), 2.0, np.random.default_rng(1))


def test_the_wall_at_the_place_of_contact_is_found():
    found = behind(wall(0.0, 2.0, -0.7), (0.1, -0.7))
    assert found is not None and found.line.distance == pytest.approx(0.7, abs=0.01)


def test_a_wall_elsewhere_a_short_one_and_one_across_are_not_followed():
    assert behind(wall(0.0, 2.0, -1.5), (0.1, -0.7)) is None
    assert behind(wall(0.0, 0.2, -0.7, 0.005), (0.1, -0.7)) is None
    assert behind(front(0.8, -0.7, 2.0), (0.8, -0.7)) is None


def test_points_of_two_things_in_a_row_are_no_wall():
    row = np.concatenate([wall(0.0, 0.15, -0.7, 0.01), wall(1.2, 1.35, -0.7, 0.01)])
    assert behind(row, (0.05, -0.7)) is None


def test_the_contact_is_found_again_and_not_elsewhere():
    points = np.array([[0.5, -0.5], [0.1, -0.3]])
    assert corner.anchored(points, (0.55, -0.5), 0.2) == (0.5, -0.5)
    assert corner.anchored(points, (2.0, 2.0), 0.2) is None
    assert corner.nearest(points) == (0.1, -0.3)
