"""From occupancy grids to few polygons: the outline of what is solid, as closed rings.

Takes: a grid of cells, the size of a cell and where the grid lies. Gives: rings with the solid on the left (outer ones
counter-clockwise, holes clockwise) that neither cross nor touch themselves or one another.
Leaves alone: where grids come from (`importers/`) and what rings are used for.

Frames. Row 0 is the top row of the picture. `origin` is the pose of the lower left corner of the grid, as in ROS maps:
the last row lies along its x axis, the first column along its y axis.

Method. Corners of the boundary are found by the pattern of the four cells round each lattice point; in one row of the
lattice they are, from left to right, in turn starts and ends of straight runs, and so in columns: sorting them joins
them. Solid cells that touch by a corner belong together, so that a wall of diagonal cells has no gap: there the two
sides of the boundary are moved apart by a quarter of a cell (`BRIDGE`) into the free cells. Rings are then simplified
by Douglas and Peucker 1973; where pieces would come nearer to one another than `APART`, the points left out there are
taken back, so that no wall vanishes and no gap opens.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from behaviours.interface import Floats, Pose, Vec2

Ring = tuple[Vec2, ...]
Bools = NDArray[np.bool_]
Ints = NDArray[np.int64]

MOST_CELLS = 100_000_000
MOST_CORNERS = 500_000
"""Grids with more corners than this are noise, not maps."""

TOLERANCE = 0.75
"""How far [cells] a simplified ring may lie from the exact one."""

BRIDGE = 0.25
"""By how much [cells] the boundary keeps away from a corner in which only two diagonal cells meet."""

APART = 0.1
"""The least distance [cells] between pieces of simplified rings that are not neighbours."""

BUCKET = 4.0  # [cells] side of the squares by which near pieces are found
PATIENCE = 6  # rounds after which all points of pieces in conflict are taken back at once


class GridError(ValueError):
    """The grid cannot be traced; says why."""


def trace(
    occupied: Bools, resolution: float, origin: Pose, tolerance: float = TOLERANCE, least_area: float = 0.0
) -> tuple[Ring, ...]:
    """The rings [m, world] round what is occupied, the greatest first.

    occupied: (rows, cols), row 0 at the top. resolution: side of a cell [m]. tolerance [cells], at most `TOLERANCE`;
    0 keeps every corner. Rings that enclose less than least_area [m^2] are left out. Raises GridError.
    """
    _check(occupied, resolution, tolerance)
    points, ring = _boundary(occupied)
    if not points.size:
        return ()
    if tolerance > 0:
        kept = _simplified(points, ring, tolerance)
        points, ring = points[kept], ring[kept]
    starts = np.flatnonzero(np.diff(ring, prepend=-1))
    areas = _areas(points, starts)
    placed = _placed(points * resolution, origin)
    pieces = np.split(placed, starts[1:])
    order = np.argsort(-np.abs(areas), kind="stable")
    wanted = [index for index in order.tolist() if abs(areas[index]) * resolution**2 >= least_area]
    return tuple(tuple((float(x), float(y)) for x, y in pieces[index].tolist()) for index in wanted)


def _check(occupied: Bools, resolution: float, tolerance: float) -> None:
    if occupied.ndim != 2 or not occupied.size:
        raise GridError("the grid is empty")
    if occupied.size > MOST_CELLS:
        raise GridError(f"the grid has {occupied.size:,} cells; at most {MOST_CELLS:,} are read")
    if not 0 < resolution < math.inf:
        raise GridError(f"the size of a cell must be greater than 0, not {resolution:g}")
    if not 0 <= tolerance <= TOLERANCE:
        raise GridError(f"the tolerance must be from 0 to {TOLERANCE:g} cells, not {tolerance:g}")


def _placed(points: Floats, origin: Pose) -> Floats:
    c, s = math.cos(origin.theta), math.sin(origin.theta)
    x, y = points[:, 0], points[:, 1]
    return np.stack([origin.x + c * x - s * y, origin.y + s * x + c * y], axis=1)


def _areas(points: Floats, starts: Ints) -> Floats:
    """Signed area [cells^2] of each ring; positive counter-clockwise."""
    following = _following(len(points), starts)
    x, y = points[:, 0], points[:, 1]
    return np.asarray(np.add.reduceat(x * y[following] - x[following] * y, starts) / 2)


def _following(count: int, starts: Ints) -> Ints:
    """The index of the next point on the same ring, for each point."""
    following = np.arange(1, count + 1)
    following[np.append(starts[1:], count) - 1] = starts
    return following


# --- the exact boundary ---------------------------------------------------------------------------

SW, SE, NW, NE = 1, 2, 4, 8
LEAVES_SIDEWAYS = {NE, SW, SW | SE | NE, NE | NW | SW, SW | NE}
"""Patterns of solid cells round a lattice point after which the boundary, solid on the left, runs along the row."""


def _boundary(occupied: Bools) -> tuple[Floats, Ints]:
    """Corners [cells, from the lower left] of all rings, one ring after the other, and which ring each belongs to."""
    rows, columns, pattern = _corners(occupied)
    rows, columns, pattern, second = _split_pinches(rows, columns, pattern)
    sideways = np.isin(pattern, list(LEAVES_SIDEWAYS))
    along_row = _partners(rows, columns, second)
    nearer_top = np.where(pattern == (SW | NE), ~second, second)
    along_column = _partners(columns, rows, nearer_top)
    following = np.where(sideways, along_row, along_column)
    order, ring = _followed(following)
    return _bridged(rows, columns, pattern, second, order, ring)


def _corners(occupied: Bools) -> tuple[Ints, Ints, Ints]:
    """Row, column and pattern of the lattice points at which the boundary turns; row 0 at the bottom."""
    rows, columns = occupied.shape
    padded = np.zeros((rows + 2, columns + 2), dtype=np.uint8)
    padded[1:-1, 1:-1] = occupied[::-1]
    code = padded[:-1, :-1] * np.uint8(SW)
    code |= padded[:-1, 1:] * np.uint8(SE)
    code |= padded[1:, :-1] * np.uint8(NW)
    code |= padded[1:, 1:] * np.uint8(NE)
    turns = np.ones(16, dtype=np.bool_)
    turns[[0, SW | SE, NW | NE, SW | NW, SE | NE, 15]] = False
    turning = turns[code]
    if np.count_nonzero(turning) > MOST_CORNERS:
        raise GridError(f"the grid has more than {MOST_CORNERS:,} corners: this is noise, not a map")
    at = np.flatnonzero(turning)
    return at // (columns + 1), at % (columns + 1), code.ravel()[at].astype(np.int64)


def _split_pinches(rows: Ints, columns: Ints, pattern: Ints) -> tuple[Ints, Ints, Ints, Bools]:
    """Where two diagonal cells meet the boundary turns twice: such a corner becomes two, the western one first."""
    pinch = (pattern == (SW | NE)) | (pattern == (SE | NW))
    times = np.where(pinch, 2, 1)
    second = np.zeros(int(times.sum()), dtype=np.bool_)
    second[np.cumsum(times)[pinch] - 1] = True
    return np.repeat(rows, times), np.repeat(columns, times), np.repeat(pattern, times), second


def _partners(lines: Ints, places: Ints, later: Bools) -> Ints:
    """The corner at the other end of the straight run of each corner, along these lines of the lattice."""
    order = np.lexsort((later, places, lines))
    partner = np.empty(len(order), dtype=np.int64)
    partner[order[0::2]], partner[order[1::2]] = order[1::2], order[0::2]
    return partner


def _followed(following: Ints) -> tuple[Ints, Ints]:
    """All corners in the order of their rings, and the number of the ring of each."""
    following_list = following.tolist()
    done = bytearray(len(following_list))
    order: list[int] = []
    lengths: list[int] = []
    for start in range(len(following_list)):
        if done[start]:
            continue
        before, at = len(order), start
        while not done[at]:
            done[at] = 1
            order.append(at)
            at = following_list[at]
        lengths.append(len(order) - before)
    return np.array(order, dtype=np.int64), np.repeat(np.arange(len(lengths)), lengths)


def _bridged(rows: Ints, columns: Ints, pattern: Ints, second: Bools, order: Ints, ring: Ints) -> tuple[Floats, Ints]:
    """The corners as points; a corner at a pinch is cut off, so that the diagonal cells hang together."""
    pattern, second = pattern[order], second[order]
    points = np.stack([columns[order], rows[order]], axis=1).astype(np.float64)
    rising, falling = pattern == (SW | NE), pattern == (SE | NW)
    pinch = rising | falling
    times = np.where(pinch, 2, 1)
    last = np.cumsum(times) - 1
    bridged, rings = np.repeat(points, times, axis=0), np.repeat(ring, times)
    side = np.where(second, 1.0, -1.0)[pinch] * BRIDGE
    upwards = np.where(rising, -1.0, 1.0)[pinch] * side
    along = rising[pinch]
    before, after = last[pinch] - 1, last[pinch]
    bridged[np.where(along, after, before), 0] += side
    bridged[np.where(along, before, after), 1] += upwards
    return bridged, rings


# --- simplification -------------------------------------------------------------------------------


@dataclass(slots=True)
class _Chains:
    """All points ring by ring, each ring closed by a copy of its first point; what is kept so far."""

    points: Floats
    kept: Bools
    home: Ints  # the index in the open points, for each point
    ring: Ints

    def ends(self) -> tuple[Ints, Ints]:
        """First and last index of each piece between points that are kept."""
        at = np.flatnonzero(self.kept)
        same = self.ring[at[:-1]] == self.ring[at[1:]]
        return at[:-1][same], at[1:][same]


def _simplified(points: Floats, ring: Ints, tolerance: float) -> Ints:
    """Indices of the points that stay."""
    chains = _closed(points, ring)
    first, last = chains.ends()
    first, last = _split_all(chains, first, last, -1.0)  # each half of a ring once more, whatever the tolerance
    while len(first):
        first, last = _split_all(chains, first, last, tolerance)
    _keep_apart(chains)
    stay = chains.kept.copy()
    stay[np.append(np.flatnonzero(np.diff(chains.ring)), len(stay) - 1)] = False
    return chains.home[stay]


def _closed(points: Floats, ring: Ints) -> _Chains:
    """Rings that begin at their lowest left corner; kept are that one and the one farthest from it."""
    starts = np.flatnonzero(np.diff(ring, prepend=-1))
    lengths = np.diff(np.append(starts, len(points)))
    lowest = np.lexsort((points[:, 1], points[:, 0], ring))[starts]
    number = np.repeat(np.arange(len(starts)), lengths + 1)
    closed_starts = starts + np.arange(len(starts))
    offset = np.arange(len(number)) - closed_starts[number]
    home = starts[number] + (lowest[number] - starts[number] + offset) % lengths[number]
    closed = points[home]
    distance = np.hypot(*(closed - closed[closed_starts[number]]).T)
    farthest = _argmax(distance, closed_starts)
    kept = np.zeros(len(number), dtype=np.bool_)
    kept[closed_starts] = kept[closed_starts + lengths] = kept[farthest] = True
    return _Chains(closed, kept, home, number)


def _argmax(values: Floats, starts: Ints) -> Ints:
    """The first index of the greatest value in each stretch that begins at `starts` and ends before the next."""
    most = np.maximum.reduceat(values, starts)
    lengths = np.diff(np.append(starts, len(values)))
    hits = np.flatnonzero(values == np.repeat(most, lengths))
    stretch = np.searchsorted(starts, hits, side="right")
    return np.asarray(hits[np.flatnonzero(np.diff(stretch, prepend=-1))])


def _split_all(chains: _Chains, first: Ints, last: Ints, tolerance: float) -> tuple[Ints, Ints]:
    """Keep the farthest point of each piece that leaves the tolerance; gives the halves with points between."""
    inner = last - first > 1
    first, last = first[inner], last[inner]
    if not len(first):
        return first, last
    farthest, distance = _farthest(chains.points, first, last)
    far = distance > tolerance
    middle = farthest[far]
    chains.kept[middle] = True
    return np.concatenate([first[far], middle]), np.concatenate([middle, last[far]])


def _farthest(points: Floats, first: Ints, last: Ints) -> tuple[Ints, Floats]:
    """The inner point farthest from the straight line between the ends of each piece, and its distance [cells]."""
    lengths = last - first - 1
    starts = np.cumsum(lengths) - lengths
    piece = np.repeat(np.arange(len(first)), lengths)
    index = np.arange(len(piece)) - starts[piece] + first[piece] + 1
    distance = _to_segment(points[index], points[first[piece]], points[last[piece]])
    place = _argmax(distance, starts)
    return index[place], distance[place]


def _to_segment(point: Floats, a: Floats, b: Floats) -> Floats:
    """Distance of each point from the straight piece a b."""
    way, to = b - a, point - a
    square = (way * way).sum(axis=1)
    share = np.clip((way * to).sum(axis=1) / np.where(square == 0, 1.0, square), 0.0, 1.0)
    return np.asarray(np.hypot(*(to - share[:, None] * way).T))


def _keep_apart(chains: _Chains) -> None:
    """Take back points wherever a simplified piece comes too near to another one, until none does."""
    new = np.ones(len(chains.points), dtype=np.bool_)  # by its first point: which pieces were not looked at yet
    for number in range(10 * PATIENCE):
        first, last = chains.ends()
        loose = last - first > 1
        start, end = chains.points[first], chains.points[last]
        one, other = _near_boxes(start, end, *_near_pairs(start, end, loose, new[first]))
        bad = _too_near(start[one], end[one], start[other], end[other])
        wrong = np.unique(np.concatenate([one[bad], other[bad]]))
        wrong = wrong[loose[wrong]]
        if not len(wrong):
            return
        before = chains.kept.copy()
        if number < PATIENCE:
            _split_all(chains, first[wrong], last[wrong], -1.0)
        else:
            _restore(chains, first[wrong], last[wrong])
        new = chains.kept & ~before
        new[first[wrong]] = True


def _restore(chains: _Chains, first: Ints, last: Ints) -> None:
    lengths = last - first
    starts = np.cumsum(lengths) - lengths
    piece = np.repeat(np.arange(len(first)), lengths)
    chains.kept[np.arange(len(piece)) - starts[piece] + first[piece]] = True


def _near_pairs(a: Floats, b: Floats, loose: Bools, fresh: Bools) -> tuple[Ints, Ints]:
    """Pairs of segments, one of them loose and one new, that share a square of the plane; a pair may come twice."""
    keys, segment = _buckets(a, b)
    order = np.lexsort((segment, keys))
    keys, segment = keys[order], segment[order]
    once = np.append(True, (np.diff(keys) != 0) | (np.diff(segment) != 0))
    keys, segment = keys[once], segment[once]
    ones: list[Ints] = []
    others: list[Ints] = []
    step, alive = 1, np.arange(len(keys))
    while len(alive := alive[alive + step < len(keys)]):
        alive = alive[keys[alive] == keys[alive + step]]
        one, other = segment[alive], segment[alive + step]
        wanted = (loose[one] | loose[other]) & (fresh[one] | fresh[other])
        ones.append(one[wanted])
        others.append(other[wanted])
        step += 1
    empty = np.empty(0, dtype=np.int64)
    return np.concatenate([empty, *ones]), np.concatenate([empty, *others])


def _buckets(a: Floats, b: Floats) -> tuple[Ints, Ints]:
    """Keys of the squares that each segment, widened by APART, may touch, and which segment it is."""
    pieces = np.maximum(1, np.ceil(np.hypot(*(b - a).T) / BUCKET)).astype(np.int64)
    segment = np.repeat(np.arange(len(a)), pieces)
    part = np.arange(len(segment)) - (np.cumsum(pieces) - pieces)[segment]
    step = (b - a)[segment] / pieces[segment][:, None]
    start = a[segment] + step * part[:, None]
    low = np.floor((np.minimum(start, start + step) - APART) / BUCKET).astype(np.int64) + 1
    high = np.floor((np.maximum(start, start + step) + APART) / BUCKET).astype(np.int64) + 1
    width = int(high[:, 0].max()) + 2
    corners = [y * width + x for x in (low[:, 0], high[:, 0]) for y in (low[:, 1], high[:, 1])]
    return np.concatenate(corners), np.tile(segment, 4)


def _near_boxes(start: Floats, end: Floats, one: Ints, other: Ints) -> tuple[Ints, Ints]:
    """Only those pairs whose bounding boxes come nearer than APART."""
    low, high = np.minimum(start, end) - APART / 2, np.maximum(start, end) + APART / 2
    near = np.ones(len(one), dtype=np.bool_)
    for axis in (0, 1):
        near &= low[one, axis] <= high[other, axis]
        near &= low[other, axis] <= high[one, axis]
    return one[near], other[near]


def _too_near(a: Floats, b: Floats, c: Floats, d: Floats) -> Bools:
    """Which pairs of segments a b and c d that are no neighbours on a ring cross or come nearer than APART."""
    joined = (a == d).all(axis=1) | (b == c).all(axis=1)
    near = np.minimum(
        np.minimum(_to_segment(a, c, d), _to_segment(b, c, d)), np.minimum(_to_segment(c, a, b), _to_segment(d, a, b))
    )
    crossing = (_turn(a, b, c) * _turn(a, b, d) < 0) & (_turn(c, d, a) * _turn(c, d, b) < 0)
    return np.asarray(~joined & (crossing | (near < APART)))


def _turn(a: Floats, b: Floats, c: Floats) -> Floats:
    way, to = b - a, c - a
    return np.asarray(way[:, 0] * to[:, 1] - way[:, 1] * to[:, 0])
