"""What faults make of readings, sensor by sensor, and for how long."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from behaviours.interface import Currents, Drive, FlipperState, HeadState, Pose, Reading, Sensed
from sim.raycast import Circle, Scene, box
from sim.robots.build import Build
from sim.sensors.build import (
    BumperBuild,
    CompassBuild,
    CurrentBuild,
    Fault,
    GpsBuild,
    ImuBuild,
    InclinometerBuild,
    InfraredBuild,
    Installed,
    LidarBuild,
    OdometryBuild,
    SonarBuild,
    StereoBuild,
)
from sim.sensors.suite import Suite
from sim.sensors.truth import Beacon, Truth
from sim.sensors.weather import Weather
from sim.things.ground import Ground, Slope

ROOM = Scene([Circle(0.25), box(1, 9)], [Pose(5, 0), Pose(-2.5, 0)], [0.9, 2.0])

KINDS: dict[str, tuple[Any, tuple[str, ...]]] = {
    "sonar": (SonarBuild(0.0, 0.0), ("sonar", "skirt")),
    "lidar": (LidarBuild(beams=16, sd=0.0), ("lidar",)),
    "infrared": (InfraredBuild(0.1, 0.0, 0.0), ("ir",)),
    "stereo": (StereoBuild(0.1, 1.2, 0.0, 0.0), ("stereo",)),
    "odometry": (OdometryBuild(0.0, 0.0), ("odometry",)),
    "compass": (CompassBuild(0.0, 0.0), ("compass",)),
    "imu": (ImuBuild(0.0, 0.0, 0.0), ("imu",)),
    "inclinometer": (InclinometerBuild(0.0), ("inclination",)),
    "gps": (GpsBuild(0.0, 0.0), ("gps",)),
    "currents": (CurrentBuild(0.0, 0.0), ("currents",)),
    "bumper": (BumperBuild(), ("bumper",)),
}
"""Kind -> a build without noise, and the fields that it fills."""
FIELDS = [(kind, field) for kind, (_, fields) in KINDS.items() for field in fields]
NUMBERS = [(kind, field) for kind, field in FIELDS if kind != "bumper"]


def at(tick: int) -> Truth:
    """A robot that creeps and turns in the room."""
    time = tick / 10
    return Truth(
        tick=tick,
        time=time,
        dt=0.1,
        pose=Pose(0.01 * tick, 0.0, 0.002 * tick),
        speed=0.1,
        turn_rate=0.02 + 0.001 * tick,
        acceleration=(0.1 * tick, 0.0),
        wheels=Drive(0.1, 0.02),
        aside=0.0,
        still_for=time,
        head=HeadState(0.0, 0.1, True),
        head_still_for=time,
        load=Currents(0.0, True, 1.0 + 0.1 * tick, 2.0),
        flippers=FlipperState(0.0, False),
        touched=(0.3 * tick,),
        beacons=(Beacon("donor", (5.0, 0.0), 0),),
        battery=None,
        weather=Weather(),
        ground=Ground((Slope((-9, -9, 9, 9), 0.1, 0.0),)),
        scene=lambda: ROOM,
    )


def run(kind: str, *faults: Fault, ticks: int = 30, **installed: Any) -> list[Reading]:
    """Readings of a robot with one sensor of this kind, which measures each tick."""
    robot = Suite((replace(sensor(kind), **installed),), faults, Build(), Pose(0, 0), 3)
    read = [robot.sense(at(0), False)]
    for tick in range(1, ticks):
        robot.update(at(tick))
        read.append(robot.sense(at(tick), False))
    return read


def sensor(kind: str) -> Installed:
    return Installed(kind, KINDS[kind][0], period=0.1)


def told(sensed: Sensed) -> str:
    with np.printoptions(precision=17, threshold=10**6):
        return repr(sensed)


# --- dropout --------------------------------------------------------------------------------------


@pytest.mark.parametrize(("kind", "field"), FIELDS)
def test_what_drops_out_does_not_arrive_and_the_last_is_repeated(kind, field):
    sound, faulty = run(kind), run(kind, Fault(kind, "dropout", 1.0, 2.0))
    last = getattr(sound[9], field)
    for tick, (true, said) in enumerate(zip(sound, faulty, strict=True)):
        if 10 <= tick < 20:
            assert told(getattr(said, field)) == told(replace(last, fresh=False))
        else:
            assert told(getattr(said, field)) == told(getattr(true, field))


def test_readings_drop_out_with_the_chance_that_is_asked_for():
    fresh = [r.imu is not None and r.imu.fresh for r in run("imu", Fault("imu", "dropout", amount=0.3), ticks=2000)]
    assert 1 - np.mean(fresh) == pytest.approx(0.3, abs=0.04)


def test_a_sensor_that_never_arrives_says_what_it_says_before_its_first_reading():
    assert run("compass", Fault("compass", "dropout"))[-1].compass is None
    odometry = run("odometry", Fault("odometry", "dropout"))[-1].odometry
    assert (odometry.pose, odometry.fresh, odometry.stamp) == (Pose(0, 0, 0), False, 0.0)
    sonar = run("sonar", Fault("sonar", "dropout"))[-1].sonar
    assert sonar is not None and not sonar.fresh and (sonar.ranges == 5.0).all()


# --- stuck ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(("kind", "field"), FIELDS)
def test_what_is_stuck_repeats_what_was_measured_last_with_new_stamps(kind, field):
    sound, faulty = run(kind), run(kind, Fault(kind, "stuck", 1.0, 2.0))
    last = getattr(sound[9], field)
    for tick, (true, said) in enumerate(zip(sound, faulty, strict=True)):
        expected = replace(last, stamp=tick / 10, fresh=True) if 10 <= tick < 20 else getattr(true, field)
        assert told(getattr(said, field)) == told(expected)
    assert told(getattr(sound[19], field)) != told(replace(last, stamp=1.9))


def test_what_is_stuck_from_the_start_repeats_its_first_reading():
    headings = [r.compass.heading for r in run("compass", Fault("compass", "stuck")) if r.compass]
    assert headings == [0.0] * 30


# --- bias -----------------------------------------------------------------------------------------

SHIFTED: dict[str, Callable[[Any], list[float]]] = {
    "sonar": lambda r: [x for x in r.ranges if x < 4.9],
    "skirt": lambda r: [x for x in r.ranges if x < 4.9],
    "lidar": lambda r: [x for x in r.ranges if x < 9],
    "ir": lambda r: [r.offset],
    "stereo": lambda r: [r.range],
    "odometry": lambda r: [r.pose.theta],
    "compass": lambda r: [r.heading],
    "imu": lambda r: [r.turn_rate],
    "inclination": lambda r: [r.pitch, r.roll],
    "gps": lambda r: [r.x, r.y],
    "currents": lambda r: [r.left, r.right],
}
"""Field -> the numbers that a bias is added to."""


@pytest.mark.parametrize(("kind", "field"), NUMBERS)
def test_a_bias_is_added_to_what_the_reading_is_about(kind, field):
    sound, faulty = run(kind), run(kind, Fault(kind, "bias", 1.0, 2.0, 0.25))
    for tick, (true, said) in enumerate(zip(sound, faulty, strict=True)):
        numbers, off = SHIFTED[field](getattr(true, field)) if getattr(true, field) else [], 10 <= tick < 20
        if off:
            assert numbers and not any(map(math.isnan, numbers))
            assert SHIFTED[field](getattr(said, field)) == pytest.approx([number + 0.25 for number in numbers])
        else:
            assert told(getattr(said, field)) == told(getattr(true, field))


def test_a_bias_adds_nothing_where_nothing_was_met_and_stays_within_the_limits():
    far, near = (run("lidar", Fault("lidar", "bias", amount=amount))[0].lidar for amount in (20.0, -20.0))
    met = run("lidar")[0].lidar.ranges < 10.0
    assert 0 < met.sum() < 16
    assert (far.ranges == 10.0).all()
    assert (near.ranges[met] == 0.05).all() and (near.ranges[~met] == 10.0).all()


def test_biased_angles_stay_within_half_a_turn():
    heading = run("compass", Fault("compass", "bias", amount=4.0))[0].compass.heading
    assert heading == pytest.approx(4.0 - math.tau)


# --- nan ------------------------------------------------------------------------------------------

BLANK: dict[str, Callable[[Any], list[float]]] = SHIFTED | {
    "sonar": lambda r: list(r.ranges),
    "skirt": lambda r: list(r.ranges),
    "lidar": lambda r: list(r.ranges),
    "ir": lambda r: [r.offset, r.strength],
    "odometry": lambda r: [r.pose.x, r.pose.y, r.pose.theta, r.speed, r.turn_rate],
    "imu": lambda r: [r.turn_rate, *r.acceleration],
}
"""Field -> the numbers that are NaN."""


@pytest.mark.parametrize(("kind", "field"), NUMBERS)
def test_numbers_are_nan_for_as_long_as_the_fault_lasts(kind, field):
    sound, faulty = run(kind), run(kind, Fault(kind, "nan", 1.0, 2.0))
    for tick, (true, said) in enumerate(zip(sound, faulty, strict=True)):
        if 10 <= tick < 20:
            reading = getattr(said, field)
            assert all(map(math.isnan, BLANK[field](reading)))
            assert (reading.stamp, reading.fresh) == (tick / 10, True)
        else:
            assert told(getattr(said, field)) == told(getattr(true, field))


def test_a_blank_beacon_reader_hears_nothing():
    assert run("infrared")[5].ir.detected
    assert not run("infrared", Fault("infrared", "nan"))[5].ir.detected


# --- together -------------------------------------------------------------------------------------


def test_faults_of_one_sensor_act_in_their_order():
    both = Fault("compass", "stuck", 1.0), Fault("compass", "bias", 1.0, amount=0.5)
    assert run("compass", *both)[20].compass.heading == pytest.approx(0.002 * 9 + 0.5)
    lost = Fault("compass", "dropout", 2.0, amount=1.0)
    assert run("compass", lost, *both)[25].compass.stamp == pytest.approx(1.9)


def test_a_fault_acts_on_what_is_measured_while_it_lasts_and_arrives_as_late_as_ever():
    read = run("compass", Fault("compass", "nan", 1.0, 1.2), latency=0.3)
    assert [r.tick for r in read if r.compass and math.isnan(r.compass.heading)] == [13, 14]


def test_a_fault_begins_and_ends_with_its_tick_whatever_the_rounding_of_time():
    fault = Fault("compass", "nan", 0.3, 0.6)
    late, early = (1 + 1e-12, 1 - 1e-12)
    for rounding in (late, early):
        robot = Suite((sensor("compass"),), (fault,), Build(), Pose(0, 0), 3)
        read = [robot.sense(replace(at(tick), time=tick / 10 * rounding), False) for tick in range(9)]
        assert [r.tick for r in read if r.compass and math.isnan(r.compass.heading)] == [3, 4, 5]


def test_a_fault_of_one_sensor_disturbs_no_other():
    pair = Installed("a", ImuBuild()), Installed("b", ImuBuild())
    sound, faulty = (
        Suite(pair, faults, Build(), Pose(0, 0), 3).sense(at(0), False)
        for faults in ((), (Fault("a", "dropout", amount=0.5), Fault("a", "nan")))
    )
    assert sound.others["b"] == faulty.others["b"]


def test_noise_goes_on_behind_a_fault_so_that_afterwards_all_is_as_without():
    noisy = {"build": ImuBuild()}
    sound, faulty = run("imu", **noisy), run("imu", Fault("imu", "dropout", 0.5, 1.0, 0.5), **noisy)
    assert sound[10:] == faulty[10:] and sound != faulty


@pytest.mark.parametrize(
    ("fault", "message"),
    [
        (Fault("lidar", "nan"), "the robot has no sensor 'lidar'; it has bumper, compass"),
        (Fault("compass", "late"), "there is no fault 'late'; there are dropout, stuck, bias, nan"),
        (Fault("bumper", "bias"), "'bumper' is a bumper, which has no numbers; it can have dropout and stuck"),
        (Fault("bumper", "nan"), "'bumper' is a bumper, which has no numbers; it can have dropout and stuck"),
        (Fault("compass", "dropout", amount=1.5), "the amount of a dropout is a chance from 0 to 1, got 1.5"),
    ],
)
def test_a_fault_that_cannot_be_is_an_error(fault, message):
    with pytest.raises(ValueError, match=message):
        Suite((sensor("bumper"), sensor("compass")), (fault,), Build(), Pose(0, 0), 0)
