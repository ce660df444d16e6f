"""The format of scenarios beyond the parking lot: own robots, sensors, shapes, events, faults; and its JSON Schema."""

from __future__ import annotations

import json
import math
from pathlib import Path

import jsonschema
import pytest
import yaml

from behaviours.interface import Pose
from sim.raycast import Circle, Polygon, Rings
from sim.robots.build import Ackermann, Differential, SkidSteer
from sim.robots.models import MODELS
from sim.scenarios import format as scenarios
from sim.scenarios.format import loads
from sim.scenarios.scenario import Event, Put, Vanish
from sim.scenarios.schema import ScenarioError
from sim.sensors.build import Fault, Installed, LidarBuild, Mount
from sim.things.ground import Slope

ROOT = Path(__file__).parents[2]
BASE = "name: room\nbounds: [-5, -5, 5, 5]\n"
ROBOT = "robot: {start: [0, 0]}\n"


def problem(text: str) -> str:
    with pytest.raises(ScenarioError) as caught:
        loads(text, "room.yaml")
    (only,) = caught.value.problems
    return str(only)


# --- robots -----------------------------------------------------------------------------------------


def test_a_robot_is_named_by_its_model():
    robot = loads(BASE + "robot: {model: packbot, start: [1, 2], heading: 90 deg}\n").robot
    assert robot.build == MODELS["packbot"].build and robot.sensors == MODELS["packbot"].sensors
    assert (robot.start, robot.heading) == ((1.0, 2.0), pytest.approx(math.pi / 2))


def test_without_a_model_it_is_the_denning():
    assert loads(BASE + ROBOT).robot.sensors == MODELS["denning"].sensors


def test_a_robot_of_ones_own_has_shape_drive_and_sensors():
    text = """robot:
  start: [0, 0]
  shape: {box: [0.6, 0.4]}
  mass: 20
  height: 0.5
  drive: {kind: differential, max_speed: 1.5, track: 0.36}
  sensors:
    - kind: lidar
      name: front
      at: [0.2, 0, 5 deg]
      height: 0.25
      period: 0.05
      latency: 0.1
      beams: 181
      field_of_view: 180 deg
    - {kind: gps, sd: 1 m}
"""
    robot = loads(BASE + text).robot
    assert robot.build.drive == Differential(max_speed=1.5, track=0.36)
    assert robot.build.radius == pytest.approx(math.hypot(0.3, 0.2)) and robot.build.mass == 20
    lidar = LidarBuild(field_of_view=math.pi, beams=181)
    assert robot.sensors[0] == Installed("front", lidar, Mount(0.2, 0.0, math.radians(5), 0.25), 0.05, 0.1)
    assert [sensor.name for sensor in robot.sensors] == ["front", "gps"]


def test_an_own_robot_without_sensors_carries_none():
    assert loads(BASE + "robot: {start: [0, 0], shape: {circle: 0.2}}\n").robot.sensors == ()


def test_single_values_of_a_model_are_changed():
    text = "robot: {model: packbot, start: [0, 0], max_speed: 0.3, lidar: {beams: 90}, compass: {sd: 2 deg}}\n"
    robot = loads(BASE + text).robot
    assert isinstance(robot.build.drive, SkidSteer) and robot.build.drive.max_speed == 0.3
    lidar = next(sensor.build for sensor in robot.sensors if sensor.name == "lidar")
    assert isinstance(lidar, LidarBuild) and lidar.beams == 90


def test_drives_of_every_kind_are_read():
    for kind, drive in (("ackermann", Ackermann()), ("skid-steer", SkidSteer()), ("differential", Differential())):
        assert loads(BASE + f"robot: {{start: [0, 0], drive: {{kind: {kind}}}}}\n").robot.build.drive == drive


@pytest.mark.parametrize(
    ("robot", "message"),
    [
        ("{start: [0, 0], model: pakbot}", "robot.model: expected one of denning, packbot"),
        ("{start: [0, 0], lidar: {beams: 3}}", "this robot carries no lidar: name it under 'sensors'"),
        ("{start: [0, 0], model: ravon, max_turn_rate: 1}", "this drive has no max_turn_rate; it has max_speed"),
        ("{start: [0, 0], shape: {circle: 1, box: [1, 1]}}", "robot.shape: give one of circle, box and polygon"),
        (
            "{start: [0, 0], shape: {polygon: [[0, 0], [2, 0], [1, 0.2], [1, 2]]}}",
            "the polygon must be convex, since it can move",
        ),
        ("{start: [0, 0], shape: {polygon: [[0, 0], [2, 0], [1, 0]]}}", "a ring encloses nothing"),
        ("{start: [0, 0], shape: {circle: 1}, radius: 2}", "give 'shape' or 'radius', not both"),
        (
            "{start: [0, 0], sensors: [{kind: gps}, {kind: lidar, name: gps}]}",
            "robot.sensors[1].name: the name 'gps' is taken",
        ),
        ("{start: [0, 0], sensors: [{kind: radar}]}", "robot.sensors[0].kind: no such kind as 'radar'"),
        ("{start: [0, 0], sensors: [{kind: lidar, beams: 0}]}", "expected a whole number from 1 to 100000, got '0'"),
    ],
)
def test_a_mistake_in_a_robot_is_told(robot, message):
    assert message in problem(BASE + f"robot: {robot}\n")


# --- things -----------------------------------------------------------------------------------------


def thing(text: str):
    return loads(BASE + ROBOT + f"things: [{text}]\n").things[0]


def test_discs_boxes_and_polygons_stand_or_are_pushed():
    assert thing("{kind: disc, radius: 0.3, at: [2, 1]}").outline == Circle(0.3)
    assert thing("{kind: box, size: [1, 0.5], at: [2, 1], mass: 5}").mass == 5
    clockwise = thing("{kind: polygon, vertices: [[0, 0], [0, 1], [1, 0]], at: [2, 1]}").outline
    assert isinstance(clockwise, Polygon) and clockwise.vertices[0] in ((1.0, 0.0), (0.0, 0.0), (0.0, 1.0))


def test_a_polygon_that_is_not_convex_may_stand_but_not_move():
    dented = "vertices: [[0, 0], [2, 0], [1, 0.2], [1, 2]], at: [1, 1]"
    assert isinstance(thing(f"{{kind: polygon, {dented}}}").outline, Rings)
    assert "must be convex" in problem(BASE + ROBOT + f"things: [{{kind: polygon, mass: 2, {dented}}}]\n")


def test_rings_are_text_or_lists_and_holes_are_wound_the_other_way():
    outline = thing('{kind: outline, rings: ["-3 -3, -3 3, 3 3, 3 -3", [[-2, -2], [2, -2], [2, 2], [-2, 2]]]}').outline
    assert isinstance(outline, Rings)
    areas = [sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(r, (*r[1:], r[0]), strict=True)) / 2 for r in outline.rings]
    assert areas == pytest.approx([36.0, -16.0])


def test_keyframes_move_a_thing():
    moving = thing("{kind: disc, radius: 0.5, keyframes: [[0, 1, 2], [4, 3, 2]]}")
    assert moving.at == (1.0, 2.0) and moving.motion.at(1.0) == (1.5, 2.0) and moving.motion.at(5.0) == (1.5, 2.0)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{kind: disc, radius: 1}", "a disc has either 'at' (it stands) or 'keyframes' (it moves)"),
        ("{kind: disc, radius: 1, keyframes: [[0, 1, 2], [0, 3, 2]]}", "the times of keyframes must rise"),
        ("{kind: disc, radius: 1, mass: 3, keyframes: [[0, 1, 2], [1, 3, 2]]}", "leave 'mass' out"),
        ('{kind: outline, rings: ["0 0, 1 1"]}', "expected corners as text"),
        ('{kind: outline, rings: ["0 0, 1 1, nan 3"]}', "expected corners as text"),
        ("{kind: curb, from: [1, 1], to: [1, 1]}", "'from' and 'to' must be two places"),
    ],
)
def test_a_mistake_in_a_thing_is_told(text, message):
    assert message in problem(BASE + ROBOT + f"things: [{text}]\n")


# --- what happens -------------------------------------------------------------------------------------


def test_events_faults_slopes_and_goals_are_read():
    text = """things: [{kind: disc, radius: 0.3, at: [2, 1], id: bin}]
events:
  - {at: 5, vanish: bin}
  - {at: 9 s, put: {thing: bin, at: [1, 1, 90 deg]}}
faults: [{sensor: sonar, kind: stuck, at: 3, until: 1 min}]
ground: [{region: [0, 0, 2, 2], rise: 5 deg, uphill: 90 deg}]
goal: {at: [4, 4], within: 50 cm, no_contact: true}
"""
    scenario = loads(BASE + ROBOT + text)
    assert scenario.events == (Event(5.0, Vanish("bin")), Event(9.0, Put("bin", Pose(1.0, 1.0, math.radians(90)))))
    assert scenario.faults == (Fault("sonar", "stuck", 3.0, 60.0),)
    assert scenario.ground.slopes == (Slope((0.0, 0.0, 2.0, 2.0), math.radians(5), math.radians(90)),)
    assert scenario.goal is not None and (scenario.goal.within, scenario.goal.no_contact) == (0.5, True)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "faults: [{sensor: sonra, kind: nan}]",
            "room.yaml:4:10: faults[0].sensor: the robot has no sensor 'sonra'",
        ),
        ("events: [{at: 1, vanish: bin}]", "room.yaml:4:10: events[0]: there is no thing 'bin'; none has an id"),
        ("events: [{at: 1}]", "events[0]: give one of vanish, put, weather and head"),
        ("faults: [{sensor: sonar, kind: dropout, amount: 3}]", "a chance from 0 to 1"),
        ("faults: [{sensor: sonar, kind: nan, at: 3, until: 2}]", "'until' must be later than 'at'"),
        ("donor: {at: [1, 1]}\ngoal: {at: [2, 2]}", "a scenario has either a donor or a goal"),
        ("goal: {at: [2, 2], no_contact: maybe}", "goal.no_contact: expected true or false, got 'maybe'"),
    ],
)
def test_a_mistake_in_what_happens_is_told(text, message):
    assert message in problem(BASE + ROBOT + text + "\n")


def test_aliases_that_multiply_are_refused():
    lines = ["a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]"]
    lines += [f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 10)}]" for n in range(1, 12)]
    assert "aliases make more than" in problem("\n".join(lines) + "\n")
    assert "aliases make more than" in problem("name: &a [*a]\n")


# --- the schema ---------------------------------------------------------------------------------------


def test_the_published_schema_is_that_of_the_format():
    published = ROOT / "sim" / "scenarios" / "scenario.schema.json"
    assert json.loads(published.read_text()) == scenarios.schema(), "python -m sim.scenarios.format > that file"


def test_the_schema_is_one_and_takes_the_scenarios_that_come_with_rplan():
    schema = scenarios.schema()
    jsonschema.Draft202012Validator.check_schema(schema)
    for path in sorted((ROOT / "plans").glob("*/*.yaml")):
        jsonschema.validate(yaml.safe_load(path.read_text()), schema, jsonschema.Draft202012Validator)


def test_the_schema_refuses_what_the_format_refuses():
    for text in ("name: a\n", BASE + "robot: {start: [0]}\n", BASE + ROBOT + "things: [{kind: wal}]\n"):
        with pytest.raises(jsonschema.ValidationError):
            jsonschema.validate(yaml.safe_load(text), scenarios.schema(), jsonschema.Draft202012Validator)
