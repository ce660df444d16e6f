"""Lines through points: sampled, then followed from scan to scan."""

from __future__ import annotations

import math

import numpy as np
import pytest

from behaviours.cores.wall_fit import FitSettings, Line, acquire, track
from behaviours.interface import wrap

FIT = FitSettings()


def on_a_wall(normal, distance, count=120, noise=0.01, seed=0, span=(-1.0, 2.0)):
    """Points on n.p = distance, noise [m] across."""
    chance = np.random.default_rng(seed)
    along = chance.uniform(*span, count)
    off = distance + chance.normal(0, noise, count)
    c, s = math.cos(normal), math.sin(normal)
    return np.column_stack([c * off - s * along, s * off + c * along])


def strewn(count, seed=1, reach=3.0):
    return np.random.default_rng(seed).uniform(-reach, reach, (count, 2))


def turned(points, angle):
    c, s = math.cos(angle), math.sin(angle)
    return points @ np.array([[c, s], [-s, c]])


@pytest.mark.parametrize("normal", [-1.57, -1.0, -2.3, 0.4])
@pytest.mark.parametrize("seed", range(5))
def test_a_wall_is_found_among_as_many_strays(normal, seed):
    points = np.concatenate([on_a_wall(normal, 1.3, seed=seed), strewn(120, seed + 50)])
    found = acquire(points, FIT, np.random.default_rng(seed))
    assert found is not None
    assert abs(wrap(found.line.normal - normal)) < math.radians(4)
    assert found.line.distance == pytest.approx(1.3, abs=0.06)
    assert np.count_nonzero(found.inliers[:120]) > 100


def test_patience_takes_the_wall_with_most_points():
    points = np.concatenate([on_a_wall(0.0, 1.0, 60, 0.001), on_a_wall(-math.pi / 2, 1.0, 100, 0.001)])
    for seed in range(8):
        found = acquire(points, FitSettings(patient=True), np.random.default_rng(seed))
        assert found is not None
        assert found.line.normal == pytest.approx(-math.pi / 2, abs=0.02)


def test_a_wall_may_be_turned_only_so_far():
    behind = on_a_wall(math.pi / 2, 1.0)  # the robot has it to its left
    assert acquire(behind, FIT, np.random.default_rng(0), math.radians(90)) is None
    assert acquire(behind, FIT, np.random.default_rng(0)) is not None


def test_too_small_a_share_is_no_wall():
    points = np.concatenate([on_a_wall(0.3, 1.0, 30), strewn(600)])
    assert acquire(points, FitSettings(share=0.3), np.random.default_rng(0)) is None


@pytest.mark.parametrize("angle", [0.3, -1.2, 2.5, math.pi])
def test_turning_the_points_turns_the_wall(angle):
    points = np.concatenate([on_a_wall(-1.4, 0.9), strewn(60)])
    plain = acquire(points, FIT, np.random.default_rng(4))
    other = acquire(turned(points, angle), FIT, np.random.default_rng(4))
    assert plain is not None and other is not None
    assert wrap(other.line.normal - plain.line.normal - angle) == pytest.approx(0.0, abs=1e-9)
    assert other.line.distance == pytest.approx(plain.line.distance, abs=1e-9)
    assert (other.inliers == plain.inliers).all()
    assert other.residual == pytest.approx(plain.residual, abs=1e-12)


def test_the_residual_is_a_mean_square_of_metres():
    found = track(on_a_wall(-1.2, 1.0, 4000, 0.02), Line(-1.2, 1.0), FitSettings(track_band=0.5))
    assert found is not None
    assert found.residual == pytest.approx(4e-4, rel=0.1)


def test_a_wall_is_followed_as_total_least_squares_say():
    points = on_a_wall(-1.3, 1.1, 200)
    found = track(points, Line(-1.28, 1.09), FIT)
    assert found is not None
    near = points[found.inliers]
    values, vectors = np.linalg.eigh(np.cov(near.T, bias=True))
    assert abs(vectors[:, 0] @ found.line.n) == pytest.approx(1.0, abs=1e-12)
    assert found.residual == pytest.approx(values[0], rel=1e-6)
    assert found.line.distance == pytest.approx(near.mean(axis=0) @ found.line.n, abs=1e-12)


def test_the_normal_keeps_its_sense_when_the_robot_crosses_the_line():
    found = track(on_a_wall(-1.5, -0.05), Line(-1.5, -0.04), FIT)
    assert found is not None
    assert found.line.normal == pytest.approx(-1.5, abs=0.05)
    assert found.line.distance < 0


@pytest.mark.parametrize("count", [0, 1, 2, 19])
def test_fewer_than_twenty_points_are_no_wall(count):
    points = on_a_wall(-1.5, 1.0, count, 0.0)
    assert acquire(points, FIT, np.random.default_rng(0)) is None
    assert track(points, Line(-1.5, 1.0), FIT) is None


def test_twenty_are():
    points = on_a_wall(-1.5, 1.0, 20, 0.001)
    assert acquire(points, FIT, np.random.default_rng(0)) is not None
    assert track(points, Line(-1.5, 1.0), FIT) is not None


@pytest.mark.parametrize("points", [np.ones((50, 2)), np.zeros((50, 2)), np.full((50, 2), 1e-9)])
def test_points_in_one_place_are_no_wall(points):
    assert acquire(points, FIT, np.random.default_rng(0)) is None
    assert track(points, Line(0.0, float(points[0, 0])), FIT) is None


def test_a_ring_round_the_robot_is_no_wall():
    bearing = np.radians(np.linspace(-120, 120, 667))
    ring = 0.02 * np.column_stack([np.cos(bearing), np.sin(bearing)])
    assert acquire(ring, FIT, np.random.default_rng(0)) is None


def test_the_same_chance_finds_the_same_wall():
    points = np.concatenate([on_a_wall(-1.2, 1.0), strewn(200)])
    one, other = (acquire(points, FIT, np.random.default_rng(9)) for _ in range(2))
    assert one is not None and other is not None
    assert one.line == other.line
