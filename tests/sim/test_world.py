"""The world moves as its parts promise: drive, contacts, cars, people, trashcans, donor."""

from __future__ import annotations

import math

import pytest

from behaviours.interface import STOP, Command, Drive, Head
from sim.world import World

AHEAD, BACK = Command(Drive(0.2, 0.0)), Command(Drive(-0.2, 0.0))


def let(world: World, command: Command, seconds: float) -> World:
    for _ in range(round(seconds * 10)):
        world.step(command)
    return world


def thing(world: World, name: str):
    return next(thing for thing in world.things if thing.placed.id == name)


# --- the drive ------------------------------------------------------------------------------------


def test_the_robot_drives_at_its_speed_after_a_modest_start(small):
    world = let(World(small(), 0), AHEAD, 10)
    assert world.robot.pose.x == pytest.approx(2.0 - 0.2 * 0.2, abs=0.01)
    assert world.robot.speed == pytest.approx(0.2)


def test_commands_beyond_the_drive_are_clipped(small):
    world = let(World(small(), 0), Command(Drive(5.0, 9.0)), 2)
    assert (world.robot.speed, world.robot.turn_rate) == pytest.approx((0.2, 0.8))


def test_a_command_without_a_drive_stops_the_robot(small):
    world = let(let(World(small(), 0), AHEAD, 3), Command(head=Head(0.1, 0.0)), 1)
    assert world.robot.standing


def test_an_arc_has_the_radius_of_speed_over_turn_rate(small):
    world = let(World(small(), 0), Command(Drive(0.2, 0.4)), 0.6)
    x, y = world.robot.pose.x, world.robot.pose.y
    turned = let(world, Command(Drive(0.2, 0.4)), math.tau / 0.4)
    assert math.hypot(turned.robot.pose.x - x, turned.robot.pose.y - y) < 0.03


def test_it_drives_backwards(small):
    assert let(World(small(), 0), BACK, 5).robot.pose.x < -0.9


def test_a_command_that_is_not_finite_is_refused(small):
    with pytest.raises(ValueError, match="finite"):
        World(small(), 0).step(Command(Drive(math.nan, 0.0)))


# --- contacts -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "thing_text",
    ["{kind: wall, from: [1, -3], to: [1, 3]}", "{kind: post, at: [1, 0]}", "{kind: parked-car, at: [3, 0.5]}"],
)
@pytest.mark.parametrize("heading", ["0", "0.5"])
def test_pushing_into_what_stands_penetrates_less_than_a_centimetre(small, thing_text, heading):
    world, deepest = World(small(thing_text, heading=heading), 0), math.inf
    for _ in range(150):
        world.step(AHEAD)
        deepest = min(deepest, world.clearance())
    assert -0.01 < deepest < 0.002


def test_driving_into_a_wall_is_the_robots_doing(small):
    world = World(small("{kind: wall, from: [1, -3], to: [1, 3]}"), 0)
    seen = []
    for _ in range(60):
        world.step(AHEAD)
        seen += world.begun
    assert [(touch.thing, touch.driven_into) for touch in seen] == [("wall-1", True)]
    assert seen[0].time == pytest.approx((0.9 - 0.35) / 0.2, abs=0.4)
    assert world.touches == tuple(seen)


def test_backing_into_a_post_is_the_robots_doing(small):
    world = let(World(small("{kind: post, at: [-1, 0]}"), 0), BACK, 6)
    assert [touch.driven_into for touch in world.touches] == [True]


def test_being_struck_by_what_moves_is_not(small):
    shove = "{kind: person, track: [[-6, 0.2], [6, 0.2]], speed: 3, then: stay}"  # too fast to stop in time
    world, seen = World(small(shove), 0), []
    for _ in range(100):
        world.step(AHEAD)
        seen += world.begun
    assert [(touch.thing, touch.driven_into) for touch in seen][:1] == [("person-1", False)]


def test_who_comes_faster_has_struck(small):
    runner = "{kind: person, track: [[6, 0], [-6, 0]], speed: 3, then: stay}"
    world, seen = World(small(runner), 0), []
    for _ in range(30):
        world.step(AHEAD)
        seen += world.begun
    assert [(touch.thing, touch.driven_into) for touch in seen][:1] == [("person-1", False)]


def test_a_contact_ends_when_the_robot_leaves(small):
    world = let(World(small("{kind: post, at: [1, 0]}"), 0), AHEAD, 5)
    assert len(world.touches) == 1
    assert let(world, BACK, 3).touches == ()


def test_a_trashcan_can_be_pushed_and_stays_where_it_is_left(small):
    world = let(World(small("{kind: trashcan, at: [1, 0]}"), 0), AHEAD, 8)
    pushed = thing(world, "trashcan-1").pose.x
    assert pushed > 1.5
    left = let(world, BACK, 3)
    assert thing(left, "trashcan-1").pose.x == pytest.approx(pushed, abs=0.06)


def test_clearance_is_the_gap_between_hulls(small):
    world = World(small("{kind: post, at: [2, 0]}", "{kind: wall, from: [-3, 1.5], to: [3, 1.5]}"), 0)
    assert world.clearance() == pytest.approx(1.4 - 0.35)


# --- what moves -----------------------------------------------------------------------------------


def test_a_car_comes_at_its_time_drives_through_and_comes_again(small):
    car = "{kind: car, id: car, track: [[-9, 4], [9, 4]], speed: 3, starts: {at: 2, every: 10}}"
    world, there = World(small(car), 0), []
    for _ in range(140):
        world.step(STOP)
        there.append(thing(world, "car").present)
    arrivals = [tick for tick in range(1, 140) if there[tick] and not there[tick - 1]]
    assert arrivals == [20, 120]
    assert there.index(False, 20) == pytest.approx(80, abs=2)


def test_a_car_brakes_for_a_robot_in_its_lane_and_goes_on_when_it_is_gone(small):
    car = "{kind: car, id: car, track: [[-9, 0], [9, 0]], speed: 2, then: stay}"
    world = let(World(small(car), 0), STOP, 10)
    gap = -0.35 - (thing(world, "car").pose.x + 2.2)
    assert 1.5 < gap < 3.0
    assert world.touches == ()
    let(world, Command(Drive(0.0, 0.8)), math.pi / 2 / 0.8)
    away = let(let(world, AHEAD, 10), STOP, 8)
    assert thing(away, "car").pose.x == pytest.approx(9, abs=0.3)


def test_a_car_does_not_wait_for_a_robot_behind_it(small):
    car = "{kind: car, id: car, track: [[3, 0], [9, 0]], speed: 2, then: stay}"
    assert thing(let(World(small(car), 0), STOP, 6), "car").pose.x == pytest.approx(9, abs=0.3)


def test_a_car_brakes_for_a_trashcan_and_a_person_walks_past_one(small):
    car = "{kind: car, id: car, track: [[-9, 4], [9, 4]], speed: 2, then: stay}"
    world = let(World(small(car, "{kind: trashcan, at: [0, 4]}"), 0), STOP, 10)
    assert 1.5 < -0.3 - (thing(world, "car").pose.x + 2.2) < 3.0
    walk = "{kind: person, id: walker, track: [[-4, 4], [4, 4]], speed: 1, then: stay}"
    world = let(World(small(walk, "{kind: trashcan, at: [0, 4.9]}"), 0), STOP, 9)
    assert thing(world, "walker").pose.x == pytest.approx(4, abs=0.3)


def test_a_car_in_the_next_lane_drives_past(small):
    car = "{kind: car, id: car, track: [[-9, 1.5], [9, 1.5]], speed: 2, then: stay}"
    world = let(World(small(car), 0), STOP, 12)
    assert thing(world, "car").pose.x == pytest.approx(9, abs=0.3)


def test_a_car_turns_into_the_next_leg_of_its_track(small):
    car = "{kind: car, id: car, track: [[-5, 5], [5, 5], [5, 9]], speed: 2, then: stay}"
    pose = thing(let(World(small(car), 0), STOP, 9), "car").pose
    assert (pose.x, pose.y, pose.theta) == pytest.approx((5, 9, math.pi / 2), abs=0.3)


def test_a_walking_person_stops_short_of_the_robot(small):
    walk = "{kind: person, id: walker, track: [[-4, 0], [4, 0]], speed: 0.8}"
    world = let(World(small(walk), 0), STOP, 10)
    gap = -0.35 - (thing(world, "walker").pose.x + 0.25)
    assert 0.3 < gap < 0.6


def test_a_walk_waits_at_its_waypoints_and_comes_back(small):
    walk = "{kind: person, id: walker, track: [[-3, 4, 3], [1, 4, 5]], speed: 1}"
    world = let(World(small(walk), 0), STOP, 8)
    assert thing(world, "walker").pose.x == pytest.approx(1, abs=0.01)
    assert thing(let(world, STOP, 10), "walker").pose.x == pytest.approx(-3, abs=0.01)


def test_a_walk_that_waits_for_the_robot_begins_when_it_has_left(small):
    walk = "{kind: person, id: walker, track: [[-3, 4], [1, 4]], speed: 1, starts: {robot_left: 1}}"
    world = let(World(small(walk), 0), AHEAD, 4)
    assert thing(world, "walker").pose.x == -3
    assert thing(let(world, AHEAD, 4), "walker").pose.x > -2.5


@pytest.mark.parametrize("at", ["[2.5, 0]", "[0, -2.5]", "[-2, 1]"])
def test_a_rolled_trashcan_comes_to_rest_at_a_hands_breadth_without_touching(small, at):
    can = f"{{kind: trashcan, id: can, at: {at}, roll: {{starts: {{at: 1}}, speed: 1}}}}"
    world, least = World(small(can), 0), math.inf
    for _ in range(80):
        world.step(STOP)
        least = min(least, world.clearance())
    assert world.clearance() == pytest.approx(0.1, abs=0.02)
    assert least > 0.07
    assert thing(world, "can").speed < 0.01


def test_a_trashcan_is_rolled_when_the_robot_comes_near(small):
    can = "{kind: trashcan, id: can, at: [0, 3], roll: {starts: {robot_within: 2}}}"
    assert thing(let(World(small(can), 0), AHEAD, 5), "can").pose.y == 3
    near = let(World(small(can, heading="90 deg"), 0), AHEAD, 6)
    assert thing(near, "can").pose.y < 2.9


def test_a_trashcan_that_rolls_into_a_post_gives_up(small):
    can = "{kind: trashcan, id: can, at: [0, 3], roll: {starts: {at: 0}}}"
    world = let(World(small(can, "{kind: post, at: [0, 1.5]}"), 0), STOP, 14)
    assert world.clearance() > 0.3
    assert thing(world, "can").speed < 0.01


def test_the_donor_moves_by_what_is_said_and_when(small):
    world = World(small(donor="[3, 0]", more_donor="move: {starts: {at: 2}, by: [1, 0.5]}"), 0)
    assert let(world, STOP, 2).donors[0].pose.x == 3
    moved = let(world, STOP, 8).donors[0]
    assert (moved.pose.x, moved.pose.y) == pytest.approx((4, 0.5))
    assert moved.speed == 0


# --- the hand-over --------------------------------------------------------------------------------


def test_the_object_changes_hands_after_fifteen_seconds_of_standing_in_reach(small):
    world = World(small(donor="[1.5, 0]"), 0)
    assert world.donor_gaps[0] == pytest.approx(0.9)
    assert not let(world, STOP, 14.9).sense().object_on_board
    assert let(world, STOP, 0.1).sense().object_on_board
    assert let(world, BACK, 5).sense().object_on_board


def test_moving_within_reach_begins_the_hand_over_anew(small):
    world = let(World(small(donor="[1.4, 0]"), 0), STOP, 10)
    let(let(world, AHEAD, 0.5), STOP, 0.5)
    assert not let(world, STOP, 14).errand.on_board
    assert let(world, STOP, 1.5).errand.on_board


def test_out_of_reach_nothing_changes_hands(small):
    assert not let(World(small(donor="[1.55, 0]"), 0), STOP, 20).errand.on_board
