"""A run as one page: an HTML file that plays a recording in any browser, without a network.

Takes: a `Recording` and where to write. Gives: one self-contained file; `pack` is its data as a JSON value, `Packing`
the same tick by tick for who watches a run while it goes on. Leaves alone: how the page looks and plays (replay.html
beside this file), the judgement of the run, and what only those know who know the plan (`Telling`).

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
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from importlib.resources import files
from pathlib import Path

from behaviours.interface import Ranges, Reading
from sim.plain import mapping
from sim.recording import Json, Recording, json_text

MILLI, CENTI = 1000, 100
DECIMALS = 2
"""Decimals that numbers in reports keep: centimetres and hundredths of a radian are finer than a screen."""

SCAN_S, BEAMS = 0.2, 180
"""Scans are shown at this distance in time [s] at least, and of each no more than so many beams."""

WORLD_TRACKS = ("robot", "odometry", "head")
WORLD_RUNS = ("contacts", "on_board", "stage")
PLAN_RUNS = (
    "inputs",
    "percepts",
    "registers",
    "hole",
    "outputs",
    "sent",
    "way",
    "started",
    "stopped",
    "faults",
    "reports",
)


@dataclass(frozen=True, slots=True)
class Telling:
    """What is added to a page by someone who knows the plan.

    parts: names and values beside those of `pack`. tick: what is added to the plan's part of a tick, by name; each name
    becomes a run.
    """

    parts: Json
    tick: Callable[[Json], Json]


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


def _fixation(world: Json, sensor: str, names: Sequence[str]) -> list[object] | None:
    """What a sensor of the head saw, as a row; None where it saw nothing new."""
    seen = world.get(sensor)
    return [seen.get(name) for name in names] if isinstance(seen, Mapping) else None


def _command(world: Json, actuator: str) -> object:
    return mapping(world.get("command")).get(actuator)


def world_rows(world: Json) -> Iterator[tuple[str, int, object]]:
    """What moves in a tick: (track, steps a unit, row)."""
    for name in WORLD_TRACKS:
        yield name, MILLI, world.get(name)
    for name, pose in mapping(world.get("movers")).items():
        yield f"mover {name}", MILLI, pose
    yield "sonar", CENTI, world.get("sonar")
    yield "ir", MILLI, _fixation(world, "ir", ("detected", "offset", "strength", "pan"))
    yield "stereo", MILLI, _fixation(world, "stereo", ("pan", "tilt", "range"))
    yield "drive", MILLI, _command(world, "drive")
    yield "look", MILLI, _command(world, "head")


@dataclass(slots=True)
class Packing:
    """A run on its way into a page. A tick is added, then what was sensed in it."""

    tracks: dict[str, Track] = field(default_factory=dict)
    runs: dict[str, Run] = field(default_factory=dict)
    rays: dict[str, object] = field(default_factory=dict)
    milliseconds: list[int | None] = field(default_factory=list)
    _due: float = -math.inf
    _every: int = 1

    def tick(self, tick: Json, more: Json | None = None) -> None:
        """Add a tick; more: what is told beside it, by name."""
        index, t, world, plan = len(self.milliseconds), tick.get("t"), mapping(tick.get("world")), tick.get("plan")
        self.milliseconds.append(round(t * 1000) if isinstance(t, int | float) else index * 100)
        for name, scale, row in world_rows(world):
            self.tracks.setdefault(name, Track(scale)).add(index, row)
        for name in WORLD_RUNS:
            self._run(name, index, world.get(name))
        if isinstance(plan, Mapping):
            for name in PLAN_RUNS:
                self._run(name, index, plan.get(name))
            for name, view in mapping(plan.get("shown")).items():
                self._view(name, index, view)
            for name, value in (more or {}).items():
                self._run(name, index, value)

    def _view(self, name: str, index: int, view: object) -> None:
        """What a plan shows: of a pose, the numbers as a track, the rest as a run."""
        if not isinstance(view, Mapping):
            return
        if view.get("kind") == "pose":
            self.tracks.setdefault(f"shown {name}", Track(MILLI)).add(index, view.get("at"))
            view = {key: part for key, part in view.items() if key != "at"}
        elif view.get("kind") == "grid":
            view = _whole(view)
        self._run(f"shown {name}", index, view)

    def _run(self, name: str, index: int, value: object) -> None:
        self.runs.setdefault(name, Run()).add(index, value)

    def reading(self, index: int, reading: Reading) -> None:
        """Add the scan that was sensed in a tick, if it is time for one, and where rays lie."""
        scan = reading.lidar
        if "sonar" not in self.rays and reading.sonar is not None:
            self.rays["sonar"] = _ring(reading.sonar, reading.skirt)
        if scan is None or not scan.fresh or reading.stamp < self._due or not scan.ranges.size:
            return
        if "scan" not in self.rays:
            self._every = -(-scan.ranges.size // BEAMS)
            self.rays["scan"] = {
                "mount": [scan.mount.x, scan.mount.y, scan.mount.theta],
                "bearings": [round(bearing, 4) for bearing in scan.bearings[:: self._every].tolist()],
                "max_range": scan.max_range,
            }
        ranges = [value if math.isfinite(value) else None for value in scan.ranges[:: self._every].tolist()]
        self.tracks.setdefault("scan", Track(CENTI)).add(index, ranges)
        self._due = reading.stamp + SCAN_S - 1e-6

    def last(self) -> Json:
        """What a tick and its reading added last: {"t" [ms], "tracks": name -> row, "runs": name -> value, "rays"}."""
        index = len(self.milliseconds) - 1
        return {
            "t": self.milliseconds[index],
            "tracks": {name: one.rows[-1] for name, one in self.tracks.items() if one.at and one.at[-1] == index},
            "runs": {name: _rounded(one.last) for name, one in self.runs.items() if one.at and one.at[-1] == index},
            "rays": self.rays,
        }

    def packed(self) -> dict[str, object]:
        """{"rays", "ticks", "t" [ms], "tracks", "runs"}."""
        return {
            "rays": self.rays,
            "ticks": len(self.milliseconds),
            "t": _differences(self.milliseconds),
            "tracks": {name: track.packed() for name, track in self.tracks.items()},
            "runs": {name: run.packed() for name, run in self.runs.items()},
        }


def _whole(grid: Json) -> Json:
    """A patch whose lengths are whole micrometres, which no rounding changes."""
    lengths = [grid.get(name) for name in ("x", "y", "cell")]
    micro = [round(value * 1e6) if isinstance(value, int | float) else 0 for value in lengths]
    return {**{key: part for key, part in grid.items() if key not in ("x", "y", "cell")}, "micro": micro}


def _ring(waist: Ranges, skirt: Ranges | None) -> Json:
    """Bearings of the sonars in the order of the snapshot, and how many of them are of the waist."""
    bearings = [*waist.bearings.tolist(), *([] if skirt is None else skirt.bearings.tolist())]
    return {"bearings": [round(b, 4) for b in bearings], "waist": len(waist.bearings), "mount": waist.mount_radius}


def pack(recording: Recording, verdict: str = "", telling: Telling | None = None) -> Json:
    """All that the page shows: {"header", "verdict", "cut_short", "ticks", "t" [ms], "rays", "tracks", "runs"}, and
    what is told beside it."""
    packing = Packing()
    for tick in recording.ticks:
        plan = tick.get("plan")
        packing.tick(tick, telling.tick(plan) if telling is not None and isinstance(plan, Mapping) else None)
    index_at = {ms: index for index, ms in enumerate(packing.milliseconds)}
    for reading in recording.readings:
        index = index_at.get(round(reading.stamp * 1000))
        if index is not None:
            packing.reading(index, reading)
    head = {"header": recording.header, "verdict": verdict, "cut_short": recording.cut_short}
    return {**(telling.parts if telling is not None else {}), **head, **packing.packed()}


def title(header: Json) -> str:
    """What a run is called: its plan and its scenario."""
    scenario = header.get("scenario")
    names = [
        mapping(header.get("plan")).get("name"),
        scenario if isinstance(scenario, str) else mapping(header.get("scenario")).get("name"),
    ]
    return " · ".join([str(name) for name in names if name] or ["a run"])


def write_replay(recording: Recording, path: Path | str, verdict: str = "", telling: Telling | None = None) -> None:
    """Write the page that plays the recording; `verdict` is a line of text for its head. An existing file is replaced.

    Raises OSError where it cannot be written, RecordingError where the recording is damaged.
    """
    packed = zlib.compress(json_text(pack(recording, verdict, telling)).encode(), 9)
    page = template().replace("{{data}}", base64.b64encode(packed).decode("ascii"), 1)
    page = page.replace("{{title}}", html.escape(title(recording.header)), 1)
    Path(path).write_text(page, encoding="utf-8")


def template() -> str:
    """The page, with `{{data}}` and `{{title}}` still to be put in."""
    return (
        files("sim").joinpath("replay.html").read_text(encoding="utf-8").replace("{{circuit.js}}", circuit_script(), 1)
    )


def circuit_script() -> str:
    """What draws parts of a large circuit in a page."""
    return files("sim").joinpath("circuit.js").read_text(encoding="utf-8")
