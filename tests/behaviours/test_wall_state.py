"""Offset and angle, filtered."""

from __future__ import annotations

import math

import numpy as np
import pytest

from behaviours.cores.wall_fit import Line
from behaviours.cores.wall_state import FilterSettings, WallState, as_line, begun, measured, predicted, updated
from behaviours.interface import wrap

SETTINGS = FilterSettings()


def line(offset, angle):
    return Line(wrap(-angle - math.pi / 2), offset)


@pytest.mark.parametrize(("offset", "angle"), [(1.0, 0.0), (0.4, 1.3), (2.0, -1.9), (-0.1, 0.2)])
def test_a_line_says_offset_and_angle_and_the_state_says_the_line(offset, angle):
    assert measured(line(offset, angle)) == pytest.approx((offset, angle))
    state = begun(line(offset, angle), SETTINGS)
    assert as_line(state).distance == offset
    assert wrap(as_line(state).normal - line(offset, angle).normal) == pytest.approx(0.0, abs=1e-12)


def test_it_predicts_as_a_unicycle_moves():
    state = predicted(begun(line(1.0, 0.5), SETTINGS), 0.48, 0.3, 0.1, SETTINGS)
    assert (state.offset, state.angle) == pytest.approx((1.0 + 0.048 * math.sin(0.5), 0.53))


def matrices(state: WallState, speed, dt):
    covariance = np.array([[state.a, state.b], [state.b, state.c]])
    slope = np.array([[1.0, speed * dt * math.cos(state.angle)], [0.0, 1.0]])
    return covariance, slope


def test_prediction_and_update_are_the_textbook_s():
    state = WallState(1.2, 0.3, 0.02, 0.004, 0.03)
    covariance, slope = matrices(state, 0.5, 0.1)
    ahead = predicted(state, 0.5, 0.2, 0.1, SETTINGS)
    expected = slope @ covariance @ slope.T + np.diag([SETTINGS.offset_drift, SETTINGS.angle_drift])
    assert np.array([[ahead.a, ahead.b], [ahead.b, ahead.c]]) == pytest.approx(expected)
    gain = expected @ np.linalg.inv(expected + np.diag([SETTINGS.offset_noise, SETTINGS.angle_noise]))
    after = updated(ahead, line(1.1, 0.25), SETTINGS)
    error = np.array([1.1 - ahead.offset, 0.25 - ahead.angle])
    assert (after.offset, after.angle) == pytest.approx(tuple(np.array([ahead.offset, ahead.angle]) + gain @ error))
    assert np.array([[after.a, after.b], [after.b, after.c]]) == pytest.approx((np.eye(2) - gain) @ expected)


def test_an_angle_is_compared_the_short_way_round():
    state = updated(WallState(1.0, 3.1, 0.05, 0.0, 0.05), line(1.0, -3.1), SETTINGS)
    assert abs(state.angle) > 3.09


def test_it_is_as_sure_as_it_should_be():
    """The squared error by the covariance is 2 in the mean where noise and drift are what it takes them for."""
    chance, weighed = np.random.default_rng(11), []
    for _ in range(40):
        y, theta = 1.0, 0.0
        spread = math.sqrt(SETTINGS.start)
        state = begun(line(y + chance.normal(0, spread), theta + chance.normal(0, spread)), SETTINGS)
        for k in range(120):
            omega = 0.4 * math.sin(k / 9) - 0.5 * theta
            state = predicted(state, 0.48, omega, 0.028, SETTINGS)
            y += 0.48 * 0.028 * math.sin(theta) + chance.normal(0, math.sqrt(SETTINGS.offset_drift))
            theta += omega * 0.028 + chance.normal(0, math.sqrt(SETTINGS.angle_drift))
            noise = chance.normal(0, 1, 2) * np.sqrt([SETTINGS.offset_noise, SETTINGS.angle_noise])
            state = updated(state, line(y + noise[0], theta + noise[1]), SETTINGS)
            covariance, _ = matrices(state, 0, 0)
            error = np.array([y - state.offset, wrap(theta - state.angle)])
            weighed.append(float(error @ np.linalg.solve(covariance, error)))
    assert np.mean(weighed) == pytest.approx(2.0, abs=0.15)
    assert np.mean(np.array(weighed) < 5.991) == pytest.approx(0.95, abs=0.015)


def test_its_covariance_stays_one():
    state = begun(line(1.0, 0.1), SETTINGS)
    for _ in range(5000):
        state = updated(predicted(state, 0.48, 0.1, 0.028, SETTINGS), line(1.0, 0.1), SETTINGS)
    assert state.a > 0 < state.c
    assert state.a * state.c > state.b**2
