"""What viewers get: the topics of the field with its schemas, at simulated stamps, and each recording its own."""

from __future__ import annotations

import hashlib
import math
import os
import subprocess
import sys
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from foxglove.messages import LaserScan, PointCloud, Pose, PoseInFrame, Quaternion, Timestamp, Vector3
from mcap.reader import make_reader

from behaviours.interface import Odometry, Ranges, Reading, Scan
from behaviours.interface import Pose as Place
from sim.recording import Recorder
from sim.viewing import XYZ

RING = [[-4.0, -4.0], [4.0, -4.0], [4.0, 4.0], [-4.0, 4.0]]
BOX = [[-1.0, -0.5], [1.0, -0.5], [1.0, 0.5], [-1.0, 0.5]]
WORLD: dict[str, Any] = {
    "bounds": [-5, -5, 5, 5],
    "home": [1, 2, 0.5],
    "robot": {"radius": 0.4, "shape": {"polygon": [[-0.4, -0.3], [0.4, 0.0], [-0.4, 0.3]]}, "height": 0.5},
    "goal": {"at": [3, 3], "within": 1.0},
    "donor": None,
    "things": [
        {"id": "disc", "kind": "disc", "shape": {"circle": 0.4}, "pose": [2, 2, 0], "height": 1},
        {"id": "box", "kind": "box", "shape": {"polygon": BOX}, "pose": [0, 3, 1], "height": 1},
        {"id": "map", "kind": "outline", "shape": {"rings": [RING, RING[::-1]]}, "pose": [0, 0, 0], "height": 2},
    ],
    "movers": [{"id": "can", "kind": "disc", "shape": {"circle": 0.3}, "pose": [3, -3, 0], "height": 1}],
}


def reading(n: int) -> Reading:
    lidar = Scan(
        n / 10, True, Place(0.1, 0.0, 0.0), np.linspace(-1, 1, 5), np.array([1, 2, 10, math.nan, 3.0]), 0.1, 10.0
    )
    waist = Ranges(n / 10, n % 3 == 0, np.array([0.0, math.pi / 2]), np.array([1.0, 7.0]), 7.0, 0.4)
    return Reading(n / 10, n, Odometry(Place(n / 10, 0.0), 0.0, 0.0), waist, lidar=lidar, others={"rear": lidar})


def world(n: int) -> dict[str, Any]:
    movers = {"can": [3.0, -3.0 + (0.1 if n >= 12 else 0.0), 0.0]} if n < 25 else {}
    return {"robot": [n / 10, 0.0, 0.5], "odometry": [n / 10, 0.0, 0.0], "movers": movers}


def record(path: Path, ticks: int = 31, header: dict[str, Any] | None = None) -> Path:
    with Recorder(path, {"world": WORLD} if header is None else header) as recorder:
        for n in range(ticks):
            recorder.tick(n / 10, world(n), "null", reading(n))
    return path


def messages(path: Path) -> list[tuple[str, str, int, bytes]]:
    """Topic, name of the schema, log time [ns], data."""
    with path.open("rb") as stream:
        return [
            (channel.topic, schema.name if schema else "", message.log_time, message.data)
            for schema, channel, message in make_reader(stream).iter_messages(log_time_order=False)
        ]


def test_every_topic_has_the_schema_that_viewers_know(tmp_path: Path) -> None:
    found = {(topic, schema) for topic, schema, _, _ in messages(record(tmp_path / "run.mcap"))}
    assert found == {
        ("/header", "rplan.Header"),
        ("/tick", "rplan.Tick"),
        ("/reading", "rplan.Reading"),
        ("/pose", "foxglove.PoseInFrame"),
        ("/odometry", "foxglove.PoseInFrame"),
        ("/tf", "foxglove.FrameTransforms"),
        ("/scene", "foxglove.SceneUpdate"),
        ("/movers", "foxglove.SceneUpdate"),
        ("/map", "foxglove.Grid"),
        ("/scan", "foxglove.LaserScan"),
        ("/scan/rear", "foxglove.LaserScan"),
        ("/sonar", "foxglove.PointCloud"),
    }


def test_what_stands_is_written_once_and_what_moves_when_it_has_moved(tmp_path: Path) -> None:
    every = messages(record(tmp_path / "run.mcap"))
    count = Counter(topic for topic, _, _, _ in every)
    assert count["/scene"] == count["/map"] == count["/header"] == 1
    assert count["/tick"] == count["/reading"] == count["/pose"] == count["/tf"] == count["/odometry"] == 31
    assert [at for topic, _, at, _ in every if topic == "/movers"] == [0, 1_200_000_000, 2_500_000_000]
    assert [at for topic, _, at, _ in every if topic == "/sonar"] == [n * 300_000_000 for n in range(11)]
    assert [at for topic, _, at, _ in every if topic == "/scan"] == [n * 200_000_000 for n in range(16)]


def test_the_messages_say_what_was_sensed(tmp_path: Path) -> None:
    every = messages(record(tmp_path / "run.mcap"))
    third = {topic: data for topic, _, at, data in every if at == 600_000_000}
    stamp = Timestamp(sec=0, nsec=600_000_000)
    half = Quaternion(x=0.0, y=0.0, z=math.sin(0.25), w=math.cos(0.25))
    here = Pose(position=Vector3(x=0.6, y=0.0, z=0.0), orientation=half)
    assert third["/pose"] == PoseInFrame(timestamp=stamp, frame_id="world", pose=here).encode()
    level = Quaternion(x=0.0, y=0.0, z=0.0, w=1.0)
    scan = LaserScan(
        timestamp=stamp,
        frame_id="robot",
        pose=Pose(position=Vector3(x=0.1, y=0.0, z=0.0), orientation=level),
        start_angle=-1.0,
        end_angle=1.0,
        ranges=[1.0, 2.0, math.inf, math.nan, 3.0],
    )
    assert third["/scan"] == third["/scan/rear"] == scan.encode(), "what met nothing is infinite"
    cloud = PointCloud(
        timestamp=stamp,
        frame_id="robot",
        pose=Pose(position=Vector3(x=0.0, y=0.0, z=0.0), orientation=level),
        point_stride=12,
        fields=XYZ,
        data=np.array([[1.4, 0.0, 0.0]], dtype="<f4").tobytes(),
    )
    assert third["/sonar"] == cloud.encode(), "only where an echo was heard, from the middle of the robot"


def test_a_header_that_says_little_is_shown_as_far_as_it_goes(tmp_path: Path) -> None:
    found = {topic for topic, _, _, _ in messages(record(tmp_path / "run.mcap", 3, {"plan": None}))}
    assert "/scene" in found
    assert "/map" not in found, "without bounds there is no map"


def test_the_view_can_be_left_out(tmp_path: Path) -> None:
    with Recorder(tmp_path / "run.mcap", {"world": WORLD}, view=False) as recorder:
        recorder.tick(0.0, world(0), "null", reading(0))
    assert [topic for topic, _, _, _ in messages(tmp_path / "run.mcap")] == ["/header", "/tick", "/reading"]


def test_several_recordings_at_once_hold_only_their_own(tmp_path: Path) -> None:
    alone = record(tmp_path / "alone.mcap").read_bytes()
    other = {"world": WORLD | {"things": [], "home": None}}
    recorders = [Recorder(tmp_path / f"{k}.mcap", {"world": WORLD} if k % 2 else other) for k in range(4)]
    for n in range(31):
        for recorder in recorders:
            recorder.tick(n / 10, world(n), "null", reading(n))
    for recorder in recorders:
        recorder.close()
    for k in (1, 3):
        assert (tmp_path / f"{k}.mcap").read_bytes() == alone
    assert (tmp_path / "0.mcap").read_bytes() == (tmp_path / "2.mcap").read_bytes() != alone


@pytest.mark.parametrize("seed", ["1", "4711"])
def test_the_bytes_do_not_depend_on_process_or_hash_seed(tmp_path: Path, seed: str) -> None:
    path = tmp_path / f"{seed}.mcap"
    script = "import runpy, sys, pathlib\nrunpy.run_path(sys.argv[1])['record'](pathlib.Path(sys.argv[2]))\n"
    environment = {**os.environ, "PYTHONHASHSEED": seed, "PYTHONPATH": os.pathsep.join(sys.path)}
    subprocess.run([sys.executable, "-c", script, __file__, str(path)], check=True, env=environment)
    digests = [hashlib.sha256(file.read_bytes()).hexdigest() for file in (path, record(tmp_path / "here.mcap"))]
    assert digests[0] == digests[1]
