"""One run beside a wall, drawn as Bayer 2012 draws it.

Takes: what was seen of a run. Gives: a picture with the way that was driven, and offset, angle and curvature over time;
scans with the points on the wall and those that were invented. Leaves alone: what is measured.

Needs matplotlib, which comes with the extra `rplan[plot]`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from behaviours.estimators.surroundings import scan_points
from behaviours.interface import View
from rplan.apps.reproduce.row import Moment, Seen
from rplan.apps.reproduce.watch import described

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FOLLOW = "follow-wall"
BLUE, RED, GREEN, GREY = "#3478e5", "#c03a2b", "#16876f", "#9aa3af"
SNAPSHOTS, SPIKE = 5, 1.0
BEFORE, AFTER, A_LITTLE = 3.0, 4.0, 0.3  # [s]


def draw_course(seen: Seen, title: str, path: Path) -> None:
    """Where the robot went, and what the controller was told (the paper's Figures 8 to 13)."""
    figure = _sheet(10.5, 3.4)
    _way(figure.add_subplot(1, 2, 1), seen.moments)
    _told(figure.add_subplot(1, 2, 2), seen.moments)
    _save(figure, title, path)


def draw_clouds(seen: Seen, title: str, path: Path) -> None:
    """Five scans, and what the controller was told (the paper's Figures 14 to 18)."""
    figure = _sheet(13.0, 6.2)
    for k, moment in enumerate(_snapshots(seen.moments)):
        _cloud(figure.add_subplot(2, SNAPSHOTS, k + 1), moment)
    _told(figure.add_subplot(2, 2, 3), seen.moments)
    _way(figure.add_subplot(2, 2, 4), seen.moments)
    _save(figure, title, path)


def _sheet(width: float, height: float) -> Figure:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), dpi=110, layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def _save(figure: Figure, title: str, path: Path) -> None:
    figure.suptitle(title, fontsize=10)
    figure.savefig(path, format="png", metadata={"Software": None})


def _way(axes: Axes, moments: Sequence[Moment]) -> None:
    axes.plot([moment.pose.x for moment in moments], [moment.pose.y for moment in moments], color=BLUE, lw=1.6)
    axes.plot(*_first(moments), "o", color=BLUE, ms=5)
    axes.set(xlabel="x [m]", ylabel="y [m]", aspect="equal", facecolor="#f8f9fb")
    axes.set_adjustable("datalim")
    axes.grid(color="#e4e8ee", lw=0.8)


def _first(moments: Sequence[Moment]) -> tuple[list[float], list[float]]:
    return [moment.pose.x for moment in moments[:1]], [moment.pose.y for moment in moments[:1]]


def _told(axes: Axes, moments: Sequence[Moment]) -> None:
    said = [(moment.time, told) for moment in moments if (told := described(moment, FOLLOW))]
    words = (("offset", "offset [m]", BLUE), ("angle", "angle [rad]", RED), ("curvature", "curvature K", GREEN))
    for key, label, colour in words:
        drawn = [(time, _number(told, key)) for time, told in said if key in told]
        if drawn:
            axes.plot([time for time, _ in drawn], [value for _, value in drawn], color=colour, lw=1.3, label=label)
    axes.set(xlabel="time [s]", facecolor="#f8f9fb")
    axes.grid(color="#e4e8ee", lw=0.8)
    if said:
        axes.legend(fontsize=7.5, frameon=False)


def _number(told: Mapping[str, object], key: str) -> float:
    value = told[key]
    return float(value) if isinstance(value, int | float) else math.nan


# --- scans ----------------------------------------------------------------------------------------------


def _snapshots(moments: Sequence[Moment]) -> list[Moment]:
    """Round the spike of the curvature where there is one, otherwise from as long as a wall was followed."""
    followed = [moment.time for moment in moments if "offset" in described(moment, FOLLOW)]
    shown = [m for m in moments if "wall-points" in m.shown and followed and m.time <= followed[-1] + A_LITTLE]
    bends = [(abs(_number(told, "curvature")), m.time) for m in shown if "curvature" in (told := described(m, FOLLOW))]
    most, spike = max(bends, default=(0.0, 0.0))
    if most >= SPIKE:
        shown = [moment for moment in shown if spike - BEFORE <= moment.time <= spike + AFTER]
    if len(shown) <= SNAPSHOTS:
        return shown
    return [shown[round(k * (len(shown) - 1) / (SNAPSHOTS - 1))] for k in range(SNAPSHOTS)]


def _places(view: View | None) -> list[tuple[float, ...]]:
    at = None if view is None else view["at"]
    return [tuple(float(value) for value in place) for place in at] if isinstance(at, list | tuple) else []


def _cloud(axes: Axes, moment: Moment) -> None:
    """The robot in the middle, heading up."""
    if moment.reading.lidar is not None:
        points = scan_points(moment.reading.lidar)
        axes.plot(-points[:, 1], points[:, 0], ".", color=GREY, ms=1.5)
    for name, mark, colour, size in (("wall-points", ".", RED, 2.5), ("invented-points", "x", BLUE, 8.0)):
        places = _places(moment.shown.get(name))
        axes.plot([-place[1] for place in places], [place[0] for place in places], mark, color=colour, ms=size)
    for ax, ay, bx, by in _places(moment.shown.get("wall-line")):
        axes.plot([-ay, -by], [ax, bx], ":", color=RED, lw=1.0)
    axes.plot([0.0], [0.0], "^", color=BLUE, ms=7)
    axes.set(xlim=(-2.2, 3.2), ylim=(-2.7, 2.7), aspect="equal", facecolor="#f8f9fb", xticks=[], yticks=[])
    axes.set_title(f"{moment.time:.1f} s", fontsize=8)
