"""A run as one page: an HTML file that plays a recording in any browser, without a network.

Takes: a `Recording` and where to write. Gives: one self-contained file; `pack` is its data as a JSON value.
Leaves alone: how the page looks and plays (replay.html beside this file), and the judgement of the run.

The data lie in the page as base64 of a zlib stream of JSON, packed by columns: moving numbers become whole
millimetres and milliradians (`Track`: differences from row to row), everything else is listed once and referred to
where it changes (`Run`). Where a tick lacks a part, the page shows the last one or nothing.
"""

from __future__ import annotations

import base64
import html
import json
import math
import zlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from importlib.resources import files
from pathlib import Path

from behaviours.interface import Ranges
from sim.recording import Json, Recording, json_text

MILLI, CENTI = 1000, 100
DECIMALS = 2
"""Decimals that numbers in reports keep: centimetres and hundredths of a radian are finer than a screen."""

SCAN_S, BEAMS = 0.2, 180
"""Scans are shown at this distance in time [s] at least, and of each no more than so many beams."""

WORLD_TRACKS = ("robot", "odometry", "head")
WORLD_RUNS = ("contacts", "on_board", "stage")
PLAN_RUNS = ("inputs", "registers", "hole", "outputs", "sent", "way", "started", "stopped", "faults", "reports")


@dataclass(slots=True)
class Track:
    """Rows of numbers at some ticks, as differences of whole steps of 1/scale; None where a row lacks a number."""

    scale: int
    at: list[int] = field(default_factory=list)
    rows: list[Sequence[object]] = field(default_factory=list)

    def add(self, tick: int, row: object) -> None:
        """Keep the row, if it is one."""
        if isinstance(row, Sequence) and not isinstance(row, str) and row:
            self.at.append(tick)
            self.rows.append(row)

    def packed(self) -> Json:
        """{"scale", "at": differences of ticks, "columns": differences of steps}."""
        width = max(map(len, self.rows), default=0)
        columns = [[row[k] if k < len(row) else None for row in self.rows] for k in range(width)]
        steps = [[self._step(value) for value in column] for column in columns]
        return {"scale": self.scale, "at": _differences(self.at), "columns": [_differences(column) for column in steps]}

    def _step(self, value: object) -> int | None:
        return round(value * self.scale) if isinstance(value, int | float) else None


@dataclass(slots=True)
class Run:
    """A value for every tick, kept where it changes."""

    values: dict[str, int] = field(default_factory=dict)
    at: list[int] = field(default_factory=list)
    of: list[int] = field(default_factory=list)
    last: object = None

    def add(self, tick: int, value: object) -> None:
        """The value holds from this tick on."""
        if self.of and value == self.last:
            return
        self.last = value
        index = self.values.setdefault(json_text(_rounded(value)), len(self.values))
        if not self.of or self.of[-1] != index:
            self.at.append(tick)
            self.of.append(index)

    def packed(self) -> Json:
        """{"at": differences of ticks, "of": indices, "values"}."""
        return {"at": _differences(self.at), "of": self.of, "values": [json.loads(text) for text in self.values]}


def _differences(numbers: Iterable[int | None]) -> list[int | None]:
    """From each number to the next, beginning at 0; None stays None and is stepped over."""
    last, steps = 0, list[int | None]()
    for number in numbers:
        steps.append(None if number is None else number - last)
        last = last if number is None else number
    return steps


def _rounded(value: object) -> object:
    match value:
        case float():
            return round(value, DECIMALS)
        case Mapping():
            return {key: _rounded(part) for key, part in value.items()}
        case list() | tuple():
            return [_rounded(part) for part in value]
        case _:
            return value


def _part(tick: Json, name: str) -> Json:
    part = tick.get(name)
    return part if isinstance(part, Mapping) else {}


def _fixation(world: Json, sensor: str, names: Sequence[str]) -> list[object] | None:
    """What a sensor of the head saw, as a row; None where it saw nothing new."""
    seen = world.get(sensor)
    return [seen.get(name) for name in names] if isinstance(seen, Mapping) else None


def _command(world: Json, actuator: str) -> object:
    return _part(world, "command").get(actuator)


@dataclass(slots=True)
class _Packing:
    tracks: dict[str, Track] = field(default_factory=dict)
    runs: dict[str, Run] = field(default_factory=dict)

    def track(self, tick: int, name: str, row: object, scale: int = MILLI) -> None:
        self.tracks.setdefault(name, Track(scale)).add(tick, row)

    def world(self, tick: int, world: Json) -> None:
        for name in WORLD_TRACKS:
            self.track(tick, name, world.get(name))
        for name, pose in _part(world, "movers").items():
            self.track(tick, f"mover {name}", pose)
        self.track(tick, "sonar", world.get("sonar"), CENTI)
        self.track(tick, "ir", _fixation(world, "ir", ("detected", "offset", "strength", "pan")))
        self.track(tick, "stereo", _fixation(world, "stereo", ("pan", "tilt", "range")))
        self.track(tick, "drive", _command(world, "drive"))
        self.track(tick, "look", _command(world, "head"))
        for name in WORLD_RUNS:
            self.runs.setdefault(name, Run()).add(tick, world.get(name))

    def plan(self, tick: int, plan: Json) -> None:
        for name in PLAN_RUNS:
            self.runs.setdefault(name, Run()).add(tick, plan.get(name))


def _sensed(packing: _Packing, recording: Recording, milliseconds: Sequence[int | None]) -> Json:
    """Scans become a track; gives where the rays of lidar and sonars lie, as far as readings say it."""
    index_at = {ms: index for index, ms in enumerate(milliseconds)}
    lie: dict[str, object] = {}
    due, every = -math.inf, 1
    for reading in recording.readings:
        scan, index = reading.lidar, index_at.get(round(reading.stamp * 1000))
        if "sonar" not in lie and reading.sonar is not None:
            lie["sonar"] = _ring(reading.sonar, reading.skirt)
        if scan is None or index is None or not scan.fresh or reading.stamp < due or not scan.ranges.size:
            continue
        if "scan" not in lie:
            every = -(-scan.ranges.size // BEAMS)
            lie["scan"] = {
                "mount": [scan.mount.x, scan.mount.y, scan.mount.theta],
                "bearings": [round(bearing, 4) for bearing in scan.bearings[::every].tolist()],
                "max_range": scan.max_range,
            }
        ranges = [value if math.isfinite(value) else None for value in scan.ranges[::every].tolist()]
        packing.track(index, "scan", ranges, CENTI)
        due = reading.stamp + SCAN_S - 1e-6
    return lie


def _ring(waist: Ranges, skirt: Ranges | None) -> Json:
    """Bearings of the sonars in the order of the snapshot, and how many of them are of the waist."""
    bearings = [*waist.bearings.tolist(), *([] if skirt is None else skirt.bearings.tolist())]
    return {"bearings": [round(b, 4) for b in bearings], "waist": len(waist.bearings), "mount": waist.mount_radius}


def pack(recording: Recording, verdict: str = "") -> Json:
    """All that the page shows: {"header", "verdict", "cut_short", "ticks", "t" [ms], "rays", "tracks", "runs"}."""
    packing, milliseconds = _Packing(), list[int | None]()
    for index, tick in enumerate(recording.ticks):
        t = tick.get("t")
        milliseconds.append(round(t * 1000) if isinstance(t, int | float) else index * 100)
        packing.world(index, _part(tick, "world"))
        if isinstance(tick.get("plan"), Mapping):
            packing.plan(index, _part(tick, "plan"))
    rays = _sensed(packing, recording, milliseconds)
    return {
        "header": recording.header,
        "rays": rays,
        "verdict": verdict,
        "cut_short": recording.cut_short,
        "ticks": len(milliseconds),
        "t": _differences(milliseconds),
        "tracks": {name: track.packed() for name, track in packing.tracks.items()},
        "runs": {name: run.packed() for name, run in packing.runs.items()},
    }


def _title(header: Json) -> str:
    scenario = header.get("scenario")
    names = [
        _part(header, "plan").get("name"),
        scenario if isinstance(scenario, str) else _part(header, "scenario").get("name"),
    ]
    return " · ".join([str(name) for name in names if name] or ["a run"])


def write_replay(recording: Recording, path: Path | str, verdict: str = "") -> None:
    """Write the page that plays the recording; `verdict` is a line of text for its head. An existing file is replaced.

    Raises OSError where it cannot be written, RecordingError where the recording is damaged.
    """
    packed = zlib.compress(json_text(pack(recording, verdict)).encode(), 9)
    page = files("sim").joinpath("replay.html").read_text(encoding="utf-8")
    page = page.replace("{{data}}", base64.b64encode(packed).decode("ascii"), 1)
    page = page.replace("{{title}}", html.escape(_title(recording.header)), 1)
    Path(path).write_text(page, encoding="utf-8")
