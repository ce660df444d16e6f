"""Obstacle circles: their number, their size, their forgetting."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from behaviours.cores.circles import Circles, CircleSettings, enclose, perceive
from behaviours.cores.cone import echoes_of
from behaviours.interface import Pose, Ranges

SETTINGS = CircleSettings()
echoes = st.lists(st.tuples(st.floats(0.1, 4.0), st.tuples(st.floats(-4, 4), st.floats(-4, 4))), max_size=24)


def after(*sweeps):
    memory = Circles()
    for sweep in sweeps:
        memory = perceive(memory, sweep, SETTINGS)
    return memory


def test_echoes_that_lie_together_make_one_circle_over_the_sweeps():
    memory = after([(1.0, (1.0, 0.0))], [(1.0, (1.0, 0.4))])
    (circle,) = memory.circles
    assert (circle.x, circle.y, circle.radius) == (1.0, pytest.approx(0.2), pytest.approx(0.2 + SETTINGS.pad))


def test_a_circle_takes_one_reading_a_sweep():
    memory = after([(1.0, (1.0, 0.0)), (1.2, (1.0, 0.3))])
    assert len(memory.circles) == 2


def test_a_sixth_sweep_forgets_the_first_and_a_silent_circle_is_freed():
    once, nothing = [(1.0, (1.0, 0.0))], []
    assert len(after(once, *[nothing] * 4).circles) == 1
    assert after(once, *[nothing] * 5).circles == ()


def test_a_circle_holds_at_most_five_readings():
    memory = after(*[[(1.0, (1.0, 0.01 * k))] for k in range(9)])
    assert [len(c.echoes) for c in memory.circles] == [5]


def test_no_circle_grows_beyond_its_limit():
    memory = after([(1.0, (1.0, 0.0))], [(1.0, (1.0, 1.1))])
    assert len(memory.circles) == 2


def test_far_echoes_are_left_out():
    assert after([(3.1, (3.4, 0.0))]).circles == ()


def test_the_eleventh_obstacle_overflows():
    memory = after([(2.0 + k / 100, (2.0 * k, 0.0)) for k in range(13)])
    assert (len(memory.circles), memory.overflow) == (10, 3)
    assert max(c.x for c in memory.circles) == 18.0, "the nearest ten are kept"


@given(st.lists(echoes, max_size=8))
def test_limits_hold_whatever_is_heard(sweeps):
    memory = after(*sweeps)
    assert len(memory.circles) <= 10
    for c in memory.circles:
        assert 1 <= len(c.echoes) <= 5
        assert len({e[2] for e in c.echoes}) == len(c.echoes)
        assert c.radius <= SETTINGS.max_radius + SETTINGS.pad + 1e-9


@given(st.lists(st.tuples(st.floats(-5, 5), st.floats(-5, 5), st.just(0)), min_size=1, max_size=5))
def test_the_circle_encloses_its_echoes(points):
    x, y, radius = enclose(points)
    assert all(math.hypot(p[0] - x, p[1] - y) <= radius + 1e-9 for p in points)


def ring(ranges):
    bearings = np.arange(len(ranges)) * math.tau / len(ranges)
    return Ranges(0.0, True, bearings, np.array(ranges), 5.0, 0.35)


def bearing_of(ranges, half_cone=0.1):
    ((_, (x, y)),) = [e for e in echoes_of(ring(ranges), Pose(0, 0, 0), half_cone, 0.5) if e[0] == 2.0]
    return math.atan2(y, x)


def test_an_echo_lies_on_the_side_where_the_neighbour_hears_something_nearer():
    assert bearing_of([2.0, 1.8, 5.0, 5.0, 5.0, 5.0]) == pytest.approx(0.1)
    assert bearing_of([2.0, 5.0, 5.0, 5.0, 5.0, 1.8]) == pytest.approx(-0.1)


def test_an_echo_without_nearer_neighbour_or_between_two_lies_on_the_axis():
    assert bearing_of([2.0, 2.3, 5.0, 5.0, 5.0, 5.0]) == pytest.approx(0.0)
    assert bearing_of([2.0, 1.8, 5.0, 5.0, 5.0, 1.8]) == pytest.approx(0.0)
    assert bearing_of([2.0, 1.0, 5.0, 5.0, 5.0, 5.0]) == pytest.approx(0.0), "that is another thing"


def test_silence_is_no_echo():
    assert echoes_of(ring([5.0] * 6), Pose(0, 0, 0), 0.1, 0.5) == []
