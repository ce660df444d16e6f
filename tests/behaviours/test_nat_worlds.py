"""Navigation in worlds: the car of Figure 2, canyons, and the same plan on a robot with a lidar."""

import math
from functools import cache
from pathlib import Path

import pytest

from rplan.apps.simulation import World, simulate
from rplan.apps.wiring import compile_source
from rplan.lang.source import Source
from sim.scenarios.format import loads

ROOT = Path(__file__).parents[2]
WORLDS = ROOT / "plans" / "find_and_fetch" / "worlds"
PLAN = (ROOT / "plans" / "go_to_goal" / "go_to_goal.rplan").read_text(encoding="utf-8")
BY_LIDAR = (ROOT / "plans" / "go_to_goal" / "go_to_goal_by_lidar.rplan").read_text(encoding="utf-8")
TURTLE = """
name: turtle
bounds: [-1, -3, 9, 3]
robot: {start: [0, 0], model: turtlebot}
goal: {at: [7.55, 0], within: 0.6}
things:
  - {kind: post, at: [2.5, 0.1], radius: 0.3}
  - {kind: post, at: [5.0, -0.2], radius: 0.3}
time_limit: 2 min
"""


@cache
def compiled(text):
    return compile_source(Source("plan.rplan", text))


def drive(text, world, seed=0, seconds=None):
    return simulate(compiled(text), World(loads(world, "world.yaml"), world), seed, until=seconds)


def world(name):
    return (WORLDS / f"{name}.yaml").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", ["car_0.6", "car_1.4", "car_2.2"])
def test_the_robot_passes_behind_the_car_without_touching_it(name):
    verdict = drive(PLAN, world(name)).verdict
    assert verdict.done and verdict.contacts == ()


def test_of_the_canyons_the_paper_escapes_the_small_one_alone():
    assert drive(PLAN, world("canyon_3x2"), 0, 200).verdict.done
    assert not drive(PLAN, world("canyon_4x3"), 0, 200).verdict.done


@pytest.mark.parametrize("name", ["canyon_4x3", "canyon_6x5"])
def test_the_modern_preset_leaves_large_canyons(name):
    modern = PLAN.replace("(use natigation ", "(use natigation :preset modern ")
    verdict = drive(modern, world(name), 0, 300).verdict
    assert verdict.done and verdict.driven_into == 0


def test_who_follows_what_moves_gives_way_to_a_car_that_runs_into_the_paper_s_robot():
    late = world("car_1.4_late")
    assert drive(PLAN, late, 0, 25).verdict.contacts
    assert not drive(BY_LIDAR, late, 0, 25).verdict.contacts


def test_the_same_plan_drives_a_robot_that_has_a_lidar_and_no_sonar():
    small = BY_LIDAR.replace("(use natigation ", "(use natigation :robot-width 0.36m ").replace(
        ":ranges lidar)", ":ranges lidar :hull-radius 0.18m)", 1
    )
    verdict = drive(small, TURTLE).verdict
    assert verdict.done and verdict.contacts == ()
    assert math.isfinite(verdict.smallest_clearance)
