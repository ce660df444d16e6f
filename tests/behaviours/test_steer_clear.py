"""Steering clear of obstacles: in gaps, along walls, out of dead ends, on several robots, tick by tick."""

import math
from functools import cache
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from behaviours.catalogue import LIBRARIES
from behaviours.cores.hull_paths import Hull, Motors, least_distance, paths
from behaviours.cores.pilot import PilotSettings, Surrounds, may_turn, safe, towards
from behaviours.cores.steering import sectors_view
from behaviours.cores.way_back import WayBack, WayBackSettings
from behaviours.interface import STOP, Compass, Drive, Odometry, Pose, Reading, Scan, Workshop, wrap
from rplan.apps.simulation import World, simulate
from rplan.apps.wiring import compile_source
from rplan.lang.source import Source
from sim.scenarios.format import loads

ROOT = Path(__file__).parents[2]
PLAN = (ROOT / "plans" / "cross_field" / "cross_field.rplan").read_text(encoding="utf-8")
PRESETS = ["paper", "modern"]
NOTHING = np.zeros((0, 2))
BEARINGS = np.arange(1, 361) / 360 * math.tau - math.pi


@cache
def compiled(parameters):
    return compile_source(Source("plan.rplan", PLAN.replace(":preset paper :goal-x 30m", parameters)))


def world(things, robot="model: packbot", goal=8.0, limit=60):
    return f"""
name: w
bounds: [-4, -6, 12, 6]
time_limit: {limit}
robot: {{start: [0, 0], {robot}}}
goal: {{at: [{goal}, 0], within: 0.6}}
things:
""" + "\n".join(f"  - {thing}" for thing in things)


def wall(x1, y1, x2, y2):
    return f"{{kind: wall, from: [{x1}, {y1}], to: [{x2}, {y2}]}}"


def gap(width):
    """A wall across, with a gap in the middle."""
    return [wall(4, width / 2, 4, 15), wall(4, -15, 4, -width / 2)]


def drive(things, parameters, seed=0, **others):
    text = world(things, **others)
    return simulate(compiled(parameters), World(loads(text, "w"), text), seed).verdict


# --- in worlds --------------------------------------------------------------------------------------


@pytest.mark.parametrize("preset", PRESETS)
def test_a_gap_of_a_metre_is_passed(preset):
    for seed in range(3):
        verdict = drive(gap(1.0), f":preset {preset} :goal-x 8m", seed)
        assert verdict.done
        assert not verdict.contacts


@pytest.mark.parametrize("preset", PRESETS)
def test_a_gap_of_three_quarters_of_a_metre_is_refused(preset):
    for seed in range(2):
        verdict = drive(gap(0.75), f":preset {preset} :goal-x 8m", seed, limit=25)
        assert not verdict.done
        assert not verdict.contacts


@pytest.mark.parametrize("when_blocked", ["left", "right"])
def test_a_pocket_straight_ahead_is_left_again(when_blocked):
    """Three walls before the goal, open to the start."""
    pocket = [wall(4, -1.2, 4, 1.2), wall(2.2, 1.2, 4, 1.2), wall(2.2, -1.2, 4, -1.2)]
    verdict = drive(pocket, f":preset modern :when-blocked {when_blocked} :goal-x 8m", limit=120)
    assert verdict.done
    assert not verdict.contacts


def test_out_of_a_slot_in_which_the_hull_cannot_turn_it_goes_backwards():
    slot = [wall(-1.5, 0.5, 1.2, 0.5), wall(-1.5, -0.5, 1.2, -0.5), wall(1.2, -0.5, 1.2, 0.5)]
    verdict = drive(slot, ":preset modern :goal-x 8m", limit=120)
    assert verdict.done
    assert not verdict.contacts


def test_a_robot_with_sonars_steers_clear_too():
    posts = ["{kind: post, at: [2.5, 0.1], radius: 0.3}", "{kind: post, at: [5.0, -0.2], radius: 0.3}"]
    for preset in PRESETS:
        hull = ":clearance 0.5m :cruise 0.2m/s :hull-radius 0.35m :slip 1 :goal-x 8m"
        verdict = drive(posts, f":preset {preset} :ranges sonar {hull}", robot="model: denning", limit=90)
        assert verdict.done
        assert not verdict.contacts


def test_a_robot_that_does_not_see_behind_itself_steers_clear_too():
    things = [*gap(1.0), "{kind: post, at: [-0.8, 0], radius: 0.1}"]
    hull = ":hull-length 0.508m :hull-width 0.43m :slip 1 :clearance 0.32m :cruise 1m/s"
    verdict = drive(things, f":preset modern {hull} :goal-x 8m", robot="model: jackal")
    assert verdict.done
    assert not verdict.contacts


def test_looking_ahead_a_dead_end_in_view_is_not_entered():
    """A pocket deeper than the window of VFH+, among walls; a Jackal that does not see behind itself."""
    pocket = [wall(5, -1.5, 5, 1.5), wall(2, 1.5, 5, 1.5), wall(2, -1.5, 5, -1.5)]
    hull = ":hull-length 0.508m :hull-width 0.43m :slip 1 :clearance 0.28m :cruise 1m/s :look-ahead 4m"
    verdict = drive(pocket, f":preset modern {hull} :goal-x 8m", robot="model: jackal", limit=40)
    assert verdict.done
    assert not verdict.contacts


# --- commands ---------------------------------------------------------------------------------------


class Steered:
    """The library `svfh` brought to life among points that stand still, with a robot that does as it is told."""

    def __init__(self, points, **values):
        self.workshop = Workshop()
        self.offer = LIBRARIES["svfh"].build({k.replace("_", "-"): v for k, v in values.items()}, self.workshop)
        self.points = np.array(points, dtype=float).reshape(-1, 2)
        self.pose, self.ticks, self.speed, self.turn_rate = Pose(0.0, 0.0, 0.0), 0, 0.0, 0.0
        self.channels, self.started = {}, False
        self.told = []

    def scan(self):
        dx, dy = self.points[:, 0] - self.pose.x, self.points[:, 1] - self.pose.y
        bearings = np.arctan2(dy, dx) - self.pose.theta
        order = np.argsort(np.remainder(bearings + math.pi, math.tau))
        bearings = (np.remainder(bearings + math.pi, math.tau) - math.pi)[order]
        ranges = np.hypot(dx, dy)[order]
        ends = np.array([-math.pi, math.pi])
        bearings, ranges = np.insert(ends, 1, bearings), np.insert(np.full(2, 20.0), 1, ranges)
        return Scan(self.ticks * 0.1, True, Pose(0.0, 0.0), bearings, ranges, 0.01, 20.0)

    def tick(self, **channels):
        stamp = self.ticks * 0.1
        odometry = Odometry(self.pose, self.speed, self.turn_rate, stamp)
        reading = Reading(stamp, self.ticks, odometry, lidar=self.scan(), compass=Compass(stamp, True, self.pose.theta))
        for estimator in self.workshop.estimators:
            estimator.update(reading, {}, self.channels)
        self.channels = {k.replace("_", "-"): v for k, v in channels.items()}
        steer = self.offer.competences["steer-clear-of-obstacles"]
        if not self.started:
            steer.start(reading, self.channels)
            self.started = True
        command, report = steer.step(reading, self.channels)
        assert command.is_finite()
        self.told.append((command.drive, report))
        self._move(command.drive)
        return command.drive

    def _move(self, told):
        self.speed, self.turn_rate = told.speed, told.turn_rate
        theta = self.pose.theta + told.turn_rate * 0.05
        x, y = self.pose.x + told.speed * 0.1 * math.cos(theta), self.pose.y + told.speed * 0.1 * math.sin(theta)
        self.pose, self.ticks = Pose(x, y, wrap(self.pose.theta + told.turn_rate * 0.1)), self.ticks + 1


def straight_wall(y):
    return [[x, y] for x in np.arange(-4, 20, 0.05)]


@pytest.mark.parametrize("preset", PRESETS)
def test_without_a_heading_the_robot_stands(preset):
    for heading in (None, math.nan, True, "north"):
        steered = Steered([], preset=preset)
        assert steered.tick(heading=heading) == STOP.drive
        assert steered.told[0][1].status == "failed"


@pytest.mark.parametrize("preset", PRESETS)
def test_in_the_open_it_turns_to_the_heading_and_cruises(preset):
    steered = Steered([], preset=preset, slip=1.0)
    for _ in range(60):
        steered.tick(heading=1.0)
    assert steered.pose.theta == pytest.approx(1.0, abs=0.01)
    assert steered.speed == pytest.approx(0.5, abs=0.01)


@pytest.mark.parametrize("preset", PRESETS)
def test_along_a_straight_wall_the_heading_is_kept(preset):
    steered = Steered(straight_wall(1.5), preset=preset, slip=1.0)
    for _ in range(240):
        steered.tick(heading=0.0)
    assert steered.pose.x > 11.0
    assert abs(steered.pose.y) < 0.001


@pytest.mark.parametrize("preset", PRESETS)
def test_a_mirrored_world_is_passed_as_in_a_mirror(preset):
    things = [[2.0, 0.1], [3.0, -0.4], *straight_wall(1.6), [5.0, 0.3]]
    left = Steered(things, preset=preset, when_blocked="left", slip=1.0)
    right = Steered(np.array(things) * (1, -1), preset=preset, when_blocked="right", slip=1.0)
    for _ in range(150):
        one, other = left.tick(heading=0.05), right.tick(heading=-0.05)
        assert (one.speed, one.turn_rate) == pytest.approx((other.speed, -other.turn_rate), abs=1e-6)


@pytest.mark.parametrize("preset", PRESETS)
def test_the_recent_path_counts_when_it_shall(preset):
    """There and back: on its old path the robot goes aside, unless it is told not to mind."""
    aside = {}
    for mind in (False, True):
        steered = Steered([], preset=preset, slip=1.0)
        for _ in range(80):
            steered.tick(heading=0.0, keep_off_recent_path=False)
        for _ in range(80):
            steered.tick(heading=math.pi, keep_off_recent_path=mind)
        aside[mind] = abs(steered.pose.y)
    assert aside[True] > aside[False] + 0.15


def test_in_a_closed_room_modern_goes_on_and_paper_turns():
    room = [[3 * math.cos(b), 3 * math.sin(b)] for b in BEARINGS]
    paper, modern = Steered(room, preset="paper", window=8.0, clearance=1.2), Steered(room, preset="modern", window=8.0)
    assert paper.tick(heading=0.0).speed == 0.0
    assert paper.offer.percepts["the-way-is-blocked"]()
    assert modern.tick(heading=0.0).speed > 0.1


@pytest.mark.parametrize("preset", PRESETS)
def test_walled_in_the_way_is_blocked(preset):
    steered = Steered([[0.7 * math.cos(b), 0.7 * math.sin(b)] for b in BEARINGS], preset=preset)
    steered.tick(heading=0.0)
    assert steered.offer.percepts["the-way-is-blocked"]()
    free = Steered([], preset=preset)
    free.tick(heading=0.0)
    assert not free.offer.percepts["the-way-is-blocked"]()


def test_in_paper_a_blocked_robot_turns_to_the_set_side():
    walled = [[0.7 * math.cos(b), 0.7 * math.sin(b)] for b in BEARINGS]
    assert Steered(walled, when_blocked="left").tick(heading=0.0) == Drive(0.0, 0.5)
    assert Steered(walled, when_blocked="right").tick(heading=0.0) == Drive(0.0, -0.5)


@pytest.mark.parametrize("seed", range(4))
def test_directions_seldom_change_by_more_than_a_quarter_turn(seed):
    """Less than once in 100 s among posts, some of which stand straight in the way."""
    chance = np.random.default_rng(seed)
    centres = [(x, y) for x, y in chance.uniform((1.5, -6), (50, 6), (55, 2)) if math.hypot(x, y) > 1.5]
    posts = [[x + 0.15 * math.cos(b), y + 0.15 * math.sin(b)] for x, y in centres for b in BEARINGS[::15]]
    steered = Steered(posts, preset="modern", slip=1.0)
    for _ in range(600):
        steered.tick(heading=0.0)
    chosen = [r.details["direction"] for _, r in steered.told if r.details.get("direction") is not None]
    assert sum(abs(wrap(b - a)) > math.pi / 2 for a, b in pairwise(chosen)) == 0
    assert steered.pose.x > 20.0


def test_the_open_sectors_are_shown_once_a_step():
    for preset in PRESETS:
        steered = Steered([[1.0, 0.0]], preset=preset)
        steered.tick(heading=0.0)
        view = steered.offer.views["sectors"]()
        assert (view["kind"], view["frame"], len(view["open"])) == ("sectors", "robot", 72)
        assert view["open"][0] == "0"
        assert view["open"][36] == "1"
        assert steered.offer.views["sectors"]() is None


def test_sectors_begin_half_a_sector_before_their_first_direction():
    view = sectors_view(np.array([True, False, True, True]), 0.5)
    assert (view["open"], view["first"]) == ("1011", round(-math.pi / 4 - 0.5, 6))


def test_the_heading_to_the_goal_and_its_distance():
    steered = Steered([], goal_x=3.0, goal_y=4.0)
    goal = steered.offer.values["the-place-to-go"]({})
    assert goal == Pose(3.0, 4.0)
    heading = steered.offer.values["the-heading-to-the-goal"]
    assert heading({}) is None
    assert heading({"goal": goal}) == pytest.approx(math.atan2(4, 3))
    assert steered.offer.percepts["the-distance-to-the-goal"]() == 0.0
    steered.tick(goal=goal)
    steered.tick(goal=goal)
    assert steered.offer.percepts["the-distance-to-the-goal"]() == pytest.approx(5.0)


@pytest.mark.parametrize(
    "values",
    [
        {"preset": "older"},
        {"ranges": "radar"},
        {"when_blocked": "up"},
        {"directions": 4.0},
        {"stop_range": 1.0, "slow_range": 1.0},
        {"goal_x": math.inf},
        {"preset": "modern", "hull_width": 0.0},
        {"preset": "modern", "acceleration": 0.0},
        {"preset": "modern", "slip": 0.0},
        {"preset": "modern", "look_ahead": 11.0},
        {"window": 0.0},
        {"clearance": 0.0},
    ],
)
def test_values_that_make_no_sense_are_refused(values):
    with pytest.raises(ValueError, match=r"must be"):
        Steered([], **values)


# --- the hull ---------------------------------------------------------------------------------------


def test_the_distance_from_a_hull_is_negative_inside():
    x, y = np.array([1.0, 0.0, 1.345, 0.0]), np.array([0.0, 1.0, 1.26, 0.0])
    assert Hull().distance(x, y) == pytest.approx([0.655, 0.74, math.sqrt(2), -0.26])
    assert Hull(radius=0.3).distance(x[:2], y[:2]) == pytest.approx([0.7, 0.7])
    assert Hull().reach == pytest.approx(math.hypot(0.345, 0.26))


def test_a_path_is_driven_and_braked():
    motors = Motors(acceleration=1.0, turn_acceleration=4.0, hold=0.2, step=0.05)
    made = paths(Drive(0.5, 0.0), np.array([(0.5, 0.0), (0.0, 0.0), (0.5, 1.0)]), motors)
    assert made[0, -1, 0] == pytest.approx(0.1 + 0.125, abs=0.01)
    assert made[1, -1, 0] == pytest.approx(0.125, abs=0.01)
    assert made[2, -1, 2] == pytest.approx(0.16, abs=0.001)
    assert least_distance(made, NOTHING, Hull()).tolist() == [math.inf] * 3


def test_corners_of_the_hull_count_when_it_turns():
    beside = np.array([[0.30, 0.32]])
    assert not may_turn(beside, PilotSettings())
    assert not safe(Drive(0.0, 1.0), Drive(0.0, 0.0), np.array([[0.30, 0.325]]), PilotSettings(margin=0.06))
    assert safe(Drive(0.0, 1.0), Drive(0.0, 0.0), np.array([[0.8, 0.0]]), PilotSettings())


@pytest.mark.parametrize("seed", range(20))
def test_no_command_carries_the_hull_into_a_reading(seed):
    """Whatever direction is wanted: told, held and braked for, the hull stays clear."""
    chance = np.random.default_rng(seed)
    settings = PilotSettings(slip=1.0)
    points = chance.uniform(-1.5, 1.5, (25, 2))
    points = points[settings.hull.distance(points[:, 0], points[:, 1]) > 0.08]
    for _ in range(20):
        direction = chance.uniform(-math.pi, math.pi)
        told = towards(direction, Drive(0.0, 0.0), Surrounds(points), settings)
        if told is not None:
            made = paths(Drive(0.0, 0.0), np.array([(told.speed, told.turn_rate)]), settings.motors)
            assert least_distance(made, points, settings.hull)[0] >= settings.margin


def test_it_does_not_drive_backwards_where_it_does_not_see():
    wall_ahead = np.array([[0.42, y] for y in np.arange(-0.6, 0.61, 0.05)])
    sides = np.array([[x, y] for x in np.arange(-0.4, 0.4, 0.05) for y in (-0.33, 0.33)])
    points = np.concatenate([wall_ahead, sides])
    seen = towards(math.pi, Drive(0.0, 0.0), Surrounds(points, True), PilotSettings())
    blind = towards(math.pi, Drive(0.0, 0.0), Surrounds(points, False), PilotSettings())
    assert seen is not None
    assert seen.speed < 0.0
    assert blind is None or blind.speed >= 0.0


# --- the way back -----------------------------------------------------------------------------------


def test_a_robot_that_does_not_get_away_is_stalled():
    way = WayBack(WayBackSettings())
    for tick in range(100):
        way.advance(Pose(tick * 0.01, 0.0), tick * 0.1)
    assert not way.is_stalled(9.9)
    for tick in range(100, 170):
        way.advance(Pose(1.0, 0.02 * (tick % 2)), tick * 0.1)
    assert way.is_stalled(16.9)
    way.rest()
    assert not way.is_stalled(16.9)


def test_the_way_back_is_the_way_that_was_come_and_longer_each_time():
    way = WayBack(WayBackSettings())
    for tick in range(40):
        way.advance(Pose(tick * 0.1, 0.0), tick * 0.1)
    lengths = []
    for stamp in (4.0, 5.0, 6.0):
        way.turn_back(Pose(3.9, 0.0), 0.0, stamp)
        x = 3.9
        while way.next_place(Pose(x, 0.0), stamp) is not None:
            x -= 0.05
        lengths.append(3.9 - x)
        for place in np.arange(x, 3.95, 0.1):
            way.advance(Pose(float(place), 0.0), stamp)
    assert 0.15 < lengths[0] < lengths[1] < lengths[2]
    assert way.dead_ends.tolist() == [[4.3, 0.0]] * 3
    way.advance(Pose(4.0, 0.0), 100.0)
    assert len(way.dead_ends) == 0
