"""When it is time to listen, and where to drive for it."""

import math

import pytest

from behaviours.estimators.beacons import Beacons, BeaconSettings
from behaviours.estimators.donor import DonorMemory, DonorSettings
from behaviours.estimators.ir_search import CONTINUE, START, IrSearch, IrSettings
from behaviours.estimators.navigation import ArrivalSettings, NavigationGoal
from behaviours.estimators.roaming import Roaming, RoamingSettings
from behaviours.estimators.stereo_search import StereoSearch, StereoSettings
from behaviours.interface import IrReading, Odometry, Pose, Reading, Report


class Walk:
    """A robot that is put wherever the test wants it."""

    def __init__(self, **settings):
        self.ir = IrSearch(IrSettings(roam=True))
        self.beacons = Beacons(BeaconSettings())
        stereo, goal = StereoSearch(StereoSettings(), lambda: None), NavigationGoal(ArrivalSettings())
        self.donor = DonorMemory(DonorSettings(several=True), self.ir, stereo, goal)
        self.roaming = Roaming(RoamingSettings(**settings), self.ir, self.donor, self.beacons)
        self.stamp = 0.0

    def tick(self, pose=None, ir=None, report=None, seconds=0.1):
        self.stamp += seconds
        reading = Reading(self.stamp, 0, Odometry(pose or Pose(0.0, 0.0), 0.0, 0.0), ir=ir)
        reports = {} if report is None else {report: Report()}
        for estimator in (self.ir, self.donor, self.beacons, self.roaming):
            estimator.update(reading, reports, {})

    def fail(self, pose=None):
        """A search that hears nothing."""
        self.tick(pose, report=START)
        self.ir.phase = "done"
        self.tick(pose)


def heard(at, pan=0.0, strength=4.0, name="ann"):
    return IrReading(0.0, True, pan, True, at, strength, name)


def test_it_listens_first_where_it_stands():
    walk = Walk()
    walk.tick()
    assert walk.roaming.is_due and walk.roaming.place is None


def test_while_a_search_goes_on_there_is_no_place_to_go():
    walk = Walk()
    walk.tick(report=START)
    walk.tick(report=CONTINUE)
    assert not walk.roaming.is_due and walk.roaming.place is None


def test_a_search_that_was_interrupted_is_due_again():
    walk = Walk()
    walk.tick(report=START)
    walk.tick()
    assert walk.roaming.is_due


@pytest.mark.parametrize("spiral", [False, True])
def test_after_a_search_in_vain_it_goes_elsewhere_and_listens_there(spiral):
    walk = Walk(spiral=spiral)
    walk.fail()
    place = walk.roaming.place
    assert not walk.roaming.is_due and math.hypot(place.x, place.y) > 1.5
    walk.tick(Pose(place.x / 2, place.y / 2))
    assert not walk.roaming.is_due
    walk.tick(Pose(place.x, place.y - 0.3))
    assert walk.roaming.is_due


def test_a_beacon_that_was_heard_is_approached_to_four_metres():
    walk = Walk()
    walk.tick(ir=heard(0.0, strength=3.4))
    walk.fail()
    found, place = walk.beacons.estimate("ann"), walk.roaming.place
    assert math.hypot(found.x - place.x, found.y - place.y) == pytest.approx(4.0)
    assert abs(place.theta) < 0.1, "looking at it"


def test_a_beacon_heard_near_on_the_way_is_worth_a_stop_and_a_served_one_is_not():
    for served, due in ((0, True), (1, False)):
        walk = Walk()
        walk.fail()
        walk.donor.served["ann"] = served
        walk.tick(Pose(2.0, 0.0), ir=heard(0.3, strength=6.0))
        assert walk.roaming.is_due == due


def test_a_place_that_cannot_be_reached_is_given_up_and_avoided():
    walk = Walk(stalled=45.0)
    walk.fail()
    place = walk.roaming.place
    walk.tick(seconds=30.0)
    walk.tick(seconds=30.0)
    assert not walk.roaming.is_due
    walk.tick(seconds=30.0)
    assert walk.roaming.is_due
    walk.fail()
    after = walk.roaming.place
    assert math.hypot(after.x - place.x, after.y - place.y) > 2.5


def test_a_spiral_that_came_to_its_end_begins_anew():
    walk = Walk(spiral=True)
    walk.fail()
    for _ in range(40):
        place = walk.roaming.place
        if place is None:
            break
        walk.fail(place)
    assert place is None and walk.roaming.is_due
