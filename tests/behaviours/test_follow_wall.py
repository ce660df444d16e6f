"""Along walls in worlds: the modern follower round ends and corners, past doors and clutter, and with bad scans."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from behaviours.catalogue import LIBRARIES
from behaviours.cores.hull_paths import Hull, Motors, least_distance, paths
from behaviours.estimators.fitted_wall import FittedWall
from behaviours.interface import Command, Drive, Odometry, Pose, Reading, Scan, Workshop
from rplan.apps.wiring import PlanBrain, compile_source
from rplan.driver import Compiled
from rplan.lang.source import Source
from sim.episode import Episode
from sim.judge import Verdict
from sim.scenarios.format import loads

PLAN = """
(plan along-a-wall :period 28ms)
(use robot)
(use {library} :preset modern {more})
(defoutput action command :idle (stop))
(goalem (do action (follow-wall)))
"""
WORLD = """
name: walls
bounds: [-20, -20, 30, 20]
robot: {{model: xrhex, start: [{x}, {y}], heading: {heading} deg}}
things:
{things}
"""
LONG = [(-12, -0.1, 30, -0.1)]


@cache
def compiled(library: str, more: str) -> Compiled:
    return compile_source(Source("wall.rplan", PLAN.format(library=library, more=more)))


def drive(walls, seconds, start=(0, 1, 0), more="", things=(), seed=0, library="wall-by-ransac"):
    """The way (n, 3) and the verdict."""
    lines = [f"- {{kind: wall, from: [{a}, {b}], to: [{c}, {d}]}}" for a, b, c, d in walls]
    x, y, heading = start
    text = WORLD.format(x=x, y=y, heading=heading, things="\n".join([*lines, *things]))
    plan = compiled(library, more)
    way: list[tuple[float, float, float]] = []

    class Watch:
        def observe(self, episode: Episode) -> None:
            pose = episode.world.robot.pose
            way.append((pose.x, pose.y, pose.theta))

    verdict: Verdict = Episode(loads(text, "walls.yaml"), seed, plan.goals.period).run(
        PlanBrain(plan), seconds, Watch()
    )
    assert not verdict.contacts
    return np.array(way)


def mirrored(walls):
    return [(a, -b, c, -d) for a, b, c, d in walls]


@pytest.mark.parametrize(("y", "heading"), [(0.3, 80), (1.5, 20), (1.5, -110), (3.2, 0)])
def test_it_comes_to_the_stand_off(y, heading):
    x, offset, theta = drive(LONG, 32, (0, y, heading))[-1]
    assert x > 10 and offset == pytest.approx(1.0, abs=0.02) and abs(theta) < math.radians(1)


@pytest.mark.parametrize("seed", [0, 1])
def test_it_turns_round_a_convex_corner(seed):
    x, y, theta = drive([(-12, -0.1, 3, -0.1), (2.9, -0.2, 2.9, -14)], 22, seed=seed)[-1]
    assert x == pytest.approx(4.0, abs=0.03) and y < -3 and theta == pytest.approx(-math.pi / 2, abs=0.03)


@pytest.mark.parametrize("seed", [0, 1])
def test_it_turns_round_the_end_of_a_wall(seed):
    x, y, theta = drive([(-12, -0.1, 3, -0.1)], 24, seed=seed)[-1]
    assert x < 1 and y == pytest.approx(-1.2, abs=0.03) and abs(theta) == pytest.approx(math.pi, abs=0.03)


def test_a_concave_corner_is_turned_in():
    x, y, theta = drive([(-12, -0.1, 5, -0.1), (5, -0.2, 5, 12)], 20)[-1]
    assert x == pytest.approx(3.9, abs=0.03) and y > 3 and theta == pytest.approx(math.pi / 2, abs=0.03)


def test_a_dead_end_is_left_on_the_other_wall():
    blind = [(-5, -0.8, 4, -0.8), (4, -0.8, 4, 0.8), (-5, 0.8, 4, 0.8)]
    x, y, theta = drive(blind, 17, (0, 0, 0), ":stand-off 0.6m")[-1]
    assert x < 1.5 and y == pytest.approx(0.1, abs=0.1) and abs(theta) == pytest.approx(math.pi, abs=0.1)


def test_a_corridor_narrower_than_twice_the_stand_off_is_followed_in_its_middle():
    way = drive([(-5, -0.5, 12, -0.5), (-5, 0.5, 12, 0.5)], 20, (0, 0.05, 0))
    assert way[-1][0] > 3 and np.abs(way[200:, 1]).max() < 0.06


@pytest.mark.parametrize("width", [0.3, 1.0])
def test_doors_are_passed_by(width):
    way = drive([(-12, -0.1, 3, -0.1), (3 + width, -0.1, 14, -0.1)], 16)
    assert way[-1][0] > 6 and np.abs(way[:, 1] - 1.0).max() < 0.05


def test_an_opening_wider_than_a_door_is_turned_into():
    way = drive([(-12, -0.1, 3, -0.1), (4, -0.1, 14, -0.1)], 15, (2, 0.4, 0), ":stand-off 0.4m :door 0.5m")
    assert way[:, 1].min() < -0.3


def test_clutter_on_the_wall_is_gone_round():
    crate = "- {kind: box, size: [0.6, 0.5], at: [4, 0.2]}"
    way = drive(LONG, 24, things=(crate,), more=":stand-off 0.6m")
    assert way[-1][0] > 8 and way[-1][1] == pytest.approx(0.6, abs=0.02)
    near = way[np.abs(way[:, 0] - 4) < 0.2]
    assert near[:, 1].min() > 0.45 + 0.25


def test_a_wall_that_vanishes_is_looked_for_and_given_up():
    way = drive([], 24, things=("- {kind: disc, id: thing, radius: 0.5, at: [1, -1.2]}",), more=":patience 4s")
    assert np.hypot(*(way[:, :2] - (1, -1.2)).T).max() < 4  # it stays with the only thing there is


@pytest.mark.parametrize("library", ["wall-by-ransac", "wall-by-hough"])
def test_both_sides_are_mirror_images(library):
    walls = [(-12, -0.1, 3, -0.1), (3, -0.2, 3, -14)]
    right = drive(walls, 6, (0, 0.8, 10), library=library)
    left = drive(mirrored(walls), 6, (0, -0.8, -10), ":side left", library=library)
    assert right[-1][0] == pytest.approx(left[-1][0], abs=0.02)
    assert right[-1][1] == pytest.approx(-left[-1][1], abs=0.02)


# --- scans without a robot ------------------------------------------------------------------------

BEARINGS = np.linspace(-math.radians(120), math.radians(120), 667)


class Follower:
    """The library alone: scans in, commands out."""

    def __init__(self, **values):
        self.workshop = Workshop()
        self.offer = LIBRARIES["wall-by-ransac"].build({"preset": "modern", **values}, self.workshop)
        self.tick = 0

    def give(self, ranges, pose=Pose(0.0, 0.0)) -> Command:  # noqa: B008
        scan = Scan(self.tick * 0.028, True, Pose(0.0, 0.0), BEARINGS, np.asarray(ranges, float), 0.02, 4.0)
        reading = Reading(self.tick * 0.028, self.tick, Odometry(pose, 0.0, 0.0), lidar=scan)
        self.tick += 1
        for estimator in self.workshop.estimators:
            estimator.update(reading, {}, {})
        return self.offer.competences["follow-wall"].step(reading, {})[0]

    def asks(self, percept):
        return self.offer.percepts[percept]()


def beside(y, far=4.0):
    """Ranges to a wall at y, without noise."""
    with np.errstate(divide="ignore"):
        reach = y / np.sin(BEARINGS)
    return np.where((reach > 0) & (reach < far), reach, far)


def test_mirrored_scans_give_mirrored_commands_to_the_last_bit():
    right, left = Follower(), Follower(side="left")
    for offset in np.linspace(-1.2, -0.8, 12):
        one, other = right.give(beside(offset)).drive, left.give(beside(offset)[::-1]).drive
        assert one is not None and other is not None
        assert (one.speed, one.turn_rate) == pytest.approx((other.speed, -other.turn_rate), abs=1e-9)


@pytest.mark.parametrize(
    "ranges", [np.full(667, math.nan), np.full(667, math.inf), np.full(667, 0.02), np.zeros(667), np.full(667, -1.0)]
)
def test_a_scan_that_says_nothing_stops_the_robot_and_says_lost(ranges):
    follower = Follower()
    assert follower.give(beside(-1.0)).drive != Drive(0.0, 0.0)
    assert follower.give(ranges).drive == Drive(0.0, 0.0)
    assert follower.asks("wall-lost") and not follower.asks("wall-found")
    assert follower.give(beside(-1.0)).drive != Drive(0.0, 0.0) and follower.asks("wall-found")


@pytest.mark.parametrize("count", [0, 1, 2, 19])
def test_a_few_points_are_no_wall_and_after_a_while_it_is_lost(count):
    follower = Follower(patience=1.0)
    follower.give(beside(-1.0))
    few = np.full(667, 4.0)
    few[300 : 300 + count] = 3.5
    for _ in range(60):
        command = follower.give(few)
        assert command.is_finite()
    assert follower.asks("wall-lost") and command.drive == Drive(0.0, 0.0)


def test_before_the_first_wall_it_stands():
    follower = Follower()
    assert follower.give(np.full(667, 4.0)).drive == Drive(0.0, 0.0)
    assert not follower.asks("wall-lost")


def test_nothing_is_driven_into_whatever_appears():
    """A wall right ahead, all at once: no speed ahead from then on."""
    follower = Follower()
    follower.give(beside(-1.0))
    ranges = np.minimum(beside(-1.0), np.where(np.abs(BEARINGS) < 1.2, 0.36 / np.maximum(np.cos(BEARINGS), 0.3), 4.0))
    command = follower.give(ranges).drive
    assert command is not None and command.speed < 0.05 and command.turn_rate > 0


@settings(max_examples=80, deadline=None, derandomize=True)
@given(st.integers(0, 10_000), st.floats(0.3, 0.8), st.floats(-1.5, 1.5))
def test_whatever_is_wanted_the_hull_stays_free_until_the_robot_could_stand(seed, speed, turn_rate):
    """Where nothing lies within the margin, no command brings the hull nearer than the margin."""
    follower = Follower()
    follower.give(beside(-1.0))
    wall = follower.workshop.share(FittedWall, list)
    chance = np.random.default_rng(seed)
    points = chance.uniform(-1, 1, (40, 2))
    wall.around = points[np.hypot(points[:, 0], points[:, 1]) > 0.32]
    wall.turn = wall.direction = 0.0
    reading = Reading(1.0, 1, Odometry(Pose(0.0, 0.0), speed, turn_rate))
    drive = follower.offer.competences["follow-wall"].step(reading, {})[0].drive
    made = paths(Drive(speed, turn_rate), np.array([[drive.speed, drive.turn_rate]]), Motors(2.0, 8.0, 0.1, 0.1))
    assert drive.speed == 0.0 or least_distance(made, wall.around, Hull(radius=0.25))[0] >= 0.05


def test_parameters_that_make_no_sense_are_refused():
    for bad in ({"hull-radius": 0.0}, {"stand-off": 0.0}, {"acceleration": 0.0}, {"side": "up"}):
        with pytest.raises(ValueError, match=next(iter(bad))):
            Follower(**bad)


def test_the_corner_ahead_is_said():
    follower = Follower()
    follower.give(beside(-1.0))
    assert not follower.asks("corner-ahead")
    across = 0.9 / np.maximum(np.cos(BEARINGS), 1e-3)
    follower.give(np.minimum(beside(-1.0), np.where(np.cos(BEARINGS) > 0.2, across, 4.0)))
    assert follower.asks("corner-ahead")


def blinded(library: str, ranges) -> list[Drive | None]:
    """The commands of a plan whose lidar gives these ranges (667,) from the 30th tick on, for a second."""
    plan = compiled(library, "")
    lines = "- {kind: wall, from: [-12, -0.1], to: [30, -0.1]}"
    episode = Episode(loads(WORLD.format(x=0, y=1, heading=0, things=lines), "walls.yaml"), 0, plan.goals.period)
    brain, told = PlanBrain(plan), []
    for tick in range(66):
        reading = episode.world.sense()
        if tick >= 30:
            reading = replace(reading, lidar=replace(reading.lidar, ranges=ranges))
        command = brain.step(reading)
        told.append(command.drive)
        episode.world.step(command)
    return told


def scattered(count: int):
    """So many beams that met something, here and there."""
    chance, ranges = np.random.default_rng(0), np.full(667, 4.0)
    ranges[chance.choice(667, count, replace=False)] = chance.uniform(0.5, 3.0, count)
    return ranges


BLIND = [scattered(count) for count in (0, 1, 2)]
BLIND += [np.full(667, bad) for bad in (math.nan, math.inf, -math.inf, 0.02, 0.0, 1e300)]


@pytest.mark.parametrize("library", ["wall-by-ransac", "wall-by-hough"])
@pytest.mark.parametrize("ranges", BLIND, ids=[*"012", "nan", "inf", "-inf", "least", "zero", "huge"])
def test_a_plan_that_sees_nothing_any_more_stands_at_once(library, ranges):
    told = blinded(library, ranges)
    assert told[29].speed > 0.1
    assert all(drive == Drive(0.0, 0.0) for drive in told[34:])


def test_nineteen_points_here_and_there_are_no_wall_to_go_on_along():
    assert all(drive == Drive(0.0, 0.0) for drive in blinded("wall-by-ransac", scattered(19))[34:])
