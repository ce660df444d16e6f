"""Sonar, infra-red, stereo, odometry: each tells the truth it promises, as often and as well as it promises."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from behaviours.interface import (
    STOP,
    Command,
    Currents,
    Drive,
    FlipperState,
    Head,
    HeadState,
    IrReading,
    Pose,
    Ranges,
    Reading,
    StereoReading,
)
from sim.noise import chance
from sim.raycast import Circle, Scene, box
from sim.robots.build import Build
from sim.robots.head import PanTilt
from sim.sensors.build import InfraredBuild, Installed, OdometryBuild, SonarBuild, StereoBuild
from sim.sensors.infrared import BeaconReader
from sim.sensors.odometry import WheelOdometry
from sim.sensors.sonar import SonarRings
from sim.sensors.stereo import VergingCameras, slant_range
from sim.sensors.suite import Suite
from sim.sensors.truth import Beacon, Truth
from sim.sensors.weather import Weather
from sim.things.ground import Ground
from sim.world import World

ORIGIN = Pose(0.0, 0.0)
FOOT = 0.3048
NOISELESS, CALM = SonarBuild(0.0, 0.0), Weather()
NOTHING = Scene([], [], [])


def rng(seed: int = 0) -> np.random.Generator:
    return np.random.default_rng(seed)


def at(tick: int = 0, scene: Scene = NOTHING, pose: Pose = ORIGIN, **more: Any) -> Truth:
    """What is so at this tick of 0.1 s; the robot and its head stand still unless `more` says otherwise."""
    time = tick / 10
    standing = Truth(
        tick=tick,
        time=time,
        dt=0.1,
        pose=pose,
        speed=0.0,
        turn_rate=0.0,
        acceleration=(0.0, 0.0),
        wheels=Drive(0.0, 0.0),
        aside=0.0,
        still_for=time,
        head=HeadState(0.0, 0.0, True),
        head_still_for=time,
        load=Currents(0.0, True, 0.0, 0.0),
        flippers=FlipperState(0.0, False),
        touched=(),
        beacons=(),
        battery=None,
        weather=CALM,
        ground=Ground(),
        scene=lambda: scene,
    )
    return replace(standing, **more)


def moved(before: Truth, pose: Pose, wheels: Drive | None = None) -> Truth:
    """A tick later at this pose; wheels: where they did something else than the hull."""
    turn = pose.theta - before.pose.theta
    middle = before.pose.theta + turn / 2
    way = (pose.x - before.pose.x) * math.cos(middle) + (pose.y - before.pose.y) * math.sin(middle)
    wheels = wheels or Drive(way / before.dt, turn / before.dt)
    return replace(before, tick=before.tick + 1, time=(before.tick + 1) * before.dt, pose=pose, wheels=wheels)


def sweep(scene: Scene, pose: Pose = ORIGIN, build: SonarBuild = NOISELESS, height: float = 1.2):
    return SonarRings(build, 0.35, height, rng()).measure(at(0, scene, pose))


def drive(world: World, command: Command, ticks: int) -> Iterator[Reading]:
    for _ in range(ticks):
        yield world.sense()
        world.step(command)


# --- sonar ----------------------------------------------------------------------------------------


def test_ranges_are_measured_from_the_hull():
    waist, skirt = sweep(Scene([box(1, 9)], [Pose(2.5, 0)], [1.0]))
    assert waist.ranges[0] == pytest.approx(2.0 - 0.35)
    assert skirt.ranges[0] == pytest.approx(2.0 - 0.35)
    assert waist.mount_radius + waist.ranges[0] == pytest.approx(2.0)


def test_the_rings_have_24_and_6_bearings_within_half_a_turn():
    waist, skirt = sweep(NOTHING)
    assert np.degrees(waist.bearings)[[0, 1, 12, 13, 23]] == pytest.approx([0, 15, 180, -165, -15])
    assert np.degrees(skirt.bearings) == pytest.approx([0, 60, 120, 180, -120, -60])
    assert (waist.ranges == 5.0).all() and (skirt.ranges == 5.0).all()


def test_the_rings_turn_with_the_robot():
    waist, _ = sweep(Scene([Circle(0.3)], [Pose(0, 2)], [1.0]), Pose(0, 0, math.pi / 4))
    assert int(np.argmin(waist.ranges)) == 3
    assert waist.ranges.min() == pytest.approx(2 - 0.3 - 0.35, abs=0.02)


def test_a_cone_hears_what_stands_beside_its_axis():
    beside = Pose(2 * math.cos(math.radians(7)), 2 * math.sin(math.radians(7)))
    waist, _ = sweep(Scene([Circle(0.05)], [beside], [1.0]))
    assert waist.ranges[0] < 1.7
    assert waist.ranges[2] == 5.0


def test_a_low_thing_is_heard_by_the_skirt_alone():
    waist, skirt = sweep(Scene([Circle(0.3)], [Pose(2, 0)], [0.4]))
    assert waist.ranges[0] == 5.0
    assert skirt.ranges[0] == pytest.approx(1.35)


def test_a_low_robot_carries_its_rings_low():
    waist, skirt = sweep(Scene([Circle(0.3)], [Pose(2, 0)], [0.15]), height=0.24)
    assert waist.ranges[0] == skirt.ranges[0] == pytest.approx(1.35)


def test_what_touches_the_hull_reads_five_centimetres():
    waist, _ = sweep(Scene([Circle(0.3)], [Pose(0.645, 0)], [1.0]))
    assert waist.ranges[0] == 0.05


def test_noise_is_one_per_cent_of_the_range_and_dropouts_read_the_maximum():
    wall = at(0, Scene([box(1, 9)], [Pose(3.85, 0)], [1.0]))
    sonar = SonarRings(SonarBuild(0.01, 0.1), 0.35, 1.2, rng())
    readings = np.array([sonar.measure(wall)[0].ranges[0] for _ in range(1500)])
    heard = readings[readings < 5.0]
    assert 1 - len(heard) / len(readings) == pytest.approx(0.1, abs=0.025)
    assert heard.mean() == pytest.approx(3.0, abs=0.005)
    assert heard.std() == pytest.approx(0.03, rel=0.1)


def test_a_sweep_is_fresh_every_third_tick_and_latched_in_between(small):
    world = World(small("{kind: post, at: [3, 0]}"), 0)
    readings = list(drive(world, Command(Drive(0.2, 0.0)), 9))
    sonars = [reading.sonar for reading in readings if reading.sonar]
    assert [sonar.fresh for sonar in sonars] == [True, False, False] * 3
    assert [sonar.stamp for sonar in sonars] == pytest.approx([0, 0, 0, 0.3, 0.3, 0.3, 0.6, 0.6, 0.6])
    assert sonars[1].ranges is sonars[0].ranges
    assert sonars[3].ranges[0] < sonars[0].ranges[0]


# --- head -----------------------------------------------------------------------------------------


def test_the_head_slews_at_sixty_degrees_a_second_and_says_when_it_is_there():
    head = PanTilt()
    head.command(Head(math.radians(90), math.radians(30)))
    states = []
    for _ in range(16):
        head.move(0.1)
        states.append(head.state)
    assert states[4].pan == pytest.approx(math.radians(30))
    assert [state.settled for state in states].index(True) == 14
    assert states[-1] == HeadState(math.radians(90), math.radians(30), True)


def test_the_head_stops_at_its_stops():
    head = PanTilt()
    head.command(Head(7.0, 7.0))
    for _ in range(60):
        head.move(0.1)
    assert (head.pan, head.tilt) == (math.pi, math.pi / 2)


# --- infra-red ------------------------------------------------------------------------------------


def scan(metres: float, seed: int, weather: Weather = CALM, behind: bool = False) -> list[IrReading]:
    """One sweep from -90 to +90 degrees in steps of two, the beacon 10 degrees to the left."""
    angle = math.radians(10)
    beacon = metres * math.cos(angle), metres * math.sin(angle)
    poses = [Pose(*beacon)] + [Pose((metres + 1) * math.cos(angle), (metres + 1) * math.sin(angle))] * behind
    scene = Scene([Circle(0.25)] * len(poses), poses, [0.9, 1.75][: len(poses)])
    beacons = (Beacon("donor", beacon, 0),)
    reader, here = BeaconReader(InfraredBuild(), rng(seed)), at(10, scene, beacons=beacons, weather=weather)
    pans = np.radians(np.arange(-90, 91, 2))
    return [reader.measure(replace(here, head=HeadState(float(pan), 0.0, True)))[0] for pan in pans]


def bearing_found(readings: list[IrReading]) -> float | None:
    """Where the offsets change from plus to minus, by a line through them; None for too few or jumping readings."""
    heard = [reading for reading in readings if reading.detected]
    offsets = np.array([reading.offset for reading in heard])
    if len(heard) < 6 or (np.diff(offsets) >= 0).any() or (offsets > 0).sum() < 3 or (offsets < 0).sum() < 3:
        return None
    slope, zero = np.polyfit([reading.pan for reading in heard], offsets, 1)
    return float(-zero / slope)


def test_a_beacon_at_24_feet_is_found_within_two_degrees():
    found = [bearing_found(scan(24 * FOOT, seed)) for seed in range(60)]
    good = [angle for angle in found if angle is not None and abs(math.degrees(angle) - 10) <= 2]
    assert len(good) >= 57


def test_a_beacon_at_28_feet_is_not_found():
    assert sum(bearing_found(scan(28 * FOOT, seed)) is not None for seed in range(60)) <= 3


def test_the_sun_behind_the_donor_drowns_the_beacon_unless_somebody_stands_between():
    sunny = Weather(sun=math.radians(20))
    assert all(bearing_found(scan(6.0, seed, sunny)) is None for seed in range(10))
    assert all(bearing_found(scan(6.0, seed, sunny, behind=True)) is not None for seed in range(10))
    assert all(bearing_found(scan(6.0, seed, Weather(sun=math.pi))) is not None for seed in range(10))


def test_the_sun_that_comes_out_in_mid_run_drowns_the_beacon():
    beacon, scene = (5.0, 0.0), Scene([Circle(0.25)], [Pose(5.0, 0.0)], [0.9])
    reader = BeaconReader(InfraredBuild(), rng())
    beacons = (Beacon("donor", beacon, 0),)
    assert reader.measure(at(10, scene, beacons=beacons))[0].detected
    assert not reader.measure(at(20, scene, beacons=beacons, weather=Weather(sun=0.0)))[0].detected


def test_a_tall_donor_does_not_shade_its_own_beacon():
    tall = Scene([Circle(0.25)], [Pose(5.0, 0.0)], [1.8])
    reader = BeaconReader(InfraredBuild(), rng())
    beacons = (Beacon("donor", (5.0, 0.0), 0),)
    assert not reader.measure(at(10, tall, beacons=beacons, weather=Weather(sun=0.0)))[0].detected


@pytest.mark.parametrize(("degrees", "heard"), [(0, True), (28, True), (-28, True), (33, False), (-33, False)])
def test_the_reader_hears_within_thirty_degrees_of_its_axis(degrees, heard):
    near = at(10, Scene([Circle(0.25)], [Pose(3.0, 0.0)], [0.9]), beacons=(Beacon("donor", (3.0, 0.0), 0),))
    aside = replace(near, head=HeadState(math.radians(degrees), 0.0, True))
    assert BeaconReader(InfraredBuild(), rng()).measure(aside)[0].detected == heard


def test_without_a_donor_nothing_is_heard():
    (reading,) = BeaconReader(InfraredBuild(), rng()).measure(at(10))
    assert (reading.detected, reading.fresh, reading.stamp) == (False, True, 1.0)
    assert math.isnan(reading.offset) and 0 <= reading.strength < 1


def test_wind_rocks_the_bearing():
    def spread(weather: Weather) -> float:
        offsets = [
            r.offset - (math.radians(10) - r.pan) for s in range(10) for r in scan(4.0, s, weather) if r.detected
        ]
        return math.degrees(float(np.std(offsets)))

    assert spread(Weather()) == pytest.approx(0.3, abs=0.05)
    windy = Weather(jitter=math.radians(1.5), gust=math.radians(6), gusts=0.2)
    assert spread(windy) > 2.0


def test_what_stands_between_hides_the_beacon(small):
    def heard(*things: str) -> bool:
        world = World(small(*things, donor="[5, 0]"), 0)
        return any(r.ir.detected for r in drive(world, STOP, 15) if r.ir)

    assert heard()
    assert not heard("{kind: person, at: [2, 0.1]}")
    assert heard("{kind: post, at: [2, 0], height: 0.5}")


def test_the_beacon_is_heard_from_where_the_robot_is(small):
    world = World(small(donor="[6, 1]"), 0)
    list(drive(world, Command(Drive(0.2, 0.0)), 101))
    ir = [reading.ir for reading in drive(world, STOP, 15) if reading.ir and reading.ir.fresh][-1]
    x = world.robot.pose.x
    bearing, distance = math.atan2(1, 6 - x), math.hypot(6 - x, 1)
    assert x == pytest.approx(2.0, abs=0.05)
    assert math.degrees(ir.offset) == pytest.approx(math.degrees(bearing), abs=1.2)
    assert ir.strength == pytest.approx(3.2 * (7.62 / distance) ** 2 * math.cos(bearing) ** 2, abs=0.8)


def test_the_reader_fixates_once_a_second_and_anew_after_the_head_has_moved(small):
    world = World(small(donor="[5, 0]"), 0)
    fresh = [reading.tick for reading in drive(world, STOP, 25) if reading.ir and reading.ir.fresh]
    assert fresh == [10, 20]
    look = Command(head=Head(math.radians(2), 0.0))
    later = [reading for reading in drive(world, look, 15) if reading.ir and reading.ir.fresh]
    assert [reading.tick for reading in later] == [36]
    assert later[0].ir is not None and later[0].ir.pan == math.radians(2)
    assert math.degrees(later[0].ir.offset) == pytest.approx(-2, abs=1.5)


# --- stereo ---------------------------------------------------------------------------------------


def gaze(tilt: float, pan: float = 0.0) -> HeadState:
    return HeadState(pan, tilt, True)


def test_the_ray_meets_the_ground_where_camera_height_and_tilt_say():
    tilt = math.atan(1.2 / 3.0)
    assert slant_range(1.2, gaze(tilt), ORIGIN, NOTHING) == pytest.approx(math.hypot(1.2, 3.0))


def test_the_ray_meets_the_side_of_a_thing_before_the_ground():
    tilt = math.atan(1.2 / 7.0)
    got = slant_range(1.2, gaze(tilt, 0.3), Pose(0, 0, -0.3), Scene([Circle(0.25)], [Pose(4, 0)], [0.9]))
    assert got == pytest.approx(3.75 / math.cos(tilt))


def test_the_ray_passes_over_what_is_low_and_may_land_on_its_top():
    tilt, low = math.atan(1.2 / 4.0), [Circle(0.5)]
    over = slant_range(1.2, gaze(tilt), ORIGIN, Scene(low, [Pose(1.0, 0)], [0.3]))
    assert over == pytest.approx(math.hypot(1.2, 4.0))
    on_top = slant_range(1.2, gaze(tilt), ORIGIN, Scene(low, [Pose(3.0, 0)], [0.4]))
    assert on_top == pytest.approx(0.8 / math.sin(tilt))


def test_a_level_gaze_into_the_open_does_not_verge_and_at_a_thing_it_does():
    assert math.isnan(slant_range(1.2, gaze(0.0), ORIGIN, NOTHING))
    assert slant_range(1.2, gaze(0.0), ORIGIN, Scene([Circle(0.5)], [Pose(4, 0)], [1.5])) == pytest.approx(3.5)
    assert math.isnan(slant_range(1.2, gaze(0.0), ORIGIN, Scene([Circle(0.5)], [Pose(4, 0)], [1.0])))


def test_the_noise_grows_with_the_range():
    stereo, level = VergingCameras(StereoBuild(), rng()), at(0, Scene([box(1, 9)], [Pose(6.5, 0)], [2.0]))
    ranges = [stereo.measure(level)[0].range for _ in range(800)]
    assert np.mean(ranges) == pytest.approx(6.0, abs=0.01)
    assert np.std(ranges) == pytest.approx(0.003 * 6 + 0.001 * 36, rel=0.1)


def test_a_fixation_takes_nine_seconds_of_standing_still(small):
    world = World(small(), 0)
    list(drive(world, Command(Drive(0.2, 0.0), Head(0.0, 0.4)), 10))
    readings = list(drive(world, Command(head=Head(0.0, 0.4)), 200))
    fresh = [reading for reading in readings if reading.stereo and reading.stereo.fresh]
    assert [reading.tick for reading in fresh] == pytest.approx([104, 194], abs=2)
    assert fresh[0].stereo is not None
    assert fresh[0].stereo.range == pytest.approx(1.2 / math.sin(0.4), abs=0.1)
    assert fresh[0].stereo.camera_height == 1.2


# --- odometry -------------------------------------------------------------------------------------


def reckoned(build: OdometryBuild, seed: int, poses: list[Pose], start: Pose = ORIGIN, slip: float = 1.0) -> Pose:
    """What odometry says after these poses, a tick apart; the tracks turn `slip` times as much as the hull."""
    odometry, truth = WheelOdometry(build, start, rng(seed)), at(0, pose=start)
    for pose in poses:
        truth = moved(truth, pose)
        truth.wheels = Drive(truth.wheels.speed, slip * truth.wheels.turn_rate)
        odometry.update(truth)
    return odometry.measure(truth)[0].pose


def test_without_errors_dead_reckoning_is_the_true_pose_seen_from_the_start(small):
    world = World(small(heading="1.0"), 0)
    for command in (Command(Drive(0.2, 0.3)), Command(Drive(-0.1, -0.8)), Command(Drive(0.2, 0.0))):
        list(drive(world, command, 40))
    pose, true = world.sense().odometry.pose, world.robot.pose
    seen = math.cos(1.0) * pose.x - math.sin(1.0) * pose.y, math.sin(1.0) * pose.x + math.cos(1.0) * pose.y
    assert seen == pytest.approx((true.x, true.y), abs=1e-3)
    assert pose.theta == pytest.approx(true.theta - 1.0)


def test_odometry_tells_speed_and_turn_rate(small):
    world = World(small(), 0)
    list(drive(world, Command(Drive(0.2, 0.4)), 20))
    odometry = world.sense().odometry
    assert (odometry.speed, odometry.turn_rate) == pytest.approx((0.2, 0.4), abs=1e-3)
    assert (odometry.stamp, odometry.fresh) == (2.0, True)


def test_the_scale_error_is_one_for_the_whole_run_and_the_heading_drifts_only_in_turns():
    straight = [Pose(0.02 * n, 0.0) for n in range(1, 101)]
    ends = [reckoned(OdometryBuild(), seed, straight) for seed in range(200)]
    assert all(end.theta == 0 and end.y == 0 for end in ends)
    assert np.std([end.x / 2.0 for end in ends]) == pytest.approx(0.005, rel=0.15)


def test_a_turn_on_the_spot_makes_the_heading_drift():
    turn = [Pose(0.0, 0.0, 0.02 * n) for n in range(1, 101)]
    ends = [reckoned(OdometryBuild(), seed, turn).theta for seed in range(200)]
    assert np.std([end - 2.0 for end in ends]) == pytest.approx(0.002 * math.sqrt(10), rel=0.15)


@pytest.mark.parametrize("slip", [1.0, 1.3, 2.0])
def test_tracks_that_slip_over_report_the_turn_by_their_slip(slip):
    turn = [Pose(0.0, 0.0, 0.01 * n) for n in range(1, 101)]
    assert reckoned(OdometryBuild(0, 0), 0, turn, slip=slip).theta == pytest.approx(slip * 1.0)


def test_a_shove_from_the_side_is_not_noticed():
    assert reckoned(OdometryBuild(0, 0), 0, [Pose(0.0, 0.1 * n) for n in range(1, 11)]) == Pose(0.0, 0.0, 0.0)


def test_wheels_that_spin_in_place_count_as_way():
    odometry, truth = WheelOdometry(OdometryBuild(0, 0), ORIGIN, rng()), at(0)
    for _ in range(10):
        truth = moved(truth, ORIGIN, Drive(0.2, 0.0))
        odometry.update(truth)
    assert odometry.measure(truth)[0].pose.x == pytest.approx(0.2)


# --- the same numbers as ever ---------------------------------------------------------------------


def test_the_four_sensors_of_the_synchro_drive_draw_the_numbers_that_they_have_always_drawn():
    """The numbers were written down when each sensor still looked at the world by itself."""
    scene = Scene([Circle(0.25), box(1, 9), Circle(0.3)], [Pose(5, 0), Pose(2.5, 6), Pose(-2, 1)], [0.9, 1.0, 0.4])
    installed = (
        Installed("odometry", OdometryBuild()),
        Installed("stereo", StereoBuild(), period=1.0),
        Installed("sonar", SonarBuild()),
        Installed("infrared", InfraredBuild()),
    )
    windy = Weather(jitter=0.01, gust=0.1, gusts=0.5)
    truth = at(0, scene, head=HeadState(-0.3, 0.2, True), beacons=(Beacon("donor", (5.0, 0.0), 0),), weather=windy)
    suite = Suite(installed, (), Build(), ORIGIN, 7)
    reading = suite.sense(truth, False)
    for tick in range(1, 31):
        theta, old = 0.02 * tick, truth.pose
        pose = Pose(old.x + 0.02 * math.cos(theta - 0.01), old.y + 0.02 * math.sin(theta - 0.01), theta)
        truth = replace(moved(truth, pose), still_for=tick / 10, head_still_for=tick / 10)
        suite.update(truth)
        reading = suite.sense(truth, False)
    assert_as_ever(reading)


def assert_as_ever(reading: Reading) -> None:
    waist, skirt, ir, stereo = reading.sonar, reading.skirt, reading.ir, reading.stereo
    assert isinstance(waist, Ranges) and isinstance(skirt, Ranges)
    assert isinstance(ir, IrReading) and isinstance(stereo, StereoReading)
    near = [1.614911402998614, 1.638199491573848, 2.2603444247189186, 4.201123128945069, 5.0]
    assert waist.ranges[:5] == pytest.approx(near, rel=1e-12)
    assert skirt.ranges == pytest.approx([1.6682858968882324, 5.0, 2.0532273235712295, 5.0, 5.0, 5.0], rel=1e-12)
    assert (ir.offset, ir.strength) == pytest.approx((-0.4981735538593371, 7.111305504672872), rel=1e-12)
    assert stereo.range == pytest.approx(6.0334284981457245, rel=1e-12)
    assert [sensed.stamp for sensed in (waist, skirt, ir, stereo)] == pytest.approx([3.0] * 4)
    pose, odometry = reading.odometry.pose, reading.odometry
    there = (0.5657946211841298, 0.17572313696041236, 0.6020518134258431)
    assert (pose.x, pose.y, pose.theta) == pytest.approx(there, rel=1e-12)
    assert (odometry.speed, odometry.turn_rate) == pytest.approx((0.20049050736660792, 0.2086331561983717), rel=1e-12)


def test_the_sources_keep_their_places():
    assert [float(source.random()) for source in (chance(3).layout, chance(3).odometry)] == pytest.approx(
        [float(np.random.default_rng(np.random.SeedSequence(3).spawn(5)[place]).random()) for place in (0, 4)]
    )
