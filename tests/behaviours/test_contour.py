"""The rolling disc: along walls, round corners, past gaps that it does not fit through."""

import math
from dataclasses import replace

import numpy as np
import pytest

from behaviours.cores.contour import ContourSettings, anchored, rolled, snapped
from behaviours.cores.hough import HoughSettings, lines

SETTINGS = ContourSettings()


def wall(a, b, step=0.03):
    """Points from a to b."""
    (ax, ay), (bx, by) = a, b
    t = np.linspace(0.0, 1.0, max(2, round(math.dist(a, b) / step)))
    return np.column_stack([ax + t * (bx - ax), ay + t * (by - ay)])


def degrees(points, contact, stand_off=1.5):
    return math.degrees(rolled(points, contact, stand_off, SETTINGS).direction)


def test_at_its_stand_off_the_disc_rolls_along_the_wall():
    assert degrees(wall((-5, 1.5), (9, 1.5)), (0.0, 1.5)) == pytest.approx(0.0, abs=0.5)


@pytest.mark.parametrize(("off", "low", "high"), [(0.3, 5, 21), (2.5, 30, 45.1), (-0.3, -22, -18), (-1.2, -49, -42)])
def test_off_its_stand_off_it_goes_back_there_no_steeper_than_forty_five_degrees(off, low, high):
    assert low <= degrees(wall((-9, 1.5 + off), (12, 1.5 + off)), (0.0, 1.5 + off)) <= high


def test_beside_the_end_of_a_wall_it_turns_round_the_end():
    points = wall((-5, 1.5), (0, 1.5))
    assert degrees(points, (0.0, 1.5)) == pytest.approx(0.0, abs=0.5)
    turn = math.radians(-40)
    c, s = math.cos(turn), math.sin(turn)
    further = points @ np.array([[c, s], [-s, c]])  # it has gone on round by 40 degrees, without turning
    end = (float(further[-1, 0]), float(further[-1, 1]))
    assert degrees(further, end) == pytest.approx(-40, abs=0.5)


def test_before_a_wall_ahead_it_turns_away_in_time():
    far = np.concatenate([wall((-5, 1.5), (6, 1.5)), wall((6, 1.5), (6, -9))])
    near = np.concatenate([wall((-5, 1.5), (2, 1.5)), wall((2, 1.5), (2, -9))])
    assert degrees(far, (0.0, 1.5)) == pytest.approx(0.0, abs=0.5)
    assert -90 < degrees(near, (0.0, 1.5)) < -60


@pytest.mark.parametrize(("mouth", "way"), [(2.8, "past"), (3.4, "in")])
def test_a_gap_is_entered_where_the_disc_fits(mouth, way):
    points = np.concatenate(
        [
            wall((-5, 1.5), (0, 1.5)),
            wall((0, 1.5), (0, 9)),
            wall((mouth, 1.5), (mouth, 9)),
            wall((mouth, 1.5), (9, 1.5)),
        ]
    )
    moved = points - (mouth / 2, 0.0)  # before the middle of the mouth
    end = (-mouth / 2, 1.5)
    turned = degrees(moved, end)
    assert (turned > 45) == (way == "in")


def test_a_disc_that_is_kept_small_enters_a_gap_that_the_stand_off_would_pass_by():
    before = [wall((-5, 1.5), (-1.4, 1.5)), wall((-1.4, 1.5), (-1.4, 9))]
    behind = [wall((1.4, 1.5), (1.4, 9)), wall((1.4, 1.5), (9, 1.5))]
    points = np.concatenate([*before, *behind])
    turned = [
        math.degrees(rolled(points, (-1.4, 1.5), 1.5, replace(SETTINGS, widest=widest)).direction)
        for widest in (math.inf, 1.0)
    ]
    assert turned[0] < 45 < turned[1]


def test_where_it_is_narrow_the_stand_off_is_half_of_the_room():
    narrow = np.concatenate([wall((-5, 0.8), (9, 0.8)), wall((-5, -0.8), (9, -0.8))])
    kept = replace(SETTINGS, widest=0.4, beside=0.25)
    assert math.degrees(rolled(narrow, (0.0, 0.8), 1.5, kept).direction) == pytest.approx(0.0, abs=1.0)
    assert math.degrees(rolled(narrow, (0.0, 0.8), 1.5, replace(kept, beside=0.0)).direction) < -20


def test_what_touched_last_tells_which_contour_is_followed():
    points = np.concatenate([wall((-5, 2), (9, 2)), wall((-5, -2), (9, -2))])
    assert abs(degrees(points, (0.0, 2.0))) < 30
    assert abs(degrees(points, (0.0, -2.0))) > 150


def test_where_the_disc_does_not_fit_a_smaller_one_goes_on():
    narrow = np.concatenate([wall((-5, 1), (9, 1)), wall((-5, -1), (9, -1))])
    assert abs(degrees(narrow, (0.0, 1.0))) < 46


def test_points_near_a_line_are_put_on_it_and_others_are_left():
    noisy = wall((-3, 1.5), (3, 1.5)) + np.random.default_rng(0).normal(0, 0.02, (200, 2)) * (0, 1)
    points = np.concatenate([noisy, [[1.0, -4.0]]])
    result = snapped(points, lines(points, HoughSettings())[:1], 0.07)
    near = np.abs(noisy[:, 1] - 1.5) < 0.06
    assert np.abs(result[:-1][near][:, 1] - 1.5).max() < 0.01
    assert result[-1].tolist() == [1.0, -4.0]


def test_contact_is_lost_when_nothing_is_near_it():
    assert anchored(np.array([[3.0, 0.0]]), (0.0, 0.0), 1.0) is None
    assert anchored(np.array([[3.0, 0.0], [0.5, 0.0]]), (0.0, 0.0), 1.0) == (0.5, 0.0)
    assert anchored(np.zeros((0, 2)), (0.0, 0.0), 1.0) is None


def test_alone_with_one_point_the_disc_circles_it():
    assert degrees(np.array([[0.0, 1.5]]), (0.0, 1.5)) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("corner", [(1.0, -1.2), (0.5, -1.35), (0.3, -1.2)])
def test_rather_than_turn_back_before_a_narrow_place_the_disc_is_made_smaller(corner):
    """Between a wall and what stands alone the disc would leave the wall for that, and go round it for ever."""
    (x, y), back = corner, replace(SETTINGS, back=math.radians(90.0))
    points = np.concatenate([wall((-5, 1.5), (9, 1.5)), wall((x, y), (x + 4, y)), wall((x, y), (x, y - 4))])
    alone, kept = (math.degrees(rolled(points, (0.0, 1.5), 1.5, one).direction) for one in (SETTINGS, back))
    assert abs(alone) > 90
    assert abs(kept) < 46


def test_more_than_half_a_turn_away_is_back_too():
    posts = np.array([[-1.5, 1.6], [0.3, 1.5], [0.4, 1.5], [0.0, -1.35], [0.1, -1.35]])
    back = replace(SETTINGS, back=math.radians(90.0))
    assert degrees(posts, (0.3, 1.5)) > 80  # the other way round the second post, where the disc comes from
    assert abs(math.degrees(rolled(posts, (0.3, 1.5), 1.5, back).direction)) < 46


def test_where_no_disc_goes_on_it_turns_back_all_the_same():
    end = np.concatenate([wall((-9, 1.6), (1.7, 1.6)), wall((1.7, 1.6), (1.7, -1.6)), wall((1.7, -1.6), (-9, -1.6))])
    for settings in (SETTINGS, replace(SETTINGS, back=math.radians(90.0))):
        assert abs(math.degrees(rolled(end, (0.0, 1.6), 1.5, settings).direction)) > 60
