"""Looking ahead: the way through what is seen, as far as the window goes, in the wanted direction.

Takes: points round the robot, a wanted direction, the way found last. Gives: the way on, as places. Leaves alone: maps;
what is not seen counts as free.

The window is a grid about the robot. A cell costs more the nearer something stands, and very much where the hull would
touch; the cheapest way to the edge of the window is taken, where a place on the edge costs the more the less far it is
in the wanted direction. What lies on the way found last costs a little less, so that of two ways alike one is kept.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from behaviours.interface import Floats, Pose

TOUCHING = 200.0
"""Times the cost of a free cell."""
BEYOND = 3.0
"""Cost of a cell that a place on the edge is less far in the wanted direction: what is there is not known."""
KEPT = 0.7
"""Share of the cost on the way found last."""
EASED = 3.0
"""In so many times the ease, nearness has worn off."""
ROUNDS = 400
"""The most rounds in which costs spread; a way with more turns is not found to its end."""
ROUNDING = 1e-6


@dataclass(frozen=True, slots=True)
class LookAheadSettings:
    """Lengths [m]. half: half the side of the window; cell: of the grid; keep: distance from the robot's middle to what
    stands that is touching; ease: the cost of nearness falls to 1/e in this distance; nearness: that cost at `keep`.
    """

    half: float = 4.0
    cell: float = 0.1
    keep: float = 0.26
    ease: float = 0.2
    nearness: float = 2.0

    @property
    def cells(self) -> int:
        """Of a side; odd, so that the robot stands in the middle of one."""
        return 2 * round(self.half / self.cell) + 1


def cell_costs(points: Floats, settings: LookAheadSettings) -> Floats:
    """What a cell costs (cells, cells), rows along y; points (n, 2) [m] from the middle of the window."""
    n = settings.cells
    at = np.rint(points / settings.cell).astype(np.int64) + n // 2
    at = at[((at >= 0) & (at < n)).all(axis=1)]
    far = math.ceil((settings.keep + EASED * settings.ease) / settings.cell)
    squared = np.full((n, n), float(far * far))
    squared[at[:, 1], at[:, 0]] = 0.0
    squared = _nearest(_nearest(squared, far).T, far).T
    away = np.sqrt(squared) * settings.cell - settings.keep
    costs = 1.0 + settings.nearness * np.exp(-np.maximum(away, 0.0) / settings.ease)
    result: Floats = np.where(away < 0.0, TOUCHING, costs)
    return result


def _nearest(squared: Floats, far: int) -> Floats:
    """Least squared distance [cells^2] along the rows, to what is no further than `far` cells."""
    result = squared.copy()
    for step in range(1, far):
        np.minimum(result[:, step:], squared[:, :-step] + step * step, out=result[:, step:])
        np.minimum(result[:, :-step], squared[:, step:] + step * step, out=result[:, :-step])
    return result


def costs_to_go(costs: Floats, wanted: float) -> Floats:
    """The cheapest cost from each cell to beyond the edge of the window; wanted [rad]."""
    n = len(costs)
    middle = np.arange(n) - n // 2
    left = BEYOND * (2.0 * n - (middle[None, :] * math.cos(wanted) + middle[:, None] * math.sin(wanted)))
    total = np.full((n, n), math.inf)
    for side in ((0, slice(None)), (-1, slice(None)), (slice(None), 0), (slice(None), -1)):
        total[side] = left[side] + costs[side]
    sums = [
        np.concatenate([np.zeros((n, 1)), np.cumsum((c[:, :-1] + c[:, 1:]) / 2, axis=1)], axis=1)
        for c in (costs, costs.T)
    ]
    diagonal = math.sqrt(2) / 2
    falling, rising = diagonal * (costs[:-1, :-1] + costs[1:, 1:]), diagonal * (costs[1:, :-1] + costs[:-1, 1:])
    for _ in range(ROUNDS):
        before = total.copy()
        for grid, way_sum in ((total, sums[0]), (total.T, sums[1])):
            _along(grid, way_sum)
        np.minimum(total[1:, 1:], total[:-1, :-1] + falling, out=total[1:, 1:])
        np.minimum(total[:-1, :-1], total[1:, 1:] + falling, out=total[:-1, :-1])
        np.minimum(total[:-1, 1:], total[1:, :-1] + rising, out=total[:-1, 1:])
        np.minimum(total[1:, :-1], total[:-1, 1:] + rising, out=total[1:, :-1])
        if not (before - total > ROUNDING).any():
            break
    return total


def _along(total: Floats, way_sum: Floats) -> None:
    """Spread along whole rows, to the right and to the left."""
    np.minimum(total, way_sum + np.minimum.accumulate(total - way_sum, axis=1), out=total)
    back = np.minimum.accumulate((total + way_sum)[:, ::-1], axis=1)[:, ::-1]
    np.minimum(total, back - way_sum, out=total)


def way(points: Floats, wanted: float, before: Floats, settings: LookAheadSettings) -> Floats:
    """Places (m, 2) [m] from the robot to the edge of the window; points, before: (n, 2) [m] from the robot.

    wanted [rad]: in the same frame.
    """
    costs = cell_costs(points, settings)
    _cheaper(costs, before, settings)
    return _traced(costs_to_go(costs, wanted), costs, settings)


def _cheaper(costs: Floats, before: Floats, settings: LookAheadSettings) -> None:
    """What lies within a cell of the way found last."""
    n = settings.cells
    near = np.zeros((n, n), dtype=bool)
    for row in (-1, 0, 1):
        for column in (-1, 0, 1):
            at = np.rint(before / settings.cell + (n // 2 + column, n // 2 + row)).astype(np.int64)
            at = at[((at >= 0) & (at < n)).all(axis=1)]
            near[at[:, 1], at[:, 0]] = True
    costs[near] *= KEPT


def _traced(total: Floats, costs: Floats, settings: LookAheadSettings) -> Floats:
    """Downhill from the middle to the edge."""
    n = settings.cells
    row = column = n // 2
    places = [(column, row)]
    while 0 < row < n - 1 and 0 < column < n - 1 and len(places) < n * n:
        step = costs[row - 1 : row + 2, column - 1 : column + 2] + costs[row, column]
        onward = total[row - 1 : row + 2, column - 1 : column + 2] + STEP_LENGTHS * step / 2
        onward[1, 1] = math.inf
        best = int(np.argmin(onward))
        row, column = row + best // 3 - 1, column + best % 3 - 1
        if (column, row) in places[-3:]:
            break
        places.append((column, row))
    return (np.array(places, dtype=np.float64) - n // 2) * settings.cell


STEP_LENGTHS = np.hypot(*np.meshgrid([-1.0, 0.0, 1.0], [-1.0, 0.0, 1.0]))
"""[cells] to the eight neighbours."""


def carrot(places: Floats, pose: Pose, ahead: float) -> float | None:
    """Direction [rad] to the place of the way `ahead` [m] from the pose; both in one frame. None without a way."""
    if len(places) < 2:
        return None
    away = np.hypot(places[:, 0] - pose.x, places[:, 1] - pose.y)
    nearest = int(np.argmin(away))
    (beyond,) = np.nonzero(away[nearest:] >= ahead)
    x, y = places[nearest + int(beyond[0]) if beyond.size else -1]
    return math.atan2(y - pose.y, x - pose.x)
