"""The directed Hough transform: where lines are, which count as one, and that it has no favourite side."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from behaviours.cores.hough import HALF, HoughSettings, lines, votes
from behaviours.interface import wrap

SETTINGS = HoughSettings()
BINS = HoughSettings(refine=False)
ALONG = np.linspace(-3.0, 3.0, 60)


def wall(bearing, rho, along=ALONG, sd=0.0, seed=0):
    """Points on the line whose normal has this bearing [rad]."""
    c, s = math.cos(bearing), math.sin(bearing)
    off = rho + sd * np.random.default_rng(seed).standard_normal(len(along))
    return np.column_stack([off * c - along * s, off * s + along * c])


@pytest.mark.parametrize("degrees", [0, 17, 45, 89, 90, 91, 133.3, 180, -90, -1])
def test_a_line_is_found_at_any_bearing(degrees):
    (line, *_) = lines(wall(math.radians(degrees), 1.57), SETTINGS)
    assert wrap(line.normal - math.radians(degrees)) == pytest.approx(0.0, abs=1e-3)
    assert line.rho == pytest.approx(1.57, abs=1e-3)


def test_noise_of_two_centimetres_moves_a_line_by_a_fraction_of_a_bin():
    for seed in range(20):
        line = lines(wall(1.234, 1.52, sd=0.02, seed=seed), SETTINGS)[0]
        assert abs(wrap(line.normal - 1.234)) < math.radians(0.5) and abs(line.rho - 1.52) < 0.015


def test_without_refinement_a_line_is_the_middle_of_its_bin():
    line = lines(wall(math.radians(91.0), 1.52), BINS)[0]
    assert math.degrees(line.normal) % 2.0 == pytest.approx(0.0, abs=1e-9)
    assert line.rho * 10 % 1.0 == pytest.approx(0.5)


def test_lines_are_directed_walls_on_either_side_have_opposite_normals():
    found = lines(np.concatenate([wall(math.pi / 2, 1.5), wall(-math.pi / 2, 1.5)]), SETTINGS)
    assert sorted(round(math.degrees(line.normal)) for line in found[:2]) == [-90, 90]
    assert all(line.rho > 0 for line in found)


def test_fewer_than_twelve_points_make_no_line():
    assert lines(wall(0.3, 2.0, ALONG[:11]), SETTINGS) == ()
    assert lines(wall(0.3, 2.0, np.linspace(0, 0.5, 12)), SETTINGS)[0].votes == 12
    assert lines(np.zeros((0, 2)), SETTINGS) == ()


def test_scattered_points_make_no_line():
    assert lines(np.random.default_rng(1).uniform(-9, 9, (60, 2)), SETTINGS) == ()


@pytest.mark.parametrize(("rho", "seen"), [(9.95, True), (10.05, False)])
def test_lines_from_ten_metres_on_are_too_far(rho, seen):
    assert bool(votes(wall(0.0, rho))[0].any()) == seen


@pytest.mark.parametrize(("apart", "count"), [(0.3, 1), (0.9, 2)])
def test_parallel_lines_within_four_bins_are_one(apart, count):
    found = lines(np.concatenate([wall(0.0, 2.0), wall(0.0, 2.0 + apart)]), SETTINGS)
    assert sum(abs(line.normal) < math.radians(3) for line in found) == count


def test_a_line_that_is_nearly_touched_is_not_found_a_second_time_on_the_other_side():
    found = lines(wall(0.2, 0.12, sd=0.02), SETTINGS)
    assert all(abs(wrap(line.normal - 0.2)) < 3 * math.pi / 4 for line in found)


def test_there_are_no_more_than_six_lines_the_strongest_first():
    star = np.concatenate([wall(k * math.tau / 9, 1.0 + 0.8 * k, np.linspace(-1, 1, 15 + 2 * k)) for k in range(9)])
    found = lines(star, SETTINGS)
    assert len(found) == 6
    assert [line.votes for line in found] == sorted((line.votes for line in found), reverse=True)


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(12, 400))
def test_a_mirror_and_half_a_turn_move_every_vote_and_change_none(seed, count):
    points = np.random.default_rng(seed).uniform(-11, 11, (count, 2))
    counted = votes(points)
    assert np.array_equal(votes(points * (1, -1)), counted[(-np.arange(2 * HALF)) % (2 * HALF)])
    assert np.array_equal(votes(-points), np.roll(counted, HALF, axis=0))


def test_each_point_votes_once_for_each_direction_in_reach():
    points = np.random.default_rng(2).uniform(-5, 5, (100, 2))
    assert votes(points).sum() == 100 * HALF
