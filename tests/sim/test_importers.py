"""Importers: what worlds of other formats become, and what is said of files that cannot be imported."""

from __future__ import annotations

import gzip
import json
import math
import os
import shutil
import struct
import zlib
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from PIL import Image

from behaviours.interface import Command, Drive
from sim.raycast import Circle, Polygon, Rings
from sim.robots.build import Ackermann, Differential
from sim.scenarios.importers import Options, WorldFileError, format_of, load, read, split, text_of
from sim.scenarios.importers.carmen import entries
from sim.scenarios.importers.imported import ring_text
from sim.scenarios.scenario import Scenario, ThingSpec
from sim.sensors.build import LidarBuild
from sim.world import World

SAMPLES = Path(__file__).parents[1] / "data" / "imports"
ROOT = Path(__file__).parents[2]
DATA = Path(os.environ.get("RPLAN_DATA", ROOT.parent / "shared" / "data"))
WORLDS = (
    "yard.world",
    "hall.yaml",
    "small.map",
    "little_maze.txt",
    "cylinders.json",
    "moving_discs.json",
    "along_walls.json",
    "yard.png",
)


def scenario(name: str, **options: Any) -> Scenario:
    return load(SAMPLES / name, Options(**options))[0]


def thing(world: Scenario, name: str) -> ThingSpec:
    return next(thing for thing in world.things if thing.id == name)


def rings(spec: ThingSpec) -> tuple[tuple[tuple[float, float], ...], ...]:
    assert isinstance(spec.outline, Rings)
    return spec.outline.rings


def refused(path: Path, **options: Any) -> str:
    with pytest.raises(WorldFileError) as error:
        read(path, Options(**options))
    assert "\n" not in str(error.value)
    return str(error.value)


def written(folder: Path, name: str, content: str | bytes) -> Path:
    path = folder / name
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return path


# --- every format -------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", WORLDS)
def test_the_text_of_an_import_is_its_document_and_a_sound_scenario(name: str) -> None:
    imported = read(SAMPLES / name, Options())
    text = text_of(imported)
    assert yaml.safe_load(text) == imported.document
    assert load(SAMPLES / name, Options())[1] == text
    assert text.startswith(f"# Imported from {name} (")
    assert imported.document["source"].startswith(name)


@pytest.mark.parametrize("name", WORLDS)
def test_the_robot_of_an_import_has_room_and_drives(name: str) -> None:
    world = World(scenario(name, model="micromouse"), 0)
    before = world.sense()
    world.step(Command(drive=Drive(0.05, 0.0)))
    assert world.sense().odometry.pose != before.odometry.pose
    assert world.touches == ()


def test_what_the_lidar_of_an_imported_world_sees_is_the_wall_of_the_bitmap() -> None:
    world = World(scenario("yard.world", start=(-2.0, 0.0, math.pi / 2)), 0)
    lidar = world.sense().lidar
    assert lidar is not None
    assert lidar.ranges[len(lidar.ranges) // 2] == pytest.approx(4.5)
    assert lidar.ranges[90 + 360] == pytest.approx(2.9 - 2.0, abs=0.01)


@pytest.mark.parametrize("name", WORLDS)
def test_what_is_left_out_stands_in_the_scenario(name: str) -> None:
    imported = read(SAMPLES / name, Options())
    assert scenario(name).left_out == imported.left_out


def test_a_start_that_is_asked_for_is_the_start() -> None:
    for name in WORLDS:
        robot = scenario(name, start=(0.3, 0.4, 0.5)).robot
        assert (robot.start, robot.heading) == ((0.3, 0.4), 0.5)


def test_the_number_of_a_world_may_stand_behind_the_file() -> None:
    assert split("worlds/barn.json#12") == (Path("worlds/barn.json"), 12)
    assert split("worlds/barn.json") == (Path("worlds/barn.json"), None)
    assert split("odd#name") == (Path("odd#name"), None)


def test_formats_are_told_by_content_where_the_name_says_nothing(tmp_path: Path) -> None:
    for name, form in [
        ("yard.world", "stage"),
        ("hall.yaml", "ros-map"),
        ("small.map", "moving-ai"),
        ("little_maze.txt", "micromouse"),
        ("yard.png", "picture"),
        ("corridor.log", "carmen"),
        ("corridor.log.gz", "carmen"),
    ]:
        shutil.copy(SAMPLES / name, tmp_path / "unnamed")
        assert (format_of(SAMPLES / name), format_of(tmp_path / "unnamed")) == (form, form)


def test_a_ring_is_one_text_without_corners_that_fall_together() -> None:
    assert ring_text([(0.0, -0.00001), (1.0, 0.25), (1.00001, 0.25), (2.5, 3.0)]) == "0 0, 1 0.25, 2.5 3"


# --- Stage --------------------------------------------------------------------------------------------


def test_the_dark_pixels_of_a_stage_bitmap_are_stretched_to_its_size() -> None:
    yard = thing(scenario("yard.world"), "yard")
    corners = np.array([corner for ring in rings(yard) for corner in ring])
    assert corners.min(axis=0) == pytest.approx([1 - 4, -5])
    assert corners.max(axis=0) == pytest.approx([1 + 4, 5])
    assert yard.height == 1.5


def test_a_boundary_is_a_frame_of_its_own() -> None:
    frames = [thing for thing in scenario("yard.world").things if thing.kind == "outline" and not thing.id]
    (frame,) = frames
    assert [len(ring) for ring in rings(frame)] == [4, 4]


def test_defines_nest_and_blocks_are_stretched() -> None:
    (ring,) = rings(thing(scenario("yard.world"), "ramp"))
    assert set(ring) == {(2.5, 0.5), (2.5, 1.5), (1.5, 1.5)}


def test_a_model_stands_on_another_one_in_its_frame() -> None:
    world = scenario("yard.world")
    crate = thing(world, "crate")
    lid = next(thing for thing in world.things if thing.kind == "box" and not thing.id)
    assert (crate.at, crate.heading) == ((-1, -1), pytest.approx(math.pi / 6))
    assert lid.at == pytest.approx((-1 + math.cos(math.pi / 6), -0.5), abs=1e-3)


def test_what_nobody_sees_or_touches_is_no_thing() -> None:
    assert "painted line" not in [thing.id for thing in scenario("yard.world").things]


def test_the_first_robot_with_a_ranger_is_the_robot_and_others_stand() -> None:
    world = scenario("yard.world")
    robot = world.robot
    assert (robot.start, robot.heading) == ((-2, 1.5), pytest.approx(math.pi / 4))
    assert robot.build.mass == 9.5
    drive = robot.build.drive
    assert isinstance(drive, Differential)
    assert (drive.max_speed, drive.max_turn_rate) == (0.6, pytest.approx(math.pi / 4, abs=1e-4))
    assert isinstance(robot.build.hull, Polygon)
    assert max(x for x, _ in robot.build.hull.vertices) == pytest.approx(0.15)
    assert thing(world, "idle").kind == "box"


def test_another_robot_may_be_asked_for() -> None:
    world = scenario("yard.world", robot="idle")
    assert world.robot.start == (3, 2)
    assert thing(world, "eyes").kind == "box"
    assert "no robot 'nobody'" in refused(SAMPLES / "yard.world", robot="nobody")


def test_sensors_of_rangers_are_lidars_and_the_one_with_many_beams_comes_first() -> None:
    sensors = scenario("yard.world").robot.sensors
    lidars = [sensor for sensor in sensors if isinstance(sensor.build, LidarBuild)]
    assert [sensor.name for sensor in lidars] == ["scanner", "whiskers", "whiskers-2"]
    first, whisker = lidars[0].build, lidars[1]
    assert isinstance(first, LidarBuild)
    assert (first.beams, first.max_range, first.field_of_view) == (541, 4.5, pytest.approx(1.5 * math.pi))
    assert (whisker.mount.x, whisker.mount.y, whisker.mount.theta) == (0.2, 0.1, pytest.approx(math.pi / 6))


def test_missing_includes_and_types_are_said_and_not_fatal() -> None:
    left_out = " | ".join(scenario("yard.world").left_out)
    assert "trailer.inc, included in yard.world:3: there is no such file" in left_out
    assert "1 x trailer: this type is nowhere defined" in left_out
    assert "controllers of robots (ctrl)" in left_out


def test_robots_of_a_type_that_is_missing_are_round_ones(tmp_path: Path) -> None:
    text = 'include "gone.inc"\ndefine bot ghost ( ctrl "wander" )\nbot ( pose [1 2 0 90] ) bot ( pose [4 2 0 0] )'
    world, _ = load(written(tmp_path, "ghosts.world", text), Options())
    assert (world.robot.start, world.robot.build.hull) == ((1, 2), Circle(0.18))
    assert [thing.outline for thing in world.things] == [Circle(0.18)]


def test_a_car_of_stage_steers(tmp_path: Path) -> None:
    text = 'position ( size [1 0.5 1] drive "car" wheelbase 0.7 ) model ( pose [5 0 0 0] )'
    world, _ = load(written(tmp_path, "car.world", text), Options())
    assert world.robot.build.drive == Ackermann(max_speed=1.0, wheelbase=0.7, acceleration=1.0)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("model ( size [1 1", "bad.world:1: the file ends within '['"),
        ("model ( size [1 x 1] )", "bad.world:1: size: expected a number up to 100000, got 'x'"),
        ("model ( size [nan 1 1] )", "bad.world:1: size: expected a number up to 100000, got 'nan'"),
        ("model ( size [0 1 1] )", "bad.world:1: size: expected lengths from 0.001 m on, got 0 and 1"),
        ('model ( bitmap "gone.png" )', "bad.world:1: bitmap: gone.png: there is no such file"),
        ("\nmodel ( block ( points 3 point[0] [0 0] ) )", "bad.world:2: it says that it has 3 points"),
        ("model ( block ( points 5e4 ) )", "bad.world:1: points: expected 3 to 1000, got 50000"),
        ('model ( name "x )', "bad.world:1: a quotation mark that is never closed"),
        ("define a model ( )", "bad.world: nothing stands in this world"),
        ("model ( pose )", "bad.world:1: pose has no value"),
        ("] model ( )", "bad.world:1: expected a name, got ']'"),
        ('include "bad.world"', "bad.world:1: the file includes itself, or includes go too far"),
        ("m ( " * 100 + ")" * 100, "bad.world:1: blocks are nested more than 40 deep"),
        ('unit_length "mm" model ( )', "bad.world: unit_length: only 'm' is read"),
        ("# nothing", "bad.world: nothing stands in this world"),
    ],
)
def test_mistakes_in_stage_worlds_are_told_with_their_place(tmp_path: Path, text: str, message: str) -> None:
    assert message in refused(written(tmp_path, "bad.world", text))


def test_defines_that_double_at_each_step_are_stopped(tmp_path: Path) -> None:
    lines = ["define m0 model ( )", *(f"define m{n} model ( m{n - 1} ( ) m{n - 1} ( ) )" for n in range(1, 35))]
    assert "more than 5,000 models" in refused(written(tmp_path, "bomb.world", "\n".join([*lines, "m34 ( )"])))


# --- maps ---------------------------------------------------------------------------------------------


def test_a_ros_map_lies_at_its_origin_and_is_turned_by_its_yaw() -> None:
    hall = scenario("hall.yaml")
    corners = np.array(rings(thing(hall, "walls"))[0])
    assert corners.min(axis=0) == pytest.approx([-3, -2])
    assert corners.max(axis=0) == pytest.approx([-1, 1])
    assert hall.bounds == pytest.approx((-3, -2, -1, 1))


def test_the_robot_stands_where_the_map_is_known_to_be_free() -> None:
    x, y = scenario("hall.yaml").robot.start
    assert -2.9 < x < -1.1
    assert -1.9 < y < 0.9


def ros_map(folder: Path, values: list[list[int]], more: str = "") -> list[float]:
    """The areas of the rings of a map with these grey values, cells of 1 m."""
    Image.fromarray(np.array(values, dtype=np.uint8)).save(folder / "grey.png")
    head = "image: grey.png\nresolution: 1\norigin: [0, 0, 0]\noccupied_thresh: 0.65\nfree_thresh: 0.2\n"
    world, _ = load(written(folder, "grey.yaml", head + more), Options(start=(0, 0, 0)))
    found = rings(world.things[0]) if world.things else ()
    return [abs(sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(r, (*r[1:], r[0]), strict=True)) / 2) for r in found]


def test_thresholds_of_ros_maps_are_those_of_map_server(tmp_path: Path) -> None:
    row = [[0, 89, 90, 205, 254, 255]]  # 89 is 65.1 % dark, 90 is 64.7 %
    assert ros_map(tmp_path, row) == [2]
    assert ros_map(tmp_path, row, "negate: 1") == [3]
    assert ros_map(tmp_path, row, "mode: scale") == [3]
    assert ros_map(tmp_path, [[0, 64, 65, 100, 101, 255]], "mode: raw") == [2]


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("resolution: -1", "bad.yaml:2: resolution: expected a number from 1e-06"),
        ("resolution: .nan", "bad.yaml:2: resolution: expected a number"),
        ("resolution: 1e-5", "bad.yaml: cells must be from 0.001 to 100 m wide"),
        ("origin: [0]", "bad.yaml:2: origin: expected [x, y, yaw]"),
        ("origin: [0, zero, 0]", "bad.yaml:2: origin: expected a number"),
        ("mode: odd", "bad.yaml:2: mode: expected one of trinary, scale, raw, got 'odd'"),
        ("image: gone.pgm", "bad.yaml:2: image: gone.pgm: there is no such file"),
        ("image: hall.yaml", "bad.yaml:2: image: hall.yaml: not a picture that can be read"),
        ("image: [a, b]", "bad.yaml:2: image: expected a word"),
        ("free_thresh: [", "bad.yaml:4: not YAML"),
    ],
)
def test_mistakes_in_ros_maps_are_told_with_their_place(tmp_path: Path, line: str, message: str) -> None:
    for name in ("hall.yaml", "hall.pgm"):
        shutil.copy(SAMPLES / name, tmp_path / name)
    key = line.split(":")[0]
    rest = [old for old in (SAMPLES / "hall.yaml").read_text().splitlines() if not old.startswith(f"{key}:")]
    text = "\n".join([rest[0], line, *rest[1:]])
    assert message in refused(written(tmp_path, "bad.yaml", text + "\n"))


def test_a_key_that_is_missing_from_a_ros_map_is_named(tmp_path: Path) -> None:
    assert "resolution: this key is missing" in refused(written(tmp_path, "bad.yaml", "image: x.png\n"))


def test_a_picture_alone_has_cells_of_the_size_that_is_asked_for() -> None:
    assert scenario("yard.png").bounds == (0, 0, 5, 4)
    assert scenario("yard.png", resolution=0.5).bounds == (0, 0, 50, 40)


def huge_png(side: int) -> bytes:
    """The head of a picture of so many cells, with nothing behind it."""
    parts = [b"IHDR" + struct.pack(">IIBBBBB", side, side, 8, 0, 0, 0, 0), b"IDAT" + zlib.compress(b"\0")]
    chunks = [struct.pack(">I", len(part) - 4) + part + struct.pack(">I", zlib.crc32(part)) for part in parts]
    return b"\x89PNG\r\n\x1a\n" + b"".join(chunks)


def test_maps_of_too_many_cells_are_refused_before_they_are_loaded(tmp_path: Path) -> None:
    for name, content in [
        ("huge.pgm", b"P5\n40000 25000\n255\n"),
        ("huge.png", huge_png(32_000)),
        ("large.png", huge_png(10_001)),
        ("huge.map", "type octile\nheight 40000\nwidth 25000\nmap\n"),
    ]:
        assert "at most 100,000,000 are read" in refused(written(tmp_path, name, content))


def test_a_moving_ai_map_is_taken_cell_by_cell() -> None:
    world = scenario("small.map")
    outer, hole = rings(thing(world, "walls"))
    assert set(outer) == {(0, 0), (7, 0), (7, 5), (0, 5)}
    assert {(1, 1), (1, 4), (3, 4), (3, 3), (2, 3), (2, 2), (4, 2), (4, 4), (6, 4), (6, 2), (5, 2), (5, 1)} == set(hole)
    assert scenario("small.map", resolution=0.5).bounds == (0, 0, 3.5, 2.5)
    assert world.left_out == ("swamp (1 cells): it is free",)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("type octile\nheight 2\nwidth 2\nmap\n..\n", "bad.map:5: the map ends after 1 of 2 rows"),
        ("type octile\nheight 2\nwidth 2\nmap\n..\n...\n", "bad.map:6: this row has 3 cells, the map is 2 wide"),
        ("type octile\nheight 1\nwidth 2\nmap\n.x\n", "bad.map:5: no cell is written 'x'"),
        ("type octile\nheight 1\nwidth 2\nmap\n.é\n", "bad.map:5: no cell is written 'é'"),
        ("type octile\nheight minus\nwidth 2\nmap\n", "bad.map:2: height: expected a number of cells, got 'minus'"),
        ("type octile\nwidth 2\nmap\n..\n", "bad.map:1: height: this line is missing"),
        ("type octile\nheight 1\nwidth 2\n..\n", "bad.map:4: expected type, height, width or map"),
        ("type octile\nheight 1\nwidth 2\nmap\n@@\n", "bad.map: no cell is free"),
    ],
)
def test_mistakes_in_moving_ai_maps_are_told_with_their_place(tmp_path: Path, text: str, message: str) -> None:
    assert message in refused(written(tmp_path, "bad.map", text))


# --- mazes and challenges -----------------------------------------------------------------------------


def test_a_maze_has_walls_of_12_mm_on_cells_of_180_mm() -> None:
    world = scenario("little_maze.txt")
    outer, room, inner = sorted(rings(world.things[0]), key=len)
    assert set(outer) == {(-0.006, -0.006), (0.546, -0.006), (0.546, 0.546), (-0.006, 0.546)}
    assert {x for ring in (room, inner) for x, _ in ring} == {0.006, 0.174, 0.186, 0.354, 0.366, 0.534}


def test_the_micromouse_looks_out_of_its_cell_and_the_goal_is_in_the_middle_of_the_goal_cells() -> None:
    world = scenario("little_maze.txt")
    assert (world.robot.start, world.robot.heading) == ((0.09, 0.09), pytest.approx(math.pi / 2))
    assert world.goal is not None
    assert (world.goal.at, world.goal.within) == ((0.18, 0.27), 0.09)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("o---o---o---o\n|", "o---o-x-o---o\n|", "bad.txt:1: column 7: expected '---' or '   ', got '-x-'"),
        ("| S |", "| S !", "bad.txt:6: column 5: expected '|' or ' ', got '!'"),
        ("o---o---o---o\n|", "o---o---o---o-\n|", "bad.txt:1: no maze has 7 lines of 14"),
    ],
)
def test_mistakes_in_mazes_are_told_with_their_place(tmp_path: Path, old: str, new: str, message: str) -> None:
    text = (SAMPLES / "little_maze.txt").read_text().replace(old, new, 1)
    assert message in refused(written(tmp_path, "bad.txt", text), format="micromouse")


def test_a_barn_world_is_discs_a_goal_and_a_jackal() -> None:
    world = scenario("cylinders.json", world=4)
    assert [thing.at for thing in world.things] == [(-0.075, 0.075), (-3.5, 6.25), (-1.0, 8.125)]
    assert world.things[0].outline == Circle(0.075)
    assert (world.robot.start, world.robot.heading) == ((-2.25, 3), 1.57)
    assert world.goal is not None
    assert (world.goal.at, world.goal.within, world.goal.no_contact) == ((-2.25, 13), 1, True)
    assert world.time_limit == 100
    assert world.left_out == ("the planned path; the optimal time by it is 5 s",)


def test_one_of_several_worlds_is_picked_by_its_number() -> None:
    assert scenario("cylinders.json", world=10).name == "BARN 10"
    assert scenario("cylinders.json").left_out[0] == "the other worlds of the file (1); this is number 4"
    assert "there is no world 5 in it; there are 2: 4, 10" in refused(SAMPLES / "cylinders.json", world=5)
    assert "there is no case 3; there are 1 to 2" in refused(SAMPLES / "along_walls.json", world=3)


def test_a_file_may_hold_one_barn_world_alone(tmp_path: Path) -> None:
    world, _ = load(written(tmp_path, "one.json", '{"cylinders": [[0, 5], [1, 6]]}'), Options())
    assert (world.name, len(world.things), world.robot.start) == ("one", 2, (-2.25, 3))


def test_discs_of_dynabarn_move_by_keyframes_through_a_walled_room() -> None:
    document = read(SAMPLES / "moving_discs.json", Options(world=2)).document
    assert [thing["kind"] for thing in document["things"]] == ["wall"] * 3 + ["disc"] * 2
    assert document["things"][4]["keyframes"] == [[0.0, 5.0, 5.0], [0.5, 5.0, 4.5], [6.5, -5.0, 5.0]]
    assert document["robot"]["start"] == [11.0, 0.0]
    assert document["goal"] == {"at": [-9.0, 0.0], "within": 1.0, "no_contact": True}


def test_a_wall_following_case_is_a_map_with_a_car_that_steers() -> None:
    world = scenario("along_walls.json", world=2)
    assert (world.name, world.robot.start, world.robot.heading) == ("right", (-1.8, 0), 3.14)
    assert isinstance(world.robot.build.drive, Ackermann)
    assert world.goal is not None
    assert (world.goal.at, world.goal.within, world.time_limit) == ((-1.8, -1), 0.5, 60)
    assert world.left_out[-1] == "what the plan shall do: side -1, velocity 2, desired_distance 0.4"


@pytest.mark.parametrize(
    ("name", "change", "message"),
    [
        ("cylinders.json", {"radius": True}, "radius: expected a number, got True"),
        ("cylinders.json", {"radius": 1e9}, "radius: expected a number from 0.001 to 100"),
        ("cylinders.json", {"start": [1, 2]}, "start: expected 3 numbers, got 2"),
        ("cylinders.json", {"worlds": []}, "worlds: expected a list, got a list of 0"),
        ("cylinders.json", {"worlds": [3]}, "worlds[0]: expected a mapping"),
        ("cylinders.json", {"worlds": [{"cylinders": [["a", 1]]}]}, "cylinders[0][0]: expected a number, got 'a'"),
        ("moving_discs.json", {"worlds": {}}, "worlds: expected a mapping, got a mapping"),
        ("moving_discs.json", {"worlds": {"x": []}}, "worlds: expected numbers of worlds as keys"),
        ("moving_discs.json", {"worlds": {"1": [{"plugin": "no"}]}}, "there is none for the disc 'no'"),
        ("along_walls.json", {"map": 3}, "map: expected the name of a file, got 3"),
        ("along_walls.json", {"tests": [{}]}, "start_x: expected a number, got nothing"),
    ],
)
def test_mistakes_in_json_worlds_are_told(tmp_path: Path, name: str, change: dict[str, object], message: str) -> None:
    whole = json.loads((SAMPLES / name).read_text()) | change
    assert message in refused(written(tmp_path, name, json.dumps(whole)))


def test_keyframes_whose_times_fall_are_refused(tmp_path: Path) -> None:
    whole = json.loads((SAMPLES / "moving_discs.json").read_text())
    whole["trajectories"]["slow"]["keyframes_t_x_y"][1][0] = 30.0
    assert "keyframes_t_x_y[2]: the time 20 s comes too early" in refused(
        written(tmp_path, "falls.json", json.dumps(whole))
    )


# --- any file -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("empty.world", b"", "empty.world: the file is empty"),
        ("latin.map", b"type octile\n\xe9\xff", "latin.map:2: not a text in UTF-8"),
        ("cut.json", b'{"worlds": [', "cut.json:1: not JSON"),
        ("deep.json", b"[" * 100_000, "deep.json: not JSON that can be read"),
        ("list.json", b"[1]", "list.json: this JSON is no world that is known"),
        ("other.json", b'{"a": 1}', "other.json: this JSON is no world that is known"),
        ("digits.json", b'{"cylinders": [[' + b"9" * 5000 + b", 1]]}", "digits.json: not JSON that can be read"),
        ("nan.json", b'{"cylinders": [[NaN, 1]]}', "cylinders[0][0]: expected a number from"),
        ("cut.png", huge_png(5), "cut.png: not a picture that can be read"),
        ("words.txt", b"once upon a time", "words.txt: this is no format that is known"),
        ("world.log", b"ODOM 0 0 0 0 0 0 1 x 1\n", "world.log: this is a log, not a world"),
    ],
)
def test_files_that_are_broken_are_refused_in_one_line(tmp_path: Path, name: str, content: bytes, message: str) -> None:
    assert message in refused(written(tmp_path, name, content))


def test_a_file_that_is_missing_or_no_file_is_refused(tmp_path: Path) -> None:
    assert refused(tmp_path / "gone.world") == "gone.world: there is no such file"
    assert "there is no such file" in refused(tmp_path)
    assert refused(Path("a\0b.world")) == "a?b.world: there is no such file"
    assert "there is no format 'odd'" in refused(SAMPLES / "yard.world", format="odd")


# --- data that nobody of the project wrote ------------------------------------------------------------


def worlds_there() -> list[Path]:
    patterns = ("stage/*.world", "stage/bitmaps/*.png", "ros_maps/*.yaml", "mazes/*.txt", "*barn/*.json")
    found = [path for pattern in patterns for path in sorted(DATA.glob(pattern))]
    return found + [path for name in ("tests.json", "maps/building_31.yaml") for path in DATA.glob(f"*/{name}")]


def test_every_world_of_the_data_folder_becomes_a_sound_scenario_of_few_corners() -> None:
    if not DATA.is_dir():
        pytest.skip(f"there is no data folder {DATA.name}: worlds of others are not tried")
    paths = worlds_there()
    assert len(paths) > 15
    for path in paths:
        world, text = load(path, Options())
        assert len(text) < 100_000, path
        assert world.source.startswith(path.name)


def test_every_log_of_the_data_folder_is_read() -> None:
    if not DATA.is_dir():
        pytest.skip(f"there is no data folder {DATA.name}: logs of others are not tried")
    for path in sorted(DATA.glob("laser_logs/*.log.gz")):
        found = list(entries(path))
        assert len(found) > 400
        assert all(a.stamp <= b.stamp for a, b in pairwise(found))
        assert math.dist(_place(found[-1]), _place(found[0])) < 200


def _place(entry: Any) -> tuple[float, float]:
    return entry.corrected.x, entry.corrected.y


# --- logs ---------------------------------------------------------------------------------------------


def test_a_log_gives_a_reading_for_each_scan() -> None:
    found = list(entries(SAMPLES / "corridor.log"))
    assert [round(entry.stamp, 3) for entry in found] == [0.0, 1.0, 2.0, 2.9]
    first = found[0].reading
    assert first.lidar is not None
    assert (len(first.lidar.bearings), first.lidar.max_range, first.lidar.mount.x) == (36, 8.0, 0.1)
    assert first.lidar.bearings[[0, 18]] == pytest.approx([-math.pi / 2, 0])
    assert first.lidar.ranges[0] == 1.0
    assert [entry.reading.tick for entry in found] == [0, 1, 2, 3]


def test_odometry_is_that_of_the_odom_lines_and_the_map_has_the_corrected_pose() -> None:
    _, second, *_ = entries(SAMPLES / "corridor.log")
    odometry = second.reading.odometry
    assert (odometry.pose.x, odometry.pose.y) == pytest.approx((0.5, 0.004))
    assert odometry.speed == 0.5
    assert (second.corrected.x, second.corrected.y) == (0.5, 0.0)


def test_a_log_without_odom_lines_has_the_odometry_of_its_scans(tmp_path: Path) -> None:
    lines = (SAMPLES / "corridor.log").read_text().splitlines()
    path = written(tmp_path, "bare.log", "\n".join(line for line in lines if not line.startswith("ODOM")))
    assert [entry.reading.odometry.pose.x for entry in entries(path)] == pytest.approx([0, 0.5, 1.0, 1.25])


def test_speeds_that_a_log_does_not_have_are_reckoned_from_poses(tmp_path: Path) -> None:
    text = (SAMPLES / "corridor.log").read_text().replace(" 0.0 0.5 0.0 0.0 ", " 0.0 0.0 0.0 0.0 ")
    _, second, *_ = entries(written(tmp_path, "slow.log", text))
    assert second.reading.odometry.speed == pytest.approx(0.5)


def test_a_packed_log_is_the_same_log() -> None:
    plain, packed = (list(entries(SAMPLES / name)) for name in ("corridor.log", "corridor.log.gz"))
    assert [entry.corrected for entry in plain] == [entry.corrected for entry in packed]


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("FLASER 3 1 2", "bad.log:1: FLASER: the line ends too early"),
        ("FLASER x 1 2", "bad.log:1: FLASER: expected a whole number up to 10000, got 'x'"),
        ("FLASER 0 1 2 3", "bad.log:1: FLASER: a scan of no beams"),
        ("FLASER 1 nan 0 0 0 0 0 0 1 x 1", "bad.log:1: FLASER: expected numbers, got 'nan'"),
        ("FLASER 99999999 1", "bad.log:1: FLASER: expected a whole number up to 10000"),
        ("ODOM 0 0 zero 0 0 0 1 x 1", "bad.log:1: ODOM: expected numbers, got 'zero'"),
        ("PARAM a b", "bad.log: there is no scan"),
    ],
)
def test_mistakes_in_logs_are_told_with_their_line(tmp_path: Path, line: str, message: str) -> None:
    with pytest.raises(WorldFileError) as error:
        list(entries(written(tmp_path, "bad.log", line + "\n")))
    assert message in str(error.value)


def test_packed_files_are_unpacked_only_so_far(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sim.scenarios.importers.sources.MOST_UNPACKED", 10_000)
    path = written(tmp_path, "bomb.log.gz", gzip.compress(b"0" * 1_000_000))
    with pytest.raises(WorldFileError, match="unpacks to more than 10,000 bytes"):
        list(entries(path))
    with pytest.raises(WorldFileError, match="the packed file is damaged"):
        list(entries(written(tmp_path, "cut.log.gz", (SAMPLES / "corridor.log.gz").read_bytes()[:60])))
