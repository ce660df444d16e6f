"""What happens at set times, what is climbed, and that gliding and stepping the space are the same motion."""

from __future__ import annotations

import math

import numpy as np
import pytest

from behaviours.interface import STOP, Command, Drive, Flippers
from sim.scenarios.format import loads
from sim.world import World

ROOM = """
name: room
bounds: [-10, -10, 10, 10]
robot: {robot}
things: [{things}]
{more}
"""


def world(*things: str, robot: str = "{model: packbot, start: [0, 0]}", more: str = "", period: float = 0.1) -> World:
    return World(loads(ROOM.format(robot=robot, things=", ".join(things), more=more)), 0, period)


def let(world: World, command: Command, seconds: float) -> World:
    for _ in range(round(seconds / world.period)):
        world.step(command)
    return world


def named(world: World, name: str):
    return next(thing for thing in world.things if thing.placed.id == name)


AHEAD = Command(Drive(0.5, 0.0))

# --- events -----------------------------------------------------------------------------------------

BIN = "{kind: disc, radius: 0.3, at: [2, 0], id: bin}"


def test_a_thing_vanishes_and_comes_back_elsewhere():
    at = world(BIN, more="events: [{at: 1, vanish: bin}, {at: 2, put: {thing: bin, at: [0, 3, 90 deg]}}]")
    let(at, STOP, 1.1)
    assert not named(at, "bin").present and at.clearance() == 10.0
    let(at, STOP, 1.0)
    assert named(at, "bin").pose.y == 3.0 and named(at, "bin").pose.theta == pytest.approx(math.pi / 2)
    assert at.clearance() < 3.0


def test_what_the_lidar_sees_follows_an_event():
    at = world(BIN, more="events: [{at: 1, vanish: bin}]")
    before = at.sense().lidar
    assert before is not None and np.nanmin(before.ranges) < 2.0
    let(at, STOP, 1.3)
    after = at.sense().lidar
    assert after is not None and np.nanmin(after.ranges) == after.max_range


def test_the_robot_drives_where_a_thing_has_vanished():
    at = let(world(BIN, more="events: [{at: 0.5, vanish: bin}]"), AHEAD, 8)
    assert at.robot.pose.x > 3.0 and not at.begun


# --- curbs ------------------------------------------------------------------------------------------

CURB = "{{kind: curb, from: [1.5, -5], to: [1.5, 5], height: {height}}}"


def test_a_low_curb_is_climbed_and_is_no_contact():
    at = world(CURB.format(height=0.06))
    touched = []
    for _ in range(80):
        at.step(AHEAD)
        touched += at.begun
    assert at.robot.pose.x > 3.0 and touched == []


def test_a_high_curb_stops_a_robot_with_its_flippers_home():
    at = let(world(CURB.format(height=0.15)), AHEAD, 10)
    assert at.robot.pose.x < 1.3 and [touch.driven_into for touch in at.touches] == [True]
    assert max(at.robot.load.left, at.robot.load.right) > 15.0


def test_deployed_flippers_lift_it_over_after_a_second_of_pushing():
    at = let(world(CURB.format(height=0.15)), AHEAD, 5)
    let(at, Command(Drive(0.5, 0.0), flippers=Flippers(True)), 7)
    assert at.robot.pose.x > 2.0


def test_wheels_climb_nothing():
    at = let(world(CURB.format(height=0.05), robot="{model: turtlebot, start: [0, 0]}"), AHEAD, 15)
    assert at.robot.pose.x < 1.5


# --- gliding ----------------------------------------------------------------------------------------

ROBOTS = ["denning", "packbot", "ravon", "jackal", "turtlebot"]


@pytest.mark.parametrize("model", ROBOTS)
def test_gliding_is_the_motion_that_the_space_would_make(model):
    free = world(robot=f"{{model: {model}, start: [0, 0]}}")
    stepped = world(robot=f"{{model: {model}, start: [0, 0]}}")
    stepped._is_free = lambda: False
    chance = np.random.default_rng(5)
    for _ in range(100):
        command = Command(Drive(*chance.uniform(-1, 1, 2)))
        free.step(command)
        stepped.step(command)
    mine, theirs = free.robot.pose, stepped.robot.pose
    assert (mine.x, mine.y, mine.theta) == pytest.approx((theirs.x, theirs.y, theirs.theta), abs=1e-9)


def test_a_driven_thing_glides_along_its_track_far_from_everything():
    moving = "{kind: disc, radius: 0.5, id: disc, keyframes: [[0, 6, 0], [10, 6, 5]]}"
    at = let(world(moving), STOP, 4)
    assert named(at, "disc").pose.y == pytest.approx(2.0)


def test_it_pushes_what_it_meets():
    moving = "{kind: disc, radius: 0.5, id: disc, keyframes: [[0, 6, 0], [10, 6, 5]]}"
    at = let(world(moving, "{kind: cart, at: [6, 2], id: cart}"), STOP, 8)
    assert named(at, "cart").pose.y > 3.0


def test_what_lies_still_is_not_moved_by_gliding():
    at = let(world("{kind: cart, at: [3, 3], id: cart}"), Command(Drive(0.3, 0.4)), 10)
    assert (named(at, "cart").pose.x, named(at, "cart").pose.y) == (3.0, 3.0)


def test_clearance_is_a_lower_bound_where_a_bound_is_enough():
    at = world(BIN)
    exact = at.clearance()
    assert at.clearance(below=0.5) == 0.5
    assert at.clearance(below=5.0) == pytest.approx(exact)


def test_a_hull_that_is_not_round_is_as_near_as_its_edge():
    at = world("{kind: wall, from: [-5, 2], to: [5, 2]}", robot="{model: jackal, start: [0, 0]}")
    assert at.clearance() == pytest.approx(1.9 - 0.215, abs=0.01)


# --- ticks ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("period", [0.02, 0.028, 0.05, 0.25])
def test_a_tick_may_have_another_length(period):
    at = world(period=period)
    let(at, AHEAD, 5)
    assert at.time == pytest.approx(5.0, abs=period) and at.robot.pose.x == pytest.approx(2.3, abs=0.15)
    assert at.sense().stamp == at.time


def test_the_bearing_of_a_contact_is_told_to_the_bumper():
    at = let(world("{kind: wall, from: [1, -3], to: [1, 3]}"), AHEAD, 4)
    bumper = at.sense().bumper
    assert bumper is not None and abs(bumper.bearings[bumper.pressed][0]) < math.radians(50)
