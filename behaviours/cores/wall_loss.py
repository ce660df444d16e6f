"""A wall that ends before the view does: points are invented where it must go on.

Takes: the fit, the points looked at, the view path. Gives: where the wall ends, and the points to add. Leaves alone:
what is made of them (`wall_law.bend`).

After Bayer 2012: "a wall must always go somewhere, even if it turns upon itself"; the points lie at the limit of the
view on the ray through the last of the wall, as many as the gap has room for, never more than were seen.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from behaviours.cores.view_path import ViewPath
from behaviours.cores.wall_fit import Fit
from behaviours.interface import Floats

GAP = 0.15
"""A wall that ends so much [m] before the view does is about to be lost."""
TAIL = 3
"""So many points may stray beyond the end of the wall."""


@dataclass(frozen=True, slots=True)
class End:
    """Where a wall ends: station [m] along it from the foot of the robot, gap [m] to the end of the view, the point."""

    station: float
    gap: float
    point: tuple[float, float]


def end_of(fit: Fit, points: Floats, view: ViewPath) -> End:
    """The last of the wall ahead."""
    on = points[fit.inliers]
    stations = fit.line.stations(on)
    last = int(np.argsort(stations)[max(0, len(stations) - 1 - TAIL)]) if len(stations) > TAIL else 0
    station = float(stations[last])
    return End(station, view.end_of(fit.line) - station, (float(on[last, 0]), float(on[last, 1])))


def invented(fit: Fit, points: Floats, end: End, view: ViewPath) -> Floats:
    """Points (k, 2) to add to the wall; none where it does not end."""
    if not GAP < end.gap < math.inf:
        return np.zeros((0, 2))
    stations = fit.line.stations(points[fit.inliers])
    length = float(stations.max() - stations.min())
    count = len(stations)
    wanted = min(count, round(end.gap * count / length)) if length > 0 else count
    return np.tile(view.edge_beyond(end.point), (wanted, 1))
