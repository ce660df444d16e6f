"""The library `sensors` says the last sound value of each sensor, and `drive` moves steadily."""

from __future__ import annotations

import math

import numpy as np
import pytest

from behaviours.catalogue import library
from behaviours.interface import Bumper, Compass, Currents, Drive, Inclination, Odometry, Pose, Reading, Scan, Workshop


def brought_to_life(name: str, **values: float):
    workshop = Workshop()
    offer = library(name).build(values, workshop)
    return offer, workshop.estimators


def told(estimators, *readings: Reading) -> None:
    for reading in readings:
        for estimator in estimators:
            estimator.update(reading, {}, {})


def reading(stamp: float = 0.0, **sensed) -> Reading:
    return Reading(stamp, 0, Odometry(Pose(0, 0), 0.0, 0.3), **sensed)


FRONT = Pose(0.0, 0.0)


def scan(ranges: list[float], mount: Pose = FRONT, stamp: float = 0.0) -> Scan:
    bearings = np.radians([-90.0, 0.0, 90.0, 180.0])
    return Scan(stamp, True, mount, bearings, np.array(ranges), 0.1, 10.0)


def test_ranges_are_told_by_direction():
    offer, estimators = brought_to_life("sensors")
    told(estimators, reading(lidar=scan([1.0, 2.0, 3.0, 0.5])))
    says = {name: percept() for name, percept in offer.percepts.items()}
    assert (says["lidar-range-right"], says["lidar-range-ahead"], says["lidar-range-left"]) == (1.0, 2.0, 3.0)
    assert (says["lidar-range-behind"], says["lidar-nearest-range"]) == (0.5, 0.5)
    assert abs(says["lidar-nearest-bearing"]) == pytest.approx(math.pi)


def test_a_lidar_that_looks_aside_is_turned_back():
    offer, estimators = brought_to_life("sensors")
    told(estimators, reading(lidar=scan([1.0, 2.0, 3.0, 0.5], Pose(0.0, 0.0, math.pi / 2))))
    assert offer.percepts["lidar-range-left"]() == 2.0


def test_failed_beams_count_for_nothing_and_empty_ones_are_far():
    offer, estimators = brought_to_life("sensors", far=50.0)
    told(estimators, reading(lidar=scan([math.nan, 10.0, 3.0, math.nan])))
    assert offer.percepts["lidar-range-ahead"]() == 50.0
    assert offer.percepts["lidar-nearest-range"]() == 3.0


def test_a_lidar_without_sound_scans_is_lost_after_a_while():
    offer, estimators = brought_to_life("sensors", patience=0.5)
    told(estimators, reading(lidar=scan([1.0, 1.0, 1.0, 1.0])))
    told(estimators, reading(0.5, lidar=scan([math.nan] * 4, stamp=0.5)))
    assert not offer.percepts["lidar-is-lost"]()
    told(estimators, reading(0.6, lidar=scan([math.nan] * 4, stamp=0.6)))
    assert offer.percepts["lidar-is-lost"]() and offer.percepts["lidar-range-ahead"]() == 1.0


def test_other_sensors_are_told_and_what_is_not_sound_is_left_out():
    offer, estimators = brought_to_life("sensors")
    sound = reading(
        compass=Compass(0.0, True, 1.0),
        inclination=Inclination(0.0, True, 0.1, -0.2),
        currents=Currents(0.0, True, 2.0, 5.0),
        bumper=Bumper(0.0, True, np.zeros(2), np.array([False, True])),
    )
    told(estimators, sound, reading(0.1, compass=Compass(0.1, True, math.nan)))
    says = {name: percept() for name, percept in offer.percepts.items()}
    assert (says["compass-heading"], says["pitch"], says["roll"], says["motor-current"]) == (1.0, 0.1, -0.2, 5.0)
    assert says["turn-rate"] == 0.3 and says["bumped"] is False


def test_a_robot_without_these_sensors_has_sound_percepts_all_the_same():
    offer, estimators = brought_to_life("sensors")
    told(estimators, reading())
    assert all(math.isfinite(percept()) for percept in offer.percepts.values())


@pytest.mark.parametrize(
    ("name", "drive"),
    [
        ("drive-ahead", Drive(0.3, 0.0)),
        ("back-up", Drive(-0.3, 0.0)),
        ("turn-left", Drive(0.0, 0.4)),
        ("turn-right", Drive(0.0, -0.4)),
    ],
)
def test_steady_motion_is_what_its_name_says(name, drive):
    offer, _ = brought_to_life("drive", speed=0.3, **{"turn-rate": 0.4})
    competence = offer.competences[name]
    competence.start(reading(), {})
    command, _ = competence.step(reading(), {})
    competence.stop()
    assert command.drive == drive
