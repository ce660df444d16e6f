"""Holding a place against being pushed, and freeing a head that is stuck."""

import math

import pytest

from behaviours.competences.keep_station import KeepStation, StationSettings
from behaviours.competences.un_stick import UnStick, UnStickSettings
from behaviours.estimators.head import HeadWatch
from behaviours.interface import HeadState, Odometry, Pose, Reading, wrap


def reading(stamp=0.0, pose=None, head=None):
    return Reading(stamp, 0, Odometry(pose or Pose(0.0, 0.0), 0.0, 0.0), head=head)


def hold(pushed, seconds=20.0):
    """Where the robot is some time after it was pushed from the origin."""
    station = KeepStation(StationSettings())
    station.start(reading(), {})
    pose = pushed
    for _ in range(int(seconds * 10)):
        drive = station.step(reading(pose=pose), {})[0].drive
        theta = wrap(pose.theta + 0.1 * drive.turn_rate)
        step = 0.1 * drive.speed
        pose = Pose(pose.x + step * math.cos(theta), pose.y + step * math.sin(theta), theta)
    return pose


@pytest.mark.parametrize("pushed", [Pose(0.5, 0.0), Pose(-0.5, 0.0), Pose(0.0, 0.6), Pose(0.3, -0.4, 1.0)])
def test_a_robot_that_was_pushed_comes_back_to_its_place_and_heading(pushed):
    pose = hold(pushed)
    assert math.hypot(pose.x, pose.y) <= 0.05
    assert abs(pose.theta) <= math.radians(3.1)


def test_it_backs_up_to_a_place_behind_it():
    station = KeepStation(StationSettings())
    station.start(reading(), {})
    drive = station.step(reading(pose=Pose(0.5, 0.0)), {})[0].drive
    assert drive.speed < 0.0 and drive.turn_rate == pytest.approx(0.0)


def test_a_push_that_is_slight_is_not_answered():
    assert hold(Pose(0.04, 0.0)) == Pose(0.04, 0.0)


def test_the_place_is_that_of_the_last_start():
    station = KeepStation(StationSettings())
    station.start(reading(), {})
    station.stop()
    station.start(reading(pose=Pose(2.0, 1.0)), {})
    assert station.step(reading(pose=Pose(2.0, 1.0)), {})[0].drive.speed == 0.0


def test_the_head_is_freed_in_three_steps_of_which_the_last_asks_a_person():
    free = UnStick(UnStickSettings(tilting=2.0, homing=4.0))
    free.start(reading(10.0, head=HeadState(0.7, 0.6, False)), {})
    told = []
    for stamp in (10.0, 11.9, 12.0, 15.9, 16.0, 90.0):
        command, report = free.step(reading(stamp), {})
        assert command.drive.speed == 0.0
        told.append((command.head.pan, command.head.tilt, report.details["level"], "asks" in report.details))
    light, bad, worst = (0.7, 0.0, 1, False), (0.0, 0.0, 2, False), (0.0, 0.0, 3, True)
    assert told == [light, light, bad, bad, worst, worst]


def test_a_head_that_does_not_settle_is_stuck_until_it_does():
    watch = HeadWatch(8.0)
    seen = []
    for stamp, settled in ((0.0, True), (1.0, False), (8.0, False), (8.1, False), (20.0, False), (20.1, True)):
        watch.update(reading(stamp, head=HeadState(0.0, 0.5, settled)), {}, {})
        seen.append(watch.is_stuck)
    assert seen == [False, False, False, True, True, False]
