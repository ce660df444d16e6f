"""Points where a wall that ends must go on."""

from __future__ import annotations

import math

import numpy as np
import pytest

from behaviours.cores.view_path import ViewPath
from behaviours.cores.wall_fit import Fit, FitSettings, Line, track
from behaviours.cores.wall_loss import TAIL, end_of, invented

VIEW = ViewPath()
BESIDE = Line(-math.pi / 2, 1.0)


def wall_to(end: float, count=150, begin=-0.28):
    """A wall to the right that ends so far ahead, fitted."""
    stations = np.linspace(begin, end, count)
    points = np.column_stack([stations, np.full(count, -1.0)])
    fit = track(points, BESIDE, FitSettings())
    assert fit is not None
    return points, fit


@pytest.mark.parametrize("end", [0.2, 0.6, 1.1])
def test_the_end_is_found_but_for_some_strays(end):
    points, fit = wall_to(end)
    found = end_of(fit, points, VIEW)
    assert found.station == pytest.approx(points[-1 - TAIL, 0])
    assert found.gap == pytest.approx(VIEW.end_of(fit.line) - found.station)


def test_points_come_in_proportion_to_the_gap_and_lie_at_the_edge_of_the_view():
    points, fit = wall_to(0.8)
    end = end_of(fit, points, VIEW)
    added = invented(fit, points, end, VIEW)
    assert len(added) == round(end.gap * 150 / 1.08)
    assert added == pytest.approx(np.tile(VIEW.edge_beyond(end.point), (len(added), 1)))
    assert added[0, 1] < -1.0 < 1.0 < added[0, 0]


def test_never_more_are_invented_than_seen():
    points, fit = wall_to(-0.1, 40, -0.28)
    assert len(invented(fit, points, end_of(fit, points, VIEW), VIEW)) == 40


def test_none_are_invented_where_the_wall_goes_on():
    points, fit = wall_to(1.42)
    assert len(invented(fit, points, end_of(fit, points, VIEW), VIEW)) == 0


@pytest.mark.parametrize("count", [1, 2, 3])
def test_the_end_of_very_few_points_is_one_of_them(count):
    points = np.column_stack([np.linspace(0, 0.1, count), np.full(count, -1.0)])
    fit = Fit(BESIDE, np.ones(count, dtype=np.bool_), 0.0)
    assert end_of(fit, points, VIEW).point in [tuple(point) for point in points.tolist()]
    assert len(invented(fit, points, end_of(fit, points, VIEW), VIEW)) <= count
