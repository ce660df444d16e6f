"""Navigation templates: grouping, spins, headings, and the situations of the paper."""

import itertools
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from behaviours.cores.circles import Circle
from behaviours.cores.nat import NatSettings, components, drive, half_angle, link, make_plan
from behaviours.estimators.obstacles import Obstacles
from behaviours.interface import Pose, wrap

SETTINGS = NatSettings()
APART = SETTINGS.robot_width + 2 * SETTINGS.group_margin
ORIGIN, GOAL = Pose(0.0, 0.0), Pose(8.0, 0.0)


def circle(ident, x, y, radius=0.3):
    return Circle(ident, ((x, y, 0),), x, y, radius)


def plan(*circles, robot=ORIGIN, goal=GOAL, before=None, memory=None, now=0.0, settings=SETTINGS):
    return make_plan(circles, robot, goal, before or {}, memory or {}, now, settings)


def sizes(*circles, before=None):
    return sorted(map(len, components(len(circles), link(circles, before or {}, SETTINGS))))


def test_free_of_obstacles_it_heads_for_the_goal():
    assert plan().heading == 0.0


def test_circles_between_which_the_robot_does_not_fit_are_one_group():
    narrow, wide = circle(1, 2, 0.6 + APART - 0.01), circle(1, 2, 0.6 + APART + 0.01)
    assert sizes(circle(0, 2, 0), narrow) == [2]
    assert sizes(circle(0, 2, 0), wide) == [1, 1]


def test_what_was_one_group_is_parted_only_by_a_wider_gap():
    a, b = circle(0, 2, 0), circle(1, 2, 0.6 + APART + 0.2)
    assert sizes(a, b, before={0: 5, 1: 5}) == [2]
    assert sizes(a, b, before={0: 5, 1: 6}) == [1, 1]


def test_a_new_circle_counts_with_the_group_that_it_overlaps():
    old, reborn, other = circle(0, 2, 0), circle(7, 2, 0.1), circle(1, 2, 0.7 + APART + 0.2)
    assert sizes(old, reborn, other, before={0: 5, 1: 5}) == [3]


def test_an_obstacle_right_of_the_path_is_passed_clockwise_on_the_left_of_it():
    made = plan(circle(0, 2, -0.2))
    assert made.groups[0].spin == "cw" and made.heading > 0


def test_an_obstacle_left_of_the_path_is_passed_counterclockwise_on_the_right_of_it():
    made = plan(circle(0, 2, 0.2))
    assert made.groups[0].spin == "ccw" and made.heading < 0


def test_the_heading_just_clears_the_obstacle():
    made = plan(circle(0, 2, -0.2))
    miss = abs(math.cos(made.heading) * -0.2 - math.sin(made.heading) * 2)
    assert miss == pytest.approx(0.3 + SETTINGS.robot_width / 2 + SETTINGS.clearance)


def test_what_lies_beyond_the_goal_is_no_obstacle():
    made = plan(circle(0, 2.3, 0.0), goal=Pose(2.0, 0.0))
    assert made.heading == 0.0 and made.groups == ()


def test_a_spin_is_kept_until_the_other_side_is_much_better():
    memory = {0: ("cw", 0.0)}
    assert plan(circle(0, 2, 0.1), memory=memory).groups[0].spin == "cw"
    assert plan(circle(0, 2, 0.9), memory=memory).groups[0].spin == "ccw"


def test_a_group_takes_the_spin_of_the_majority():
    memory = {0: ("ccw", 0.0), 1: ("cw", 0.0), 2: ("cw", 0.0)}
    made = plan(circle(0, 2, 0.3), circle(1, 2, 0.0), circle(2, 2.2, 0.2), memory=memory)
    assert [g.spin for g in made.groups] == ["cw"]


def test_a_locked_spin_is_kept_until_its_time():
    memory = {0: ("cw", 10.0)}
    assert plan(circle(0, 2, 0.9), memory=memory, now=9.0).groups[0].spin == "cw"
    assert plan(circle(0, 2, 0.9), memory=memory, now=10.0).groups[0].spin == "ccw"


def test_a_farther_group_that_contradicts_a_nearer_one_is_skipped():
    memory = {0: ("cw", 99.0), 1: ("ccw", 99.0)}
    made = plan(circle(0, 1.2, 0.0), circle(1, 0.8, 2.9), memory=memory, settings=NatSettings(squeeze=0.0))
    assert [g.heeded for g in made.groups] == [True, True]
    made = plan(circle(0, 1.2, 0.0), circle(1, 2.5, 2.2), memory=memory, settings=NatSettings(squeeze=0.0))
    assert [g.heeded for g in made.groups] == [True, False]


def test_in_a_tight_gap_the_way_is_the_middle():
    memory = {0: ("cw", 99.0), 1: ("ccw", 99.0)}
    made = plan(circle(0, 1.5, -0.87), circle(1, 1.5, 0.87), memory=memory)
    assert [g.heeded for g in made.groups] == [True, True]
    assert made.interval[0] == made.interval[1] and made.heading == pytest.approx(0.0, abs=1e-6)


def test_within_the_clearance_of_an_obstacle_the_heading_pushes_out():
    assert half_angle(0.5, 0.9) > math.pi / 2
    assert half_angle(1.8, 0.9) == pytest.approx(math.pi / 6)


def test_a_ring_around_the_robot_is_left_through_its_widest_gap():
    spots = [0.5 + i * (math.tau - 1.0) / 8 for i in range(9)]
    ring = [circle(i, 1.6 * math.cos(a), 1.6 * math.sin(a), 0.2) for i, a in enumerate(spots)]
    assert sizes(*ring) == [9]
    assert abs(plan(*ring).heading) < 0.2


def test_it_slows_near_obstacles_and_stops_to_turn():
    assert drive(0.0, 5.0, SETTINGS) == (pytest.approx(0.2), 0.0)
    assert drive(0.0, 0.85, SETTINGS)[0] == pytest.approx(0.1)
    assert drive(0.0, 0.1, SETTINGS)[0] == pytest.approx(0.04), "never less than a fifth"
    assert drive(math.pi / 2, 5.0, SETTINGS) == (pytest.approx(0.0, abs=1e-9), 0.8)


places = st.tuples(st.floats(0.3, 6), st.floats(-math.pi, math.pi), st.floats(0.05, 0.6))


@given(st.lists(places, max_size=10), st.floats(-math.pi, math.pi), st.floats(-5, 5))
def test_turning_and_moving_the_world_turns_the_heading_and_nothing_else(spots, turn, shift):
    def seen(angle, dx):
        made = [
            circle(i, dx + d * math.cos(b + angle), d * math.sin(b + angle), r) for i, (d, b, r) in enumerate(spots)
        ]
        goal = Pose(dx + 8 * math.cos(angle), 8 * math.sin(angle))
        return plan(*made, robot=Pose(dx, 0.0, angle), goal=goal)

    straight, turned = seen(0.0, 0.0), seen(turn, shift)
    if [(g.idents, g.spin, g.heeded) for g in straight.groups] == [(g.idents, g.spin, g.heeded) for g in turned.groups]:
        assert wrap(turned.heading - turn - straight.heading) == pytest.approx(0.0, abs=1e-5)


@given(st.lists(places, max_size=10), st.floats(-math.pi, math.pi))
def test_every_number_of_a_plan_is_finite(spots, theta):
    made = plan(*[circle(i, d * math.cos(b), d * math.sin(b), r) for i, (d, b, r) in enumerate(spots)])
    assert all(map(math.isfinite, (*made.interval, made.heading)))
    assert all(math.isfinite(g.left) and math.isfinite(g.right) for g in made.groups)


# --- driving in the stand-in ------------------------------------------------------------------------


def drive_to(standin, world, goal, limit, watch=None):
    """Drive with runaway over NaT until the goal or the limit [s]; the ticks of runaway, and whether it arrived."""
    robot = standin.Robot("robot", "runaway", "natigation")
    fled = 0
    while world.stamp < limit:
        reading = world.read()
        percepts = robot.sense(reading)
        if percepts["we-are-at-the-goal"]:
            return fled, True
        action = "stop"
        if percepts["anything-is-too-close"]:
            action, fled = "move-away-from-danger", fled + 1
        elif percepts["there-is-a-goal"]:
            action = "move-according-to-NaT-plan"
        world.act(robot.act(reading, action, goal=goal))
        if watch is not None:
            watch(world, robot)
    return fled, False


FIELD = [(2.0, 0.2, 0.3), (3.6, -1.4, 0.3), (4.4, 0.9, 0.2), (5.6, -0.5, 0.4), (3.0, 2.4, 0.3)]


@pytest.mark.parametrize("seed", range(4))
def test_a_field_of_obstacles_is_crossed_without_touch_and_without_running_away(standin, seed):
    world = standin.World(seed=seed, discs=[standin.Disc(*spot) for spot in FIELD], dropout=0.02)
    fled, arrived = drive_to(standin, world, standin.Pose(7.0, 0.0), 300)
    assert (fled, arrived, world.touched) == (0, True, 0)
    assert world.gap() > 0.2


@pytest.mark.parametrize("crossing", [5.0, 8.0])
@pytest.mark.parametrize("speed", [0.6, 1.4, 2.2])
def test_a_car_that_crosses_is_passed_behind_after_one_change_of_spin(standin, speed, crossing):
    """Figure 2: the car comes from the right; its group starts clockwise and becomes counter-clockwise once."""
    ux, uy = -1 / math.hypot(1, 0.2), -0.2 / math.hypot(1, 0.2)
    x, y = -ux * speed * crossing, 3.2 - uy * speed * crossing
    walls = standin.box(x, y, 4.4, 1.8, math.atan2(uy, ux), speed * ux, speed * uy)
    world = standin.World(walls=walls, pose=standin.Pose(0.0, 0.0, 1.771))
    spins, moving = [], []

    def watch(world, robot):
        plan = robot.estimator(Obstacles).plan
        heeded = [g.spin for g in plan.groups if g.heeded] if plan is not None else []
        if heeded and spins[-1:] != heeded[:1]:
            spins.append(heeded[0])
        moving.append(abs(world.speed) > 0.01)

    # The odometry frame is the first pose: the goal of the paper's figure, (-1.5, 7.4), lies straight ahead in it.
    fled, arrived = drive_to(standin, world, standin.Pose(7.55, 0.0), 60, watch)
    assert (fled, arrived, world.touched) == (0, True, 0)
    assert spins == ["cw", "ccw"]
    assert sum(moving) > 0.88 * len(moving), "without stopping its traversal motion"


def test_a_shallow_canyon_is_escaped(standin):
    walls = [standin.Wall(2, -1.5, 2, 1.5), standin.Wall(0, 1.5, 2, 1.5), standin.Wall(0, -1.5, 2, -1.5)]
    world = standin.World(walls=walls)
    _, arrived = drive_to(standin, world, standin.Pose(6.0, 0.0), 400)
    assert arrived and world.touched == 0


def test_a_canyon_that_takes_more_circles_than_there_are_is_a_trap(standin):
    """The limitation that the paper states: no memory beyond its ten obstacles."""
    walls = [standin.Wall(3, -2, 3, 2), standin.Wall(0, 2, 3, 2), standin.Wall(0, -2, 3, -2)]
    world, seen = standin.World(walls=walls), []
    _, arrived = drive_to(
        standin, world, standin.Pose(7.0, 0.0), 300, lambda _, robot: seen.append(robot.estimator(Obstacles).memory)
    )
    assert not arrived and world.touched == 0 and seen[-1].overflow > 100


def test_the_plan_is_reported_as_plain_values_and_the_same_between_sweeps(standin):
    world = standin.World(discs=[standin.Disc(2.0, 0.1, 0.3)])
    robot = standin.Robot("robot", "natigation")
    told = []
    for _ in range(9):
        reading = world.read()
        robot.sense(reading)
        world.act(robot.act(reading, "move-according-to-NaT-plan", goal=standin.Pose(6.0, 0.0)))
        told.append(robot.reports["move-according-to-NaT-plan"].details)
    assert set(told[-1]) == {"circles", "groups", "interval", "heading", "goal"}
    assert told[-1]["goal"] == [6.0, 0.0] and told[-1]["groups"][0]["spin"] in ("cw", "ccw")
    assert told[3] is told[4] is told[5] and told[5] is not told[6]


def test_the_head_moves_by_steps_while_driving(standin):
    world = standin.World(discs=[standin.Disc(2.0, 0.1, 0.3)])
    robot = standin.Robot("robot", "natigation")
    pans = []
    for _ in range(300):
        reading = world.read()
        robot.sense(reading)
        command = robot.act(reading, "move-according-to-NaT-plan", goal=standin.Pose(6.0, 0.0))
        world.act(command)
        pans.append(command.head.pan)
    steps = [abs(b - a) for a, b in itertools.pairwise(pans) if a != b]
    assert steps and min(steps) > math.radians(5) * 0.99
    assert len(steps) < 30


def test_arrival_does_not_flicker(standin):
    world = standin.World(pose=standin.Pose(0, 0, 0))
    robot = standin.Robot("natigation", "robot")
    goal, felt = standin.Pose(1.0, 0.0), []
    for x in (0.0, 0.8, 0.9, 0.6, 0.45, 0.3, 0.6):
        world.pose = standin.Pose(x, 0.0, 0.0)
        reading = world.read()
        felt.append(robot.sense(reading)["we-are-at-the-goal"])
        robot.act(reading, "stop", goal=goal)
    assert felt == [False, False, True, True, True, False, False]


def test_a_goal_behind_something_counts_as_reached_within_an_arms_length(standin):
    world = standin.World(discs=[standin.Disc(1.0 + 0.65, 0.0, 0.3)], sonar_sd=0.0)
    robot = standin.Robot("natigation", "robot")
    reading = world.read()
    robot.act(reading, "stop", goal=standin.Pose(1.05, 0.0))
    world.pose = standin.Pose(0.7, 0.0, 0.0)
    assert robot.sense(world.read())["we-are-at-the-goal"]


def test_a_goal_beside_something_counts_as_reached_before_danger_begins(standin):
    """A goal so near to a thing that runaway would drive the robot off it again and again."""
    world = standin.World(discs=[standin.Disc(1.9, 0.75, 0.25)])
    fled, arrived = drive_to(standin, world, standin.Pose(2.2, 0.0), 100)
    assert arrived and fled == 0


def test_without_a_goal_it_stands_and_says_so(standin):
    world = standin.World()
    robot = standin.Robot("natigation")
    reading = world.read()
    command = robot.act(reading, "move-according-to-NaT-plan", goal=None)
    assert command.drive.speed == 0.0 and robot.reports["move-according-to-NaT-plan"].status == "failed"
