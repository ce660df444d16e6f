"""The recent path is a hundred points of twenty seconds; with `modern` it is as long as it was driven."""

from __future__ import annotations

import math
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from behaviours.catalogue import LIBRARIES
from behaviours.cores.recent_path import DeadEnd, Trace, TraceSettings
from behaviours.estimators.recent_path import RecentPath
from behaviours.interface import Compass, Odometry, Pose, Reading, Workshop
from behaviours.libraries.recent_path import recent_path
from rplan.apps.reproduce.watch import watch
from rplan.apps.wiring import compile_file
from sim.scenarios.format import load, loads

PLANS = Path(__file__).parents[2] / "plans"
LONG_ALLEY = """
name: long alley
bounds: [-6, -4, 18, 4]
robot: {model: packbot, start: [2, 0]}
time_limit: 60 s
things:
- {kind: wall, from: [-6, 0.85], to: [14, 0.85]}
- {kind: wall, from: [-6, -0.85], to: [14, -0.85]}
- {kind: wall, from: [14, -0.85], to: [14, 0.85]}
"""


def driven(settings, place_at, seconds):
    trace = Trace(settings)
    for k in range(round(seconds * 10) + 1):
        trace.add(k / 10, place_at(k / 10))
    return trace


def ahead(t):
    return 0.5 * t, 0.0


def test_a_point_is_kept_each_fifth_of_a_second_and_a_hundred_of_them():
    assert len(driven(TraceSettings(), ahead, 10.0).places) == 51
    trace = driven(TraceSettings(), ahead, 60.0)
    assert len(trace.places) == 100
    assert trace.places[0] == pytest.approx((0.5 * 40.2, 0.0)) and trace.places[-1] == pytest.approx((30.0, 0.0))


def test_a_robot_that_stands_has_forgotten_its_path_after_twenty_seconds():
    def there_and_wait(t):
        return ahead(min(t, 10.0))

    assert len(driven(TraceSettings(), there_and_wait, 27.0).apart((5.0, 0.0))) > 0
    assert len(driven(TraceSettings(), there_and_wait, 30.0).apart((5.0, 0.0))) == 0


def test_by_distance_it_forgets_nothing_while_it_stands():
    settings = TraceSettings(by_distance=True, patience=1e9)
    trace = driven(settings, lambda t: ahead(min(t, 10.0)), 300.0)
    assert len(trace.places) == 51
    assert np.diff(trace.places[:, 0]) == pytest.approx(0.1)


def test_near_points_are_left_out():
    trace = driven(TraceSettings(), ahead, 10.0)
    away = np.hypot(*(trace.apart((5.0, 0.0)) - (5.0, 0.0)).T)
    assert away.min() >= 1.0 and len(away) < len(trace.places)


def test_we_were_here_lately_only_after_having_been_away():
    trace = driven(TraceSettings(), ahead, 4.0)
    assert not trace.is_back((2.0, 0.0))
    there_and_back = driven(TraceSettings(), lambda t: (0.5 * min(t, 12.0 - t), 0.0), 11.0)
    assert there_and_back.is_back((0.5, 0.0))
    assert not driven(TraceSettings(), lambda t: (0.0, 0.0), 30.0).is_back((0.0, 0.0))


def test_a_dead_end_is_closed_behind_the_robot_and_whole_once_it_is_out():
    settings = TraceSettings(by_distance=True)
    trace = np.column_stack([np.arange(0.0, 8.0, 0.1), np.zeros(80)])
    end = DeadEnd(trace, settings)
    assert len(end.closed) == 0
    end.retreat((4.0, 0.3))
    assert end.closed[:, 0].min() >= 5.0 - 1e-9, "only what lies deeper; the way out is open"
    end.retreat((6.0, 0.3))
    assert end.closed[:, 0].min() >= 5.0 - 1e-9, "going in again opens nothing"
    end.retreat((2.0, -1.5))
    assert len(end.closed) == 80


def test_where_no_progress_is_made_the_path_becomes_a_dead_end():
    settings = TraceSettings(by_distance=True)
    trace = driven(settings, lambda t: ahead(min(t, 10.0)), 16.0)
    assert len(trace.apart((5.0, 0.0))) == 0, "nothing bars the way out"
    for k in range(60):
        trace.add(16.1 + k / 10, (5.0 - 0.05 * k, 0.0))
    assert len(trace.apart((2.0, 0.0))) > 0
    assert trace.apart((2.0, 0.0))[:, 0].min() >= 3.0 - 1e-9, "and nothing leads back in"


class Driven:
    """The library with a robot on a circle, whose odometry turns too much."""

    def __init__(self, slip=1.3, **values):
        workshop = Workshop()
        self.offer = LIBRARIES["recent-path"].build(values, workshop)
        self.estimators = workshop.estimators
        self.path = next(e for e in self.estimators if isinstance(e, RecentPath))
        x = y = 0.0
        for k in range(150):
            true, told = 0.2 * k / 10, slip * 0.2 * k / 10
            x, y = x + 0.05 * math.cos(told) * (k > 0), y + 0.05 * math.sin(told) * (k > 0)
            self.truth = Pose(2.5 * math.sin(true), 2.5 * (1 - math.cos(true)), true)
            compass = Compass(k / 10, True, math.remainder(true, math.tau))
            self.reading = Reading(k / 10, k, Odometry(Pose(x, y, told), 0.5, 0.2), compass=compass)
            self.update()

    def update(self):
        for estimator in self.estimators:
            estimator.update(self.reading, {}, {})


def test_points_lie_in_the_robot_frame_by_the_hybrid_pose():
    driven = Driven()
    c, s, at = math.cos(driven.truth.theta), math.sin(driven.truth.theta), driven.truth
    world = [(at.x + c * x - s * y, at.y + s * x + c * y) for x, y in driven.path.points]
    off = [abs(math.hypot(x, y - 2.5) - 2.5) for x, y in world]
    assert len(off) > 50 and max(off) < 0.1, "on the circle, although odometry turned by 30 % too much"


def test_the_view_shows_the_path_in_the_frame_of_localisation():
    view = Driven().offer.views["recent-path"]()
    assert view["kind"] == "points" and view["frame"] == "map"
    assert len(view["at"]) == 75


def test_where_something_held_the_robot_is_remembered_at_its_place():
    driven = Driven()
    driven.path.held_by(np.array([[0.45, 0.1]]))
    driven.update()
    assert driven.path.points[-1] == pytest.approx((0.45, 0.1)), "however near it is"


def test_two_libraries_that_want_it_otherwise_are_told():
    workshop = Workshop()
    recent_path(workshop)
    with pytest.raises(ValueError, match="use recent-path before"):
        LIBRARIES["recent-path"].build({"points": 7.0}, workshop)


def test_in_a_long_and_narrow_alley_the_robot_waits_until_its_path_is_forgotten():
    plan = compile_file(PLANS / "perimeter" / "perimeter.rplan")
    seen = watch(plan, loads(LONG_ALLEY, "long_alley.yaml"), 0)
    deepest = max(moment.pose.x for moment in seen.moments)
    waits = [moment.time for moment in seen.moments if deepest - moment.pose.x < 0.15]
    assert seen.moments[-1].pose.x < deepest - 2.0, "it came out again"
    assert waits[-1] - waits[0] == pytest.approx(20.0, abs=5.0)


def test_out_of_an_alley_the_robot_does_not_go_in_again_beside_its_path():
    plan = compile_file(PLANS / "perimeter" / "perimeter.rplan")
    seen = watch(plan, load(PLANS / "perimeter" / "worlds" / "alley_corner.yaml"), 106)
    inside = [moment.pose.x > 0.3 for moment in seen.moments if moment.time < 75.0]
    assert sum(now and not last for last, now in pairwise(inside)) == 1
    assert min(moment.pose.y for moment in seen.moments if moment.time < 75.0) < -6.0, "on along the wall"


@pytest.mark.parametrize(
    ("values", "says"),
    [({"spacing": 0.0}, "spacing must be finite and more than 0"), ({"points": 1e9}, "points must be at most 10000")],
)
def test_a_path_without_end_is_refused(values, says):
    with pytest.raises(ValueError, match=says):
        LIBRARIES["recent-path"].build({"preset": "modern", **values}, Workshop())
