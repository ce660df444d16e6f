"""The closed loop of robot, wall and law: what the Lyapunov function measures never grows."""

from __future__ import annotations

import math

from hypothesis import given, settings
from hypothesis import strategies as st

from behaviours.cores.wall_law import LawSettings, lyapunov, turn_rate

FINE, PERIOD = 1e-3, 0.028  # [s]
FREE = 1e9
"""The law without its limit: where a limit cuts the turn rate, the proof says nothing."""

gains = st.floats(0.3, 6.0)
speeds = st.floats(0.05, 1.5)
offsets = st.floats(-2.0, 4.0)
angles = st.floats(-math.pi, math.pi)


@st.composite
def laws(draw) -> LawSettings:
    """Of the presets paper and tuned, and with any gain on the offset."""
    gain = draw(gains)
    offset_gain = draw(st.sampled_from((1.0, gain * gain / 4)) | st.floats(0.1, 5.0))
    return LawSettings(gain=gain, offset_gain=offset_gain, stand_off=draw(st.floats(0.3, 2.0)), most=FREE)


def step(y: float, theta: float, v: float, omega: float, dt: float) -> tuple[float, float]:
    """A unicycle on its arc, exactly."""
    if abs(omega) * dt < 1e-9:
        return y + v * dt * math.sin(theta), theta + omega * dt
    return y + v / omega * (math.cos(theta) - math.cos(theta + omega * dt)), theta + omega * dt


def most_growth(y: float, theta: float, v: float, omega: float, law: LawSettings, dt: float) -> float:
    """Of a step with the turn rate held: V' is not above 0 at its start, and V'' is nowhere above what is here."""
    reach = abs(y - law.stand_off) + v * dt
    second = abs(omega) * (abs(omega) + v * law.offset_gain * reach) + v * v * law.offset_gain
    return second * dt * dt / 2 + 1e-12


@settings(max_examples=60, deadline=None)
@given(law=laws(), v=speeds, y=offsets, theta=angles)
def test_it_never_grows_in_the_fine_loop(law, v, y, theta):
    for _ in range(1500):
        omega = turn_rate(y, theta, 0.0, v, law)
        before = lyapunov(y, theta, law)
        allowed = most_growth(y, theta, v, omega, law, FINE)
        y, theta = step(y, theta, v, omega, FINE)
        assert lyapunov(y, theta, law) <= before + allowed


@settings(max_examples=150, deadline=None)
@given(law=laws(), v=speeds, y=offsets, theta=angles)
def test_its_slope_is_that_of_the_proof(law, v, y, theta):
    omega = turn_rate(y, theta, 0.0, v, law)
    slope = math.sin(theta) * omega + law.offset_gain * (y - law.stand_off) * v * math.sin(theta)
    scale = 1.0 + abs(omega) + law.offset_gain * abs(y - law.stand_off) * v
    assert abs(slope + law.gain * v * math.sin(theta) ** 2) <= 1e-9 * scale


@settings(max_examples=60, deadline=None)
@given(law=laws(), v=speeds, y=offsets, theta=angles)
def test_with_a_scan_each_28_ms_it_grows_no_more_than_a_held_turn_rate_explains(law, v, y, theta):
    for _ in range(300):
        omega = turn_rate(y, theta, 0.0, v, law)
        before = lyapunov(y, theta, law)
        allowed = most_growth(y, theta, v, omega, law, PERIOD)
        y, theta = step(y, theta, v, omega, PERIOD)
        assert lyapunov(y, theta, law) <= before + allowed


@settings(max_examples=40, deadline=None)
@given(preset=st.sampled_from((1.0, 2.25)), v=st.floats(0.2, 0.8), y=st.floats(0.2, 2.5), theta=st.floats(-2.6, 2.6))
def test_as_it_is_driven_it_ends_beside_the_wall(preset, v, y, theta):
    law = LawSettings(offset_gain=preset)
    for _ in range(int(25.0 / v / PERIOD)):
        y, theta = step(y, theta, v, turn_rate(y, theta, 0.0, v, law), PERIOD)
    assert abs(y - law.stand_off) < 0.01
    assert abs(math.sin(theta)) < 0.01 and math.cos(theta) > 0
