"""The percepts of libraries, for programs that are no plans."""

from __future__ import annotations

import pytest

from behaviours.catalogue import LIBRARIES
from behaviours.interface import Odometry, Pose, Reading
from rplan.apps.percepts import Percepts


def reading(stamp: float) -> Reading:
    return Reading(stamp, round(stamp * 10), Odometry(Pose(0, 0), 0.4, 0.0))


def test_every_percept_of_the_libraries_is_told():
    percepts = Percepts("robot", "sensors", settings={"sensors": {"far": 30.0}})
    says = percepts(reading(2.0))
    assert (says["speed"], says["time-since-start"], says["lidar-range-ahead"]) == (0.4, 2.0, 30.0)


def test_the_libraries_to_choose_from_may_be_given():
    percepts = Percepts("mine", offered={"mine": LIBRARIES["robot"]})
    assert percepts(reading(2.0))["speed"] == 0.4
    with pytest.raises(ValueError, match="no library 'robot'; known: mine"):
        Percepts("robot", offered={"mine": LIBRARIES["robot"]})


def test_a_run_begins_without_what_was_before():
    percepts = Percepts("sensors")
    assert percepts(reading(5.0))["lidar-is-lost"]
    percepts.begin()
    assert not percepts(reading(0.5))["lidar-is-lost"]


def test_unknown_libraries_are_refused_with_a_hint():
    with pytest.raises(ValueError, match="no library 'sensor'; did you mean 'sensors'"):
        Percepts("sensor")
    with pytest.raises(ValueError, match="no library 'x'; known: robot"):
        Percepts("robot", settings={"x": {}})
