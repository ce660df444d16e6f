"""The follower by the Hough transform speaks as the one by sampling does, and follows walls as well."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pytest

from behaviours.catalogue import LIBRARIES
from behaviours.competences.steer_by_vfh_plus import SteerByVfhPlus
from behaviours.estimators.walls import Walls
from behaviours.interface import Command, Drive, Odometry, Pose, Reading, Scan, Workshop
from rplan.apps.wiring import PlanBrain, compile_source
from rplan.lang.source import Source
from sim.episode import Episode
from sim.scenarios.format import loads

BEARINGS = np.linspace(-math.pi, math.pi, 361)[1:]
PLAN = """
(plan along-a-wall :period 28ms)
(use robot)
(use wall-by-hough :preset {preset} :stand-off {stand_off}m)
(defoutput action command :idle (stop))
(goalem (do action (follow-wall)))
"""
WORLD = """
name: wall
bounds: [-20, -20, 30, 20]
robot: {{model: xrhex, start: [0, {y}], heading: {heading} deg}}
things:
- {{kind: wall, from: [-12, -0.1], to: [30, -0.1]}}
"""


def words(name):
    return {(word.name, word.type, word.unit, word.actuators) for word in LIBRARIES[name].functions}


def test_both_followers_have_the_same_words():
    assert words("wall-by-hough") == words("wall-by-ransac")


def test_what_both_can_be_told_has_the_same_name_unit_and_default():
    ransac = {p.name: (p.type, p.unit, p.default) for p in LIBRARIES["wall-by-ransac"].parameters}
    hough = {p.name: (p.type, p.unit, p.default) for p in LIBRARIES["wall-by-hough"].parameters}
    common = {
        "preset",
        "side",
        "stand-off",
        "speed",
        "most",
        "hull-radius",
        "margin",
        "patience",
        "door",
        "acceleration",
    }
    assert common <= ransac.keys() & hough.keys()
    assert all(ransac[name] == hough[name] for name in ransac.keys() & hough.keys())


@pytest.mark.parametrize("preset", ["paper", "modern"])
@pytest.mark.parametrize(("y", "heading"), [(0.5, 30), (1.5, 20)])
def test_it_comes_to_the_stand_off(preset, y, heading):
    plan = compile_source(Source("wall.rplan", PLAN.format(preset=preset, stand_off=1.0)))
    episode = Episode(loads(WORLD.format(y=y, heading=heading), "wall.yaml"), 0, plan.goals.period)
    verdict = episode.run(PlanBrain(plan), 20)
    pose = episode.world.robot.pose
    assert not verdict.contacts and pose.x > 5
    assert pose.y == pytest.approx(1.0, abs=0.06) and abs(pose.theta) < math.radians(3)


class Follower:
    """The library alone: scans in, commands out."""

    def __init__(self, period=0.1, **values):
        self.period = period
        self.workshop = Workshop()
        self.offer = LIBRARIES["wall-by-hough"].build({"preset": "modern", **values}, self.workshop)
        self.tick = 0

    def give(self, ranges) -> Command:
        scan = Scan(self.tick * self.period, True, Pose(0.0, 0.0), BEARINGS, np.asarray(ranges, float), 0.02, 4.0)
        reading = Reading(self.tick * self.period, self.tick, Odometry(Pose(0.0, 0.0), 0.0, 0.0), lidar=scan)
        self.tick += 1
        for estimator in self.workshop.estimators:
            estimator.update(reading, {}, {})
        return self.offer.competences["follow-wall"].step(reading, {})[0]

    def asks(self, percept):
        return self.offer.percepts[percept]()


def to_line(normal, distance, to=4.0):
    """Ranges to a straight wall whose nearest point lies at a bearing and distance."""
    slant = np.cos(BEARINGS - normal)
    reach = np.where(slant > 1e-6, distance / np.maximum(slant, 1e-6), 4.0)
    return np.where(reach < to, reach, 4.0)


RIGHT = to_line(-math.pi / 2, 1.0)


def test_the_wall_is_found_and_where_it_is_said():
    follower = Follower()
    assert follower.give(np.full(360, 4.0)).drive == Drive(0.0, 0.0)
    assert not follower.asks("wall-found") and not follower.asks("wall-lost")
    follower.give(to_line(-math.pi / 2 - 0.2, 1.1))
    assert follower.asks("wall-found")
    assert follower.asks("the-wall-distance") == pytest.approx(1.1, abs=0.01)
    assert follower.asks("the-wall-angle") == pytest.approx(0.2, abs=0.01)


@pytest.mark.parametrize("side", ["left", "right"])
def test_the_angle_is_positive_away_from_the_wall_on_either_side(side):
    follower = Follower(side=side)
    sign = 1.0 if side == "left" else -1.0
    follower.give(to_line(sign * (math.pi / 2 + 0.2), 1.0))
    assert follower.asks("the-wall-angle") == pytest.approx(0.2, abs=0.01)


def test_a_wall_that_is_not_seen_for_long_is_lost_and_the_robot_stands():
    follower = Follower(patience=0.5)
    follower.give(RIGHT)
    for _ in range(40):
        command = follower.give(np.full(360, 4.0))
    assert follower.asks("wall-lost") and command.drive == Drive(0.0, 0.0)
    follower.give(RIGHT)
    assert follower.asks("wall-found") and not follower.asks("wall-lost")


def test_the_end_and_the_corner_are_said():
    follower = Follower()
    follower.give(RIGHT)
    assert not follower.asks("wall-ends") and not follower.asks("corner-ahead")
    x = RIGHT * np.cos(BEARINGS)
    follower.give(np.where(x < 0.8, RIGHT, 4.0))
    assert follower.asks("wall-ends")
    follower.give(np.minimum(RIGHT, to_line(0.0, 0.9)))
    assert follower.asks("corner-ahead")


@pytest.mark.parametrize("ranges", [np.full(360, math.nan), np.full(360, math.inf), np.full(360, 0.02)])
def test_scans_that_say_nothing_give_finite_commands_and_a_lost_wall(ranges):
    follower = Follower(patience=0.5)
    follower.give(RIGHT)
    for _ in range(40):
        command = follower.give(ranges)
        assert command.is_finite()
    assert not follower.asks("wall-found")


def walls_of(follower):
    return next(one for one in follower.workshop.estimators if isinstance(one, Walls))


def test_of_frequent_scans_every_third_is_looked_at():
    follower = Follower(period=0.028)
    looked = []
    for _ in range(9):
        follower.give(RIGHT)
        looked.append(walls_of(follower).fresh)
    assert looked == [True, False, False] * 3


def test_the_disc_is_no_smaller_than_the_hull_needs_and_enters_what_is_wider_than_the_door():
    contour = walls_of(Follower(**{"hull-radius": 0.3, "door": 0.3})).settings.contour
    assert contour.least == contour.widest == pytest.approx(0.36)
    assert walls_of(Follower(door=1.2)).settings.contour.widest == pytest.approx(0.6)


@dataclass
class Open:
    """Nothing stands anywhere, and the robot is where it began."""

    points = np.zeros((0, 2))
    sees_all = True
    pose = Pose(0.0, 0.0)


@pytest.mark.parametrize(("aside", "turn"), [(-150, 1.0), (-100, -1.0), (100, 1.0), (150, 1.0)])
def test_to_what_lies_behind_it_turns_away_from_the_wall(aside, turn):
    """Else a robot in a dead end would turn to and fro, as the shorter way changes."""
    follower, here = Follower(), Open()
    settings = follower.offer.competences["follow-wall"]._steer.settings
    steer = SteerByVfhPlus(settings, here, here, lambda: True, lambda: here.points)
    reading = Reading(0.0, 0, Odometry(Pose(0.0, 0.0), 0.0, 0.0))
    command, _ = steer.step(reading, {"heading": math.radians(aside)})
    assert math.copysign(1.0, command.drive.turn_rate) == turn


def test_parameters_that_make_no_sense_are_refused():
    for bad in ({"hull-radius": 0.0}, {"stand-off": 0.0}, {"slip": 0.0}, {"side": "up"}, {"preset": "tuned"}):
        with pytest.raises(ValueError, match=next(iter(bad))):
            Follower(**bad)


def test_a_perimeter_with_other_settings_is_refused():
    workshop = Workshop()
    LIBRARIES["perimeter"].build({"side": "left"}, workshop)
    with pytest.raises(ValueError, match="perimeter"):
        LIBRARIES["wall-by-hough"].build({"side": "right"}, workshop)
