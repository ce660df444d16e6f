"""A suite of sensors: each kind as exact as it promises, at its rate, after its latency, undisturbed by the others."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from behaviours.interface import (
    Command,
    Currents,
    Drive,
    FlipperState,
    HeadState,
    Inclination,
    Pose,
    Ranges,
    Reading,
    Scan,
    Sensed,
)
from sim.noise import chance, named_chance, sensor_chance
from sim.raycast import Circle, Rays, Scene, box, cast
from sim.robots.build import Build, SkidSteer
from sim.scenarios.format import loads
from sim.sensors.build import (
    BumperBuild,
    CompassBuild,
    CurrentBuild,
    GpsBuild,
    ImuBuild,
    InclinometerBuild,
    InfraredBuild,
    Installed,
    LidarBuild,
    Mount,
    OdometryBuild,
    SonarBuild,
    StereoBuild,
)
from sim.sensors.compass import MagneticCompass
from sim.sensors.lidar import beam_bearings
from sim.sensors.suite import Suite
from sim.sensors.truth import Truth
from sim.sensors.weather import Weather
from sim.things.ground import Ground, Slope
from sim.world import World

ORIGIN = Pose(0.0, 0.0)
NOTHING = Scene([], [], [])
ROOM = Scene(
    [box(0.2, 8), box(0.2, 8), box(8, 0.2), box(8, 0.2), Circle(0.3), box(0.5, 1.0)],
    [Pose(4, 0), Pose(-4, 0), Pose(0, 4), Pose(0, -4), Pose(1.5, 1.0), Pose(-2.0, -1.0, 0.7)],
    [2.0] * 6,
)
CENTRE = Mount()
EXACT = LidarBuild(sd=0.0)


def at(tick: int = 0, scene: Scene = NOTHING, pose: Pose = ORIGIN, dt: float = 0.1, **more: Any) -> Truth:
    """What is so at this tick; the robot stands still unless `more` says otherwise."""
    time = tick * dt
    standing = Truth(
        tick=tick,
        time=time,
        dt=dt,
        pose=pose,
        speed=0.0,
        turn_rate=0.0,
        acceleration=(0.0, 0.0),
        wheels=Drive(0.0, 0.0),
        aside=0.0,
        still_for=time,
        head=HeadState(0.0, 0.4, True),
        head_still_for=time,
        load=Currents(0.0, True, 0.0, 0.0),
        flippers=FlipperState(0.0, False),
        touched=(),
        beacons=(),
        battery=None,
        weather=Weather(),
        ground=Ground(),
        scene=lambda: scene,
    )
    return replace(standing, **more)


def suite(*installed: Installed, seed: int = 1) -> Suite:
    return Suite(installed, (), Build(), ORIGIN, seed)


def readings(suite: Suite, ticks: int, first: int = 0, **truth: Any) -> list[Reading]:
    """Of a robot that stands still."""
    read = []
    for tick in range(first, first + ticks):
        now = at(tick, **truth)
        if tick:
            suite.update(now)
        read.append(suite.sense(now, False))
    return read


def samples(build: Any, field: str, count: int, mount: Mount = CENTRE, **truth: Any) -> list[Any]:
    """So many readings of one sensor that measures each tick."""
    sensor = Installed("one", build, mount, period=0.1)
    return [getattr(reading, field) for reading in readings(suite(sensor), count, **truth)]


# --- when -----------------------------------------------------------------------------------------

KINDS = {
    "sonar": (SonarBuild(), ("sonar", "skirt"), 3),
    "lidar": (LidarBuild(beams=8), ("lidar",), 1),
    "odometry": (OdometryBuild(), ("odometry",), 1),
    "compass": (CompassBuild(), ("compass",), 1),
    "imu": (ImuBuild(), ("imu",), 1),
    "inclinometer": (InclinometerBuild(), ("inclination",), 1),
    "gps": (GpsBuild(), ("gps",), 10),
    "currents": (CurrentBuild(), ("currents",), 1),
    "bumper": (BumperBuild(), ("bumper",), 1),
}
"""Kind -> build, fields, every how many ticks of 0.1 s it measures by itself."""
SEEN_AT_ONCE = ("sonar", "skirt", "odometry", "ir", "stereo")


def fresh_ticks(read: list[Reading], field: str) -> list[int]:
    return [r.tick for r in read if getattr(r, field) is not None and getattr(r, field).fresh]


def stamps(read: list[Reading], field: str) -> list[float]:
    return [getattr(r, field).stamp for r in read if getattr(r, field) is not None]


@pytest.mark.parametrize("kind", KINDS)
def test_a_sensor_measures_at_the_rate_of_its_kind(kind):
    build, fields, every = KINDS[kind]
    read = readings(suite(Installed(kind, build)), 31)
    for field in fields:
        assert fresh_ticks(read, field) == list(range(0, 31, every))
        assert stamps(read, field) == pytest.approx([(tick - tick % every) / 10 for tick in range(31)])


@pytest.mark.parametrize("kind", KINDS)
def test_a_sensor_measures_at_the_rate_that_it_is_given(kind):
    build, fields, _ = KINDS[kind]
    for field in fields:
        read = readings(suite(Installed(kind, build, period=0.5)), 31)
        assert fresh_ticks(read, field) == [0, 5, 10, 15, 20, 25, 30]


@pytest.mark.parametrize("kind", KINDS)
def test_a_reading_arrives_after_its_latency_with_the_stamp_of_its_measuring(kind):
    build, fields, _ = KINDS[kind]
    read = readings(suite(Installed(kind, build, period=0.4, latency=0.25)), 16)
    for field in fields:
        assert fresh_ticks(read, field) == [3, 7, 11, 15]
        assert stamps(read[3:], field) == pytest.approx([0.0] * 4 + [0.4] * 4 + [0.8] * 4 + [1.2])
        early = [getattr(reading, field) for reading in read[:3]]
        assert all((e is not None and not e.fresh) if field in SEEN_AT_ONCE else e is None for e in early)


def test_several_readings_are_under_way_when_latency_is_longer_than_the_period():
    read = readings(suite(Installed("imu", ImuBuild(), latency=0.3)), 10)
    assert fresh_ticks(read, "imu") == [3, 4, 5, 6, 7, 8, 9]
    assert stamps(read[3:], "imu") == pytest.approx([0.1 * n for n in range(7)])


def test_who_asks_seldom_gets_the_newest_that_has_arrived():
    robot = suite(Installed("imu", ImuBuild(), latency=0.3))
    seen = [robot.sense(at(tick), False).imu for tick in (0, 1, 2, 8, 9)]
    assert seen[:3] == [None] * 3
    assert (seen[3].stamp, seen[4].fresh) == (pytest.approx(0.2), False)


def test_what_is_late_is_what_was_so_when_it_was_measured():
    robot = suite(Installed("compass", CompassBuild(0.0, 0.0), latency=0.2))
    seen = [robot.sense(at(tick, pose=Pose(0, 0, 0.1 * tick)), False).compass for tick in range(6)]
    assert [compass.heading for compass in seen if compass] == pytest.approx([0.0, 0.1, 0.2, 0.3])


@pytest.mark.parametrize(
    ("dt", "period", "ticks"), [(0.1, 0.028, 1), (0.02, 0.028, 1), (0.014, 0.028, 2), (0.05, 0.12, 2), (0.1, 0.3, 3)]
)
def test_periods_are_rounded_to_whole_ticks_and_to_one_at_least(dt, period, ticks):
    read = readings(suite(Installed("imu", ImuBuild(), period=period)), 13, dt=dt)
    assert fresh_ticks(read, "imu") == list(range(0, 13, ticks))


def test_between_arrivals_the_last_reading_is_repeated_itself():
    read = readings(suite(Installed("lidar", LidarBuild(), period=0.4)), 8, scene=ROOM)
    assert read[1].lidar is read[2].lidar is read[3].lidar
    assert read[1].lidar.ranges is read[0].lidar.ranges
    assert (read[0].lidar.fresh, read[1].lidar.fresh, read[4].lidar.fresh) == (True, False, True)


@pytest.mark.parametrize(
    ("kind", "build", "field"), [("infrared", InfraredBuild(), "ir"), ("stereo", StereoBuild(1.0), "stereo")]
)
def test_fixations_wait_for_the_head_and_arrive_after_their_latency(kind, build, field):
    assert fresh_ticks(readings(suite(Installed(kind, build)), 35), field) == [10, 20, 30]
    assert fresh_ticks(readings(suite(Installed(kind, build, latency=0.2)), 35), field) == [12, 22, 32]
    assert fresh_ticks(readings(suite(Installed(kind, build, period=0.5)), 17), field) == [5, 10, 15]
    assert fresh_ticks(readings(suite(Installed(kind, build)), 35, head_still_for=0.9), field) == []
    unsettled = HeadState(0.0, 0.4, False)
    assert fresh_ticks(readings(suite(Installed(kind, build)), 35, head=unsettled), field) == []


def test_verging_needs_a_base_that_stands_still_and_the_beacon_reader_does_not():
    robot = suite(Installed("stereo", StereoBuild(1.0)), Installed("infrared", InfraredBuild()))
    read = readings(robot, 12, still_for=0.0)
    assert (fresh_ticks(read, "stereo"), fresh_ticks(read, "ir")) == ([], [10])


# --- what lands where -----------------------------------------------------------------------------


def test_a_robot_without_sensors_has_perfect_odometry_and_nothing_else():
    robot, start = suite(), at(0)
    turned = at(1, pose=Pose(1.0, 0.0, 0.0), wheels=Drive(10.0, 0.0))
    robot.sense(start, False)
    robot.update(turned)
    reading = robot.sense(turned, True)
    assert reading.odometry.pose == Pose(1.0, 0.0, 0.0)
    assert reading.object_on_board and not reading.others
    for field in (
        "sonar",
        "skirt",
        "ir",
        "stereo",
        "lidar",
        "compass",
        "imu",
        "inclination",
        "gps",
        "currents",
        "bumper",
    ):
        assert getattr(reading, field) is None


def test_head_and_flippers_are_as_they_are_and_stamped():
    state = {"head": HeadState(0.3, 0.2, False), "flippers": FlipperState(0.5, True)}
    robot = Suite((Installed("ir", InfraredBuild()),), (), Build(drive=SkidSteer()), ORIGIN, 1)
    reading = robot.sense(at(7, **state), False)
    assert reading.head == HeadState(0.3, 0.2, False, reading.stamp)
    assert reading.flippers == FlipperState(0.5, True, reading.stamp)
    assert (reading.stamp, reading.tick) == (pytest.approx(0.7), 7)
    without = suite().sense(at(7, **state), False)
    assert (without.head, without.flippers) == (None, None)


def test_the_second_of_a_kind_goes_to_the_others_under_its_name():
    robot = suite(
        Installed("front", EXACT),
        Installed("rear", EXACT, Mount(-0.3, 0.0, math.pi)),
        Installed("sonar", SonarBuild()),
        Installed("more sonar", SonarBuild()),
        Installed("late", ImuBuild(), latency=5.0),
        Installed("later", ImuBuild(), latency=5.0),
    )
    reading = robot.sense(at(0, ROOM), False)
    assert isinstance(reading.lidar, Scan) and reading.lidar.mount == ORIGIN
    assert sorted(reading.others) == ["more sonar", "more sonar.skirt", "rear"]
    rear, skirt = reading.others["rear"], reading.others["more sonar.skirt"]
    assert isinstance(rear, Scan) and rear.mount == Pose(-0.3, 0.0, math.pi)
    assert isinstance(skirt, Ranges) and skirt.ranges.size == 6


def test_the_rings_of_a_low_robot_are_low():
    low = Suite((Installed("sonar", SonarBuild(0, 0)),), (), Build(Circle(0.2), height=0.24), ORIGIN, 0)
    reading = low.sense(at(0, Scene([Circle(0.3)], [Pose(2, 0)], [0.15])), False)
    assert reading.sonar.ranges[0] == pytest.approx(2.0 - 0.3 - 0.2)


def test_two_sensors_of_one_name_are_an_error():
    with pytest.raises(ValueError, match="two sensors are called 'eye'"):
        suite(Installed("eye", LidarBuild()), Installed("eye", CompassBuild()))


# --- lidar ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("field_of_view", [math.tau, 4.0, 1.0])
@pytest.mark.parametrize("mount", [Mount(), Mount(0.2, -0.1, 0.5, 0.4)])
def test_without_noise_a_scan_is_what_the_caster_says(field_of_view, mount):
    pose, build = Pose(0.4, -0.3, 2.0), LidarBuild(field_of_view, 91, sd=0.0)
    (scan,) = samples(build, "lidar", 1, mount, scene=ROOM, pose=pose)
    c, s = math.cos(pose.theta), math.sin(pose.theta)
    x, y = pose.x + c * mount.x - s * mount.y, pose.y + s * mount.x + c * mount.y
    rays = Rays(np.full(91, x), np.full(91, y), scan.bearings + pose.theta + mount.theta, np.full(91, mount.height))
    assert scan.ranges == pytest.approx(cast(rays, 10.0, ROOM)[0], abs=1e-9)
    assert scan.mount == Pose(mount.x, mount.y, mount.theta)
    assert scan.ranges.min() < 5.0 and not scan.ranges.flags.writeable


def test_the_mount_moves_and_turns_the_scan():
    wall = Scene([box(1, 20)], [Pose(3.5, 0)], [1.0])
    (ahead,) = samples(EXACT, "lidar", 1, Mount(0.5, 0, 0), scene=wall)
    (aside,) = samples(EXACT, "lidar", 1, Mount(0.5, 0, math.pi / 2), scene=wall)
    assert ahead.ranges[int(np.argmin(abs(ahead.bearings)))] == pytest.approx(2.5)
    assert aside.ranges[int(np.argmin(abs(aside.bearings + math.pi / 2)))] == pytest.approx(2.5)


def test_a_full_turn_has_no_beam_twice_and_a_part_of_one_has_a_beam_at_either_edge():
    full, part = beam_bearings(math.tau, 8), beam_bearings(math.radians(240), 5)
    assert np.degrees(full) == pytest.approx([-135, -90, -45, 0, 45, 90, 135, 180])
    assert np.degrees(part) == pytest.approx([-120, -60, 0, 60, 120])
    assert beam_bearings(1.0, 1) == pytest.approx([0.0])


def test_a_low_post_is_under_the_plane_of_the_lidar_and_before_the_skirt():
    post = Scene([Circle(0.1)], [Pose(2.0, 0.0)], [0.25])
    reading = suite(Installed("sonar", SonarBuild(0, 0)), Installed("lidar", EXACT)).sense(at(0, post), False)
    assert reading.lidar.ranges.min() == 10.0
    assert (reading.skirt.ranges[0], reading.sonar.ranges[0]) == (pytest.approx(2.0 - 0.1 - 0.35), 5.0)


def test_the_noise_of_a_range_has_a_constant_and_a_relative_part():
    wall = Scene([box(1, 40)], [Pose(4.5, 0)], [1.0])
    build = LidarBuild(0.2, 11, sd=0.02, relative_sd=0.01)
    ranges = np.array([scan.ranges[5] for scan in samples(build, "lidar", 1500, scene=wall)])
    assert ranges.mean() == pytest.approx(4.0, abs=0.005)
    assert ranges.std() == pytest.approx(0.06, rel=0.06)


def test_the_noise_of_the_angles_turns_beams():
    wall = Scene([box(1, 400)], [Pose(4.5 * math.cos(2), 4.5 * math.sin(2), 2.0)], [1.0])
    build = LidarBuild(2 * math.radians(45), 3, sd=0.0, angle_sd=0.01, max_range=50.0)
    scans = samples(build, "lidar", 1500, Mount(theta=0.5), scene=wall, pose=Pose(0, 0, 1.5))
    ranges = np.array([scan.ranges for scan in scans])
    assert ranges[:, 2].std() == pytest.approx(0.01 * 4.0 * math.sqrt(2), rel=0.08)  # d(4 / cos a) / da at 45 degrees
    assert ranges[:, 1] == pytest.approx(4.0, abs=0.01)


def test_beams_fail_by_chance_and_say_so():
    scans = samples(LidarBuild(beams=100, dropout=0.2), "lidar", 50, scene=ROOM)
    assert np.mean([np.isnan(scan.ranges) for scan in scans]) == pytest.approx(0.2, abs=0.02)


def test_what_is_too_near_reads_the_least_range_and_what_is_not_there_the_greatest():
    near = Scene([Circle(0.3)], [Pose(0.32, 0)], [1.0])
    for scan in samples(LidarBuild(beams=36, sd=0.5), "lidar", 40, scene=near):
        assert scan.ranges[17] >= 0.05 and scan.ranges[-1] == 10.0
        assert (scan.min_range, scan.max_range) == (0.05, 10.0)
    (inside,) = samples(EXACT, "lidar", 1, scene=near, pose=Pose(0.3, 0))
    assert (inside.ranges == 0.05).all()


def test_noise_never_exceeds_the_greatest_range():
    wall = Scene([box(1, 40)], [Pose(4.5, 0)], [1.0])
    ranges = [scan.ranges for scan in samples(LidarBuild(0.2, 5, max_range=4.01, sd=0.1), "lidar", 100, scene=wall)]
    assert np.max(ranges) == 4.01 and np.min(ranges) < 3.9


# --- compass --------------------------------------------------------------------------------------


def biases(seed: int) -> np.ndarray:
    build = CompassBuild()
    compass = MagneticCompass(build, named_chance(seed, "a"), named_chance(seed, "magnetic field"))
    grid = np.arange(0, 2 * build.wavelength, build.wavelength / 23)
    return np.array([compass.bias(float(x), float(y)) for x in grid for y in grid])


@pytest.mark.parametrize("seed", range(4))
def test_the_bias_of_the_compass_has_its_rms_and_a_peak_of_twice_that(seed):
    field = np.degrees(biases(seed))
    assert math.sqrt(np.mean(field**2)) == pytest.approx(2.1, rel=0.02)
    assert np.abs(field).max() <= 4.2 + 1e-9
    assert np.abs(field).max() == pytest.approx(4.2, rel=0.05)


def test_the_bias_is_smooth_and_drawn_from_the_seed():
    assert not np.allclose(biases(1), biases(2))
    compass = MagneticCompass(CompassBuild(), named_chance(1, "a"), named_chance(1, "magnetic field"))
    steps = np.diff([compass.bias(0.1 * n, 3.0) for n in range(1000)])
    assert np.abs(steps).max() <= 0.1 * math.radians(2.1) * math.tau / 38.0


def test_the_heading_is_true_but_for_white_noise_where_there_is_no_bias():
    seen = samples(CompassBuild(bias_rms=0.0), "compass", 2000, pose=Pose(3, 4, math.pi))
    errors = np.degrees([math.remainder(compass.heading - math.pi, math.tau) for compass in seen])
    assert (errors.mean(), errors.std()) == (pytest.approx(0.0, abs=0.07), pytest.approx(1.0, rel=0.06))
    assert all(-math.pi < compass.heading <= math.pi for compass in seen)


def test_two_compasses_of_a_world_feel_the_same_field():
    build = CompassBuild(sd=0.0)
    reading = suite(Installed("a", build), Installed("b", build)).sense(at(0, pose=Pose(7, 9)), False)
    assert reading.compass == reading.others["b"] and reading.compass.heading != 0.0


# --- imu, inclinometer, gps, currents, bumper -----------------------------------------------------


def test_the_gyroscope_has_noise_and_a_bias_that_stays_for_the_run():
    seen = samples(ImuBuild(bias_sd=0.1), "imu", 2000, turn_rate=0.5, acceleration=(0.3, -0.2))
    rates, across = np.array([imu.turn_rate for imu in seen]), np.array([imu.acceleration for imu in seen])
    bias = rates.mean() - 0.5
    assert 0.001 < abs(bias) < 0.4
    assert rates.std() == pytest.approx(0.002, rel=0.06)
    assert across.mean(axis=0) == pytest.approx([0.3, -0.2], abs=0.004)
    assert across.std(axis=0) == pytest.approx([0.05, 0.05], rel=0.06)
    biases = [suite(Installed("imu", ImuBuild(0, 0, 0.1)), seed=s).sense(at(), False).imu.turn_rate for s in range(300)]
    assert np.std(biases) == pytest.approx(0.1, rel=0.12)


def test_the_inclinometer_tells_nose_up_uphill_and_left_side_up_across_the_slope():
    ground = Ground((Slope((-1, -1, 1, 1), math.radians(10), math.pi / 2),))
    exact = InclinometerBuild(0.0)
    (up,) = samples(exact, "inclination", 1, ground=ground, pose=Pose(0, 0, math.pi / 2))
    (across,) = samples(exact, "inclination", 1, ground=ground)
    (level,) = samples(exact, "inclination", 1, ground=ground, pose=Pose(5, 0))
    assert (up.pitch, up.roll) == pytest.approx((math.radians(10), 0.0))
    assert (across.pitch, across.roll) == pytest.approx((0.0, math.radians(10)))
    assert level == Inclination(0.0, True, 0.0, 0.0)
    noisy = samples(InclinometerBuild(), "inclination", 2000)
    assert np.degrees([i.roll for i in noisy]).std() == pytest.approx(0.3, rel=0.06)


def test_a_fix_is_where_the_antenna_is_with_white_noise():
    seen = samples(GpsBuild(0.5, 0.0), "gps", 2000, Mount(0.4, 0.0), pose=Pose(10, 20, math.pi / 2))
    fixes = np.array([(fix.x, fix.y) for fix in seen])
    assert fixes.mean(axis=0) == pytest.approx([10, 20.4], abs=0.04)
    assert fixes.std(axis=0) == pytest.approx([0.5, 0.5], rel=0.06)


def test_the_drift_of_the_fix_wanders_with_its_time_constant():
    build = Installed("gps", GpsBuild(0.0, 1.5, 5.0), period=1.0)
    runs = [[r.gps.x for r in readings(suite(build, seed=seed), 40, dt=1.0)] for seed in range(300)]
    drift = np.array(runs)
    assert drift.std(axis=0) == pytest.approx(np.full(40, 1.5), rel=0.25)
    assert drift.std() == pytest.approx(1.5, rel=0.06)
    kept = (drift[:, 5:] * drift[:, :-5]).mean() / drift.var()
    assert kept == pytest.approx(math.exp(-1), abs=0.06)
    assert (drift[:, 1:] * drift[:, :-1]).mean() / drift.var() == pytest.approx(math.exp(-0.2), abs=0.05)


def test_the_currents_follow_the_load_through_a_low_pass():
    robot = suite(Installed("currents", CurrentBuild(sd=0.0, smoothing=0.2)))
    read = readings(robot, 4, load=Currents(0.0, True, 10.0, -4.0))
    after = [10 * (1 - math.exp(-0.1 * tick / 0.2)) for tick in range(4)]
    assert [r.currents.left for r in read] == pytest.approx(after)
    assert [r.currents.right for r in read] == pytest.approx([-0.4 * current for current in after])
    noisy = samples(CurrentBuild(), "currents", 2000)
    assert np.std([c.left for c in noisy]) == pytest.approx(0.1, rel=0.06)


def test_without_smoothing_the_currents_are_the_load():
    read = readings(suite(Installed("currents", CurrentBuild(0.0, 0.0))), 2, load=Currents(0.0, True, 3.0, 2.0))
    assert (read[1].currents.left, read[1].currents.right) == (3.0, 2.0)


@pytest.mark.parametrize(
    ("degrees", "pressed"),
    [((), []), ((0,), [0]), ((22, -22), [0]), ((23,), [1]), ((-90, 180), [4, 6]), ((-179,), [4])],
)
def test_each_contact_presses_the_switch_that_covers_it(degrees, pressed):
    (bumper,) = samples(BumperBuild(), "bumper", 1, touched=tuple(map(math.radians, degrees)))
    assert list(np.flatnonzero(bumper.pressed)) == pressed
    assert np.degrees(bumper.bearings) == pytest.approx([0, 45, 90, 135, 180, -135, -90, -45])


# --- chance ---------------------------------------------------------------------------------------

ALL = tuple(Installed(kind, build) for kind, (build, _, _) in KINDS.items())
MORE = (
    Installed("rear", LidarBuild(dropout=0.1)),
    Installed("gps 2", GpsBuild()),
    Installed("infrared", InfraredBuild()),
)


def told(sensed: Sensed) -> str:
    with np.printoptions(precision=17, threshold=10**6):
        return repr(sensed)


@pytest.mark.parametrize("kind", KINDS)
def test_further_sensors_change_no_bit_of_what_one_says(kind):
    build, fields, _ = KINDS[kind]
    driving = {"scene": ROOM, "wheels": Drive(0.1, 0.2)}
    alone = readings(suite(Installed(kind, build)), 12, **driving)
    amid = readings(suite(*reversed(MORE), *reversed(ALL)), 12, **driving)
    for one, other in zip(alone, amid, strict=True):
        for field in fields:
            assert told(getattr(one, field)) == told(other.others.get(kind, getattr(other, field)))


def test_sensors_of_one_kind_draw_apart():
    reading = suite(Installed("a", LidarBuild()), Installed("b", LidarBuild())).sense(at(0, ROOM), False)
    assert (reading.lidar.ranges != reading.others["b"].ranges).any()


def test_chance_follows_from_seed_and_name_alone():
    def first(seed: int, name: str) -> float:
        return float(sensor_chance(seed, name).random())

    names = ["sonar", "infrared", "stereo", "odometry", "lidar", "lidar2", "a", "layout", "ü"]
    assert len({first(seed, name) for seed in (0, 1) for name in names}) == 2 * len(names)
    assert first(4, "lidar") == first(4, "lidar")
    assert sensor_chance(4, "layout").random() != chance(4).layout.random()
    assert sensor_chance(4, "sonar").random() == chance(4).sonar.random()
    assert named_chance(1, "a", "b").random() != named_chance(1, "ab").random()


def test_the_same_seed_gives_the_same_readings():
    runs = [readings(suite(*ALL, *MORE, seed=5), 12, scene=ROOM) for _ in range(2)]
    assert [told(r) for r in runs[0]] == [told(r) for r in runs[1]]


# --- on a robot in a world ------------------------------------------------------------------------

YARD = """
name: yard
bounds: [-5, -5, 5, 5]
robot: {model: packbot, start: [0, 0], sensors: [
  {kind: odometry, scale_sd: 0, turn_sd: 0}, {kind: lidar, sd: 0, at: [0.2, 0, 0]}, {kind: compass, sd: 0, bias_rms: 0},
  {kind: bumper}, {kind: currents, sd: 0}, {kind: imu, turn_rate_sd: 0, bias_sd: 0}]}
goal: {at: [4, 4], within: 1 m}
things: [{kind: wall, from: [2, -5], to: [2, 5]}]
faults: [{sensor: compass, kind: nan, at: 2, until: 3}]
"""


def yard(command: Command, ticks: int) -> tuple[World, list[Reading]]:
    world = World(loads(YARD, "yard.yaml"), 0)
    read = [world.sense()]
    for _ in range(ticks):
        world.step(command)
        read.append(world.sense())
    return world, read


def test_tracks_that_turn_in_a_world_over_report_it_and_gyroscope_and_compass_do_not():
    world, read = yard(Command(Drive(0.0, 0.5)), 30)
    true, slip = world.robot.pose.theta, world.robot.build.drive.slip
    assert read[-1].odometry.pose.theta == pytest.approx(slip * true)
    assert (read[-1].imu.turn_rate, read[-1].compass.heading) == pytest.approx((world.robot.turn_rate, true))
    assert [r.tick for r in read if math.isnan(r.compass.heading)] == list(range(20, 30))


def test_a_robot_against_a_wall_feels_it_in_its_bumper_and_its_motors_and_sees_it_near():
    world, read = yard(Command(Drive(0.5, 0.0)), 80)
    struck, ahead = read[-1], int(np.argmin(np.abs(read[0].lidar.bearings)))
    felt = struck.bumper.bearings[struck.bumper.pressed]
    assert felt.size and (np.abs(felt) < 1).all() and not read[0].bumper.pressed.any()
    assert struck.currents.left > 2 * read[20].currents.left > 0
    assert read[0].lidar.ranges[ahead] == pytest.approx(2.0 - 0.1 - 0.2)
    assert struck.lidar.ranges[ahead] == pytest.approx(1.9 - world.robot.pose.x - 0.2)
    assert world.sense() is world.sense()
