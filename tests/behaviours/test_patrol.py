"""The round of the library `patrol`, and its charger."""

from __future__ import annotations

import math

import pytest

from behaviours.catalogue import library
from behaviours.interface import Battery, Odometry, Pose, Reading, Workshop


def patrol(**values: float):
    workshop = Workshop()
    offer = library("patrol").build(values, workshop)

    def at(x: float, y: float, theta: float = 0.0, battery: Battery | None = None) -> None:
        reading = Reading(0.0, 0, Odometry(Pose(x, y, theta), 0.0, 0.0), battery=battery)
        for estimator in workshop.estimators:
            estimator.update(reading, {}, {})

    return offer, at


def test_the_places_follow_one_another_and_rounds_are_counted():
    offer, at = patrol(length=2.0, width=1.0)
    seen = []
    for place in [(0, 0), (2, 0), (2, 1), (0, 1), (0, 0)]:
        at(*map(float, place))
        seen.append(offer.values["the-next-place"]({}))
    assert [(pose.x, pose.y) for pose in seen] == [(2, 0), (2, 1), (0, 1), (0, 0), (2, 0)]
    assert offer.percepts["rounds-made"]() == 1.0


def test_the_round_lies_ahead_of_where_the_robot_started():
    offer, at = patrol(length=2.0)
    at(1.0, 1.0, math.pi / 2)
    place = offer.values["the-next-place"]({})
    assert (place.x, place.y) == pytest.approx((1.0, 3.0))


def test_the_charger_is_where_the_plan_says():
    offer, at = patrol(**{"charger-x": 1.0, "charger-y": -2.0})
    at(0.0, 0.0)
    assert offer.values["the-charger"]({}) == Pose(1.0, -2.0, 0.0)


def test_the_battery_is_told_and_full_where_there_is_none():
    offer, at = patrol()
    at(0.0, 0.0)
    assert offer.percepts["battery-level"]() == 1.0 and not offer.percepts["the-battery-is-charged"]()
    at(0.0, 0.0, battery=Battery(0.0, True, 0.3, True))
    assert offer.percepts["battery-level"]() == 0.3 and offer.percepts["the-battery-is-charged"]()


def test_a_round_of_no_length_is_refused():
    with pytest.raises(ValueError, match="greater than 0"):
        patrol(length=0.0)
