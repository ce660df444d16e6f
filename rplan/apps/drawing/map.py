"""The map that a robot made, and the ways that it believed to go, out of a recording.

Takes: a `Recording` of a plan that uses the library `mapping`. Gives: the map that its patches make up, how far beliefs
were off, and a picture after Figures 5 and 6 of Yamauchi 2005. Leaves alone: files of maps (sim/maps.py).

Everything lies in the frame of the map; the truth is brought into it by where the robot started.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from behaviours.cores.hybrid import turned
from behaviours.cores.occupancy import MOST, UNKNOWN, Bytes, Region
from behaviours.cores.patches import Patch, PatchReader
from behaviours.interface import Pose, wrap
from sim.maps import CellMap
from sim.plain import Json, mapping
from sim.plain import number as as_number
from sim.recording import Recording

TRUTH, BELIEVED, ODOMETRY = "truth", "believed-pose", "odometry-pose"
COLOURS = {TRUTH: (64, 160, 255), BELIEVED: (40, 200, 80), ODOMETRY: (255, 140, 30)}
OTHERS = (225, 80, 160)
LINE_M = 10
"""Lines are drawn at this distance [m]."""
STYLES = ("paper", "ros")
LONG, MOST_SCALE = 1200, 12
"""Pixels of the longer side, and of a cell at most."""
LEGEND = 26
MARGIN = 1.0
"""So much [m] is shown round the map and the ways."""

Colour = tuple[int, int, int]


class MapError(ValueError):
    """There is no map in a recording, or it is damaged; the message says what to do."""


@dataclass(slots=True)
class Course:
    """Poses of one name: (tick, pose in the frame of the map)."""

    at: dict[int, Pose] = field(default_factory=dict)


@dataclass(slots=True)
class Mapped:
    """What a recording tells of a map. courses: by name, the truth among them; bytes: of all patches, as sent."""

    name: str
    frame: str = "map"
    reader: PatchReader = field(default_factory=PatchReader)
    courses: dict[str, Course] = field(default_factory=dict)
    patches: int = 0
    bytes: int = 0
    seconds: float = 0.0

    @property
    def known(self) -> float:
        """Area [m^2] that the map knows."""
        return float(np.count_nonzero(self.reader.plane.cells != UNKNOWN)) * self.reader.cell**2

    def rate(self) -> float:
        """What the map has cost to send [bytes/s]."""
        return self.bytes / self.seconds if self.seconds > 0 else 0.0

    def off(self, name: str) -> tuple[float, float, float] | None:
        """How far a belief was off: at the end [m], at most [m], and of the heading at the end [rad]."""
        both = self.courses.get(name, Course()).at, self.courses.get(TRUTH, Course()).at
        ticks = [tick for tick in both[0] if tick in both[1]]
        if not ticks:
            return None
        ways = [math.hypot(both[0][t].x - both[1][t].x, both[0][t].y - both[1][t].y) for t in ticks]
        return ways[-1], max(ways), abs(wrap(both[0][ticks[-1]].theta - both[1][ticks[-1]].theta))


# --- what the recording says ------------------------------------------------------------------------


def gather(recording: Recording, view: str | None = None, until: float = math.inf) -> Mapped:
    """The map of this view (None: of the only one) as it stood at a time [s].

    Raises MapError where there is none or a patch is damaged, RecordingError where the recording is.
    """
    found = Mapped(view or "")
    shown: dict[str, None] = {}
    home: Pose | None = None
    for number, tick in enumerate(recording.ticks):
        t = tick.get("t")
        if not isinstance(t, int | float) or t > until:
            break
        home = home or _home(recording.header, tick)
        _note_truth(found, number, tick, home)
        for name, seen in mapping(mapping(tick.get("plan")).get("shown")).items():
            if isinstance(seen, Mapping):
                _note(found, number, name, seen, shown)
        found.seconds = float(t) + _period(recording.header)
    if not found.patches:
        raise MapError(_why_none(view, shown, recording.header))
    return _in_frame(found, home or Pose(0.0, 0.0, 0.0))


def _note(found: Mapped, number: int, name: str, seen: Json, shown: dict[str, None]) -> None:
    if seen.get("kind") == "pose" and (pose := _pose(seen.get("at"))) is not None:
        found.courses.setdefault(name, Course()).at[number] = pose
    if seen.get("kind") != "grid":
        return
    shown.setdefault(name)
    found.name = found.name or name
    if name == found.name:
        try:
            patch = patch_of(seen)
            found.reader.add(patch)
        except ValueError as fault:
            raise MapError(f"the view {name} of tick {number} is damaged: {fault}") from fault
        found.frame = str(seen.get("frame", "map"))
        found.patches, found.bytes = found.patches + 1, found.bytes + patch.size


def patch_of(seen: Json) -> Patch:
    """The patch in a view of kind `grid`. Raises ValueError where it is none."""
    numbers = [seen.get(name) for name in ("cell", "x", "y", "columns", "rows")]
    data = seen.get("data")
    if not isinstance(data, str) or not all(isinstance(n, int | float) and math.isfinite(n) for n in numbers):
        raise ValueError("expected cell, x, y, columns, rows and data")
    cell, x, y, columns, rows = (float(str(n)) for n in numbers)
    if not 0.001 <= cell <= 100.0:
        raise ValueError(f"cells of {cell:g} m")
    return Patch(cell, Region(round(x / cell), round(y / cell), int(columns), int(rows)), data)


def _note_truth(found: Mapped, number: int, tick: Json, home: Pose | None) -> None:
    robot = _pose(mapping(tick.get("world")).get("robot"))
    if robot is not None and home is not None:
        found.courses.setdefault(TRUTH, Course()).at[number] = Pose(robot.x - home.x, robot.y - home.y, robot.theta)


def _in_frame(found: Mapped, home: Pose) -> Mapped:
    """The truth turned into the frame of the map."""
    if found.frame == "odom" and TRUTH in found.courses:
        truth = found.courses[TRUTH].at
        found.courses[TRUTH] = Course({tick: turned(pose, -home.theta) for tick, pose in truth.items()})
    return found


def _home(header: Json, tick: Json) -> Pose | None:
    world = header.get("world")
    told = world.get("home") if isinstance(world, Mapping) else header.get("home")
    return _pose(told) or _pose(mapping(tick.get("world")).get("robot"))


def _period(header: Json) -> float:
    world = header.get("world")
    return as_number(header.get("period", world.get("period") if isinstance(world, Mapping) else None), 0.0)


def _pose(told: object) -> Pose | None:
    if not isinstance(told, Sequence) or isinstance(told, str) or len(told) != 3:
        return None
    if not all(isinstance(n, int | float) and math.isfinite(n) for n in told):
        return None
    return Pose(*map(float, told))


def _why_none(view: str | None, shown: Mapping[str, None], header: Json) -> str:
    if shown:
        return f"there is no map {view} in this recording; there is {', '.join(shown)}"
    plan = mapping(header.get("plan")).get("name") or "its brain"
    return f"there is no map in this recording: {plan} makes none; write (use mapping) into the plan and record again"


# --- the map and its picture ------------------------------------------------------------------------


def cell_map(mapped: Mapped) -> CellMap:
    """The part of the map that is known."""
    plane, cell = mapped.reader.plane, mapped.reader.cell
    known = plane.cells != UNKNOWN
    rows, columns = np.flatnonzero(known.any(axis=1)), np.flatnonzero(known.any(axis=0))
    if not rows.size:
        raise MapError("the map of this recording knows nothing: the lidar met nothing, or failed")
    part = plane.cells[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
    x, y = (plane.region.column + int(columns[0])) * cell, (plane.region.row + int(rows[0])) * cell
    return CellMap(part, cell, round(x, 6), round(y, 6))


@dataclass(frozen=True, slots=True)
class _Frame:
    """Where the picture lies: left, top [m], pixels a metre, its size [pixels]."""

    left: float
    top: float
    scale: float
    width: int
    height: int

    def pixel(self, x: float, y: float) -> tuple[float, float]:
        return (x - self.left) * self.scale, (self.top - y) * self.scale


def draw(mapped: Mapped, path: Path, style: str = "paper") -> None:
    """Write the picture (PNG): the map, lines each 10 m, the ways and their legend.

    style: "paper" has open ground black, obstacles white, unknown grey; "ros" the reverse of the first two.
    Raises MapError where nothing is known, OSError where the picture cannot be written.
    """
    cells = cell_map(mapped)
    frame = _frame(cells, mapped.courses)
    image = Image.new("RGB", (frame.width, frame.height + LEGEND), _unknown(style))
    greys = Image.fromarray(np.ascontiguousarray(_greys(cells.percents, style)[::-1]))
    side = cells.resolution * frame.scale
    size = max(1, round(greys.width * side)), max(1, round(greys.height * side))
    left, top = frame.pixel(cells.x, cells.y + cells.percents.shape[0] * cells.resolution)
    image.paste(greys.resize(size, Image.Resampling.NEAREST).convert("RGB"), (round(left), round(top)))
    pen = ImageDraw.Draw(image)
    _lines(pen, frame, style)
    for name, course in mapped.courses.items():
        _course(pen, frame, course, COLOURS.get(name, OTHERS))
    _legend(pen, frame, list(mapped.courses))
    image.save(path, format="PNG")


def _greys(percents: Bytes, style: str) -> Bytes:
    share = percents.astype(np.float64) / 100
    grey = np.rint(255 * (share if style == "paper" else 1 - share)).clip(0, 255).astype(np.uint8)
    return np.where(percents > 100, np.uint8(_unknown(style)[0]), grey)


def _unknown(style: str) -> Colour:
    return (128, 128, 128) if style == "paper" else (205, 205, 205)


def _frame(cells: CellMap, courses: Mapping[str, Course]) -> _Frame:
    rows, columns = cells.percents.shape
    xs, ys = [cells.x, cells.x + columns * cells.resolution], [cells.y, cells.y + rows * cells.resolution]
    far = MOST * cells.resolution
    for course in courses.values():
        xs += [min(max(pose.x, -far), far) for pose in course.at.values()]
        ys += [min(max(pose.y, -far), far) for pose in course.at.values()]
    left, right, low, top = min(xs) - MARGIN, max(xs) + MARGIN, min(ys) - MARGIN, max(ys) + MARGIN
    scale = min(LONG / max(right - left, top - low), MOST_SCALE / cells.resolution)
    return _Frame(left, top, scale, max(420, math.ceil((right - left) * scale)), math.ceil((top - low) * scale))


def _lines(pen: ImageDraw.ImageDraw, frame: _Frame, style: str) -> None:
    colour = (96, 96, 96) if style == "paper" else (180, 180, 180)
    right, bottom = frame.left + frame.width / frame.scale, frame.top - frame.height / frame.scale
    for x in range(math.ceil(frame.left / LINE_M) * LINE_M, math.ceil(right), LINE_M):
        at = frame.pixel(x, 0)[0]
        pen.line([(at, 0), (at, frame.height)], fill=colour)
    for y in range(math.ceil(bottom / LINE_M) * LINE_M, math.ceil(frame.top), LINE_M):
        at = frame.pixel(0, y)[1]
        pen.line([(0, at), (frame.width, at)], fill=colour)


def _course(pen: ImageDraw.ImageDraw, frame: _Frame, course: Course, colour: Colour) -> None:
    points = [frame.pixel(pose.x, pose.y) for pose in course.at.values()]
    if len(points) > 1:
        pen.line(points, fill=colour, width=3)
    for at, filled in ((points[0], False), (points[-1], True)) if points else ():
        box = [at[0] - 5, at[1] - 5, at[0] + 5, at[1] + 5]
        pen.ellipse(box, fill=colour if filled else None, outline=colour, width=2)


def _legend(pen: ImageDraw.ImageDraw, frame: _Frame, names: Sequence[str]) -> None:
    pen.rectangle([0, frame.height, frame.width, frame.height + LEGEND], fill=(24, 24, 24))
    font, x, y = ImageFont.load_default(13), 10.0, frame.height + LEGEND / 2
    for name in names:
        pen.line([(x, y), (x + 18, y)], fill=COLOURS.get(name, OTHERS), width=4)
        pen.text((x + 24, y), name, fill=(235, 235, 235), font=font, anchor="lm")
        x += 24 + pen.textlength(name, font=font) + 18
    pen.text((frame.width - 10, y), f"lines each {LINE_M} m", fill=(170, 170, 170), font=font, anchor="rm")
