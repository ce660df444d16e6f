"""VFH+: the histogram with hysteresis, the mask of the turning circle, openings, what a direction costs."""

import math

import numpy as np
import pytest

from behaviours.cores.vfh_plus import (
    VfhPlus,
    VfhPlusSettings,
    candidates,
    cost,
    density,
    hysteresis,
    is_blocked,
    masked,
    openings,
)

SETTINGS = VfhPlusSettings()
WIDTH = math.tau / 72
NOTHING = np.zeros((0, 2))


def flags(*blocked):
    result = np.zeros(72, dtype=bool)
    result[[i % 72 for i in blocked]] = True
    return result


def arc(away, *bearings):
    return np.array([[away * math.cos(b), away * math.sin(b)] for b in bearings])


def ring(away, but=()):
    return arc(away, *(b for b in np.arange(0, 360) * math.tau / 360 if not any(lo < b < hi for lo, hi in but)))


def literally(points, heading, window):
    total = np.zeros(72)
    for x, y in points:
        away = math.hypot(x, y)
        if away < window:
            for i in range(72):
                off = abs(math.remainder(i * WIDTH - math.atan2(y, x) - heading, math.tau))
                total[i] += (off <= math.asin(min(1.0, 0.4 / away)) + 1e-9) * (1 - away / window)
    return total


@pytest.mark.parametrize("seed", range(4))
def test_a_reading_weighs_by_its_nearness_within_the_angle_that_the_clearance_covers(seed):
    chance = np.random.default_rng(seed)
    points, heading = chance.uniform(-4, 4, (40, 2)), chance.uniform(-3, 3)
    assert density(points, heading, 4.0, SETTINGS) == pytest.approx(literally(points, heading, 4.0), abs=1e-9)


def test_the_histogram_stays_where_it_is_while_the_robot_turns():
    points = arc(1.5, 0.3, 0.5, 2.0)
    turned = arc(1.5, 0.3 - 0.7, 0.5 - 0.7, 2.0 - 0.7)
    assert density(turned, 0.7, 4.0, SETTINGS) == pytest.approx(density(points, 0.0, 4.0, SETTINGS), abs=1e-9)


def test_between_the_thresholds_a_direction_stays_as_it_was():
    total = np.array([0.05, 0.2, 0.2, 0.4])
    assert hysteresis(total, None, SETTINGS).tolist() == [False, False, False, True]
    assert hysteresis(total, np.array([True, True, False, False]), SETTINGS).tolist() == [False, True, False, True]


def test_what_the_turning_circle_does_not_reach_is_masked():
    beside = arc(0.8, 0.6)
    assert not masked(flags(), beside, 0.0, 0.0, 0.4).any()
    blocked = masked(flags(), beside, 0.0, 1.0, 0.4)
    assert blocked[[7, 12, 30]].all()
    assert not blocked[[6, 0, -10, -35]].any()
    other = masked(flags(), beside * (1, -1), 0.0, 1.0, 0.4)
    assert other.tolist() == np.roll(blocked[::-1], 1).tolist()


def test_openings_are_runs_of_open_directions_also_over_the_end():
    assert openings(flags(*range(3, 70))) == [(70, 74)]
    assert openings(flags(5, 6, 40)) == [(7, 39), (41, 76)]
    assert openings(np.ones(72, dtype=bool)) == []
    assert openings(flags()) == [(0, 71)]


def test_a_narrow_opening_is_taken_through_its_middle():
    assert candidates(flags(*range(4, 72)), math.pi, SETTINGS) == pytest.approx([1.5 * WIDTH])


def test_a_wide_opening_is_taken_near_its_sides():
    assert candidates(flags(*range(31, 72)), -2.0, SETTINGS) == pytest.approx([4 * WIDTH, 26 * WIDTH])


def test_the_wanted_direction_is_always_a_candidate_when_it_is_open():
    assert candidates(flags(20), 0.456, SETTINGS)[0] == 0.456
    assert candidates(flags(), 0.456, SETTINGS) == [0.456]


def test_the_wanted_direction_counts_more_than_the_others():
    assert cost(0.2, 0.0, 0.2, None, SETTINGS) == pytest.approx(1.0)
    assert cost(0.2, 0.2, 0.0, None, SETTINGS) == pytest.approx(0.4)
    assert cost(0.2, 0.2, 0.2, -0.1, SETTINGS) == pytest.approx(0.6)


def test_it_stays_on_the_side_that_it_has_chosen():
    """A post straight ahead that seems to move a little to and fro."""
    vfh = VfhPlus(SETTINGS, left=True)
    first = vfh.choose(arc(1.5, -0.05, 0.0, 0.06), 0.0, 0.0, 0.0).direction
    for shift in (0.06, -0.06, 0.03, 0.06):
        direction = vfh.choose(arc(1.5, shift - 0.05, shift, shift + 0.05), 0.0, 0.0, 0.0).direction
        assert direction * first > 0


@pytest.mark.parametrize("left", [True, False])
def test_of_two_equally_good_directions_the_set_side_is_taken(left):
    direction = VfhPlus(SETTINGS, left).choose(arc(1.5, -0.05, 0.0, 0.05), 0.0, 0.0, 0.0).direction
    assert (direction > 0) is left


def test_where_walls_stand_all_round_the_window_shrinks_until_something_is_open():
    room = ring(2.5)
    assert not is_blocked(room, SETTINGS)
    assert VfhPlus(SETTINGS, True).choose(room, 0.0, 0.5, 0.0).direction is not None


def test_what_is_walled_in_is_blocked():
    walled = ring(0.7)
    assert is_blocked(walled, SETTINGS)
    assert VfhPlus(SETTINGS, True).choose(walled, 0.0, 0.0, 0.0).direction is None
    assert not is_blocked(ring(0.7, but=[(1.0, 2.5)]), SETTINGS)
    assert not is_blocked(NOTHING, SETTINGS)


def test_forgetting_it_begins_afresh():
    vfh = VfhPlus(SETTINGS, True)
    first = vfh.choose(arc(1.5, 0.1), 0.0, 0.0, 0.0).direction
    vfh.choose(arc(1.5, -0.1), 0.0, 0.3, 0.0)
    vfh.forget()
    assert vfh.choose(arc(1.5, 0.1), 0.0, 0.0, 0.0).direction == first
