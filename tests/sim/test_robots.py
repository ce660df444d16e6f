"""Robots move alike with and without the space, meet things as their hulls say, and tell the truth about it."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pymunk
import pytest

from behaviours.interface import Command, Drive, Flippers, Pose, wrap
from sim.raycast import Circle, Rings, box
from sim.robots.build import Ackermann, Build, Differential, SkidSteer, Synchro
from sim.robots.models import MODELS
from sim.robots.robot import Robot
from sim.things.ground import Ground, Slope
from sim.things.thing import FRICTION, OTHER

DT, SUBSTEPS = 0.02, 5
TICK = DT * SUBSTEPS
ORIGIN, LEVEL = Pose(0.0, 0.0), Ground()
HILL = Ground((Slope((-2.0, -2.0, 2.0, 2.0), 0.2, 0.5),))
STOP = Command(Drive(0.0, 0.0))

BUILDS = {
    "synchro": Build(),
    "disc": Build(Circle(0.2), Differential(), 5.0),
    "box": Build(box(0.508, 0.43), Differential(2.0, 4.0, 3.0, 8.0, 0.376), 17.0),
    "tracks": Build(box(0.69, 0.52), SkidSteer(1.0, 2.0), 24.0),
    "steered": Build(box(2.35, 1.4), Ackermann(), 750.0),
}
by_build = pytest.mark.parametrize("build", BUILDS.values(), ids=BUILDS)


def empty() -> pymunk.Space:
    space = pymunk.Space()
    space.damping, space.iterations, space.collision_slop = 0.01, 20, 0.0005
    return space


def placed(build: Build, pose: Pose = ORIGIN, ground: Ground = LEVEL) -> Robot:
    return Robot(empty(), pose, build, ground)


def wall(robot: Robot, x: float, thickness: float = 0.0) -> pymunk.Shape:
    """Across the x axis, its near face at x."""
    space, corners = robot.body.space, ((x, -30), (x + thickness, -30), (x + thickness, 30), (x, 30))
    static = space.static_body
    shape = pymunk.Poly(static, corners) if thickness else pymunk.Segment(static, (x, -30), (x, 30), 0.0)
    shape.friction, shape.collision_type = FRICTION, OTHER
    space.add(shape)
    return shape


def cart(robot: Robot, x: float, y: float, mass: float) -> pymunk.Body:
    body = pymunk.Body(mass, pymunk.moment_for_box(mass, (0.3, 0.3)))
    body.position = x, y
    shape = pymunk.Poly.create_box(body, (0.3, 0.3))
    shape.friction, shape.collision_type = FRICTION, OTHER
    robot.body.space.add(body, shape)
    return body


def tick(robot: Robot, command: Command, substeps: int = SUBSTEPS, after: Callable[[], None] = lambda: None) -> None:
    robot.command(command)
    for _ in range(substeps):
        robot.body.space.step(TICK / substeps)
        after()
    robot.settle(TICK)


def gliding(robot: Robot, command: Command) -> None:
    robot.command(command)
    for _ in range(SUBSTEPS):
        robot.glide(DT)
    robot.settle(TICK)
    robot.tell()


def let(robot: Robot, drive: Drive, seconds: float) -> Robot:
    for _ in range(round(seconds / TICK)):
        gliding(robot, Command(drive))
    return robot


def commands(build: Build, seed: int, count: int) -> list[Command]:
    """One new one in each few ticks, some of them none, some beyond the drive."""
    chance, drawn = np.random.default_rng(seed), []
    for number in range(count):
        if number % 4 == 0:
            speed, turn_rate = chance.uniform(-1.5, 1.5, 2)
            drive = Drive(speed * build.max_speed, turn_rate * build.max_turn_rate) if chance.random() < 0.8 else None
        drawn.append(Command(drive))
    return drawn


def frontmost(robot: Robot) -> float:
    """The largest x [m] of the hull."""
    x, angle, hull = robot.body.position.x, robot.body.angle, robot.build.hull
    if isinstance(hull, Circle):
        return x + hull.radius
    assert not isinstance(hull, Rings)
    return max(x + math.cos(angle) * px - math.sin(angle) * py for px, py in hull.vertices)


def reached(robot: Robot, drive: Drive, substeps: int) -> float:
    """The largest x [m] that the hull ever has in four seconds of driving so."""
    far: list[float] = []
    for _ in range(40):
        tick(robot, Command(drive), substeps, lambda: far.append(frontmost(robot)))
    return max(far)


# --- the same motion with and without the space ---------------------------------------------------


@by_build
@pytest.mark.parametrize("ground", [LEVEL, HILL], ids=["level", "hill"])
def test_gliding_goes_where_the_space_would_go(build, ground):
    spaced, glided = (placed(build, Pose(0.3, -0.2, 0.7), ground) for _ in range(2))
    for command in commands(build, 1, 400):
        tick(spaced, command)
        gliding(glided, command)
        a, b = spaced.body, glided.body
        assert (a.position - b.position).length < 1e-12
        assert abs(a.angle - b.angle) < 1e-12
        assert (a.velocity - b.velocity).length < 1e-12
        assert abs(a.angular_velocity - b.angular_velocity) < 1e-12
        assert glided.wheels.speed == pytest.approx(spaced.wheels.speed, abs=1e-11)
        assert glided.load == spaced.load


@by_build
def test_one_may_take_turns_with_the_other(build):
    mixed, spaced = placed(build), placed(build)
    for number, command in enumerate(commands(build, 2, 200)):
        (gliding if number % 3 else tick)(mixed, command)
        tick(spaced, command)
        assert (mixed.body.position - spaced.body.position).length < 1e-12


@by_build
def test_nothing_is_lost_on_free_ground(build):
    robot = placed(build)
    for command in commands(build, 3, 300):
        gliding(robot, command)
        assert robot.blocked == 0.0


def test_the_round_robot_drives_as_it_always_has():
    robot, chance = placed(Build(), Pose(0.0, 0.0, 0.3)), np.random.default_rng(7)
    for number in range(400):
        if number % 5 == 0:
            drive = Drive(chance.uniform(-0.3, 0.3), chance.uniform(-1.2, 1.2))
        tick(robot, Command(drive))
    x, y, theta = 0.24272696297789148, -0.7962523673204173, 3.0108453358718066
    assert (robot.pose.x, robot.pose.y, robot.pose.theta) == pytest.approx((x, y, theta), abs=1e-12)
    assert (robot.speed, robot.turn_rate) == pytest.approx((-0.1782529486718903, -0.8), abs=1e-12)


def test_a_hull_of_rings_is_refused():
    with pytest.raises(ValueError, match="circle or a convex polygon"):
        placed(Build(Rings(()), Differential()))


# --- what it says of itself -----------------------------------------------------------------------


@pytest.mark.parametrize("name", ["synchro", "disc", "box", "tracks", "steered"])
def test_an_arc_has_the_radius_of_speed_over_turn_rate(name):
    build = BUILDS[name]
    slip = build.drive.slip if isinstance(build.drive, SkidSteer) else 1.0
    robot = let(placed(build), Drive(0.2, 0.06), 10)
    places = []
    for _ in range(3):
        places.append(complex(robot.pose.x, robot.pose.y))
        let(robot, Drive(0.2, 0.06), 10)
    radius = _circle(places)
    middle = math.hypot(0.2 / 0.06, build.drive.wheelbase / 2) if isinstance(build.drive, Ackermann) else 0.2 / 0.06
    assert radius == pytest.approx(middle * slip, rel=1e-4)


def _circle(places: list[complex]) -> float:
    """Radius of the circle through three places."""
    a, b, c = places
    area = abs(((b - a).conjugate() * (c - a)).imag) / 2
    return abs(a - b) * abs(b - c) * abs(c - a) / (4 * area)


def test_a_skid_steered_hull_turns_less_than_commanded_by_exactly_the_slip():
    robot = let(placed(BUILDS["tracks"]), Drive(0.1, 0.65), 2)
    assert robot.turn_rate == pytest.approx(0.5, abs=1e-12)
    assert robot.wheels.turn_rate == pytest.approx(0.65, abs=1e-9)
    assert robot.wheels.speed == pytest.approx(0.1, rel=1e-3)


def test_a_steered_robot_never_turns_standing():
    robot = let(placed(BUILDS["steered"]), Drive(0.0, 1.0), 5)
    assert robot.pose == Pose(0.0, 0.0, 0.0)
    assert robot.standing


def test_a_steered_robot_turns_no_tighter_than_its_wheelbase_allows():
    robot = let(placed(BUILDS["steered"]), Drive(0.5, 5.0), 10)
    assert robot.turn_rate == pytest.approx(0.5 * math.tan(0.5) / 1.4)
    assert robot.aside == pytest.approx(robot.turn_rate * 0.7)


def test_its_rear_axle_goes_along_the_heading():
    robot, axle = placed(BUILDS["steered"]), []
    for _ in range(100):
        gliding(robot, Command(Drive(0.8, 0.3)))
        x, y, theta = robot.pose.x, robot.pose.y, robot.pose.theta
        axle.append((x - 0.7 * math.cos(theta), y - 0.7 * math.sin(theta), theta))
    for (x0, y0, theta0), (x1, y1, theta1) in pairwise(axle):
        middle = theta0 + wrap(theta1 - theta0) / 2
        assert (y1 - y0) * math.cos(middle) - (x1 - x0) * math.sin(middle) == pytest.approx(0.0, abs=1e-4)


@by_build
def test_speed_is_along_the_heading_and_negative_backwards(build):
    robot = let(placed(build, Pose(0.0, 0.0, 2.0)), Drive(-0.2, 0.0), 3)
    assert robot.speed == pytest.approx(-0.2)
    assert robot.wheels.speed == pytest.approx(-0.2)
    assert not robot.standing


def test_acceleration_is_felt_forward_while_it_speeds_up_and_sideways_in_a_curve():
    robot = placed(BUILDS["disc"])
    gliding(robot, Command(Drive(0.5, 0.0)))
    gliding(robot, Command(Drive(0.5, 0.0)))
    assert robot.acceleration == pytest.approx((1.0, 0.0), abs=1e-9)
    let(robot, Drive(0.3, 0.5), 2)
    assert robot.acceleration == pytest.approx((0.0, 0.15), abs=5e-3)


def test_uphill_it_loses_speed():
    slope = Ground((Slope((-9, -9, 9, 9), 0.2, 0.0),))
    up = let(placed(BUILDS["tracks"], ground=slope), Drive(0.4, 0.0), 3)
    down = let(placed(BUILDS["tracks"], ground=slope), Drive(-0.4, 0.0), 3)
    assert up.speed == pytest.approx(0.4 * (1 - 0.5 * 0.2))
    assert down.speed == pytest.approx(-0.4)


def test_it_loses_speed_where_the_slope_begins():
    slope = Ground((Slope((1.0, -9, 9, 9), 0.2, 0.0),))
    robot = let(placed(BUILDS["tracks"], ground=slope), Drive(0.4, 0.0), 2)
    assert robot.speed == pytest.approx(0.4)
    let(robot, Drive(0.4, 0.0), 2)
    assert robot.speed == pytest.approx(0.36)
    assert robot.blocked == 0.0


def test_numbers_of_numpy_do_not_spread():
    robot = let(placed(BUILDS["disc"]), Drive(np.float64(0.2), np.float64(0.1)), 1)
    told = [robot.pose.x, robot.speed, robot.turn_rate, robot.wheels.speed, robot.load.left, robot.blocked]
    assert {type(number) for number in told} == {float}


def test_put_brings_it_to_rest_elsewhere():
    robot = let(placed(BUILDS["disc"]), Drive(0.4, 0.5), 3)
    robot.put(Pose(5.0, 6.0, 1.0))
    assert (robot.pose, robot.speed, robot.standing) == (Pose(5.0, 6.0, 1.0), 0.0, True)
    gliding(robot, STOP)
    assert robot.pose == Pose(5.0, 6.0, 1.0)


# --- contacts -------------------------------------------------------------------------------------

HARD = [Drive(9.0, 0.0), Drive(9.0, 3.0), Drive(9.0, -9.0)]


@by_build
@pytest.mark.parametrize("thickness", [0.0, 0.2], ids=["line", "slab"])
@pytest.mark.parametrize("substeps", [5, 10], ids=["0.02 s", "0.01 s"])
def test_pushing_a_wall_at_full_speed_goes_in_less_than_five_millimetres(build, thickness, substeps):
    deepest = -math.inf
    for heading in (0.0, 0.3, 0.8, 1.4):
        for drive in HARD:
            robot = placed(build, Pose(0.0, 0.0, heading))
            wall(robot, build.radius + 0.4, thickness)
            deepest = max(deepest, reached(robot, drive, substeps) - build.radius - 0.4)
    assert -0.005 < deepest < 0.005


TURNING = [
    (name, drive) for name in ("box", "tracks") for drive in (Drive(0.0, 9.0), Drive(0.1, 2.0), Drive(-0.1, 2.0))
]


@pytest.mark.parametrize(("name", "drive"), [*TURNING, ("steered", Drive(0.3, 9.0))])
def test_a_corner_that_turns_into_a_wall_is_stopped_by_it(name, drive):
    build, robot = BUILDS[name], placed(BUILDS[name])
    at = build.radius - 0.02  # the box is free as it stands, its corners are not when it turns
    wall(robot, at, 0.2)
    assert -0.005 < reached(robot, drive, SUBSTEPS) - at < 0.005


def test_a_robot_comes_up_to_a_wall_before_it_goes_into_it():
    robot, at = placed(BUILDS["box"]), 1.05
    wall(robot, at)
    seen: list[tuple[float, float]] = []
    for _ in range(10):
        tick(robot, Command(Drive(2.0, 0.0)), after=lambda: seen.append((frontmost(robot) - at, robot.asked[0])))
    assert 0.0 < max(depth for depth, _ in seen) < 0.0025
    assert seen[-1][1] == pytest.approx(2.0)  # it goes on asking


@pytest.mark.parametrize("build", [BUILDS[name] for name in ("box", "tracks", "steered")])
@pytest.mark.parametrize("seed", [3, 15, 21])
def test_no_hull_leaves_a_cluttered_yard_or_goes_deep_into_what_stands_there(build, seed):
    robot, chance, side = placed(build), np.random.default_rng(seed), 3 * build.radius + 1
    standing = _yard(robot, chance, side)
    depths = [0.0]
    for number in range(150):
        if number % 25 == 0:
            forward, turn = chance.choice([1.0, 1.0, 1.0, 1.0, -1.0]), chance.uniform(-0.5, 0.5)
            drive = Drive(forward * build.max_speed, turn * build.max_turn_rate)
        tick(
            robot,
            Command(drive),
            after=lambda: depths.append(max(_depth(robot, shape) for shape in standing)),
        )
        assert max(abs(robot.pose.x), abs(robot.pose.y)) < side
        assert 0.0 <= robot.blocked <= 1.0
    assert 0.0 < max(depths) < 0.01


def _yard(robot: Robot, chance: np.random.Generator, side: float) -> list[pymunk.Shape]:
    space, radius = robot.body.space, robot.build.radius
    corners = [(-side, -side), (side, -side), (side, side), (-side, side), (-side, -side)]
    shapes: list[pymunk.Shape] = [pymunk.Segment(space.static_body, a, b, 0.0) for a, b in pairwise(corners)]
    for place in chance.uniform(-side, side, (10, 2)).tolist():
        if math.hypot(*place) > 1.2 * radius + 0.4:
            shapes.append(pymunk.Circle(space.static_body, 0.1 * radius + 0.05, place))
    for shape in shapes:
        shape.friction, shape.collision_type = FRICTION, OTHER
    space.add(*shapes)
    cart(robot, radius + 0.3, 0.1, 5.0)
    return shapes


def _depth(robot: Robot, shape: pymunk.Shape) -> float:
    """How deep [m] the hull lies in a shape."""
    x, y = robot.body.position
    if shape.point_query((x, y)).distance > robot.build.radius + shape.radius:
        return 0.0
    found = [info for info in robot.body.space.shape_query(robot.shapes[0]) if info.shape is shape]
    sets = [info.contact_point_set for info in found]
    return max([-(p.point_b - p.point_a).dot(s.normal) for s in sets for p in s.points], default=0.0)


def test_a_box_against_a_wall_is_turned_flat_by_it():
    robot = placed(BUILDS["box"], Pose(0.0, 0.0, 0.3))
    wall(robot, 1.0)
    for _ in range(40):
        tick(robot, Command(Drive(0.5, 0.0)))
    assert robot.pose.theta == pytest.approx(0.0, abs=1e-3)
    assert robot.standing


def test_a_round_robot_is_not_turned_by_a_wall():
    robot = placed(BUILDS["disc"], Pose(0.0, 0.0, 0.3))
    wall(robot, 1.0)
    for _ in range(60):
        tick(robot, Command(Drive(0.5, 0.0)))
    assert robot.pose.theta == 0.3
    assert robot.pose.y > 0.4


def test_a_fast_robot_does_not_pass_through_a_thin_wall():
    robot = placed(Build(Circle(0.02), Differential(max_speed=20.0, acceleration=1000.0), 1.0))
    wall(robot, 2.0)
    for _ in range(10):
        tick(robot, Command(Drive(20.0, 0.0)))
    assert robot.pose.x == pytest.approx(1.98, abs=0.005)


def test_what_moves_away_as_fast_does_not_hinder():
    robot = placed(BUILDS["box"])
    runner = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    shape = pymunk.Circle(runner, 0.1)
    robot.body.space.add(runner, shape)
    let(robot, Drive(2.0, 0.0), 2)
    runner.position, runner.velocity = (robot.pose.x + 0.254 + 0.101, 0.0), (2.0, 0.0)
    robot.body.space.reindex_shapes_for_body(robot.body)
    for _ in range(10):
        tick(robot, Command(Drive(2.0, 0.0)))
        assert robot.blocked == 0.0


def test_looking_ahead_heeds_no_sensor_shape():
    robot = placed(BUILDS["box"])
    wall(robot, 1.0).sensor = True
    for _ in range(20):
        tick(robot, Command(Drive(2.0, 0.0)))
        assert robot.blocked == 0.0
    assert robot.pose.x > 2.0


@by_build
@pytest.mark.parametrize("mass", [0.5, 10.0, 300.0])
@pytest.mark.parametrize("pushed", [0.3, 0.5, 0.9, 2.0])
@pytest.mark.parametrize("offset", [0.0, 0.12])
def test_energy_never_grows_once_it_has_been_told_to_stop(build, mass, pushed, offset):
    robot = placed(build)
    pushee = cart(robot, build.radius + 0.2, offset, mass)
    for _ in range(round(pushed / TICK)):
        tick(robot, Command(Drive(9.0, 0.0)))
    energies = [math.inf]
    for _ in range(20):
        tick(robot, STOP, after=lambda: energies.append(_energy(robot) + pushee.kinetic_energy))
    assert all(after <= before * (1 + 1e-9) + 1e-12 for before, after in pairwise(energies))
    assert energies[-1] < 1e-3 * energies[1] + 1e-12


def _energy(robot: Robot) -> float:
    body = robot.body
    turning = 0.0 if math.isinf(body.moment) else body.moment * body.angular_velocity**2 / 2
    return body.mass * body.velocity.length**2 / 2 + turning


def test_a_cart_is_pushed_and_rolls_out():
    robot = placed(BUILDS["box"])
    pushee = cart(robot, 0.6, 0.0, 3.0)
    for _ in range(20):
        tick(robot, Command(Drive(0.5, 0.0)))
    assert pushee.velocity.x == pytest.approx(0.5, abs=0.05)
    for _ in range(20):
        tick(robot, STOP)
    assert pushee.velocity.length < 0.01


# --- flippers and currents ------------------------------------------------------------------------

DOWN, HOME = Command(Drive(0.5, 0.0), flippers=Flippers(True)), Command(Drive(0.5, 0.0), flippers=Flippers(False))


def test_flippers_take_half_a_second_down_and_up():
    robot, angles = placed(BUILDS["tracks"]), []
    for command in [DOWN] * 6 + [HOME] * 6:
        gliding(robot, command)
        angles.append((round(robot.flippers.angle, 6), robot.flippers.deployed))
    fifth = round(math.pi / 10, 6)
    ways = [1, 2, 3, 4, 5, 5, 4, 3, 2, 1, 0, 0]
    assert [angle for angle, _ in angles] == pytest.approx([way * fifth for way in ways], abs=5e-6)
    assert [deployed for _, deployed in angles] == [way == 5 for way in ways]


def test_flippers_stay_as_they_are_without_a_word():
    robot = placed(BUILDS["tracks"])
    for command in [DOWN] * 6 + [STOP] * 20:
        gliding(robot, command)
    assert robot.flippers.deployed


def test_wheels_have_no_flippers_and_climb_nothing():
    robot = placed(BUILDS["box"])
    for _ in range(10):
        gliding(robot, DOWN)
    assert (robot.flippers.angle, robot.flippers.deployed, robot.climbs()) == (0.0, False, 0.0)


def test_free_tracks_draw_little_enough_for_flippers_to_go_home():
    robot = let(placed(BUILDS["tracks"]), Drive(0.5, 0.0), 2)
    assert (robot.load.left, robot.load.right) == pytest.approx((1.5, 1.5))


def test_turning_draws_more_than_driving_and_less_than_being_stuck():
    robot = let(placed(BUILDS["tracks"]), Drive(0.0, 1.0), 2)
    assert robot.load.left == pytest.approx(robot.load.right)
    assert 2.0 < robot.load.left < 15.0


def test_a_blocked_robot_draws_all_it_can():
    robot = placed(BUILDS["tracks"])
    wall(robot, 1.0)
    for _ in range(30):
        tick(robot, Command(Drive(0.5, 0.0)))
    assert (robot.blocked, robot.load.left, robot.load.right) == pytest.approx((1.0, 25.0, 25.0))
    tick(robot, STOP)
    for _ in range(5):
        tick(robot, STOP)
    assert robot.load.left == pytest.approx(0.5)


def test_climbing_draws_eight_amperes():
    robot = let(placed(BUILDS["tracks"]), Drive(0.5, 0.0), 1)
    robot.settle(TICK, climbing=True)
    assert (robot.load.left, robot.load.right) == (8.0, 8.0)


def test_it_climbs_higher_after_a_second_of_pushing_with_its_flippers_down():
    robot, climbs = placed(BUILDS["tracks"], Pose(0.654, 0.0)), []
    wall(robot, 1.0)
    for _ in range(10):
        tick(robot, HOME)
    for _ in range(20):
        tick(robot, DOWN)
        climbs.append(robot.climbs())
    assert climbs[:14] == [0.08] * 14  # half a second down, a second of pushing
    assert climbs[15:] == [0.2] * 5
    tick(robot, STOP)
    for _ in range(3):
        tick(robot, STOP)
    assert robot.climbs() == 0.08


def test_flippers_that_bear_on_free_ground_lift_nothing():
    robot = placed(BUILDS["tracks"])
    for _ in range(30):
        gliding(robot, DOWN)
    assert robot.climbs() == 0.08


def test_a_hull_on_a_curb_stays_lifted_until_it_is_over():
    robot = placed(BUILDS["tracks"], Pose(0.654, 0.0))
    shape = wall(robot, 1.0)
    for _ in range(30):
        tick(robot, DOWN)
    robot.body.space.remove(shape)
    for climbing, height in [(True, 0.2), (True, 0.2), (False, 0.08)]:
        for _ in range(5):
            robot.command(DOWN)
            robot.glide(DT)
            robot.settle(DT, climbing)
            robot.tell()
        assert robot.climbs() == height


# --- the models -----------------------------------------------------------------------------------


@pytest.mark.parametrize("name", MODELS)
def test_every_model_reaches_its_speed(name):
    build = MODELS[name].build
    robot = let(placed(build), Drive(99.0, 0.0), 5)
    assert robot.speed == pytest.approx(build.max_speed)


@pytest.mark.parametrize("name", MODELS)
def test_every_model_carries_odometry_and_no_name_twice(name):
    names = [sensor.name for sensor in MODELS[name].sensors]
    assert "odometry" in names
    assert len(set(names)) == len(names)


def test_only_round_models_have_synchro_drives():
    for model in MODELS.values():
        assert isinstance(model.build.hull, Circle) or not isinstance(model.build.drive, Synchro)
