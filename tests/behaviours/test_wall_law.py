"""Steering along a wall: which reading of equation (2) is stable, and what equation (3) measures."""

from __future__ import annotations

import cmath
import math

import numpy as np
import pytest

from behaviours.cores.wall_law import NEAREST, STEEPEST, LawSettings, bend, lyapunov, turn_rate

K = 3.0


def eigenvalues(by_offset: float, by_angle: float) -> tuple[complex, complex]:
    """Per metre, of d offset = angle, d angle = by_offset * offset + by_angle * angle."""
    root = cmath.sqrt(by_angle * by_angle / 4 + by_offset)
    return by_angle / 2 + root, by_angle / 2 - root


@pytest.mark.parametrize(
    ("reading", "by_offset", "by_angle", "stable", "expected"),
    [
        ("A: -k sin - (y - T) + K", -1.0, -K, True, (-0.382, -2.618)),
        ("B: -k (sin - (y - T)) + K", K, -K, False, (0.791, -3.791)),
        ("C: -k (sin + (y - T)) + K", -K, -K, True, (-1.5 + 0.866j, -1.5 - 0.866j)),
        ("D: -k (sin - (y - T) + K)", K, -K, False, (0.791, -3.791)),
    ],
)
def test_of_the_readings_of_equation_2_only_a_and_c_are_stable(reading, by_offset, by_angle, stable, expected):
    found = eigenvalues(by_offset, by_angle)
    assert found == pytest.approx(expected, abs=1e-3), reading
    assert all(value.real < 0 for value in found) == stable


@pytest.mark.parametrize("law", [LawSettings(), LawSettings(offset_gain=2.25)])
def test_the_law_is_reading_a(law):
    tiny, speed = 1e-6, 0.48
    by_offset = turn_rate(law.stand_off + tiny, 0.0, 0.0, speed, law) / speed / tiny
    by_angle = turn_rate(law.stand_off, tiny, 0.0, speed, law) / speed / tiny
    assert (by_offset, by_angle) == pytest.approx((-law.offset_gain, -law.gain), rel=1e-6)
    assert turn_rate(law.stand_off, 0.0, 0.2, speed, law) == pytest.approx(0.2 * speed)


def test_tuned_is_damped_critically():
    first, second = eigenvalues(-(K**2) / 4, -K)
    assert first == second == -1.5


def test_the_turn_rate_is_limited():
    law = LawSettings()
    assert turn_rate(50.0, 0.0, 0.0, 1.0, law) == -law.most
    assert turn_rate(1.0, -1.5, 3.0, 1.0, law) == law.most


def test_the_lyapunov_function_is_least_beside_the_wall():
    law = LawSettings()
    assert lyapunov(law.stand_off, 0.0, law) == 0.0
    assert lyapunov(law.stand_off + 0.1, 0.0, law) > 0.0 < lyapunov(law.stand_off, 0.1, law)


# --- equation (3) -------------------------------------------------------------------------------------


def literal(x, y):
    """Equation (3) as it is printed, with a from -0.3 N to N / 2; terms that are 0 / 0 or beyond the ends left out."""
    n = len(x)
    c = (n - 1) // 2
    total = 0.0
    for a in range(-(3 * n // 10), n // 2 + 1):
        if a == 0 or not (0 <= c + a < n and 0 <= c - a < n):
            continue
        total += (y[c + a] - y[c]) / (x[c + a] - x[c]) - (y[c] - y[c - a]) / (x[c] - x[c - a])
    return 2.0 / n * total


@pytest.mark.parametrize("count", [5, 20, 30, 41, 100, 137])
def test_k_is_the_printed_sum(count):
    chance = np.random.default_rng(count)
    x = np.cumsum(chance.uniform(0.03, 0.06, count))
    y = 0.1 * np.sin(x) + chance.normal(0, 0.01, count)
    assert bend(x, y) == pytest.approx(literal(x, y), abs=1e-12)


def parabola(kappa, length=1.5, count=301):
    x = np.linspace(-length / 2, length / 2, count)
    return x, kappa * x * x / 2


@pytest.mark.parametrize("kappa", [-0.5, 0.1, 0.8])
@pytest.mark.parametrize("length", [0.8, 1.5, 3.0])
def test_k_is_the_curvature_times_016_of_the_length(kappa, length):
    assert bend(*parabola(kappa, length)) == pytest.approx(0.16 * length * kappa, rel=0.02)


@pytest.mark.parametrize("kappa", [-0.5, 0.1, 0.8])
@pytest.mark.parametrize("length", [0.8, 3.0])
def test_per_metre_k_is_the_curvature(kappa, length):
    assert bend(*parabola(kappa, length), per_metre=True) == pytest.approx(kappa, rel=1e-9)


def test_per_metre_noise_does_not_shift_the_mean():
    chance = np.random.default_rng(7)
    x, y = parabola(0.4)
    some = [bend(x, y + chance.normal(0, 0.01, len(x)), per_metre=True) for _ in range(400)]
    assert np.mean(some) == pytest.approx(0.4, abs=3 * np.std(some) / 20)


def test_terms_near_the_middle_would_be_ten_times_as_noisy():
    chance = np.random.default_rng(3)
    x = np.linspace(-0.75, 0.75, 151)
    ours = np.std([bend(x, chance.normal(0, 0.01, 151)) for _ in range(200)])
    assert ours < 0.02


def test_points_that_lead_back_say_nothing():
    x, y = parabola(0.0, 1.0, 60)
    ahead = bend(np.append(x, np.full(40, 1.2)), np.append(y, np.full(40, -1.0)))
    back = bend(np.append(x, np.full(59, -0.3)), np.append(y, np.full(59, -1.0)))
    assert ahead < -0.3
    assert back == 0.0


@pytest.mark.parametrize("count", [0, 1, 2, 3])
def test_too_few_points_have_no_curvature(count):
    x = np.linspace(0.0, 1.0, count)
    assert math.isfinite(bend(x, x * x))


def test_identical_points_have_no_curvature():
    assert bend(np.ones(50), np.ones(50)) == 0.0
    assert bend(np.arange(50) * NEAREST / 100, np.ones(50)) == 0.0


def test_curvature_is_limited():
    x = np.linspace(-0.05, 0.05, 51)
    assert bend(x, -100.0 * np.abs(x)) == -STEEPEST
