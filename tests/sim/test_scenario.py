"""Scenarios are read from YAML, and every mistake in them is told with its place."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim.raycast import Circle
from sim.scenarios.format import load, loads
from sim.scenarios.scenario import Between
from sim.scenarios.schema import ScenarioError
from sim.sensors.build import SonarBuild, StereoBuild
from sim.things.thing import At, RobotLeft, Roll, Travel, Waypoint

LOT = Path(__file__).parents[2] / "plans" / "find_and_fetch" / "parking_lot.yaml"

LEAST = """\
name: least
bounds: [-1, -1, 1, 1]
robot: {start: [0, 0]}
donor: {at: [3, 0]}
"""

RICH = (
    LEAST
    + """\
things:
  - {kind: wall, from: [-10, 8], to: [10, 8]}
  - {kind: car, track: [[0, 0], [5, 0, 2]], speed: 2, starts: {at: 20, every: 70}}
  - {kind: trashcan, at: [2, 3], roll: {starts: {robot_left: 2.5}}}
scatter:
  - {kinds: [post], count: [1, 2], region: [0, 0, 9, 9], keep_clear: [{from: robot, to: [1, 2], by: 0.3}]}
weather: {sun: 20 deg}
"""
)


def problems(text: str) -> list[str]:
    with pytest.raises(ScenarioError) as caught:
        loads(text, "lot.yaml")
    return [str(problem) for problem in caught.value.problems]


def with_thing(thing: str) -> str:
    return LEAST + f"things:\n  - {thing}\n"


def test_the_parking_lot_has_the_donor_at_25_feet():
    lot = load(LOT)
    assert math.dist(lot.robot.start, lot.donor.at) == pytest.approx(7.62)
    assert lot.robot.heading == Between(math.radians(-60), math.radians(60))
    assert lot.scatter[0].count == (4, 7)


def test_what_is_not_said_is_the_denning():
    robot = loads(LEAST).robot
    assert (robot.build.radius, robot.build.max_speed, robot.build.max_turn_rate) == (0.35, 0.2, 0.8)


def test_quantities_may_carry_units():
    scenario = loads(LEAST.replace("[3, 0]", "[25 ft, 50cm]") + "time_limit: 2 min\n")
    assert scenario.donor.at == pytest.approx((7.62, 0.5))
    assert scenario.time_limit == 120


def test_a_track_has_waypoints_with_and_without_waiting():
    thing = loads(with_thing("{kind: person, track: [[0, 5], [5, 5, 2]], starts: {robot_left: 1}}")).things[0]
    assert isinstance(thing.motion, Travel)
    assert thing.motion.track == (Waypoint(0, 5), Waypoint(5, 5, 2))
    assert thing.motion.start == RobotLeft(1)


def test_a_trashcan_may_be_rolled():
    thing = loads(with_thing("{kind: trashcan, at: [0, 5], roll: {starts: {at: 3}}}")).things[0]
    assert (thing.outline, thing.motion) == (Circle(0.3), Roll(At(3.0)))


def test_all_mistakes_are_told_at_once_in_the_order_of_the_file():
    text = """\
name: lot
bounds: [-5, -8, 15]
robt: 3
robot:
  start: [0, zero]
  radius: big
donor: {at: [25 ft, 0], at: [1, 2]}
things:
  - {kind: wal, from: [0, 0], to: [1, 1]}
  - 7
"""
    assert problems(text) == [
        "lot.yaml:2:9: bounds: expected a region [xmin, ymin, xmax, ymax], got a list of 3",
        "lot.yaml:3:1: robt: unknown key; did you mean 'robot'?",
        "lot.yaml:5:14: robot.start[1]: expected a length in metres, got 'zero'",
        "lot.yaml:6:11: robot.radius: expected a length in metres >= 0.001, got 'big'",
        "lot.yaml:7:25: donor.at: this key is here a second time",
        "lot.yaml:9:12: things[0].kind: no such kind as 'wal'; did you mean 'wall'?",
        "lot.yaml:10:5: things[1]: expected a mapping with a key 'kind', one of "
        "wall, curb, parked-car, car, person, trashcan, post, cart, charger, disc, box, polygon, outline",
    ]


@pytest.mark.parametrize(
    ("thing", "message"),
    [
        ("{kind: wall, from: [0, 0], to: [0, 0]}", "things[0]: 'from' and 'to' must be two places"),
        ("{kind: person}", "things[0]: a person has either 'at' (it stands) or 'track' (it walks)"),
        (
            "{kind: person, track: [[1, 1], [1, 1]]}",
            "things[0]: one waypoint of the track after the other must be at another place",
        ),
        (
            "{kind: car, track: [[0, 0], [1, 0]], speed: 2, starts: {at: 1, robot_left: 2}}",
            "things[0].starts: give one of at, robot_within and robot_left",
        ),
        (
            "{kind: car, track: [[0, 0]], speed: 1}",
            "things[0].track: expected a list of waypoints of at least 2, got a list of 1",
        ),
        ("{kind: post, at: [1, .nan]}", "things[0].at[1]: expected a length in metres, got '.nan'"),
        ("{kind: post, at: [1, 1e999]}", "things[0].at[1]: expected a length in metres, got '1e999'"),
        ("{kind: post}", "things[0].at: this key is missing"),
        ("{kind: post, at: [1, 5 deg]}", "things[0].at[1]: expected a length in metres, got '5 deg'"),
        ("{kind: post, id: donor, at: [1, 5]}", "things[0].id: the name 'donor' is taken"),
        ("{kind: [post], at: [1, 5]}", "things[0].kind: no such kind as a list of 1; one of "),
        ("{kind: parked-car, at: [1, 5], present: 2}", "things[0].present: expected a number >= 0 and <= 1, got '2'"),
    ],
)
def test_a_mistake_in_a_thing_is_told(thing, message):
    (problem,) = problems(with_thing(thing))
    assert message in problem


def test_an_interval_goes_upwards():
    (problem,) = problems(LEAST.replace("{start: [0, 0]}", "{start: [0, 0], heading: {between: [1, 0]}}"))
    assert "robot.heading.between: the first of the two numbers must not be the greater" in problem


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "lot.yaml:1:1: the file is empty; expected a scenario"),
        ("# nothing\n", "lot.yaml:1:1: the file is empty; expected a scenario"),
        ("- 1\n- 2\n", "got a list of 2"),
        ("words", "got 'words'"),
        ("a: [1", "lot.yaml:2:1: not YAML: did not find expected ',' or ']'"),
        ("\x00\x01", "lot.yaml:1:1: not a YAML text"),
        ("[" * 5000, "lot.yaml:1:31: lists and mappings lie more than 30 deep in one another"),
        (LEAST + "---\nname: second\n", "not YAML: but found another document"),
    ],
)
def test_what_is_no_scenario_at_all_is_one_clear_problem(text, message):
    (problem,) = problems(text)
    assert message in problem


def test_a_file_of_other_bytes_is_one_clear_problem(tmp_path):
    (tmp_path / "lot.yaml").write_bytes(b"\xff\xfe\x00name")
    with pytest.raises(ScenarioError, match=r"lot.yaml:1:1: not a text in UTF-8"):
        load(tmp_path / "lot.yaml")


def test_weather_and_sensors_are_set_by_name():
    text = LEAST.replace("{start: [0, 0]}", "{start: [0, 0], sonar: {dropout: 0.2}, stereo: {period: 5}}")
    scenario = loads(text + "weather: {sun: 20 deg, jitter: 1.5 deg, gusts: 0.1}\n")
    builds = {sensor.name: sensor.build for sensor in scenario.robot.sensors}
    assert builds["sonar"] == SonarBuild(sd=0.01, dropout=0.2)
    assert builds["stereo"] == replace(StereoBuild(), period=5.0)
    assert scenario.weather.sun == pytest.approx(math.radians(20))
    assert (scenario.weather.gust, scenario.weather.gusts) == (0.0, 0.1)


@settings(max_examples=200, deadline=None, derandomize=True)
@given(st.data())
def test_a_mangled_scenario_is_read_or_refused_but_never_a_crash(data):
    text = RICH
    for _ in range(data.draw(st.integers(1, 3))):
        start = data.draw(st.integers(0, len(text)))
        end = data.draw(st.integers(start, min(len(text), start + 12)))
        text = text[:start] + data.draw(st.text("[]{}:,- &*!|>\"'#\n\t0e.aé\x07", max_size=4)) + text[end:]
    try:
        loads(text, "lot.yaml")
    except ScenarioError as error:
        assert error.problems
        assert str(error).startswith("lot.yaml:")


def test_a_node_that_holds_itself_does_not_hang_the_reader():
    assert problems("&a [*a]")
    assert problems("name: &a {b: *a}\n")
