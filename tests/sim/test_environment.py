"""An environment: reset and step, for any program; nothing is shared between two of them."""

from __future__ import annotations

import math

import pytest

from behaviours.interface import STOP, Command, Drive, Pose
from sim.environment import Environment
from sim.recording import read
from sim.scenarios.format import loads

ROOM = """
name: room
bounds: [-5, -5, 5, 5]
time_limit: 20
robot: {model: turtlebot, start: [0, 0]}
goal: {at: [2, 0], within: 0.3, no_contact: true}
things: [{kind: disc, radius: 0.3, id: bin, keyframes: [[0, -2, 0], [10, -2, 3]]}]
"""
AHEAD = Command(Drive(0.2, 0.0))


def drive(environment: Environment, command: Command, seed: int = 0) -> list:
    environment.reset(seed)
    steps = []
    while not steps or not (steps[-1].done or steps[-1].out_of_time):
        steps.append(environment.step(command))
    return steps


def test_a_tick_is_as_long_as_it_was_asked_for():
    environment = Environment(loads(ROOM), period=0.05)
    environment.reset()
    stamps = [environment.step(AHEAD).seen.stamp for _ in range(3)]
    assert stamps[2] - stamps[1] == pytest.approx(0.05) == stamps[1] - stamps[0]


def test_a_run_ends_at_the_goal():
    environment = Environment(loads(ROOM))
    steps = drive(environment, AHEAD)
    assert steps[-1].done and not steps[-1].out_of_time and steps[-1].state.stage == "done"
    assert environment.verdict.done and environment.verdict.times.arrival == steps[-1].state.time
    assert steps[-1].state.pose.x == pytest.approx(1.7, abs=0.03)


def test_or_when_its_time_is_over():
    steps = drive(Environment(loads(ROOM)), STOP)
    assert steps[-1].out_of_time and not steps[-1].done and len(steps) == 200


def test_a_touch_ends_a_run_that_must_have_none():
    blocked = ROOM.replace("keyframes: [[0, -2, 0], [10, -2, 3]]", "at: [1, 0]")
    environment = Environment(loads(blocked))
    steps = drive(environment, AHEAD)
    assert steps[-1].done and steps[-1].state.stage == "touched"
    assert not environment.verdict.done
    assert environment.verdict.reason == f"a contact at {steps[-1].state.time:.1f} s " + (
        "on the way to the goal, which must be reached without a contact"
    )


def test_the_state_is_the_truth_and_what_is_seen_comes_from_the_sensors():
    environment = Environment(loads(ROOM))
    seen, state = environment.reset()
    assert (state.time, state.pose, state.things["bin"]) == (0.0, Pose(0.0, 0.0, 0.0), Pose(-2.0, 0.0, 0.0))
    assert seen.lidar is not None and seen.lidar.fresh
    step = environment.step(AHEAD)
    assert step.seen.tick == 1 and step.state.time == 0.1 and step.state.things["bin"].y == pytest.approx(0.03)


def test_what_is_seen_may_be_made_of_readings():
    calls = []

    def sense(reading):
        calls.append(reading.tick)
        return {"speed": reading.odometry.speed}

    environment = Environment(loads(ROOM), sense, begin=calls.clear)
    environment.reset()
    assert environment.step(AHEAD).seen == {"speed": pytest.approx(0.0, abs=0.2)}
    environment.reset()
    assert calls == [0]


def test_two_environments_side_by_side_do_what_each_does_alone():
    alone = [step.state for step in drive(Environment(loads(ROOM)), AHEAD, 3)]
    first, second = Environment(loads(ROOM)), Environment(loads(ROOM))
    first.reset(3)
    second.reset(4)
    together = []
    for _ in alone:
        together.append(first.step(AHEAD).state)
        second.step(Command(Drive(0.1, math.pi / 8)))
    assert together == alone


def test_each_records_only_itself(tmp_path):
    scenario = loads(ROOM)
    with (
        Environment(scenario, record=tmp_path / "a.mcap") as first,
        Environment(scenario, record=tmp_path / "b.mcap") as second,
    ):
        first.reset(1)
        second.reset(2)
        for _ in range(10):
            first.step(AHEAD)
        second.step(STOP)
    a, b = read(tmp_path / "a.mcap"), read(tmp_path / "b.mcap")
    assert (a.header["seed"], len(list(a.ticks)), b.header["seed"], len(list(b.ticks))) == (1, 11, 2, 2)


def test_a_step_before_the_first_reset_is_refused():
    with pytest.raises(RuntimeError, match="reset"):
        Environment(loads(ROOM)).step(STOP)


def test_a_command_that_is_not_finite_is_refused():
    environment = Environment(loads(ROOM))
    environment.reset()
    with pytest.raises(ValueError, match="finite"):
        environment.step(Command(Drive(math.nan, 0.0)))
