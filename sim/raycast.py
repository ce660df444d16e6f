"""One caster for every range sensor: rays against the very outlines that collide.

Takes: rays, and a `Scene` of discs, convex polygons and rings at their present poses. Gives: for each ray the distance
to the first thing and which thing that is, or every crossing with its way in and its way out.
Leaves alone: noise, and the robot itself (it is not in the scene).

Method. All outlines are discs and directed edges with the solid on the left. What never moved is kept by cells: an
`_Area` lists what can be met from anywhere in a cell, so that a cast does not look at the rest of the world; what has
moved is a list of its own. Seen from the origin each disc and each edge that shows its front fills an interval of
angles; only the rays in it are tried (a margin makes sure that none is lost, so no cull ever shows in a result).
A ray meets an edge when one end lies on either side of it, ends included; neighbours share the very same corner, so
that no ray slips through. A start on a rim meets the thing at once where the ray leads into it, and not where it leads
away. The distance is a mean of the ends' distances along the ray, weighted by how far they lie
off it: never outside the edge, however flat the ray. A ray that starts inside a thing meets it at distance 0; whether
it does is known from the middle of the cell and the edges between there and the start.

Every distance comes from +, -, *, / and sqrt alone, in a fixed order. So the compiled loops (`sim/raycast_c.py`),
which are taken where there is a C compiler, give the same bits.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from behaviours.interface import Floats, Pose, Vec2
from sim.raycast_c import Loops, loops, order_of

Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]
SLACK = 1e-7  # [rad] by which intervals of angles are wider than need be
MARGIN = 1e-6  # [m] by which areas are wider than need be
TINY = 1e-200
CELLS = 8  # the width of a cell is the reach of its rays over this; a wide cell has so many across
SHIFT = 0.1  # share of a cell by which the place that stands for it may lie off its middle
ATTEMPTS, CLEAR = 40, 1e-9  # to find one that no edge comes so near [m]
MANY = 1000  # discs and edges above this number are sorted out by wide cells first, edges of one thing by the line
KEPT = 64  # areas that are remembered; the oldest goes first
FEW = 64  # moving things up to this number are not sorted out by distance


# --- outlines -------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Circle:
    """A disc round the origin of its body: radius [m]."""

    radius: float


@dataclass(frozen=True, slots=True)
class Polygon:
    """A convex polygon: corners [m] in the body frame, counter-clockwise."""

    vertices: tuple[Vec2, ...]


@dataclass(frozen=True, slots=True)
class Rings:
    """Closed rings of corners [m] in the body frame, the solid on the left: outer ones turn left, holes turn right.

    For what never moves, such as the walls of a map; need not be convex.
    """

    rings: tuple[tuple[Vec2, ...], ...]


Outline = Circle | Polygon | Rings


def box(length: float, width: float) -> Polygon:
    """The rectangle round the origin, `length` along x and `width` along y [m]."""
    x, y = length / 2, width / 2
    return Polygon(((-x, -y), (x, -y), (x, y), (-x, y)))


def reach(outline: Outline) -> float:
    """Radius [m] of the circle round the origin of the body that encloses the outline."""
    match outline:
        case Circle(radius):
            return radius
        case Polygon(vertices):
            return max(math.hypot(x, y) for x, y in vertices)
        case Rings(rings):
            return max(math.hypot(x, y) for ring in rings for x, y in ring)


def _edges(outline: Outline) -> Floats:
    """(4, n): from (ax, ay) to (bx, by), in the body frame."""
    match outline:
        case Circle():
            rings: tuple[tuple[Vec2, ...], ...] = ()
        case Polygon(vertices):
            rings = (vertices,)
        case Rings():
            rings = outline.rings
    corners = [np.array(ring, dtype=float).reshape(-1, 2).T for ring in rings]
    return np.hstack([np.zeros((4, 0)), *(np.vstack([ring, np.roll(ring, -1, axis=1)]) for ring in corners)])


# --- rays -----------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Rays:
    """Where rays start [m], where they point [rad, world], and how high above the ground they run [m]; each (n,)."""

    x: Floats
    y: Floats
    angle: Floats
    height: Floats


def ray(start: Vec2, angle: float, height: float = 0.0) -> Rays:
    """One ray."""
    return Rays(*(np.array([number]) for number in (start[0], start[1], angle, height)))


class Fan:
    """Rays from one origin, made once for a sensor.

    bearings: (n,) [rad] in the frame of the sensor, rising, over a full turn at most; evenly spaced or not. Raises
    ValueError where they are not.
    """

    def __init__(self, bearings: Floats) -> None:
        self.bearings = np.array(bearings, dtype=float)
        rising = self.bearings.ndim == 1 and bool((np.diff(self.bearings) > 0).all())
        if not rising or not self.bearings.size or not np.ptp(self.bearings) <= math.tau + SLACK:
            raise ValueError("bearings of a fan must be finite and rise, over a full turn at most")
        self.bearings.setflags(write=False)
        self.first = float(self.bearings[0])
        self.cos, self.sin = np.cos(self.bearings), np.sin(self.bearings)
        self.turned = np.concatenate([self.bearings - self.first, self.bearings - self.first + math.tau])

        self._struct: tuple[Any, Any] | None = None

    def struct(self, compiled: Loops) -> Any:
        """The fan as the compiled loops want it."""
        if self._struct is None:
            order, before = order_of(self.cos, self.sin)
            arrays = {"cos": self.cos, "sin": self.sin, "order": order, "before": before}
            self._struct = compiled.struct("fan", {"count": self.bearings.size}, arrays)
        return self._struct[0]

    def directions(self, theta: float) -> tuple[Floats, Floats]:
        """Unit vectors of the rays when the sensor looks along `theta` [rad, world]."""
        c, s = math.cos(theta), math.sin(theta)
        return self.cos * c - self.sin * s, self.sin * c + self.cos * s


@dataclass(frozen=True, slots=True)
class Crossings:
    """Pairs of a ray and a thing on it, in the order of the things: distances [m] of the way in and the way out.

    A ray may enter and leave one thing of rings several times: a pair for each.
    """

    ray: Ints
    thing: Ints
    enter: Floats
    exit: Floats


# --- the scene ------------------------------------------------------------------------------------


class Scene:
    """The outlines of things at their present poses, laid out for casting.

    x, y [m], radius [m, that encloses], height [m]: of each thing. edges: (4, e) [m, world], edge_thing: (e,).
    loops: gives the compiled loops, or None to do without; no result depends on it. One thread at a time.
    """

    def __init__(
        self,
        outlines: Sequence[Outline],
        poses: Sequence[Pose],
        heights: Sequence[float],
        loops: Callable[[], Loops | None] = loops,
    ) -> None:
        if not len(outlines) == len(poses) == len(heights):
            raise ValueError(f"{len(outlines)} outlines, {len(poses)} poses and {len(heights)} heights make no scene")
        own = [_edges(outline) for outline in outlines]
        counts = [edges.shape[1] for edges in own]
        self.x = np.array([pose.x for pose in poses], dtype=float)
        self.y = np.array([pose.y for pose in poses], dtype=float)
        self.height = np.array(heights, dtype=float)
        self.round = np.array([isinstance(outline, Circle) for outline in outlines], dtype=bool)
        self.radius = np.array([reach(outline) for outline in outlines], dtype=float)
        self._own = np.hstack([np.zeros((4, 0)), *own])
        self.edge_thing = np.repeat(np.arange(len(own)), counts)
        self.first_edge = np.concatenate([[0], np.cumsum(counts, dtype=np.intp)])
        turn = np.array([(math.cos(pose.theta), math.sin(pose.theta)) for pose in poses]).reshape(-1, 2)
        self.edges = _moved(self._own, *(column[self.edge_thing] for column in (self.x, self.y, *turn.T)))
        self._theta = [pose.theta for pose in poses]
        self._bounds = self.first_edge.tolist()
        self.moving = np.zeros(len(own), dtype=bool)
        self.version, self._settled = 0, True
        self.compiled = loops()
        self.struct = None if self.compiled is None else self.compiled.struct("scene", {}, self._arrays())
        self._settle()

    def _arrays(self) -> dict[str, NDArray[Any]]:
        """What the compiled loops look into; written in place ever after."""
        edges = dict(zip(("ax", "ay", "bx", "by"), self.edges, strict=True))
        edges |= dict(zip(("own_ax", "own_ay", "own_bx", "own_by"), self._own, strict=True))
        things = {"x": self.x, "y": self.y, "radius": self.radius, "height": self.height}
        return things | edges | {"edge_thing": self.edge_thing}

    def place(self, index: int, pose: Pose) -> None:
        """Put thing `index` at a new pose."""
        x, y, theta = pose.x, pose.y, pose.theta
        if x == self.x[index] and y == self.y[index] and theta == self._theta[index]:
            return
        self.x[index], self.y[index], self._theta[index] = x, y, theta
        if not self.round[index]:
            self._place_edges(self._bounds[index], self._bounds[index + 1], x, y, math.cos(theta), math.sin(theta))
        self.version += 1
        if not self.moving[index]:
            self.moving[index], self._settled = True, False

    def _place_edges(self, first: int, last: int, x: float, y: float, c: float, s: float) -> None:
        if self.compiled is not None and self.struct is not None:
            self.compiled.place(self.struct[0], first, last, x, y, c, s)
        else:
            self.edges[:, first:last] = _moved(self._own[:, first:last], x, y, c, s)

    def _settle(self) -> None:
        """Sort what moves from what never did; forget the areas."""
        self._settled = True
        self.moving_discs = np.flatnonzero(self.moving & self.round)
        self.moving_edges = np.flatnonzero(self.moving[self.edge_thing])
        self._many = self.round.size + self.edge_thing.size > MANY
        self._areas: dict[_Cell, _Area] = {}

    def area(self, x: float, y: float, max_range: float, height: float, spread: float = 0.0) -> _Area:
        """What rays can meet that start within `spread` [m] of a place and run higher than `height` [m]."""
        if not self._settled:
            self._settle()
        extent = max(math.ceil(max_range), 1.0)  # so that few areas do for many ranges
        size = (extent + spread) / CELLS
        cell = _Cell(math.floor(x / size), math.floor(y / size), size, extent, height, spread)
        return self._areas.get(cell) or self._made(cell)

    def _made(self, cell: _Cell) -> _Area:
        return self._kept(cell, self._kept(cell.around(), None) if self._many else None)

    def _kept(self, cell: _Cell, wide: _Area | None) -> _Area:
        area = self._areas.get(cell)
        if area is None:
            if len(self._areas) >= KEPT:
                del self._areas[next(iter(self._areas))]
            area = self._areas[cell] = _Area(self, cell, wide)
        return area

    def still_within(self, x: float, y: float, distance: float, height: float) -> tuple[Ints, Ints]:
        """Discs that never moved, higher than `height` [m] and so near, and all edges of such things."""
        to_x, to_y, far = self.x - x, self.y - y, self.radius + (distance + MARGIN)
        things = np.flatnonzero((to_x * to_x + to_y * to_y <= far * far) & (self.height > height) & ~self.moving)
        discs, flat = things[self.round[things]], things[~self.round[things]]
        first = self.first_edge[flat]
        return discs, _pairs(first, self.first_edge[flat + 1] - first)[1]


def _moved(edges: Floats, x: Floats | float, y: Floats | float, c: Floats | float, s: Floats | float) -> Floats:
    """Edges from the body frame to the world. The same corner gives the same bits, whichever edge it ends."""
    ax, ay, bx, by = edges
    return np.array([x + (c * ax - s * ay), y + (s * ax + c * ay), x + (c * bx - s * by), y + (s * bx + c * by)])


class _Cell(NamedTuple):
    """A square of the plane, column and row of `size` [m], and the rays that start in it, or within `spread` of it."""

    column: int
    row: int
    size: float
    extent: float
    height: float
    spread: float

    def around(self) -> _Cell:
        """The wider cell that holds this one."""
        return self._replace(column=self.column // CELLS, row=self.row // CELLS, size=self.size * CELLS)


class _Area:
    """What rays from a cell can meet: indices of discs (things) and of edges. wide: that of the wider cell, if made.

    Also whether the middle of the cell lies inside a thing, and the edges that stand between it and a start.
    """

    still_discs: Ints
    still_edges: Ints
    doubtful: Ints

    def __init__(self, scene: Scene, cell: _Cell, wide: _Area | None) -> None:
        self.scene = scene
        margin = cell.size * (math.sqrt(0.5) + SHIFT) + cell.spread + MARGIN
        self._reach = cell.extent + margin
        middle = (cell.column + 0.5) * cell.size, (cell.row + 0.5) * cell.size
        if wide is None:
            discs, edges = scene.still_within(*middle, self._reach + SHIFT * cell.size, cell.height)
        else:
            discs, edges = wide.still_discs, wide.still_edges
        self.x, self.y, away = _off_edges(scene.edges[:, edges], *middle, SHIFT * cell.size)
        x, y = self.x, self.y
        self.still_discs = discs[np.hypot(scene.x[discs] - x, scene.y[discs] - y) <= self._reach + scene.radius[discs]]
        self.still_edges = edges[away <= self._reach]
        self.near = edges[away <= margin]
        if wide is None:
            self._inside_of = _wound(scene, edges, x, y)
        else:
            self._inside_of = wide.doubtful[wide.winding(np.array([x]), np.array([y]))[0] > 0]
        self._watch(scene)
        self.moving_discs = scene.moving_discs[scene.height[scene.moving_discs] > cell.height]
        self.moving_edges = scene.moving_edges[scene.height[scene.edge_thing[scene.moving_edges]] > cell.height]
        self._version = -1
        self.struct = None if scene.compiled is None else scene.compiled.struct("area", *self._fields())

    def _fields(self) -> tuple[dict[str, float | int], dict[str, NDArray[Any]]]:
        """What the compiled loops want of it: numbers and arrays."""
        lists = {
            "still_disc": self.still_discs,
            "moving_disc": self.moving_discs,
            "still_edge": self.still_edges,
            "moving_edge": self.moving_edges,
        }
        counts = {f"{name}_count": some.size for name, some in lists.items()}
        numbers = {"x": self.x, "y": self.y, "near_count": self.near.size, "doubtful_count": self.doubtful.size}
        watch = {"near": self.near, "doubtful": self.doubtful, "column": self._column, "wound": self.wound}
        more = {"left": self._left, "winding": np.zeros_like(self.wound)}
        return counts | numbers, {f"{name}s": some for name, some in lists.items()} | watch | more

    def _watch(self, scene: Scene) -> None:
        """Things that a start in the cell may lie inside of, and how often each winds round the middle."""
        of = scene.edge_thing[self.near]
        self.doubtful = np.union1d(of, self._inside_of).astype(np.intp)
        self.wound = np.isin(self.doubtful, self._inside_of).astype(np.intp)
        self._column = np.searchsorted(self.doubtful, of)
        ax, ay, bx, by = scene.edges[:, self.near]
        self._left = (ax - self.x) * (by - self.y) - (bx - self.x) * (ay - self.y) > 0

    def gather(self) -> None:
        """Bring `discs` (3, n: x, y, radius), `edges` (4, n) and which things they are up to the scene's present."""
        scene = self.scene
        if self._version == scene.version:
            return
        self._version = scene.version
        discs, edges = self.moving_discs, self.moving_edges
        if discs.size > FEW:
            discs = discs[
                np.hypot(scene.x[discs] - self.x, scene.y[discs] - self.y) <= self._reach + scene.radius[discs]
            ]
        if edges.size > FEW:
            edges = edges[_distance(scene.edges[:, edges], self.x, self.y) <= self._reach]
        self.disc_thing = np.concatenate([self.still_discs, discs])
        some = np.concatenate([self.still_edges, edges])
        self.edge_thing = scene.edge_thing[some]
        self.discs = np.array([column[self.disc_thing] for column in (scene.x, scene.y, scene.radius)])
        self.edges = scene.edges[:, some]

    def inside(self, x: Floats, y: Floats) -> tuple[Ints, Ints]:
        """Pairs of a start and a thing of edges that it lies inside of; all starts in the cell."""
        which, column = np.nonzero(self.winding(x, y) > 0)
        thing = self.doubtful[column]
        if self.moving_edges.size:
            more = [(k, t) for k in range(x.size) for t in _wound(self.scene, self.moving_edges, x[k], y[k])]
            which = np.concatenate([which, np.array([k for k, _ in more], dtype=np.intp)])
            thing = np.concatenate([thing, np.array([t for _, t in more], dtype=np.intp)])
        return which, thing

    def winding(self, x: Floats, y: Floats) -> Ints:
        """(starts, doubtful things): what the edges add that lie between the middle of the cell and the start."""
        wound = np.repeat(self.wound[None], x.size, axis=0)
        if not self.near.size:
            return wound
        ax, ay, bx, by = self.scene.edges[:, self.near]
        x, y = x[:, None], y[:, None]
        left = (ax - x) * (by - y) - (bx - x) * (ay - y) > 0
        ux, uy = x - self.x, y - self.y
        apart = (ux * (ay - self.y) - uy * (ax - self.x) >= 0) != (ux * (by - self.y) - uy * (bx - self.x) >= 0)
        start, edge = np.nonzero(apart & (left != self._left))
        np.add.at(wound, (start, self._column[edge]), np.where(left[start, edge], 1, -1))
        return wound


def _distance(edges: Floats, x: float, y: float) -> Floats:
    """From a place to each edge [m]."""
    ax, ay, bx, by = edges
    ex, ey = bx - ax, by - ay
    along = ((x - ax) * ex + (y - ay) * ey) / (ex * ex + ey * ey + TINY)
    along = np.clip(along, 0.0, 1.0)
    away: Floats = np.hypot(ax + along * ex - x, ay + along * ey - y)
    return away


def _off_edges(edges: Floats, x: float, y: float, shift: float) -> tuple[float, float, Floats]:
    """A place near (x, y) that lies on no edge, so that its side of each is beyond doubt; its distance to each [m]."""
    for attempt in range(ATTEMPTS):
        turn, way = attempt * 2.4, shift * attempt / ATTEMPTS
        at_x, at_y = x + way * math.cos(turn), y + way * math.sin(turn)
        away = _distance(edges, at_x, at_y)
        if not away.size or away.min() > CLEAR:
            break
    return at_x, at_y, away


def _wound(scene: Scene, edges: Ints, x: float, y: float) -> Ints:
    """Things among these edges (all edges of a thing, or none) in whose solid a place lies, rims left out."""
    ax, ay, bx, by = scene.edges[:, edges]
    side = (ax - x) * (by - y) - (bx - x) * (ay - y)
    level = (ay <= y) != (by <= y)
    turn = np.where(level & (ay <= y) & (side > 0), 1, np.where(level & (ay > y) & (side < 0), -1, 0))
    some = np.flatnonzero(turn)
    of, place = np.unique(scene.edge_thing[edges[some]], return_inverse=True)
    winding = np.zeros(of.size, dtype=np.intp)
    np.add.at(winding, place, turn[some])
    on = (side == 0) & (np.minimum(ax, bx) <= x) & (x <= np.maximum(ax, bx))
    on &= (np.minimum(ay, by) <= y) & (y <= np.maximum(ay, by))
    return of[(winding > 0) & ~np.isin(of, scene.edge_thing[edges[on]])]


# --- one ray, one shape ---------------------------------------------------------------------------


def _to_discs(dx: Floats, dy: Floats, x: Floats, y: Floats, radius: Floats) -> tuple[Floats, Floats]:
    """Distances along rays into and out of discs at (x, y) off their starts; inf, -inf: they pass by or lead away."""
    along, across = dx * x + dy * y, np.abs(dx * y - dy * x)
    square = (radius - across) * (radius + across)
    half = np.sqrt(np.where(square >= 0, square, 0.0))
    met = (across <= radius) & ((along > 0) | (x * x + y * y < radius * radius))
    return np.where(met, along - half, np.inf), np.where(met, along + half, -np.inf)


def _to_edges(dx: Floats, dy: Floats, ax: Floats, ay: Floats, bx: Floats, by: Floats) -> Floats:
    """Distances along rays to edges from (ax, ay) to (bx, by) off their starts, seen from the front; inf: passes by."""
    a, b = dx * ay - dy * ax, dx * by - dy * bx
    met = (a >= 0) & (b <= 0) & (a > b)
    at = _between(a, b, dx * ax + dy * ay, dx * bx + dy * by, met)
    return np.where(met, np.where(at > 0, at, 0.0), np.inf)


def _between(a: Floats, b: Floats, along_a: Floats, along_b: Floats, met: Bools) -> Floats:
    return along_a + (along_b - along_a) * (a / np.where(met, a - b, 1.0))


def _pairs(first: Ints, number: Ints) -> tuple[Ints, Ints]:
    """For runs of `number` from `first`: which run, and the place."""
    ends = np.cumsum(number)
    which = np.repeat(np.arange(number.size), number)
    return which, np.arange(which.size) + np.repeat(first - (ends - number), number)


# --- rays from one origin -------------------------------------------------------------------------


def sweep(fan: Fan, pose: Pose, height: float, max_range: float, scene: Scene) -> Floats:
    """Distance [m] to the first thing along each ray of a fan at a pose [m, rad; world], `height` [m] above ground."""
    return _sweep(fan, pose, max_range, scene.area(pose.x, pose.y, max_range, height), False)[0]


def sweep_things(fan: Fan, pose: Pose, height: float, max_range: float, scene: Scene) -> tuple[Floats, Ints]:
    """As `sweep`, and the index of the thing that each ray meets first (-1 if none)."""
    return _sweep(fan, pose, max_range, scene.area(pose.x, pose.y, max_range, height), True)


def _sweep(fan: Fan, pose: Pose, max_range: float, area: _Area, named: bool) -> tuple[Floats, Ints]:
    compiled, scene = area.scene.compiled, area.scene.struct
    if compiled is None or scene is None or area.struct is None:
        return _sweep_arrays(fan, pose, max_range, area, named)
    at = pose.x, pose.y, math.cos(pose.theta), math.sin(pose.theta)
    return compiled.sweep(scene[0], area.struct[0], fan.struct(compiled), at, max_range, fan.bearings.size)


def _sweep_arrays(fan: Fan, pose: Pose, max_range: float, area: _Area, named: bool) -> tuple[Floats, Ints]:
    """Without a compiler; things only where `named`."""
    area.gather()
    count = fan.bearings.size
    first, number, front = _fan_intervals(fan, pose, area)
    which, place = _pairs(first, number)
    beam = np.where(place < count, place, place - count)
    at, thing = _fan_hits(fan, pose, area, front, which, beam)
    if area.doubtful.size or area.moving_edges.size:
        _, inside = area.inside(np.array([pose.x]), np.array([pose.y]))
        if inside.size:
            beam, at = np.concatenate([beam, np.arange(count)]), np.concatenate([at, np.zeros(count)])
            thing = np.concatenate([thing, np.full(count, inside.min())])
    ranges = np.full(count, max_range)
    np.minimum.at(ranges, beam, at)
    return ranges, _first_things(ranges, beam, at, thing) if named else thing


def _first_things(ranges: Floats, beam: Ints, at: Floats, thing: Ints) -> Ints:
    """The things at these ranges; of several the first, -1 for none."""
    things = np.full(ranges.shape, np.iinfo(np.intp).max, dtype=np.intp)
    met = np.flatnonzero(at == ranges[beam])
    np.minimum.at(things, beam[met], thing[met])
    return np.where(things == np.iinfo(np.intp).max, -1, things)


def _fan_intervals(fan: Fan, pose: Pose, area: _Area) -> tuple[Ints, Ints, Ints]:
    """First ray (of two turns) and number of rays for each disc and for each edge that shows its front; these edges."""
    x, y, radius = area.discs[0] - pose.x, area.discs[1] - pose.y, area.discs[2]
    half = _half_angle(np.hypot(x, y), radius)
    ends_x, ends_y = area.edges[::2] - pose.x, area.edges[1::2] - pose.y
    side = ends_x[0] * ends_y[1] - ends_x[1] * ends_y[0]
    front = np.flatnonzero(side <= 0)
    angle = np.arctan2(ends_y[:, front], ends_x[:, front])
    low = np.concatenate([np.arctan2(y, x) - half, angle[1]])
    wide = np.concatenate([2 * half, np.mod(angle[0] - angle[1], math.tau)])
    wide[half.size :][side[front] == 0] = math.tau
    low = np.mod(low - (pose.theta + fan.first + SLACK), math.tau)
    first = np.searchsorted(fan.turned, low)
    last = np.searchsorted(fan.turned, low + (wide + 2 * SLACK), side="right")
    return first, np.minimum(last - first, fan.bearings.size), front


def _half_angle(distance: Floats, radius: Floats) -> Floats:
    """Half the angle [rad] that discs fill; all round for a start inside."""
    half = np.arcsin(np.minimum(radius / (distance + TINY), 1.0))
    return np.where(distance <= radius, math.pi, half)


def _fan_hits(fan: Fan, pose: Pose, area: _Area, front: Ints, which: Ints, beam: Ints) -> tuple[Floats, Ints]:
    """Distance and thing for each pair; inf where the ray passes by."""
    dx, dy = fan.directions(pose.theta)
    dx, dy = dx[beam], dy[beam]
    rounds = area.disc_thing.size
    split = int(np.searchsorted(which, rounds))
    disc, edge = which[:split], front[which[split:] - rounds]
    x, y, radius = area.discs[:, disc]
    enter, _ = _to_discs(dx[:split], dy[:split], x - pose.x, y - pose.y, radius)
    enter = np.where(enter > 0, enter, 0.0)
    ax, ay, bx, by = area.edges[:, edge]
    at = _to_edges(dx[split:], dy[split:], ax - pose.x, ay - pose.y, bx - pose.x, by - pose.y)
    return np.concatenate([enter, at]), np.concatenate([area.disc_thing[disc], area.edge_thing[edge]])


# --- any rays -------------------------------------------------------------------------------------


def cast(rays: Rays, max_range: float, scene: Scene) -> tuple[Floats, Ints]:
    """Distance [m] to the first thing along each ray (`max_range` if there is none) and its index (-1 if none)."""
    _check(rays)
    if not rays.x.size:
        return np.zeros(0), np.zeros(0, dtype=np.intp)
    x, y, spread = _middle(rays)
    area = scene.area(x, y, max_range, -math.inf, spread)
    if scene.compiled is None or scene.struct is None or area.struct is None:
        return _cast_arrays(rays, (x, y, spread), max_range, area)
    numbers = {"count": rays.x.size, "middle_x": x, "middle_y": y, "spread": spread}
    arrays = {"x": rays.x, "y": rays.y, "dx": np.cos(rays.angle), "dy": np.sin(rays.angle), "height": rays.height}
    arrays = {name: np.ascontiguousarray(array, dtype=float) for name, array in arrays.items()}
    struct, _kept = scene.compiled.struct("rays", numbers, arrays)
    return scene.compiled.cast(scene.struct[0], area.struct[0], struct, max_range, rays.x.size)


def _cast_arrays(rays: Rays, middle: tuple[float, float, float], max_range: float, area: _Area) -> tuple[Floats, Ints]:
    """Without a compiler."""
    area.gather()
    ray, at, thing = _any_hits(rays, *middle, area)
    if area.doubtful.size or area.moving_edges.size:
        start, inside = area.inside(rays.x, rays.y)
        ray, at = np.concatenate([ray, start]), np.concatenate([at, np.zeros(start.size)])
        thing = np.concatenate([thing, inside])
    high = rays.height[ray] < area.scene.height[thing]
    ray, at, thing = ray[high], at[high], thing[high]
    ranges = np.full(rays.x.shape, max_range)
    np.minimum.at(ranges, ray, at)
    return ranges, _first_things(ranges, ray, at, thing)


def _check(rays: Rays) -> None:
    if not (rays.x.size,) == rays.x.shape == rays.y.shape == rays.angle.shape == rays.height.shape:
        raise ValueError("x, y, angle and height of rays must be of one length")


def _middle(rays: Rays) -> tuple[float, float, float]:
    """Amid the starts, and how far they lie from there at most, rounded up [m]."""
    x, y = float(rays.x.sum() / rays.x.size), float(rays.y.sum() / rays.y.size)
    spread = math.sqrt(float(((rays.x - x) ** 2 + (rays.y - y) ** 2).max()))
    return x, y, math.ceil(spread * 4) / 4


def _any_hits(rays: Rays, x: float, y: float, spread: float, area: _Area) -> tuple[Ints, Floats, Ints]:
    """Ray, distance and thing for each pair that angles do not rule out; inf where the ray passes by."""
    ax, ay, bx, by = area.edges
    item_x = np.concatenate([area.discs[0], (ax + bx) / 2]) - x
    item_y = np.concatenate([area.discs[1], (ay + by) / 2]) - y
    size = np.concatenate([area.discs[2], np.hypot(bx - ax, by - ay) / 2]) + (spread + MARGIN)
    which, ray = _candidates(rays, item_x, item_y, size)
    dx, dy = np.cos(rays.angle)[ray], np.sin(rays.angle)[ray]
    split = int(np.searchsorted(which, area.disc_thing.size))
    disc, edge = which[:split], which[split:] - area.disc_thing.size
    start_x, start_y = rays.x[ray], rays.y[ray]
    to_x, to_y, radius = area.discs[:, disc]
    enter, _ = _to_discs(dx[:split], dy[:split], to_x - start_x[:split], to_y - start_y[:split], radius)
    enter = np.where(enter > 0, enter, 0.0)
    start_x, start_y = start_x[split:], start_y[split:]
    ax, ay, bx, by = area.edges[:, edge]
    ax, ay, bx, by = ax - start_x, ay - start_y, bx - start_x, by - start_y
    at = np.where(ax * by - bx * ay <= 0, _to_edges(dx[split:], dy[split:], ax, ay, bx, by), np.inf)
    return ray, np.concatenate([enter, at]), np.concatenate([area.disc_thing[disc], area.edge_thing[edge]])


def _candidates(rays: Rays, x: Floats, y: Floats, size: Floats) -> tuple[Ints, Ints]:
    """Pairs of an item at (x, y) from the middle of all starts and a ray that its angle does not rule out."""
    half = _half_angle(np.hypot(x, y), size) + SLACK
    low = np.mod(np.arctan2(y, x) - half, math.tau)
    angle = np.mod(rays.angle, math.tau)
    order = np.argsort(angle, kind="stable")
    angle = np.concatenate([angle[order], angle[order] + math.tau, angle[order] + 2 * math.tau])
    first = np.searchsorted(angle, low)
    last = np.searchsorted(angle, low + 2 * half, side="right")
    which, place = _pairs(first, np.minimum(last - first, order.size))
    return which, order[place % order.size]


def crossings(rays: Rays, max_range: float, scene: Scene) -> Crossings:
    """Every way through a thing, higher than the ray runs, that a ray begins within `max_range` [m]."""
    _check(rays)
    ray, thing = _ways(rays, max_range, scene)
    dx, dy = np.cos(rays.angle)[ray], np.sin(rays.angle)[ray]
    disc = scene.round[thing]
    to_x, to_y = scene.x[thing[disc]] - rays.x[ray[disc]], scene.y[thing[disc]] - rays.y[ray[disc]]
    enter, leave = _to_discs(dx[disc], dy[disc], to_x, to_y, scene.radius[thing[disc]])
    through = _through(rays, ray[~disc], thing[~disc], dx[~disc], dy[~disc], scene)
    ray, thing = np.concatenate([ray[disc], through.ray]), np.concatenate([thing[disc], through.thing])
    enter, leave = np.concatenate([enter, through.enter]), np.concatenate([leave, through.exit])
    order = np.lexsort((enter, ray, thing))
    order = order[(enter[order] <= leave[order]) & (leave[order] > 0) & (enter[order] <= max_range)]
    return Crossings(ray[order], thing[order], np.where(enter > 0, enter, 0.0)[order], leave[order])


def _ways(rays: Rays, max_range: float, scene: Scene) -> tuple[Ints, Ints]:
    """Pairs of a ray and a thing, higher than it runs, whose enclosing circles are in reach."""
    if not rays.x.size:
        return np.zeros(0, dtype=np.intp), np.zeros(0, dtype=np.intp)
    x, y, spread = _middle(rays)
    to_x, to_y, size = scene.x - x, scene.y - y, scene.radius + (spread + MARGIN)
    some = np.flatnonzero(np.hypot(to_x, to_y) <= max_range + size)
    which, ray = _candidates(rays, to_x[some], to_y[some], size[some])
    thing = some[which]
    high = rays.height[ray] < scene.height[thing]
    return ray[high], thing[high]


def _through(rays: Rays, ray: Ints, thing: Ints, dx: Floats, dy: Floats, scene: Scene) -> Crossings:
    """Ways through things of edges, those behind the start among them: on a line as many lead in as out."""
    which, edge = _crossed(rays.x[ray], rays.y[ray], thing, dx, dy, scene)
    ray, thing, dx, dy = ray[which], thing[which], dx[which], dy[which]
    x, y = rays.x[ray], rays.y[ray]
    ax, ay, bx, by = scene.edges[:, edge]
    ax, ay, bx, by = ax - x, ay - y, bx - x, by - y
    a, b = dx * ay - dy * ax, dx * by - dy * bx
    met = (a >= 0) != (b >= 0)
    at = _between(a, b, dx * ax + dy * ay, dx * bx + dy * by, met)[met]
    into, ray, thing = a[met] >= 0, ray[met], thing[met]
    order = np.lexsort((at, ray, thing))
    ways_in, ways_out = order[into[order]], order[~into[order]]
    return Crossings(ray[ways_in], thing[ways_in], at[ways_in], at[ways_out])


def _crossed(x: Floats, y: Floats, thing: Ints, dx: Floats, dy: Floats, scene: Scene) -> tuple[Ints, Ints]:
    """Pairs of a line, given with its thing, and an edge of that it may cross; of many edges, only those crossed."""
    first, last = scene.first_edge[thing], scene.first_edge[thing + 1]
    many = np.flatnonzero(last - first > MANY)
    number = last - first
    number[many] = 0
    which, edge = _pairs(first, number)
    for k in many.tolist():
        ax, ay, bx, by = scene.edges[:, first[k] : last[k]]
        left_a = dx[k] * (ay - y[k]) - dy[k] * (ax - x[k]) >= 0
        left_b = dx[k] * (by - y[k]) - dy[k] * (bx - x[k]) >= 0
        found = first[k] + np.flatnonzero(left_a != left_b)
        which, edge = np.concatenate([which, np.full(found.size, k)]), np.concatenate([edge, found])
    return which, edge
