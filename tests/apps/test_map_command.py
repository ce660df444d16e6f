"""`rplan map`: the map of a recording for ROS and as a picture; and clear words where there is none."""

from __future__ import annotations

import base64
import json
import math
import re
import zlib
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from click.testing import CliRunner, Result
from numpy.typing import NDArray
from PIL import Image

from behaviours.cores.occupancy import Region
from behaviours.cores.patches import packed
from rplan.apps.cli import cli
from rplan.apps.drawing.map import BELIEVED, ODOMETRY, TRUTH, cell_map, gather
from rplan.apps.simulation import load_world, simulate
from rplan.apps.wiring import compile_file
from sim.maps import CellMap, trinary, write_ros
from sim.recording import Recorder, json_text, read
from sim.replay import pack
from sim.scenarios.format import loads
from sim.scenarios.importers import Options, text_of
from sim.scenarios.importers import read as import_map

PLAN = """
(plan room "Round in a room." :period 0.1s)
(use robot)
(use localisation {localisation})
(use mapping)
(use drive :speed 0.5m/s :turn-rate 0.6rad/s)
(defoutput action command :idle (stop))
(defgoalr (ach go)
  (if (or (< (time-since-start) 8s) (> (time-since-start) 10s))
      (do action (drive-ahead))
      (do action (turn-left))))
(goalem (ach go))
"""
ROOM = """
name: room
bounds: [-6, -6, 12, 12]
robot: {start: [-3, -3], heading: 30 deg, model: packbot}
things:
  - {kind: wall, from: [-5, -5], to: [11, -5]}
  - {kind: wall, from: [11, -5], to: [11, 11]}
  - {kind: wall, from: [11, 11], to: [-5, 11]}
  - {kind: wall, from: [-5, 11], to: [-5, -5]}
  - {kind: box, at: [0, 5], size: [2, 3]}
"""


def rplan_map(*arguments: object) -> Result:
    result = CliRunner().invoke(cli, ["map", *map(str, arguments)], catch_exceptions=False)
    assert "Traceback" not in result.output
    return result


def recorded(folder: Path, localisation: str = "") -> Path:
    plan, scenario, run = folder / "room.rplan", folder / "room.yaml", folder / "run.mcap"
    plan.write_text(PLAN.format(localisation=localisation), encoding="utf-8")
    scenario.write_text(ROOM, encoding="utf-8")
    simulate(compile_file(plan), load_world(scenario), 0, until=14.0, record=run)
    return run


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return recorded(tmp_path_factory.mktemp("runs"))


def grid(cells: object = None, **change: object) -> dict[str, object]:
    patch = packed(0.2, Region(1, 2, 2, 2), np.array(cells or [[3, 97], [97, 255]], dtype=np.uint8))
    lies = {"x": 0.2, "y": 0.4, "columns": 2, "rows": 2}
    return {"kind": "grid", "frame": "map", "cell": 0.2, **lies, "data": patch.data, **change}


def hand_made(path: Path, shown: Iterable[Mapping[str, object]], poses: Iterable[object] = ()) -> Path:
    places = list(poses)
    with Recorder(path, {"plan": {"name": "room"}, "home": [1, 2, 0.5], "period": 0.1}) as recorder:
        for n, views in enumerate(shown):
            robot = places[n] if places else [1, 2, 0.5]
            recorder.tick(n / 10, {"robot": robot}, json_text({"shown": views}))
    return path


# --- maps for ROS ---------------------------------------------------------------------------------


def test_a_map_for_ros_is_two_files_that_say_where_it_lies(run: Path, tmp_path: Path) -> None:
    result = rplan_map(run, "-o", tmp_path / "yard.yaml")
    assert result.exit_code == 0, result.output
    about = yaml.safe_load((tmp_path / "yard.yaml").read_text(encoding="utf-8"))
    cells = cell_map(gather(read(run)))
    assert about == {
        "image": "yard.pgm",
        "mode": "trinary",
        "resolution": 0.2,
        "origin": [cells.x, cells.y, 0.0],
        "negate": 0,
        "occupied_thresh": 0.65,
        "free_thresh": 0.196,
    }
    grey = np.asarray(Image.open(tmp_path / "yard.pgm"))
    assert np.array_equal(grey[::-1], trinary(cells.percents))
    assert (tmp_path / "yard.pgm").read_bytes().startswith(b"P5")


def test_either_name_of_the_pair_gives_the_same_files(run: Path, tmp_path: Path) -> None:
    for name in ("a.yaml", "b.pgm"):
        rplan_map(run, "-o", tmp_path / name)
    assert (tmp_path / "a.pgm").read_bytes() == (tmp_path / "b.pgm").read_bytes()
    assert (tmp_path / "b.yaml").read_text(encoding="utf-8").replace("b.pgm", "a.pgm") == (
        tmp_path / "a.yaml"
    ).read_text(encoding="utf-8")


def test_the_map_comes_back_as_a_scenario_with_the_room_in_it(run: Path, tmp_path: Path) -> None:
    rplan_map(run, "-o", tmp_path / "room.yaml")
    scenario = loads(text_of(import_map(tmp_path / "room.yaml", Options(start=(0.0, 0.0, 0.0)))), "room.yaml")
    xmin, ymin, xmax, ymax = scenario.bounds
    assert (xmin, ymin) == (pytest.approx(-2.1, abs=1.1), pytest.approx(-2.1, abs=1.1))
    assert (xmax, ymax) == (pytest.approx(14.1, abs=1.1), pytest.approx(14.1, abs=1.1))


def test_greys_are_cut_where_map_server_cuts_them(tmp_path: Path) -> None:
    percents = np.array([[0, 19, 20, 50, 65, 66, 100, 254, 255]], dtype=np.uint8)
    assert trinary(percents)[0].tolist() == [254, 254, 205, 205, 205, 0, 0, 205, 205]
    about, picture = write_ros(CellMap(percents, 0.5, -1.0, 2.0), tmp_path / "some.map")
    assert (about.name, picture.name) == ("some.yaml", "some.pgm")


# --- the picture ----------------------------------------------------------------------------------


def pixels(path: Path) -> NDArray[np.uint8]:
    return np.asarray(Image.open(path).convert("RGB"))


def share(picture: NDArray[np.uint8], colour: tuple[int, int, int]) -> float:
    return float(np.mean((picture == colour).all(axis=-1)))


def test_the_picture_lies_beside_the_recording_and_shows_the_ways(run: Path) -> None:
    result = rplan_map(run)
    picture = run.with_suffix(".png")
    assert result.stdout.startswith(f"wrote {picture}\n")
    shown = pixels(picture)
    for colour in ((64, 160, 255), (40, 200, 80), (255, 140, 30)):
        assert share(shown, colour) > 0.0003
    assert share(shown, (128, 128, 128)) > 0.02


def test_styles_exchange_open_and_occupied(run: Path, tmp_path: Path) -> None:
    for style in ("paper", "ros"):
        assert rplan_map(run, "-o", tmp_path / f"{style}.png", "--style", style).exit_code == 0
    paper, ros = pixels(tmp_path / "paper.png").mean(axis=-1), pixels(tmp_path / "ros.png").mean(axis=-1)
    assert np.mean(paper < 30) > 0.5
    assert np.mean(ros > 225) > 0.5
    assert np.mean(paper > 225) > 0.01


def test_what_it_prints_says_how_good_it_is(run: Path, tmp_path: Path) -> None:
    said = rplan_map(run, "-o", tmp_path / "x.png").stdout
    assert re.search(r"1[67]\.\d x 1[67]\.\d m in cells of 0\.2 m, 2\d\d m² known", said)
    assert re.search(r"sent in 14 patches, \d\.\d kbit/s", said)
    assert re.search(r"believed-pose: 0\.\d\d m off at the end, 0\.\d\d m at most, its heading \d°", said)
    assert re.search(r"odometry-pose: .* its heading 1\d°", said)


def test_for_programs_it_prints_figures(run: Path, tmp_path: Path) -> None:
    told = json.loads(rplan_map(run, "-o", tmp_path / "x.yaml", "--json").stdout)
    assert told["wrote"] == [str(tmp_path / "x.yaml"), str(tmp_path / "x.pgm")]
    assert told["patches"] == 14
    assert 0 < told["off"]["believed-pose"]["at_the_end"] < 0.5


def test_at_a_time_the_map_is_what_it_was_then(run: Path, tmp_path: Path) -> None:
    told = [json.loads(rplan_map(run, "-o", tmp_path / "x.png", "--at", t, "--json").stdout) for t in (0, 5, 14)]
    assert [one["patches"] for one in told] == [1, 6, 14]
    assert told[0]["known"] < told[2]["known"]


# --- frames ---------------------------------------------------------------------------------------


def test_the_truth_is_told_from_where_the_robot_started(run: Path) -> None:
    courses = gather(read(run)).courses
    assert list(courses) == [TRUTH, BELIEVED, ODOMETRY]
    first = courses[TRUTH].at[0]
    assert (first.x, first.y, first.theta) == (0.0, 0.0, pytest.approx(math.radians(30), abs=1e-4))


def test_without_a_compass_the_truth_is_turned_into_the_frame_of_odometry(tmp_path: Path) -> None:
    mapped = gather(read(recorded(tmp_path, ":compass false")))
    assert mapped.frame == "odom"
    truth = mapped.courses[TRUTH].at
    assert truth[0].theta == pytest.approx(0.0, abs=1e-4)
    assert (truth[60].x, truth[60].y) == (pytest.approx(2.9, abs=0.2), pytest.approx(0.0, abs=0.01))
    assert (off := mapped.off(BELIEVED)) is not None and off[0] < 2.0


def test_a_later_patch_changes_the_map_and_no_other_view_does(tmp_path: Path) -> None:
    second = grid([[254, 3], [254, 254]])
    views = [{"map": grid(), "other": grid([[1, 1], [1, 1]])}, {"map": second, "note": 3}, {"wall": {"kind": "lines"}}]
    mapped = gather(read(hand_made(tmp_path / "x.mcap", views)))
    assert cell_map(mapped).percents.tolist() == [[3, 3], [97, 255]]
    assert (mapped.patches, mapped.known) == (2, pytest.approx(0.12))
    other = gather(read(tmp_path / "x.mcap"), "other")
    assert cell_map(other).percents.tolist() == [[1, 1], [1, 1]]


def test_a_small_map_has_a_picture_too(tmp_path: Path) -> None:
    run = hand_made(tmp_path / "x.mcap", [{"map": grid(), BELIEVED: {"kind": "pose", "at": [0, 0, 0]}}] * 2)
    assert rplan_map(run).exit_code == 0
    assert pixels(tmp_path / "x.png").shape[1] == 420


def test_ways_that_lead_to_the_end_of_the_world_leave_a_picture(tmp_path: Path) -> None:
    far = {"kind": "pose", "at": [1e12, -1e12, 0]}
    bad = {"kind": "pose", "at": ["x", None, 0]}
    run = hand_made(tmp_path / "x.mcap", [{"map": grid(), BELIEVED: far, "bad": bad}] * 2, [[1, 2, 0.5], None])
    result = rplan_map(run)
    assert result.exit_code == 0, result.output
    assert max(pixels(tmp_path / "x.png").shape) < 1300


# --- what is wrong --------------------------------------------------------------------------------


def refused(*arguments: object) -> str:
    result = rplan_map(*arguments)
    assert result.exit_code == 2
    assert result.stdout == ""
    return result.stderr


def test_a_recording_without_a_map_says_what_to_use(tmp_path: Path) -> None:
    run = hand_made(tmp_path / "x.mcap", [{}])
    assert refused(run) == (
        f"error: {run}: there is no map in this recording: room makes none; "
        "write (use mapping) into the plan and record again\n"
    )


def test_another_view_is_told_with_those_there_are(tmp_path: Path) -> None:
    run = hand_made(tmp_path / "x.mcap", [{"map": grid()}])
    assert "there is no map rooms in this recording; there is map" in refused(run, "--view", "rooms")


def test_a_map_that_knows_nothing_says_so(tmp_path: Path) -> None:
    run = hand_made(tmp_path / "x.mcap", [{"map": grid([[255, 255], [255, 255]])}])
    assert "knows nothing" in refused(run)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"data": "????"}, "the view map of tick 0 is damaged: damaged data"),
        ({"data": None}, "expected cell, x, y, columns, rows and data"),
        ({"cell": "wide"}, "expected cell, x, y, columns, rows and data"),
        ({"cell": 0}, "cells of 0 m"),
        ({"rows": 3}, "4 cells instead of 6"),
        ({"x": 1e15}, "outside of all maps"),
    ],
)
def test_a_damaged_patch_is_told_with_its_tick(tmp_path: Path, change: dict[str, object], told: str) -> None:
    assert told in refused(hand_made(tmp_path / "x.mcap", [{"map": grid(**change)}]))


def test_other_endings_no_recording_and_no_place_are_told(run: Path, tmp_path: Path) -> None:
    assert "expected FILE.yaml or FILE.pgm" in refused(run, "-o", tmp_path / "x.jpg")
    assert "No such file" in refused(tmp_path / "none.mcap")
    (tmp_path / "text.mcap").write_text("no recording", encoding="utf-8")
    assert "is not an MCAP file" in refused(tmp_path / "text.mcap")
    assert "No such file" in refused(run, "-o", tmp_path / "no" / "x.png")


def test_a_recording_cut_short_gives_the_map_so_far(run: Path, tmp_path: Path) -> None:
    cut = tmp_path / "cut.mcap"
    whole = run.read_bytes()
    cut.write_bytes(whole[: len(whole) // 2])
    result = rplan_map(cut)
    assert result.exit_code == 0
    assert "was cut short: what was written by then is mapped" in result.stderr


# --- the page -------------------------------------------------------------------------------------


def test_the_page_of_a_run_gets_what_the_plan_shows(tmp_path: Path) -> None:
    views: list[dict[str, Any]] = [
        {"map": grid(), BELIEVED: {"kind": "pose", "frame": "map", "at": [0.1234, 2, 3]}, "broken": 3},
        {
            BELIEVED: {"kind": "pose", "frame": "map", "at": [0.2, 2, 3]},
            "wall": {"kind": "lines", "at": [[0, 0, 1, 1.234]]},
        },
    ]
    data = pack(read(hand_made(tmp_path / "x.mcap", views)))
    tracks, runs = data["tracks"], data["runs"]
    assert isinstance(tracks, Mapping) and isinstance(runs, Mapping)
    assert tracks["shown believed-pose"] == {"scale": 1000, "at": [0, 1], "columns": [[123, 77], [2000, 0], [3000, 0]]}
    assert runs["shown believed-pose"]["values"] == [{"kind": "pose", "frame": "map"}]
    patch = runs["shown map"]["values"][0]
    assert patch["micro"] == [200000, 400000, 200000]
    assert zlib.decompress(base64.b64decode(patch["data"])) == bytes([3, 97, 97, 255])
    assert runs["shown wall"] == {"at": [1], "of": [0], "values": [{"kind": "lines", "at": [[0, 0, 1, 1.23]]}]}
    assert "shown broken" not in runs
