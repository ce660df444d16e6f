"""Recordings and plans of earlier days are still read: files of every format, as they were written then."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Any

import pytest

from rplan.apps.wiring import compile_file
from sim.recording import FORMAT, RecordingError, read, readings
from sim.replay import pack, write_replay

DATA = Path(__file__).parents[1] / "data" / "recordings"
TICKS = {1: 201, 2: 51}


def test_there_is_a_file_of_every_format() -> None:
    assert [path.name for path in sorted(DATA.glob("*.mcap"))] == [f"format_{n}.mcap" for n in range(1, FORMAT + 1)]


@pytest.mark.parametrize("number", TICKS)
def test_a_recording_of_this_format_is_read(number: int) -> None:
    recording = read(DATA / f"format_{number}.mcap")
    header: Any = recording.header
    assert header["format"] == number
    assert header["plan"]["name"] == "find-and-fetch"
    assert header["scenario"]["name"] == "parking lot"
    ticks: list[Any] = list(recording.ticks)
    assert [tick["tick"] for tick in ticks] == list(range(TICKS[number]))
    assert ticks[-2]["plan"]["outputs"]["action"] == "(continue-ir-search)"
    assert ticks[-1]["plan"] is None, "the run is over"


@pytest.mark.parametrize("number", TICKS)
def test_a_recording_of_this_format_is_replayed(number: int, tmp_path: Path) -> None:
    recording = read(DATA / f"format_{number}.mcap")
    packed: Any = pack(recording)
    assert packed["ticks"] == TICKS[number]
    assert {"robot", "odometry", "head", "sonar", "drive"} <= packed["tracks"].keys()
    assert {"inputs", "outputs", "way", "stage"} <= packed["runs"].keys()
    write_replay(recording, tmp_path / "run.html")
    assert "find-and-fetch · parking lot" in (tmp_path / "run.html").read_text(encoding="utf-8")


def test_the_first_format_has_no_readings_and_says_so() -> None:
    with pytest.raises(RecordingError, match=r"format_1\.mcap holds no readings"):
        next(readings(DATA / "format_1.mcap"))


def test_readings_come_out_of_a_file_of_the_second_format() -> None:
    every = list(readings(DATA / "format_2.mcap"))
    assert [reading.tick for reading in every] == [*range(TICKS[2] - 1), TICKS[2]], (
        "the run ends with a step of its own"
    )
    last = every[-1]
    assert last.sonar is not None
    assert last.sonar.bearings.shape == last.sonar.ranges.shape == (24,)
    assert last.head is not None
    assert last.lidar is None


def test_a_plan_of_the_first_days_compiles_to_the_same_circuit() -> None:
    compiled = compile_file(DATA / "find_and_fetch_1.rplan")
    assert compiled.goals.name == "find-and-fetch"
    recorded: Any = read(DATA / "format_1.mcap").header["plan"]
    source = (DATA / "find_and_fetch_1.rplan").read_bytes()
    assert hashlib.sha256(source).hexdigest() == recorded["sha256"], "it is the plan that was recorded"
    assert [atom.text for atom in compiled.ways.atoms[: compiled.ways.asking]] == recorded["inputs"]
    assert [output.name for output in compiled.goals.outputs] == recorded["outputs"]
