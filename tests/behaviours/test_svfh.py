"""The scaled vector field histogram: what is blocked, which direction is taken, how fast."""

import math

import numpy as np
import pytest

from behaviours.cores.svfh import SvfhSettings, chosen_direction, drive, front_range, histogram

SETTINGS = SvfhSettings()
WIDTH = math.tau / 72
NOTHING = np.zeros((0, 2))


def at(bearing, away):
    return [away * math.cos(bearing), away * math.sin(bearing)]


def cloud(seed, count=361):
    chance = np.random.default_rng(seed)
    return np.array(
        [at(b, r) for b, r in zip(chance.uniform(-4, 4, count), chance.uniform(0.3, 6, count), strict=True)]
    )


def literally(points):
    """Each reading increments all wedges that reach within k / r of it."""
    counts = np.zeros(72, dtype=int)
    for x, y in points:
        away = math.hypot(x, y)
        if away <= 4.0:
            for i in range(72):
                off = abs(math.remainder(i * WIDTH - math.atan2(y, x), math.tau))
                counts[i] += off - WIDTH / 2 <= 0.4 / away + 1e-9
    return counts


def open_but(*blocked):
    free = np.ones(72, dtype=bool)
    free[[i % 72 for i in blocked]] = False
    return free


@pytest.mark.parametrize("seed", range(5))
def test_the_histogram_counts_readings_within_k_over_r(seed):
    points = cloud(seed, 40)
    assert histogram(points, SETTINGS).tolist() == literally(points).tolist()


def test_a_reading_blocks_more_the_nearer_it_is():
    blocked = [int((histogram(np.array([at(0.0, r)]), SETTINGS) > 0).sum()) for r in (3.9, 2.0, 1.0, 0.5, 0.2)]
    assert blocked == sorted(blocked)
    assert blocked == [3, 5, 11, 19, 47]


@pytest.mark.parametrize("seed", range(5))
def test_every_heading_in_an_open_wedge_keeps_the_clearance(seed):
    points = cloud(seed, 40)
    points = points[np.hypot(*points.T) <= 4.0]
    for heading in np.linspace(-math.pi, math.pi, 500):
        if histogram(points, SETTINGS)[round(heading / WIDTH) % 72] == 0:
            off = [abs(math.remainder(heading - math.atan2(y, x), math.tau)) * math.hypot(x, y) for x, y in points]
            assert min(off) >= 0.4 - 1e-6


def test_a_reading_that_is_all_but_inside_the_robot_blocks_every_direction_once():
    assert histogram(np.array([at(1.0, 0.01)]), SETTINGS).tolist() == [1] * 72


def test_what_lies_beyond_the_window_does_not_count():
    assert histogram(np.array([at(0.3, 4.01)]), SETTINGS).sum() == 0
    assert histogram(NOTHING, SETTINGS).sum() == 0


@pytest.mark.parametrize("seed", range(5))
def test_left_and_right_are_mirror_images(seed):
    points = cloud(seed)
    mirrored = points * (1, -1)
    counts, other = histogram(points, SETTINGS), histogram(mirrored, SETTINGS)
    assert other.tolist() == np.roll(counts[::-1], 1).tolist()
    free = counts <= np.sort(counts)[20]
    for wanted in np.linspace(-3, 3, 41):
        left = chosen_direction(free, wanted, True)
        right = chosen_direction(np.roll(free[::-1], 1), -wanted, False)
        assert right == pytest.approx(-left, abs=1e-12)


def test_the_wanted_direction_itself_is_taken_when_it_is_open():
    assert chosen_direction(open_but(), 0.1234, True) == 0.1234
    assert chosen_direction(open_but(5), 0.1234, True) == 0.1234


def test_otherwise_the_nearest_open_one_is_taken():
    assert chosen_direction(open_but(0, 1, 2, 3, -1), 0.0, True) == pytest.approx(-2 * WIDTH)
    assert chosen_direction(open_but(*range(-30, 31)), 0.3, True) == pytest.approx(31 * WIDTH)


def test_of_two_equally_near_ones_the_set_side_is_taken():
    """Within the width of a direction."""
    free = open_but(0, 1, -1)
    for wanted in (-0.04, 0.0, 0.04):
        assert chosen_direction(free, wanted, True) == pytest.approx(2 * WIDTH)
        assert chosen_direction(free, wanted, False) == pytest.approx(-2 * WIDTH)


def test_none_is_taken_where_none_is_open():
    assert chosen_direction(np.zeros(72, dtype=bool), 0.0, True) is None


def test_blocked_the_robot_turns_on_the_spot_to_the_set_side():
    assert (drive(None, True, 9.0, True, SETTINGS).speed, drive(None, True, 9.0, True, SETTINGS).turn_rate) == (0, 0.5)
    assert drive(None, True, 9.0, False, SETTINGS).turn_rate == -0.5


@pytest.mark.parametrize(
    ("direction", "deflected", "front", "speed"),
    [
        (0.0, False, 9.0, 0.5),
        (math.pi / 3, False, 9.0, 0.25),
        (math.pi / 2, False, 9.0, 0.0),
        (2.5, False, 9.0, 0.0),
        (0.0, True, 9.0, 0.35),
        (0.0, False, 0.6, 0.25),
        (0.0, False, 0.3, 0.0),
        (0.0, False, 0.1, 0.0),
    ],
)
def test_the_speed_falls_with_the_turn_with_deflection_and_with_what_stands_ahead(direction, deflected, front, speed):
    assert drive(direction, deflected, front, True, SETTINGS).speed == pytest.approx(speed, abs=1e-12)


def test_the_turn_rate_is_proportional_up_to_a_limit():
    assert drive(0.1, False, 9.0, True, SETTINGS).turn_rate == pytest.approx(0.2)
    assert drive(-2.0, False, 9.0, True, SETTINGS).turn_rate == -1.0


def test_the_range_ahead_is_that_of_what_stands_ahead():
    points = np.array([at(0.4, 0.7), at(-0.4, 0.6), at(1.0, 0.2), at(math.pi, 0.1)])
    assert front_range(points, SETTINGS) == pytest.approx(0.6)
    assert front_range(NOTHING, SETTINGS) == math.inf
