"""Readings come back from a recording as they went in, to the last bit, whatever the robot carries."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any, get_args

import numpy as np
import pytest

from behaviours.interface import (
    Battery,
    Bumper,
    Compass,
    Currents,
    Fix,
    FlipperState,
    HeadState,
    Imu,
    Inclination,
    IrReading,
    Odometry,
    Pose,
    Ranges,
    Reading,
    Scan,
    Sensed,
    StereoReading,
)
from sim.readings import ReadingTexts
from sim.readings import readings as from_texts
from sim.recording import Recorder, RecordingError, readings

HEADER = {"plan": None}


def same(one: object, other: object) -> bool:
    """Equal to the last bit; NaN is NaN, and arrays have one type and shape."""
    if isinstance(one, np.ndarray) and isinstance(other, np.ndarray):
        return one.dtype == other.dtype and one.shape == other.shape and one.tobytes() == other.tobytes()
    if isinstance(one, float) and isinstance(other, float):
        return one == other or (math.isnan(one) and math.isnan(other))
    if is_dataclass(one) and type(one) is type(other):
        return all(same(getattr(one, f.name), getattr(other, f.name)) for f in fields(one))
    if isinstance(one, Mapping) and isinstance(other, Mapping):
        return [*one] == [*other] and all(same(one[name], other[name]) for name in one)
    if isinstance(one, tuple) and isinstance(other, tuple):
        return len(one) == len(other) and all(map(same, one, other))
    return type(one) is type(other) and one == other


def every_sensor(n: int, chance: np.random.Generator) -> dict[str, Any]:
    """One of each kind; some of what they say stays, some is lost."""
    t, fresh = n / 10, n % 3 == 0
    ring = np.linspace(-math.pi, math.pi, 24, endpoint=False)
    x, y, theta = chance.normal(size=3).tolist()
    lost = math.nan if n % 4 == 1 else x
    ranges = np.where(chance.random(90) < 0.1, math.nan, chance.random(90) * 10)
    return {
        "odometry": Odometry(Pose(x, y, theta), 0.1, theta, t, True),
        "sonar": Ranges(t, fresh, ring, chance.random(24) * 7 if fresh else np.full(24, 7.62), 7.62, 0.35),
        "skirt": Ranges(t, fresh, ring[::4], np.full(6, 2.0), 2.0, 0.35),
        "head": HeadState(0.1, -0.0, n > 5, t, True),
        "ir": IrReading(t, fresh, x, n % 2 == 0, lost, 3.0),
        "stereo": StereoReading(t, fresh, 0.1, 0.2, lost, 1.2),
        "lidar": Scan(t, True, Pose(0.1, 0.0, 0.0), np.linspace(-2, 2, 90), ranges, 0.05, 10.0),
        "compass": Compass(t, fresh, lost),
        "imu": Imu(t, True, x, (y, theta)),
        "inclination": Inclination(t, True, 1 / 3, math.pi / 7),
        "gps": Fix(t, fresh, lost, lost),
        "currents": Currents(t, True, math.inf if n == 7 else x, -math.inf if n == 8 else y),
        "bumper": Bumper(t, True, ring[::3], np.array([k == n for k in range(8)])),
        "battery": Battery(t, n % 3 == 0, 0.1 * n, n > 4),
        "flippers": FlipperState(x, n > 4, t, n % 2 == 0),
    }


def run(ticks: int = 12) -> list[Reading]:
    chance = np.random.default_rng(3)
    every = []
    for n in range(ticks):
        sensed = every_sensor(n, chance)
        others = {"rear": sensed["lidar"], "low": sensed["sonar"], "second": sensed["compass"]}
        every.append(Reading(n / 10, n, object_on_board=n > 6, others=others, **sensed))
    return every


def back(every: list[Reading], path: Path) -> list[Reading]:
    with Recorder(path, HEADER) as recorder:
        for reading in every:
            recorder.tick(reading.stamp, {"robot": [0.0, 0.0, 0.0]}, "null", reading)
    return list(readings(path))


def test_every_kind_of_sensor_comes_back_equal(tmp_path: Path) -> None:
    every = run()
    kinds = {type(getattr(every[0], f.name)) for f in fields(Reading)}
    assert set(get_args(Sensed)) <= kinds, "a kind of sensor is not tried here"
    found = back(every, tmp_path / "run.mcap")
    assert len(found) == len(every)
    for n, (went_in, came_out) in enumerate(zip(every, found, strict=True)):
        assert same(went_in, came_out), f"reading {n}"


def test_a_sensor_that_comes_and_goes_comes_back_as_it_was(tmp_path: Path) -> None:
    odometry, heading = Odometry(Pose(0.0, 0.0), 0.0, 0.0), Compass(0.0, True, 1.0)
    every = [
        Reading(n / 10, n, odometry, compass=heading if n % 2 else None, others={"b": heading} if n % 3 else {})
        for n in range(7)
    ]
    assert all(map(same, every, back(every, tmp_path / "run.mcap")))


def test_another_kind_under_the_same_name_is_not_mixed_with_the_first(tmp_path: Path) -> None:
    odometry = Odometry(Pose(0.0, 0.0), 0.0, 0.0)
    kinds: list[Sensed] = [Compass(0.0, True, 1.0), Inclination(0.0, True, 0.1, 0.2), Compass(0.0, True, 1.0)]
    every = [Reading(n / 10, n, odometry, others={"one": kind}) for n, kind in enumerate(kinds)]
    assert all(map(same, every, back(every, tmp_path / "run.mcap")))


def test_what_stays_is_not_written_again() -> None:
    every, writer = run(3), ReadingTexts()
    writer.text(every[0])
    unchanged = Reading(0.1, 1, every[0].odometry, lidar=every[0].lidar, bumper=every[0].bumper)
    assert writer.text(unchanged) == (
        '{"tick":1,"stamp":0.1,"object_on_board":false,"odometry":{},"lidar":{},"bumper":{}}'
    )


@pytest.mark.parametrize(
    "text",
    [
        "[]",
        "{",
        '{"tick":0,"stamp":0,"object_on_board":false}',
        '{"tick":0,"stamp":0,"object_on_board":false,"odometry":{}}',
        '{"tick":0,"stamp":0,"object_on_board":false,"odometry":{"pose":[0,0]}}',
        '{"tick":0,"stamp":true,"object_on_board":false,"odometry":{}}',
        '{"tick":0,"stamp":0,"object_on_board":false,"odometry":{},"sonar":{"ranges":"AA"}}',
        '{"tick":0,"stamp":0,"object_on_board":false,"odometry":{},"others":{"a":{"kind":"Nose"}}}',
    ],
)
def test_a_text_that_is_no_reading_is_a_clear_error(text: str) -> None:
    with pytest.raises(ValueError, match="reading 0 is not whole"):
        list(from_texts([text]))


def test_damage_inside_is_told_while_iterating(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    back(run(40), path)
    data = bytearray(path.read_bytes())
    data[len(data) // 2] ^= 0xFF
    path.write_bytes(data)
    with pytest.raises(RecordingError, match=r"run\.mcap is damaged"):
        list(readings(path))
