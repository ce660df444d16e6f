"""The strip that is looked at."""

from __future__ import annotations

import math

import numpy as np
import pytest

from behaviours.cores.view_path import ViewPath
from behaviours.cores.wall_fit import Line

VIEW = ViewPath()
BESIDE = Line(-math.pi / 2, 1.0)


def test_it_holds_what_lies_within_half_its_width_and_ahead_of_its_foot():
    view = ViewPath(math.radians(-90), 1.0)
    points = np.array([[0.0, -2.0], [0.49, -1.0], [-0.51, -1.0], [0.0, 1.0]])
    assert view.holds(points).tolist() == [True, True, False, False]


def test_at_60_degrees_a_wall_a_metre_away_is_seen_from_behind_the_robot_to_ahead():
    stations = np.linspace(-2, 3, 5001)
    seen = stations[VIEW.holds(np.column_stack([stations, np.full(5001, -1.0)]))]
    assert (seen.min(), seen.max()) == pytest.approx((-0.289, 1.443), abs=2e-3)
    assert VIEW.end_of(BESIDE) == pytest.approx(seen.max(), abs=2e-3)


def test_along_the_strip_the_reach_ends_the_view():
    view = ViewPath(math.radians(-90), 1.0, 4.0)
    assert view.end_of(Line(0.0, 0.2)) == pytest.approx(math.sqrt(16 - 0.04))
    assert view.end_of(Line(0.0, 5.0)) <= 0.0  # never in view


def test_the_edge_beyond_a_point_lies_on_its_ray_at_the_edge():
    for point in ((1.0, -1.0), (0.3, -0.9), (0.0, -1.0)):
        x, y = VIEW.edge_beyond(point)
        assert x * point[1] - y * point[0] == pytest.approx(0.0, abs=1e-12)
        c, s = math.cos(VIEW.angle), math.sin(VIEW.angle)
        at_side = abs(abs(c * y - s * x) - VIEW.width / 2) < 1e-9
        assert at_side or math.hypot(x, y) == pytest.approx(VIEW.reach)


def test_the_edge_beyond_the_robot_itself_is_the_robot():
    assert VIEW.edge_beyond((0.0, 0.0)) == (0.0, 0.0)
