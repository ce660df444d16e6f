"""Stage worlds (`.world`): floor plans from bitmaps, models of blocks, and a robot with its rangers.

Takes: the file, with what it includes. Gives: `Imported`. Leaves alone: controllers, colours, windows, blobs, fiducials
and grippers; the text of the file (`stage_text.py`).

The first position model that carries a ranger is the robot, unless another one is asked for; the other ones stand
where they are. A robot of a type that is nowhere defined is a round one of 0.18 m that drives differentially. As in
Stage the pixels (or blocks) of a model are stretched so that together they fill its size, and `boundary` puts walls
round them. A sensor of one sample is a lidar of one beam.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from behaviours.interface import Pose, Vec2
from sim.scenarios.grid import Bools, GridError, Ring, trace
from sim.scenarios.importers import stage_text
from sim.scenarios.importers.chart import roomiest, tolerated
from sim.scenarios.importers.imported import (
    MOST_METRES,
    Document,
    Imported,
    Options,
    WorldFileError,
    box_round,
    enclosed,
    metres,
    place,
    printable,
    radians,
    ring_texts,
    shown,
)
from sim.scenarios.importers.ros_map import dark
from sim.scenarios.importers.stage_text import Entity

STANDARD_SIZE = (0.1, 0.1, 0.1)
BOUNDARY = 0.01  # [m] thickness of the walls that `boundary` puts up
UNKNOWN_RADIUS = 0.18  # [m] of robots whose type is nowhere defined
MOST_MODELS = 5000
LEAST_SIZE = 0.001  # [m] of a model and of a pixel
SHAPES = {"model", "position"}
SILENT = {"window", "speech", "power"}
NO_MODEL = {"block", "sensor", "ranger", "laser"}
SENSES = {"blobfinder", "fiducial", "gripper", "bumper", "camera", "actuator", "wifi", "indicator", "lightindicator"}
STEERED = "car"


def read(path: Path, options: Options) -> Imported:
    """The world in the file. Raises WorldFileError."""
    world = stage_text.read(path)
    _check_units(world, path.name)
    solids = [model for model in _models(world) if model.entity.kind in SHAPES or model.is_robot]
    robot = _chosen(solids, options.robot, path.name)
    things = [thing for model in solids if model is not robot for thing in _things(model, world)]
    if not things and robot is None:
        raise WorldFileError(path.name, 0, "nothing stands in this world: it defines models but places none")
    start = options.start or (_at(robot.pose) if robot else _free_start(solids, world))
    body = _robot(robot.entity) if robot else {"model": options.model}
    document = {
        "name": path.stem,
        "bounds": _bounds(solids, start),
        "robot": body | {"start": place(start), "heading": radians(start[2])},
        "things": _named(things),
    }
    return Imported(document, tuple(_left_out(world, solids, robot)))


# --- models where they are ----------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _Model:
    """A model of the world at its pose."""

    entity: Entity
    pose: Pose

    @property
    def is_robot(self) -> bool:
        return self.entity.kind == "position" or self.is_unknown_robot

    @property
    def is_unknown_robot(self) -> bool:
        """Of a type that is nowhere defined, but with a controller."""
        known = SHAPES | NO_MODEL | SILENT | SENSES
        return self.entity.kind not in known and "ctrl" in self.entity.properties

    @property
    def name(self) -> str:
        name = self.entity.properties.get("name", "")
        return printable(name, 80) if isinstance(name, str) else ""


def _models(world: stage_text.World) -> list[_Model]:
    """All models, those that stand on others after them. Raises WorldFileError where they are too many."""
    found: list[_Model] = []
    waiting = [_Model(entity, _pose(entity)) for entity in reversed(world.entities)]
    while waiting:
        model = waiting.pop()
        found.append(model)
        if len(found) > MOST_MODELS:
            raise model.entity.fault(f"the world has more than {MOST_MODELS:,} models")
        if model.entity.kind in SHAPES and not model.is_robot:
            parts = [part for part in model.entity.parts if part.kind not in NO_MODEL]
            waiting += [_Model(part, _on(model.pose, _pose(part))) for part in reversed(parts)]
    return found


def _pose(entity: Entity) -> Pose:
    x, y, _, degrees = _numbers(entity, "pose", (0.0, 0.0, 0.0, 0.0))
    return Pose(x, y, math.radians(degrees))


def _on(base: Pose, pose: Pose) -> Pose:
    c, s = math.cos(base.theta), math.sin(base.theta)
    x, y = base.x + c * pose.x - s * pose.y, base.y + s * pose.x + c * pose.y
    return Pose(x, y, base.theta + pose.theta)


def _at(pose: Pose) -> tuple[float, float, float]:
    return pose.x, pose.y, pose.theta


def _numbers(entity: Entity, key: str, default: tuple[float, ...]) -> tuple[float, ...]:
    """The numbers of a property; those that it does not give are as in the default."""
    value = entity.properties.get(key)
    if value is None:
        return default
    given = [_number(entity, key, text) for text in ((value,) if isinstance(value, str) else value)]
    return (*given[: len(default)], *default[len(given) :])


def _number(entity: Entity, key: str, text: str) -> float:
    try:
        number = float(text)
    except ValueError:
        number = math.nan
    if not abs(number) <= MOST_METRES:
        raise entity.fault(f"{key}: expected a number up to {MOST_METRES:g}, got {shown(text)}")
    return number


def _single(entity: Entity, key: str, default: float) -> float:
    return _numbers(entity, key, (default,))[0]


def _size(entity: Entity) -> tuple[float, float, float]:
    length, width, height = _numbers(entity, "size", STANDARD_SIZE)
    if min(length, width) < LEAST_SIZE:
        raise entity.fault(f"size: expected lengths from {LEAST_SIZE:g} m on, got {length:g} and {width:g}")
    return length, width, height if height > 0 else STANDARD_SIZE[2]


def _check_units(world: stage_text.World, file: str) -> None:
    for key, known in (("unit_length", ("m",)), ("unit_angle", ("deg", "degrees"))):
        value = world.properties.get(key, known[0])
        if value not in known:
            raise WorldFileError(file, 0, f"{key}: only {known[-1]!r} is read, not {shown(value)}")


# --- what they are shaped like ------------------------------------------------------------------------


def _things(model: _Model, world: stage_text.World) -> Iterator[Document]:
    """What a model that is not the robot puts into the scenario."""
    entity = model.entity
    if model.is_unknown_robot:
        yield {"kind": "disc", "at": place(_at(model.pose)), "radius": UNKNOWN_RADIUS, "height": 0.3}
        return
    if not _is_solid(entity):
        return
    height = metres(_height(entity))
    rings = _bitmap_rings(entity, world) if "bitmap" in entity.properties else _block_rings(entity)
    if not rings and "bitmap" not in entity.properties:
        yield _box(model, height)
    elif rings and (outline := _outline(model, rings, height))["rings"]:
        yield outline
    if _single(entity, "boundary", 0.0) and min(_size(entity)[:2]) > 4 * BOUNDARY:
        yield _outline(model, _frame(entity), height)


def _is_solid(entity: Entity) -> bool:
    """Whether robots run into it or see it; floor plans are, whatever they say."""
    seen = _single(entity, "ranger_return", 1.0) > 0
    return "bitmap" in entity.properties or seen or _single(entity, "obstacle_return", 1.0) != 0


def _outline(model: _Model, rings: Sequence[Ring], height: float) -> Document:
    placed = [[_at(_on(model.pose, Pose(x, y)))[:2] for x, y in ring] for ring in rings]
    return {"kind": "outline", "id": model.name, "height": height, "rings": ring_texts(placed)}


def _box(model: _Model, height: float) -> Document:
    length, width, _ = _size(model.entity)
    middle = _on(model.pose, _origin(model.entity))
    return {
        "kind": "box",
        "id": model.name,
        "at": place(_at(middle)),
        "heading": radians(middle.theta),
        "size": [max(metres(length), 1e-4), max(metres(width), 1e-4)],
        "height": height,
    }


def _height(entity: Entity) -> float:
    """How high [m] it is with the rangers that stand on it."""
    tops = [above + _size(ranger)[2] for ranger, _, above in _rangers(entity) if "size" in ranger.properties]
    return _size(entity)[2] + max([0.0, *tops])


def _origin(entity: Entity) -> Pose:
    """Where the middle of the shape lies in the model."""
    x, y, _, degrees = _numbers(entity, "origin", (0.0, 0.0, 0.0, 0.0))
    return Pose(x, y, math.radians(degrees))


def _grid(entity: Entity, world: stage_text.World) -> Bools:
    """The dark pixels of its bitmap, without the rows and columns round them that have none."""
    name = entity.properties["bitmap"]
    if not isinstance(name, str) or "\0" in name:
        raise entity.fault(f"bitmap: expected the name of a file, got {shown(name)}")
    try:
        solid = dark(world.folder / name)
    except WorldFileError as fault:
        raise entity.fault(f"bitmap: {str(fault)[:200]}") from fault
    rows, columns = np.flatnonzero(solid.any(axis=1)), np.flatnonzero(solid.any(axis=0))
    return solid[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1] if rows.size else solid


def _bitmap_rings(entity: Entity, world: stage_text.World) -> list[Ring]:
    grid = _grid(entity, world)
    try:
        length, width, _ = _size(entity)
        cells = length / grid.shape[1], width / grid.shape[0]
        if min(cells) < LEAST_SIZE:
            raise entity.fault(f"bitmap: its pixels would be {min(cells):g} m wide; expected {LEAST_SIZE:g} m or more")
        rings = trace(grid, 1.0, Pose(0.0, 0.0, 0.0), tolerated(max(cells)))
    except GridError as fault:
        raise entity.fault(f"bitmap: {fault}") from fault
    return _fitted(entity, rings, (0.0, 0.0), (float(grid.shape[1]), float(grid.shape[0])))


def _block_rings(entity: Entity) -> list[Ring]:
    """Its blocks, counter-clockwise, stretched together to its size."""
    rings = [_block(part) for part in entity.parts if part.kind == "block"]
    if not rings:
        return []
    xs, ys = zip(*(corner for ring in rings for corner in ring), strict=True)
    if min(xs) == max(xs) or min(ys) == max(ys):
        raise entity.fault("its blocks enclose nothing")
    return _fitted(entity, rings, (min(xs), min(ys)), (max(xs), max(ys)))


def _block(block: Entity) -> Ring:
    count = _single(block, "points", 0.0)
    if not 3 <= count <= 1000:
        raise block.fault(f"points: expected 3 to 1000, got {count:g}")
    corners = [_numbers(block, f"point[{index}]", (math.nan, math.nan)) for index in range(int(count))]
    if any(math.isnan(number) for corner in corners for number in corner):
        raise block.fault(f"it says that it has {count:g} points, but not all of them are there with two numbers")
    ring = tuple(dict.fromkeys((x, y) for x, y in corners))
    area = sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(ring, (*ring[1:], ring[0]), strict=True))
    if abs(area) < 1e-9:
        raise block.fault("its points enclose nothing")
    return ring if area > 0 else ring[::-1]


def _fitted(entity: Entity, rings: Sequence[Ring], low: Vec2, high: Vec2) -> list[Ring]:
    """The rings stretched from this box to the size of the entity, in the frame of the model."""
    length, width, _ = _size(entity)
    origin, across, along = _origin(entity), high[0] - low[0], high[1] - low[1]
    placed: list[Ring] = []
    for ring in rings:
        stretched = [((x - low[0]) / across - 0.5, (y - low[1]) / along - 0.5) for x, y in ring]
        placed.append(tuple(_at(_on(origin, Pose(x * length, y * width)))[:2] for x, y in stretched))
    return placed


def _frame(entity: Entity) -> list[Ring]:
    """Walls along the sides of its size: an outer ring and a hole."""
    length, width, _ = _size(entity)
    x, y, thick = length / 2, width / 2, BOUNDARY
    outer = ((-x, -y), (x, -y), (x, y), (-x, y))
    inner = tuple((math.copysign(x - thick, px), math.copysign(y - thick, py)) for px, py in reversed(outer))
    return [tuple(_at(_on(_origin(entity), Pose(px, py)))[:2] for px, py in ring) for ring in (outer, inner)]


def _named(things: list[Document]) -> list[Document]:
    """Things whose ids differ; those without a name get one from the kinds when the scenario is laid out."""
    taken: Counter[str] = Counter(["robot", "donor"])
    named = []
    for thing in things:
        name = str(thing.get("id", ""))
        taken[name] += 1
        rest = {key: value for key, value in thing.items() if key != "id"}
        if name and taken[name] == 1:
            rest = {"kind": rest.pop("kind"), "id": name, **rest}
        named.append(rest)
    return named


# --- the robot ----------------------------------------------------------------------------------------


def _chosen(models: list[_Model], name: str, file: str) -> _Model | None:
    """The robot: the one of this name, else the first position model with a ranger, else the first there is."""
    robots = [model for model in models if model.is_robot]
    if name:
        asked = [model for model in robots if model.name == name]
        if not asked:
            known = ", ".join(model.name for model in robots[:8] if model.name) or "none with a name"
            raise WorldFileError(file, 0, f"there is no robot {name[:40]!r} in it; there is {known}")
        return asked[0]
    ranging = [model for model in robots if any(_rangers(model.entity))]
    return next(iter(ranging or robots), None)


def _rangers(entity: Entity) -> Iterator[tuple[Entity, Pose, float]]:
    """The rangers that it carries, in its frame, with their height above its own."""
    for part in entity.parts:
        if part.kind in ("ranger", "laser"):
            yield part, _pose(part), _numbers(part, "pose", (0.0, 0.0, 0.0, 0.0))[2]


def _robot(entity: Entity) -> Document:
    if entity.kind != "position":
        return {
            "shape": {"circle": UNKNOWN_RADIUS},
            "drive": {"kind": "differential"},
            "sensors": [{"kind": "odometry"}, {"kind": "lidar", "height": 0.2}],
        }
    height = _size(entity)[2]
    mass = _single(entity, "mass", 0.0)
    return {
        "shape": _hull(entity),
        **({"mass": round(mass, 3)} if mass > 0 else {}),
        "height": metres(height),
        "drive": _drive(entity),
        "sensors": [{"kind": "odometry"}, *_lidars(entity, height)],
    }


def _hull(entity: Entity) -> Document:
    """The convex hull of its blocks, or the box of its size."""
    length, width, _ = _size(entity)
    corners = {(metres(x), metres(y)) for ring in _block_rings(entity) for x, y in ring}
    hull = _convex_hull(sorted(corners))
    if len(hull) > 2 and enclosed(hull) > 1e-6:
        return {"polygon": [place(corner) for corner in hull]}
    origin = _origin(entity)
    if (origin.x, origin.y, origin.theta) == (0, 0, 0):
        return {"box": [metres(length), metres(width)]}
    ends = [(x * length / 2, y * width / 2) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    return {"polygon": [place(_at(_on(origin, Pose(x, y)))) for x, y in ends]}


def _convex_hull(points: list[Vec2]) -> list[Vec2]:
    """Counter-clockwise. points: sorted. Source: Andrew 1979, the monotone chain."""

    def half(points: list[Vec2]) -> list[Vec2]:
        chain: list[Vec2] = []
        for x, y in points:
            while len(chain) > 1 and not _left(chain[-2], chain[-1], (x, y)):
                chain.pop()
            chain.append((x, y))
        return chain[:-1]

    return half(points) + half(points[::-1])


def _left(a: Vec2, b: Vec2, c: Vec2) -> bool:
    return (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0]) > 1e-9


def _drive(entity: Entity) -> Document:
    """What its bounds allow; omnidirectional robots drive differentially."""
    speeds = _numbers(entity, "velocity_bounds", (-1.0, 1.0, 0.0, 0.0, 0.0, 0.0, -90.0, 90.0))
    gains = _numbers(entity, "acceleration_bounds", (-1.0, 1.0, 0.0, 0.0, 0.0, 0.0, -90.0, 90.0))
    max_speed, acceleration = (min(max(abs(bounds[1]), 0.01), 10.0) for bounds in (speeds, gains))
    if entity.properties.get("drive") == STEERED:
        wheelbase = max(_single(entity, "wheelbase", 1.0), 0.01)
        return {"kind": "ackermann", "max_speed": max_speed, "acceleration": acceleration, "wheelbase": wheelbase}
    turns = [round(math.radians(min(max(abs(bounds[7]), 1.0), 3600.0)), 4) for bounds in (speeds, gains)]
    return {
        "kind": "differential",
        "max_speed": max_speed,
        "max_turn_rate": turns[0],
        "acceleration": acceleration,
        "turn_acceleration": turns[1],
        "track": max(metres(_size(entity)[1]), 0.01),
    }


def _lidars(entity: Entity, height: float) -> list[Document]:
    """One lidar for each sensor of its rangers; those with many beams come first. Names differ."""
    found: list[Document] = []
    taken: Counter[str] = Counter(["odometry"])
    for ranger, at, above in _rangers(entity):
        for sensor in [part for part in ranger.parts if part.kind == "sensor"] or [ranger]:
            name = printable(ranger.kinds[0], 80)
            taken[name] += 1
            lidar = _lidar(sensor, _on(at, _pose(sensor)) if sensor is not ranger else at)
            level = max(metres(height + above), 0.01)
            found.append({"kind": "lidar", "name": name if taken[name] == 1 else f"{name}-{taken[name]}"} | lidar)
            found[-1]["height"] = level
    if len(found) > 200:
        raise entity.fault(f"the robot carries {len(found)} range sensors; at most 200 are read")
    return sorted(found, key=lambda lidar: lidar["beams"] == 1)


def _lidar(sensor: Entity, at: Pose) -> Document:
    near, far, fov = _view(sensor)
    beams = int(min(max(_single(sensor, "samples", 180.0 if fov > 90 else 1.0), 1.0), 100_000))
    full = fov >= 360 and beams > 1
    return {
        "at": [*place(_at(at)), radians(at.theta)],
        "field_of_view": round(math.tau if full else math.radians(min(max(fov, 0.1), 359.9)), 6),
        "beams": beams,
        "min_range": metres(max(near, 0.0)),
        "max_range": max(metres(far), 0.01),
        "sd": 0.0,
        "period": 0.1,
    }


def _view(sensor: Entity) -> tuple[float, float, float]:
    """Least and greatest range [m] and field of view [deg]; `view` and the keys of lasers are older ways to say it."""
    near, far = _numbers(sensor, "range", (0.0, 8.0))
    near, far, fov = _numbers(sensor, "view", (near, far, _single(sensor, "fov", 180.0)))
    return _single(sensor, "range_min", near), _single(sensor, "range_max", far), fov


# --- the rest -----------------------------------------------------------------------------------------


def _bounds(models: list[_Model], start: Sequence[float]) -> list[float]:
    """What holds all models by their sizes."""
    corners = [(start[0], start[1])]
    for model in models:
        length, width, _ = _size(model.entity)
        for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
            corners.append(_at(_on(model.pose, Pose(x * length / 2, y * width / 2)))[:2])
    return box_round(corners, 0.5)


def _free_start(models: list[_Model], world: stage_text.World) -> tuple[float, float, float]:
    """The middle of the largest free square of the first bitmap; the origin where there is none."""
    for model in models:
        if "bitmap" not in model.entity.properties:
            continue
        solid = _grid(model.entity, world)
        found = roomiest(~solid)
        if found is not None:
            rows, columns = solid.shape
            corner = ((found[0], rows - found[1]),)
            fitted = _fitted(model.entity, [corner], (0.0, 0.0), (float(columns), float(rows)))
            return _at(_on(model.pose, Pose(*fitted[0][0])))
    return 0.0, 0.0, 0.0


def _left_out(world: stage_text.World, solids: list[_Model], robot: _Model | None) -> Iterator[str]:
    yield from world.missing
    unknown = Counter(
        model.entity.kind
        for model in _models(world)
        if model not in solids and model.entity.kind not in SHAPES | NO_MODEL | SILENT
    )
    for kind, count in unknown.items():
        why = "nothing of this kind is simulated" if kind in SENSES else "this type is nowhere defined"
        yield f"{count} x {kind}: {why}"
    guessed = [model for model in solids if model.is_unknown_robot]
    if guessed:
        kinds = ", ".join(dict.fromkeys(model.entity.kind for model in guessed))
        yield f"what robots of type {kinds} ({len(guessed)}) look like, which is nowhere defined: round, of 0.18 m"
    others = [model for model in solids if model.is_robot and model is not robot]
    if others:
        yield f"the other robots ({len(others)}): they stand where they are"
    if any("ctrl" in model.entity.properties for model in solids):
        yield "controllers of robots (ctrl)"
    if robot is None:
        yield "the file has no robot: one was put where there is room"
    elif robot.entity.properties.get("drive") == "omni":
        yield "the omnidirectional drive of the robot: it drives differentially"
