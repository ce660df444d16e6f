"""A run as one picture: the lot, the way that was driven, and which competence drove when.

Takes: a `Recording` and where to write. Gives: a PNG, in the manner of the parking lot run of Bonasso, Antonisse and
Slack 1992 (Figure 4), with a strip of time below. Leaves alone: the judgement of the run; a verdict is given as text.

Needs matplotlib, which comes with the extra `rplan[plot]`; without it `draw` raises ImportError that says so.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import groupby, pairwise
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from behaviours.interface import Floats, Scan
from sim.plain import Json, listed, mapping, number
from sim.recording import Recording

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.patches import Patch
    from matplotlib.path import Path as Path_
    from matplotlib.ticker import Locator

PALETTE = ("#8457d8", "#b0478f", "#8d5a3b", "#16876f", "#3478e5", "#a9720a", "#0f7fa3", "#5c7f1c")
DANGER, OPEN, DRIVEN, INK, DIM = "#e5484d", "#b4bcc8", "#3478e5", "#19202b", "#566172"
THING, THING_EDGE, MOVER, DONOR = "#aab4c2", "#6b7788", "#c98a1b", "#0b7a4b"
CURB, SLOPE, GOAL, SCAN = "#e3d9c3", "#f0ead9", "#cfe0fb", "#2f9fd0"
FLEEING = re.compile(r"danger|runaway|run-away|escape")
MARGIN = 3.5
"""So much of the lot [m] is shown around the way and the donor."""
WIDTH = 9.0
"""Of the picture [in]."""
FOOTPRINT_S = 5.0
"""A faint outline of the robot is drawn at this distance in time [s] while it moves."""

SCAN_S = 1.0
"""The echoes of scans at this distance in time [s] are drawn."""
MOST_ECHOES = 20_000

MOVED = 0.05
"""What went farther than this [m] is drawn as a thing that moves."""
FEW = 5
"""Up to so many moments of a kind are labelled with their time."""

Point = tuple[float, float]
Pose = tuple[float, float, float]


@dataclass(slots=True)
class Track:
    """What the picture needs of every tick. act: text of the main output, None where it is open."""

    t: list[float] = field(default_factory=list)
    pose: list[Pose] = field(default_factory=list)
    odometry: list[Pose] = field(default_factory=list)
    act: list[str | None] = field(default_factory=list)
    stage: list[str] = field(default_factory=list)
    on_board: list[bool] = field(default_factory=list)
    contact: list[bool] = field(default_factory=list)
    hole: list[bool] = field(default_factory=list)
    movers: dict[str, list[Pose]] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Band:
    """Ticks [start, end) with one act."""

    start: int
    end: int
    act: str | None


# --- what the recording says ------------------------------------------------------------------------


def pose_of(value: object) -> Pose | None:
    """x, y, theta, where the value is a pose."""
    match value:
        case [x, y, theta]:
            return number(x), number(y), number(theta)
        case _:
            return None


def _main_output(header: Json) -> str:
    names = [str(name) for name in listed(mapping(header.get("plan")).get("outputs"))]
    return "action" if "action" in names or not names else names[-1]


def _add(track: Track, tick: Json, output: str) -> None:
    world, plan = mapping(tick.get("world")), mapping(tick.get("plan"))
    pose = pose_of(world.get("robot")) or (track.pose[-1] if track.pose else (math.nan, math.nan, 0.0))
    act = mapping(plan.get("outputs")).get(output) if plan else (track.act[-1] if track.act else None)
    track.t.append(number(tick.get("t")))
    track.pose.append(pose)
    track.odometry.append(pose_of(world.get("odometry")) or (math.nan, math.nan, 0.0))
    track.act.append(None if act is None else str(act))
    track.stage.append(str(world.get("stage") or ""))
    track.on_board.append(bool(world.get("on_board")))
    track.contact.append(bool(world.get("contacts")))
    track.hole.append(bool(plan.get("hole")))
    for name, value in mapping(world.get("movers")).items():
        if found := pose_of(value):
            track.movers.setdefault(str(name), []).append(found)


def track_of(recording: Recording) -> Track:
    """What the picture needs of the whole run."""
    track, output = Track(), _main_output(recording.header)
    for tick in recording.ticks:
        _add(track, tick, output)
    return track


def bands_of(acts: Sequence[str | None]) -> list[Band]:
    """Stretches of the same act."""
    bands, start = list[Band](), 0
    for act, group in groupby(acts):
        end = start + sum(1 for _ in group)
        bands.append(Band(start, end, act))
        start = end
    return bands


def _lasted(bands: Sequence[Band]) -> dict[str | None, int]:
    """Competence -> ticks, the longest first."""
    lasts: dict[str | None, int] = {}
    for band in bands:
        lasts[band.act] = lasts.get(band.act, 0) + band.end - band.start
    return dict(sorted(lasts.items(), key=lambda item: -item[1]))


def _colours(lasted: Mapping[str | None, int], text: str) -> dict[str | None, str]:
    """Competence -> colour, by where the plan's text names it, so that its runs share their colours."""
    plain = [act for act in lasted if act is not None and not FLEEING.search(act)]
    plain.sort(key=lambda act: text.find(act) if act in text else len(text))
    given = {act: PALETTE[k % len(PALETTE)] for k, act in enumerate(plain)}
    left_open = OPEN if any(lasted) else DRIVEN
    return {act: left_open if act is None else given.get(act, DANGER) for act in lasted}


def world_of(header: Json) -> Json:
    """What the header says of the world."""
    return mapping(header.get("world")) or header


def colours_of(header: Json, bands: Sequence[Band]) -> dict[str | None, str]:
    """Competence -> colour."""
    return _colours(_lasted(bands), str(mapping(header.get("plan")).get("text") or ""))


def _rises(flags: Sequence[bool]) -> list[int]:
    """Where a flag comes up, the first tick included."""
    return [k for k, flag in enumerate(flags) if flag and not (k and flags[k - 1])]


def _hand_overs(track: Track) -> list[int]:
    return [k + 1 for k, (before, now) in enumerate(pairwise(track.on_board)) if now and not before]


def _period(track: Track) -> float:
    """The mean distance of two ticks [s]."""
    return (track.t[-1] - track.t[0]) / max(1, len(track.t) - 1)


def name_of(act: str | None) -> str:
    """An act in words."""
    return "left open" if act is None else re.sub(r"^\(([^() ]+)\)$", r"\1", act)


def clock(seconds: float) -> str:
    """Minutes and seconds."""
    minutes, rest = divmod(round(seconds, 1), 60.0)
    return f"{int(minutes)}:{rest:04.1f}"


# --- the lot --------------------------------------------------------------------------------------


def _placed(points: Sequence[object], pose: Pose) -> list[Point]:
    cos, sin, placed = math.cos(pose[2]), math.sin(pose[2]), list[Point]()
    for point in points:
        x, y = map(number, listed(point)[:2])
        placed.append((pose[0] + cos * x - sin * y, pose[1] + sin * x + cos * y))
    return placed


def outline(shape: Json, pose: Pose, face: str, edge: str, alpha: float = 1.0) -> Patch:
    """A shape (circle, polygon, or rings with holes) where it stands."""
    from matplotlib.patches import Circle, PathPatch, Polygon

    style = {"facecolor": face, "edgecolor": edge, "linewidth": 0.9, "alpha": alpha}
    if "rings" in shape:
        return PathPatch(_rings([_placed(listed(ring), pose) for ring in listed(shape["rings"])]), **style)
    if "polygon" in shape:
        return Polygon(_placed(listed(shape["polygon"]), pose), closed=True, **style)
    return Circle(pose[:2], number(shape.get("circle", 0.2)), **style)


def _rings(rings: Sequence[Sequence[Point]]) -> Path_:
    """One path of closed rings: solid where the outer ones are counter-clockwise and the holes clockwise."""
    from matplotlib.path import Path as MatplotlibPath

    points, codes = list[Point](), list[int]()
    for ring in rings:
        points += [*ring, ring[0]]
        kinds = [MatplotlibPath.MOVETO, *[MatplotlibPath.LINETO] * (len(ring) - 1), MatplotlibPath.CLOSEPOLY]
        codes += map(int, kinds)
    return MatplotlibPath(points, codes)


def hull(world: Json) -> Json:
    """The shape of the robot."""
    robot = mapping(world.get("robot"))
    return mapping(robot.get("shape")) or {"circle": number(robot.get("radius", 0.3))}


def _draw_ground(axes: Axes, world: Json) -> None:
    """Slopes, each with an arrow uphill, and the place to be reached."""
    from matplotlib.patches import Circle, Rectangle

    for slope in map(mapping, listed(world.get("slopes"))):
        xmin, ymin, xmax, ymax = (number(value) for value in listed(slope.get("region")))
        axes.add_patch(Rectangle((xmin, ymin), xmax - xmin, ymax - ymin, color=SLOPE, zorder=0.5, lw=0))
        rise, uphill = math.degrees(number(slope.get("rise"))), number(slope.get("uphill"))
        middle = (xmin + xmax) / 2, (ymin + ymax) / 2
        words = axes.annotate(f"{rise:.0f}° up →", middle, ha="center", va="center", rotation=math.degrees(uphill))
        words.set(color=DIM, fontsize=7.5, zorder=1)
    goal = mapping(world.get("goal"))
    if at := [number(value) for value in listed(goal.get("at"))]:
        axes.add_patch(Circle((at[0], at[1]), number(goal.get("within", 1.0)), fc=GOAL, ec=DRIVEN, alpha=0.35, lw=1.2))
        _label(axes, "goal", at, DRIVEN, (0, 0))


def draw_things(axes: Axes, world: Json, track: Track) -> None:
    """All that stands, and what moves with its way, where it was last."""
    draw_standing(axes, world)
    donor_id = donor_id_of(world)
    for mover in map(mapping, listed(world.get("movers"))):
        way = track.movers.get(str(mover.get("id")), [])
        moved = any(math.dist(pose[:2], way[0][:2]) > MOVED for pose in way)
        is_donor = mover.get("id") == donor_id
        if moved and not is_donor:
            axes.plot([p[0] for p in way], [p[1] for p in way], ":", color=MOVER, lw=1.0, zorder=2)
        if way:
            draw_thing(axes, mover, way[-1], is_donor, MOVER if moved else THING, 0.55 if moved else 1.0)


def draw_standing(axes: Axes, world: Json) -> None:
    """The ground, the goal and all that stands."""
    _draw_ground(axes, world)
    donor_id = donor_id_of(world)
    for thing in map(mapping, listed(world.get("things"))):
        if pose := pose_of(thing.get("pose")):
            draw_thing(axes, thing, pose, thing.get("id") == donor_id, THING, 1.0)


def draw_thing(axes: Axes, thing: Json, pose: Pose, is_donor: bool, face: str, alpha: float) -> None:
    """A thing where it stands."""
    shape = mapping(thing.get("shape"))
    if is_donor:
        axes.add_patch(outline(shape, pose, "white", DONOR)).set(linewidth=2.0, zorder=3)
        _label(axes, "donor", pose[:2], DONOR)
    else:
        curb = thing.get("kind") == "curb"
        axes.add_patch(outline(shape, pose, CURB if curb else face, THING_EDGE, alpha)).set_zorder(1.4 if curb else 1.5)


def _label(axes: Axes, words: str, at: Sequence[float], colour: str, offset: Point = (0, -15)) -> None:
    from matplotlib.patheffects import withStroke

    text = axes.annotate(words, (at[0], at[1]), xytext=offset, textcoords="offset points", ha="center", va="center")
    text.set(color=colour, fontsize=8.5, zorder=9, path_effects=[withStroke(linewidth=2.5, foreground="white")])


def _draw_path(axes: Axes, track: Track, bands: Sequence[Band], colours: Mapping[str | None, str]) -> None:
    for band in bands:
        stretch = track.pose[band.start : band.end + 1]
        colour, xs, ys = colours[band.act], [p[0] for p in stretch], [p[1] for p in stretch]
        axes.plot(xs, ys, color=colour, lw=2.4, solid_capstyle="round", zorder=5 if colour == DANGER else 4)
    believed = _believed(track)
    axes.plot([p[0] for p in believed], [p[1] for p in believed], ":", color=INK, lw=1.0, zorder=3.5)


def _believed(track: Track) -> list[Point]:
    """The odometry, laid on the true first pose."""
    (x, y, theta), (u, v, phi) = track.pose[0], track.odometry[0]
    moved = [(p[0] - u, p[1] - v) for p in track.odometry]
    return _placed(moved, (x, y, theta - phi))


def _draw_scans(axes: Axes, recording: Recording, track: Track) -> None:
    """What the lidar saw, from where the robot really was."""
    known, due, points = {round(t * 1000): k for k, t in enumerate(track.t)}, -math.inf, list[Floats]()
    for reading in recording.readings:
        scan, k = reading.lidar, known.get(round(reading.stamp * 1000))
        if scan is not None and k is not None and scan.fresh and reading.stamp >= due:
            points.append(seen(scan, track.pose[k]))
            due = reading.stamp + SCAN_S
    if points:
        x, y = np.concatenate(points)[:: max(1, sum(map(len, points)) // MOST_ECHOES)].T
        axes.plot(x, y, ",", color=SCAN, alpha=0.8, zorder=2.5)


def seen(scan: Scan, pose: Pose) -> Floats:
    """Where the beams of a scan ended [m, world], (n, 2), with the robot at this pose."""
    met = scan.ranges < scan.max_range  # not where the beam failed
    ranges, turned = scan.ranges[met], scan.bearings[met] + scan.mount.theta + pose[2]
    ((x, y),) = _placed([(scan.mount.x, scan.mount.y)], pose)
    return np.stack([x + ranges * np.cos(turned), y + ranges * np.sin(turned)], axis=1)


def _draw_footprints(axes: Axes, world: Json, track: Track) -> None:
    shape = hull(world)
    last_t, last = -math.inf, (math.inf, math.inf)
    for t, pose in zip(track.t, track.pose, strict=True):
        if t - last_t >= FOOTPRINT_S and math.dist(last, pose[:2]) > 0.1:
            axes.add_patch(outline(shape, pose, "none", DIM, 0.45)).set(linewidth=0.7, zorder=3)
            last_t, last = t, pose[:2]


def _draw_moments(axes: Axes, world: Json, track: Track, bands: Sequence[Band]) -> None:
    home = pose_of(world.get("home")) or track.pose[0]
    axes.plot(*home[:2], marker="s", ms=9, mfc="white", mec=INK, mew=1.6, zorder=6)
    _label(axes, "start, home", home[:2], INK)
    flights = [b.start for b in bands if b.act is not None and FLEEING.search(b.act)]
    _mark(axes, track, _hand_overs(track), "on board", "P", DONOR, (0, 40))
    _mark(axes, track, flights, "runaway", "X", DANGER, (0, 14))
    _mark(axes, track, _rises(track.contact), "contact", "v", INK, (38, -13))


def _mark(axes: Axes, track: Track, at: list[int], word: str, marker: str, colour: str, offset: Point) -> None:
    for n, k in enumerate(at):
        place = track.pose[k][:2]
        axes.plot(*place, marker=marker, ms=9, mfc=colour, mec="white", zorder=8, ls="")
        if len(at) <= FEW:
            above = math.copysign(12.0 * (n % 3), offset[1])  # neighbours do not cover each other
            _label(axes, f"{word} {clock(track.t[k])}", place, colour, (offset[0], offset[1] + above))


def bounds_of(world: Json, track: Track) -> tuple[float, float, float, float]:
    """xmin, ymin, xmax, ymax [m] of the picture."""
    match [number(value) for value in listed(world.get("bounds"))]:
        case [xmin, ymin, xmax, ymax]:
            lot = xmin - 0.3, ymin - 0.3, xmax + 0.3, ymax + 0.3
        case _:
            lot = -math.inf, -math.inf, math.inf, math.inf
    places = [pose[:2] for pose in (*track.pose, *track.movers.get(donor_id_of(world), []))]
    if goal := [number(value) for value in listed(mapping(world.get("goal")).get("at"))]:
        places.append((goal[0], goal[1]))
    xs, ys = [place[0] for place in places], [place[1] for place in places]
    left, right = max(lot[0], min(xs) - MARGIN), min(lot[2], max(xs) + MARGIN)
    return left, max(lot[1], min(ys) - MARGIN), right, min(lot[3], max(ys) + MARGIN)


def donor_id_of(world: Json) -> str:
    donor = world.get("donor")
    return str(mapping(donor).get("id", donor))


def frame_axes(axes: Axes, bounds: tuple[float, float, float, float]) -> None:
    """The part of the lot that is shown, with a grid."""
    axes.set(xlim=(bounds[0], bounds[2]), ylim=(bounds[1], bounds[3]), aspect="equal")
    axes.set(xlabel="x [m]", ylabel="y [m]", facecolor="#f8f9fb")
    axes.grid(color="#e4e8ee", lw=0.8)
    axes.set_axisbelow(True)


# --- the strip of time ------------------------------------------------------------------------------


def _draw_strip(axes: Axes, track: Track, bands: Sequence[Band], colours: Mapping[str | None, str]) -> None:
    ends = [*track.t[1:], track.t[-1] + 0.1]
    for band in bands:
        start, end = track.t[band.start], ends[band.end - 1]
        axes.broken_barh([(start, end - start)], (0.42, 0.58), facecolors=colours[band.act])
    for k, band in enumerate(bands_of(track.stage)):
        start, end = track.t[band.start], ends[band.end - 1]
        axes.broken_barh([(start, end - start)], (0.0, 0.34), facecolors="#dfe4eb" if k % 2 else "#cfd6df")
        if end - start > 0.1 * (ends[-1] - track.t[0]):
            axes.text((start + end) / 2, 0.16, band.act or "", ha="center", va="center", fontsize=8, color=INK)
    for flags, marker, colour, _ in _marks(track):
        axes.plot([track.t[k] for k in flags], [1.14] * len(flags), marker, color=colour, ms=7, clip_on=False)
    axes.set(xlim=(track.t[0], ends[-1]), ylim=(0, 1.02), yticks=[], xlabel="time [min:s]")
    axes.xaxis.set_major_formatter(lambda t, _: f"{int(t // 60)}:{int(t % 60):02d}")
    axes.xaxis.set_major_locator(_locator(ends[-1]))
    for side in ("left", "right", "top"):
        axes.spines[side].set_visible(False)


def _marks(track: Track) -> Iterator[tuple[list[int], str, str, str]]:
    yield _hand_overs(track), "P", DONOR, "on board"
    yield _rises(track.contact), "v", INK, "contact"
    yield _rises(track.hole), "D", "#945b00", "hole"


def _locator(duration: float) -> Locator:
    from matplotlib.ticker import MultipleLocator

    steps = (1, 2, 5, 10, 20, 30, 60, 120, 300, 600)
    return MultipleLocator(next((step for step in steps if duration / step <= 14), 1800))


def _draw_legend(figure: Figure, track: Track, bands: Sequence[Band], colours: Mapping[str | None, str]) -> None:
    from matplotlib.lines import Line2D

    handles = []
    for act, ticks in _lasted(bands).items():
        words = f"{name_of(act) if any(colours) else 'driven'}  {ticks * _period(track):.1f} s"
        handles.append(Line2D([], [], color=colours[act], lw=6, label=words))
    handles.append(Line2D([], [], color=INK, lw=1, ls=":", label="odometry"))
    kinds = [*_marks(track), ([b.start for b in bands if FLEEING.search(b.act or "")], "X", DANGER, "runaway")]
    for at, marker, colour, word in kinds:
        if at:
            handles.append(Line2D([], [], color=colour, marker=marker, ls="", ms=7, label=f"{word}  {len(at)}×"))
    figure.legend(handles=handles, loc="lower center", ncols=3, fontsize=8.5, frameon=False, handlelength=1.2)


# --- the picture ------------------------------------------------------------------------------------


def _title(header: Json, track: Track, verdict: str) -> tuple[str, str]:
    scenario = header.get("scenario")
    where = scenario if isinstance(scenario, str) else mapping(scenario).get("name")
    names = [mapping(header.get("plan")).get("name") or "hand-written brain", where, f"seed {header.get('seed', '–')}"]
    moments = [f"on board at {clock(track.t[k])}" for k in _hand_overs(track)] + [f"end at {clock(track.t[-1])}"]
    return " · ".join(str(name) for name in names if name), verdict or ", ".join(moments)


def _figure(recording: Recording, track: Track, verdict: str) -> Figure:
    from matplotlib.figure import Figure

    world = world_of(recording.header)
    bands = bands_of(track.act)
    colours = colours_of(recording.header, bands)
    xmin, ymin, xmax, ymax = bounds_of(world, track)
    across = WIDTH * 0.89 * (ymax - ymin) / (xmax - xmin)  # [in] height of the lot at full width
    figure = Figure(figsize=(WIDTH, across + 3.4), dpi=130)
    lot, strip = figure.subplots(2, 1, height_ratios=(across, 0.75))
    frame_axes(lot, (xmin, ymin, xmax, ymax))
    draw_things(lot, world, track)
    _draw_scans(lot, recording, track)
    _draw_footprints(lot, world, track)
    _draw_path(lot, track, bands, colours)
    _draw_moments(lot, world, track, bands)
    _draw_strip(strip, track, bands, colours)
    _draw_legend(figure, track, bands, colours)
    title, below = _title(recording.header, track, verdict)
    inch = 1 / (across + 3.4)
    figure.text(0.08, 1 - 0.3 * inch, title, va="center", fontsize=13, fontweight="bold", parse_math=False)
    figure.text(0.08, 1 - 0.56 * inch, below, va="center", fontsize=10, color=DIM, parse_math=False)
    figure.subplots_adjust(left=0.08, right=0.97, top=1 - 0.8 * inch, bottom=1.25 * inch)
    figure.subplots_adjust(hspace=0.7 / ((across + 0.75) / 2))
    return figure


def draw(recording: Recording, path_png: Path | str, verdict: str = "") -> None:
    """Draw the run into a PNG; `verdict` is a line of text below the title (empty: when what happened).

    Raises ImportError without matplotlib, ValueError where the recording has no ticks, OSError where the file cannot
    be written. The same recording gives the same bytes with the same matplotlib.
    """
    try:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
    except ImportError as fault:
        raise ImportError("drawing needs matplotlib: pip install 'rplan[plot]'", name="matplotlib") from fault
    track = track_of(recording)
    if not track.t:
        raise ValueError("the recording has no ticks: there is nothing to draw")
    figure = _figure(recording, track, verdict)
    FigureCanvasAgg(figure)
    figure.savefig(path_png, format="png", metadata={"Software": None})
