"""Drives do what their kind can do: limits, ramps, and what the hull makes of it."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

from behaviours.interface import Drive
from sim.robots.build import Ackermann, Differential, DriveBuild, SkidSteer, Synchro
from sim.robots.drives import REST, Motion, aside, hull, ramped, reachable, unwound, wheels

DT = 0.02
DRIVES = [Synchro(), Differential(), SkidSteer(), Ackermann(), Differential(2.0, 4.0, 3.0, 8.0, 0.376)]


def driven(drive: DriveBuild, seed: int, steps: int = 4000) -> list[Motion]:
    """Motions under commands drawn at random, some of them far beyond the drive."""
    chance, motions = np.random.default_rng(seed), [REST]
    for step in range(steps):
        if step % 17 == 0:
            wanted = Drive(*chance.normal(0, 2 * drive.max_speed, 2)) if chance.random() < 0.8 else Drive(0.0, 0.0)
        goal = reachable(drive, wanted, motions[-1])
        motions.append(ramped(drive, motions[-1], goal, DT))
    return motions


@pytest.mark.parametrize("drive", DRIVES, ids=lambda drive: type(drive).__name__)
def test_no_command_makes_a_drive_faster_than_it_can(drive):
    for motion in driven(drive, 1):
        assert abs(motion.speed) <= drive.max_speed + 1e-9


@pytest.mark.parametrize("drive", DRIVES, ids=lambda drive: type(drive).__name__)
def test_no_command_makes_a_drive_accelerate_more_than_it_can(drive):
    for before, after in pairwise(driven(drive, 2)):
        assert abs(after.speed - before.speed) <= drive.acceleration * DT + 1e-9


@pytest.mark.parametrize("drive", [d for d in DRIVES if not isinstance(d, Ackermann)], ids=lambda d: type(d).__name__)
def test_turning_keeps_its_limits_too(drive):
    for before, after in pairwise(driven(drive, 3)):
        assert abs(after.turn_rate) <= drive.max_turn_rate + 1e-9
        assert abs(after.turn_rate - before.turn_rate) <= drive.turn_acceleration * DT + 1e-9


@pytest.mark.parametrize("drive", [d for d in DRIVES if isinstance(d, Differential | SkidSteer)], ids=repr)
def test_no_wheel_ever_turns_too_fast_even_between_two_commands(drive):
    for motion in driven(drive, 4):
        assert abs(motion.speed) + abs(motion.turn_rate) * drive.track / 2 <= drive.max_speed + 1e-9


@pytest.mark.parametrize("wanted", [Drive(3.0, 1.0), Drive(0.4, 3.0), Drive(-2.0, 0.5), Drive(0.1, -30.0)])
@pytest.mark.parametrize("drive", [Differential(), SkidSteer()])
def test_two_wheels_scale_a_command_down_and_keep_its_curvature(drive, wanted):
    goal = reachable(drive, wanted, REST)
    assert abs(goal.speed) < abs(wanted.speed)
    assert goal.turn_rate / goal.speed == pytest.approx(wanted.turn_rate / wanted.speed)


@pytest.mark.parametrize("drive", DRIVES, ids=lambda drive: type(drive).__name__)
def test_a_command_within_reach_is_reached_exactly(drive):
    motion, wanted = REST, Drive(0.1, 0.02)
    for _ in range(200):
        motion = ramped(drive, motion, reachable(drive, wanted, motion), DT)
    assert (motion.speed, motion.turn_rate) == pytest.approx((0.1, 0.02))
    assert ramped(drive, motion, reachable(drive, wanted, motion), DT) == motion


# --- steered wheels -------------------------------------------------------------------------------


def test_steering_keeps_its_limit_and_its_rate():
    drive = Ackermann()
    for before, after in pairwise(driven(drive, 5)):
        assert abs(after.steering) <= drive.max_steering
        assert abs(after.steering - before.steering) <= drive.steering_rate * DT + 1e-9


def test_no_command_makes_a_steered_robot_turn_tighter_than_its_wheelbase_allows():
    drive = Ackermann()
    tightest = drive.wheelbase / math.tan(drive.max_steering)
    for motion in driven(drive, 6):
        assert abs(motion.turn_rate) * tightest <= abs(motion.speed) + 1e-9


def test_a_steered_robot_that_stands_turns_its_wheels_and_not_itself():
    drive, motion = Ackermann(), REST
    for _ in range(100):
        motion = ramped(drive, motion, reachable(drive, Drive(0.0, 1.0), motion), DT)
    assert motion == Motion(0.0, 0.0, drive.max_steering)


def test_a_steered_robot_that_is_told_to_stop_leaves_its_wheels_as_they_are():
    drive = Ackermann()
    now = Motion(0.5, 0.1, 0.2)
    assert reachable(drive, Drive(0.0, 0.0), now) == Motion(0.0, 0.0, 0.2)


@pytest.mark.parametrize(("speed", "turn_rate"), [(0.5, 0.1), (-0.5, 0.1), (0.5, -0.1), (-0.5, -0.1), (5.0, 0.1)])
def test_a_steered_robot_drives_the_curvature_it_is_asked_for(speed, turn_rate):
    drive = Ackermann()
    goal = reachable(drive, Drive(speed, turn_rate), REST)
    assert goal.turn_rate / goal.speed == pytest.approx(turn_rate / speed)


def test_its_middle_goes_along_heading_and_half_the_tangent_of_the_steering():
    drive = Ackermann()
    goal = reachable(drive, Drive(0.5, 0.1), REST)
    twist = hull(drive, goal, 0.0)
    assert math.atan2(twist.aside, twist.forward) == pytest.approx(math.atan(math.tan(goal.steering) / 2))
    assert aside(drive, twist.turn) == twist.aside


# --- tracks ---------------------------------------------------------------------------------------


def test_a_skid_steered_hull_turns_less_than_its_tracks_by_the_slip():
    drive = SkidSteer(slip=1.3)
    twist = hull(drive, Motion(0.2, 0.65), 0.0)
    assert (twist.forward, twist.turn) == pytest.approx((0.2, 0.5))
    assert wheels(drive, twist.forward, twist.turn) == Drive(pytest.approx(0.2), pytest.approx(0.65))


def test_wheels_turn_as_their_hull_does():
    assert wheels(Differential(), 0.2, 0.5) == Drive(0.2, 0.5)


@pytest.mark.parametrize(
    ("speed", "pitch", "left"), [(0.4, 0.2, 0.9), (0.4, -0.2, 1.0), (-0.4, -0.2, 0.9), (-0.4, 0.2, 1.0), (0.4, 9, 0.0)]
)
def test_tracks_lose_speed_uphill_whichever_way_they_go(speed, pitch, left):
    assert hull(SkidSteer(slope_speed_loss=0.5), Motion(speed, 0.0), pitch).forward == pytest.approx(speed * left)


# --- braking --------------------------------------------------------------------------------------


def test_braking_starts_from_what_was_made_of_the_motion():
    assert unwound(Motion(0.5, 1.0), REST, 0.4, 0.1) == Motion(pytest.approx(0.2), pytest.approx(0.1))
    assert unwound(Motion(0.5, 1.0), Motion(-0.5, -1.0), 0.0, 0.0) == REST


def test_braking_does_not_fall_below_what_is_still_wanted():
    assert unwound(Motion(0.5, 0.0), Motion(0.3, 0.0), 0.1, 1.0).speed == 0.3


def test_who_does_not_brake_keeps_pushing():
    assert unwound(Motion(0.3, 0.2), Motion(0.5, 0.4), 0.0, 0.0) == Motion(0.3, 0.2)
