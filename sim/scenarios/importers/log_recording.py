"""A log as a recording, so that percepts can be read from it and viewers can play it.

Takes: a CARMEN log and where the recording goes. Gives: the recording: a tick for each scan, with its reading; the
true pose of the robot is the one in the map. Leaves alone: what a brain makes of the readings.
"""

from __future__ import annotations

from pathlib import Path

from behaviours.interface import Pose
from sim.recording import Recorder
from sim.scenarios.importers.carmen import Entry, entries
from sim.scenarios.importers.imported import box_round, metres, radians

RADIUS, HEIGHT = 0.25, 0.5
"""[m] of the robot as it is drawn; logs do not say."""

ROOM = 10.0
"""[m] that is shown round the way of the robot."""


def record_log(log: Path, recording: Path) -> tuple[int, float]:
    """Write the recording of a log; gives how many scans there are, and how many seconds.

    The log is read twice: first to see that all of it is sound, and how far it goes. Raises WorldFileError before
    anything is written; OSError where the recording cannot be written.
    """
    way = [(entry.stamp, entry.corrected) for entry in entries(log)]
    with Recorder(recording, _header(log.name, [pose for _, pose in way])) as recorder:
        for entry in entries(log):
            recorder.tick(entry.stamp, _world(entry), "null", entry.reading)
    return len(way), way[-1][0]


def _header(name: str, way: list[Pose]) -> dict[str, object]:
    world: dict[str, object] = {
        "scenario": name,
        "seed": 0,
        "period": 0.1,
        "bounds": box_round([(pose.x, pose.y) for pose in way], ROOM),
        "robot": {"radius": RADIUS, "shape": {"circle": RADIUS}, "height": HEIGHT},
        "home": _pose(way[0]),
        "donor": None,
        "goal": None,
        "slopes": [],
        "things": [],
        "movers": [],
    }
    return {"source": f"{name} (carmen)", "world": world}


def _pose(pose: Pose) -> list[float]:
    return [metres(pose.x), metres(pose.y), radians(pose.theta)]


def _world(entry: Entry) -> dict[str, object]:
    return {
        "t": round(entry.stamp, 6),
        "stage": "log",
        "robot": _pose(entry.corrected),
        "odometry": _pose(entry.reading.odometry.pose),
        "movers": {},
        "contacts": [],
        "head": None,
        "command": {},
        "on_board": False,
    }
