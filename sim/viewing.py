"""What the field's viewers show of a run: typed channels with Foxglove's schemas beside the JSON of a recording.

Takes: the world's header and, tick by tick, its snapshot and the Reading. Gives: messages on the channels of a
foxglove `Context`. Leaves alone: the file that they go into, and the JSON, which alone is read back.

Frames: `world`; `odom`, the frame of the odometry, which lies in the world where the robot started; `robot`.

| topic | schema | when |
| --- | --- | --- |
| `/tf` | FrameTransforms, world to robot and world to odom | every tick |
| `/pose`, `/odometry` | PoseInFrame, the true pose in `world`, the believed one in `odom` | every tick |
| `/scene` | SceneUpdate, what stands, and the hull in the frame `robot` | once |
| `/map` | Grid of what stands, 0 or 100 | once |
| `/movers` | SceneUpdate of all that can move | when one has moved, at most twice a second |
| `/scan` | LaserScan | when measured, at most five times a second |
| `/sonar` | PointCloud of the echoes | when measured |

A lidar or ring of sonars of which there are several has its name behind a slash: `/scan/rear`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from foxglove import Context
from foxglove.channels import (
    FrameTransformsChannel,
    GridChannel,
    LaserScanChannel,
    PointCloudChannel,
    PoseInFrameChannel,
    SceneUpdateChannel,
)
from foxglove.messages import (
    Color,
    CubePrimitive,
    CylinderPrimitive,
    FrameTransform,
    FrameTransforms,
    Grid,
    LaserScan,
    LinePrimitive,
    LinePrimitiveLineType,
    PackedElementField,
    PackedElementFieldNumericType,
    Point3,
    PointCloud,
    Pose,
    PoseInFrame,
    Quaternion,
    SceneEntity,
    SceneEntityDeletion,
    SceneEntityDeletionType,
    SceneUpdate,
    Timestamp,
    TriangleListPrimitive,
    Vector2,
    Vector3,
)
from numpy.typing import NDArray

from behaviours.interface import Ranges, Reading, Scan
from sim.plain import Json, listed, mapping, number
from sim.raster import Raster, rasterise

Row = tuple[float, float, float]
Ring = list[tuple[float, float]]

MOVERS_S, SCANS_S = 0.5, 0.2
"""Movers and the scans of one lidar are shown at these distances in time [s] at least."""

THING = Color(r=0.55, g=0.60, b=0.67, a=1.0)
MOVER = Color(r=0.85, g=0.64, b=0.25, a=1.0)
DONOR = Color(r=0.04, g=0.48, b=0.29, a=1.0)
HULL = Color(r=0.20, g=0.32, b=0.82, a=0.9)
GOAL = Color(r=0.20, g=0.32, b=0.82, a=0.4)
NOSE = Color(r=0.05, g=0.05, b=0.10, a=1.0)
HERE = (0.0, 0.0, 0.0)


# --- plain values -----------------------------------------------------------------------------------


def row(value: object) -> Row | None:
    """x, y, theta of a pose that is whole."""
    match value:
        case [float() | int() as x, float() | int() as y, float() | int() as theta]:
            return x, y, theta
        case _:
            return None


def rings_of(shape: Json) -> list[Ring]:
    """The closed rings of corners of a shape in its own frame; a circle has 32 corners."""
    match shape:
        case {"rings": list() as rings}:
            return [_ring(ring) for ring in rings]
        case {"polygon": list() as corners}:
            return [_ring(corners)]
        case {"circle": float() | int() as radius}:
            turns = [math.tau * k / 32 for k in range(32)]
            return [[(radius * math.cos(turn), radius * math.sin(turn)) for turn in turns]]
        case _:
            return []


def _ring(corners: object) -> Ring:
    return [(number(x), number(y)) for x, y in (listed(corner)[:2] for corner in listed(corners))]


def placed(rings: list[Ring], pose: Row) -> list[Ring]:
    """The rings where the thing stands."""
    x, y, theta = pose
    c, s = math.cos(theta), math.sin(theta)
    return [[(x + c * u - s * v, y + s * u + c * v) for u, v in ring] for ring in rings]


# --- messages ---------------------------------------------------------------------------------------


def _turned(theta: float) -> Quaternion:
    return Quaternion(x=0.0, y=0.0, z=math.sin(theta / 2), w=math.cos(theta / 2))


def _pose(at: Row, z: float = 0.0) -> Pose:
    return Pose(position=Vector3(x=at[0], y=at[1], z=z), orientation=_turned(at[2]))


def _stamp(nanoseconds: int) -> Timestamp:
    sec, nsec = divmod(nanoseconds, 1_000_000_000)
    return Timestamp(sec=sec, nsec=nsec)


def _transform(stamp: Timestamp, child: str, at: Row) -> FrameTransform:
    there, turn = Vector3(x=at[0], y=at[1], z=0.0), _turned(at[2])
    return FrameTransform(
        timestamp=stamp, parent_frame_id="world", child_frame_id=child, translation=there, rotation=turn
    )


def _walls(rings: list[Ring], pose: Pose, height: float, colour: Color) -> TriangleListPrimitive:
    """The upright faces over the edges of the rings."""
    points, indices = list[Point3](), list[int]()
    for ring in rings:
        for (ax, ay), (bx, by) in pairwise([*ring, *ring[:1]]):
            k = len(points)
            points += [Point3(x=x, y=y, z=z) for x, y, z in ((ax, ay, 0.0), (bx, by, 0.0), (bx, by, height))]
            points.append(Point3(x=ax, y=ay, z=height))
            indices += [k, k + 1, k + 2, k, k + 2, k + 3]
    return TriangleListPrimitive(pose=pose, points=points, indices=indices, color=colour)


def _lid(ring: Ring, pose: Pose, height: float, colour: Color) -> TriangleListPrimitive:
    """The top of a convex polygon."""
    points = [Point3(x=x, y=y, z=height) for x, y in ring]
    indices = [index for k in range(1, len(ring) - 1) for index in (0, k, k + 1)]
    return TriangleListPrimitive(pose=pose, points=points, indices=indices, color=colour)


def _is_box(ring: Ring) -> tuple[float, float] | None:
    """Length and width of a rectangle round the origin whose sides lie along the axes."""
    xs, ys = sorted({x for x, _ in ring}), sorted({y for _, y in ring})
    if len(ring) == 4 and len(xs) == len(ys) == 2 and xs[0] == -xs[1] and ys[0] == -ys[1] and len(set(ring)) == 4:
        return 2 * xs[1], 2 * ys[1]
    return None


class _Look:
    """How a thing is shown, wherever it stands."""

    def __init__(self, thing: Json, colour: Color) -> None:
        self.id, self.colour = str(thing.get("id", "")), colour
        self.height = max(number(thing.get("height"), 1.0), 0.01)
        shape = mapping(thing.get("shape"))
        self._radius = number(shape["circle"]) if "circle" in shape else None
        self._rings = [] if self._radius is not None else rings_of(shape)
        self._convex = "polygon" in shape
        self._box = _is_box(self._rings[0]) if self._convex else None

    def entity(self, stamp: Timestamp, at: Row) -> SceneEntity:
        """The thing at a pose in the world."""
        return self._entity(stamp, "world", at, [])

    def carried(self, ahead: float) -> SceneEntity:
        """The thing as the origin of the frame that it gives its name to; a line `ahead` [m] shows where x is."""
        points = [Point3(x=0.0, y=0.0, z=self.height), Point3(x=ahead, y=0.0, z=self.height)]
        nose = LinePrimitive(thickness=0.04, points=points, color=NOSE, pose=_pose(HERE))
        return self._entity(_stamp(0), self.id, HERE, [nose])

    def _entity(self, stamp: Timestamp, frame: str, at: Row, lines: list[LinePrimitive]) -> SceneEntity:
        middle, foot = _pose(at, self.height / 2), _pose(at)
        cylinders, cubes, faces = list[CylinderPrimitive](), list[CubePrimitive](), list[TriangleListPrimitive]()
        if self._radius is not None:
            size = Vector3(x=2 * self._radius, y=2 * self._radius, z=self.height)
            cylinders = [CylinderPrimitive(pose=middle, size=size, bottom_scale=1.0, top_scale=1.0, color=self.colour)]
        elif self._box is not None:
            size = Vector3(x=self._box[0], y=self._box[1], z=self.height)
            cubes = [CubePrimitive(pose=middle, size=size, color=self.colour)]
        else:
            faces = [_walls(self._rings, foot, self.height, self.colour)]
            faces += [_lid(self._rings[0], foot, self.height, self.colour)] if self._convex else []
            lines = [*lines, *(_edge(ring, foot) for ring in self._rings)]
        return SceneEntity(
            timestamp=stamp,
            frame_id=frame,
            id=self.id,
            frame_locked=True,
            cylinders=cylinders,
            cubes=cubes,
            triangles=faces,
            lines=lines,
        )


def _edge(ring: Ring, pose: Pose) -> LinePrimitive:
    points = [Point3(x=x, y=y, z=0.0) for x, y in ring]
    kind = LinePrimitiveLineType.LineLoop
    return LinePrimitive(type=kind, pose=pose, thickness=2.0, scale_invariant=True, points=points, color=NOSE)


def _hull(world: Json) -> SceneEntity:
    robot = mapping(world.get("robot"))
    shape = mapping(robot.get("shape")) or {"circle": number(robot.get("radius"), 0.3)}
    ahead = max((x for ring in rings_of(shape) for x, _ in ring), default=0.3)
    return _Look({"id": "robot", "shape": shape, "height": robot.get("height")}, HULL).carried(ahead)


def _goal(world: Json) -> list[SceneEntity]:
    """The place to be reached, as a flat disc."""
    goal = mapping(world.get("goal"))
    match goal.get("at"):
        case [float() | int() as x, float() | int() as y]:
            look = _Look({"id": "goal", "shape": {"circle": number(goal.get("within"), 1.0)}, "height": 0.02}, GOAL)
            return [look.entity(_stamp(0), (x, y, 0.0))]
        case _:
            return []


def _grid(raster: Raster) -> Grid:
    kind = PackedElementField(name="occupied", offset=0, type=PackedElementFieldNumericType.Uint8)
    columns = raster.cells.shape[1]
    return Grid(
        timestamp=_stamp(0),
        frame_id="world",
        pose=_pose((raster.x, raster.y, 0.0)),
        column_count=columns,
        cell_size=Vector2(x=raster.cell, y=raster.cell),
        row_stride=columns,
        cell_stride=1,
        fields=[kind],
        data=(raster.cells * np.uint8(100)).tobytes(),
    )


def _scan(scan: Scan, stamp: Timestamp) -> LaserScan:
    """Beams that met nothing are infinite, as LaserScan has it."""
    mount, ranges = scan.mount, np.where(scan.ranges >= scan.max_range, math.inf, scan.ranges)
    return LaserScan(
        timestamp=stamp,
        frame_id="robot",
        pose=_pose((mount.x, mount.y, mount.theta)),
        start_angle=float(scan.bearings[0]),
        end_angle=float(scan.bearings[-1]),
        ranges=ranges.tolist(),
    )


XYZ = [
    PackedElementField(name=name, offset=4 * k, type=PackedElementFieldNumericType.Float32)
    for k, name in enumerate("xyz")
]


def _echoes(ring: Ranges) -> NDArray[np.float32]:
    """Where echoes came from, in the robot frame [m]: (n, 3)."""
    heard = ring.ranges < ring.max_range
    reach, bearing = ring.ranges[heard] + ring.mount_radius, ring.bearings[heard]
    points = np.zeros((reach.size, 3), dtype="<f4")
    points[:, 0], points[:, 1] = reach * np.cos(bearing), reach * np.sin(bearing)
    return points


def _cloud(rings: Sequence[Ranges], stamp: Timestamp) -> PointCloud:
    points = np.concatenate([_echoes(ring) for ring in rings])
    return PointCloud(
        timestamp=stamp, frame_id="robot", pose=_pose(HERE), point_stride=12, fields=XYZ, data=points.tobytes()
    )


# --- channels ---------------------------------------------------------------------------------------


class View:
    """The typed channels of one recording."""

    def __init__(self, context: Context, header: Json) -> None:
        self._context = context
        self._world = world = mapping(header.get("world")) or header
        self._home = row(world.get("home"))
        self._pose = PoseInFrameChannel("/pose", context=context)
        self._tf = FrameTransformsChannel("/tf", context=context)
        self._odometry = PoseInFrameChannel("/odometry", context=context)
        self._movers = SceneUpdateChannel("/movers", context=context)
        self._scans: dict[str, LaserScanChannel] = {}
        self._scans_due: dict[str, int] = {}
        self._sonars: dict[str, PointCloudChannel] = {}
        donor = mapping(world.get("donor")).get("id")
        every = map(mapping, listed(world.get("movers")))
        self._looks = {str(one.get("id")): _Look(one, DONOR if one.get("id") == donor else MOVER) for one in every}
        self._shown: Json = {}
        self._due = 0

    def begin(self) -> None:
        """What does not change."""
        world, things = self._world, [mapping(thing) for thing in listed(self._world.get("things"))]
        standing = [(thing, at) for thing in things if (at := row(thing.get("pose")))]
        entities = [_Look(thing, THING).entity(_stamp(0), at) for thing, at in standing]
        entities += [*_goal(world), _hull(world)]
        SceneUpdateChannel("/scene", context=self._context).log(SceneUpdate(entities=entities), log_time=0)
        bounds = [number(value) for value in listed(world.get("bounds"))]
        if len(bounds) == 4 and all(map(math.isfinite, bounds)):
            xmin, ymin, xmax, ymax = bounds
            outlines = [placed(rings_of(mapping(thing.get("shape"))), at) for thing, at in standing]
            raster = rasterise(outlines, (xmin, ymin, xmax, ymax))
            GridChannel("/map", context=self._context).log(_grid(raster), log_time=0)

    def tick(self, nanoseconds: int, world: Json, reading: Reading | None) -> None:
        """What is so now."""
        stamp = _stamp(nanoseconds)
        pose, believed = row(world.get("robot")), row(world.get("odometry"))
        if pose is not None:
            self._pose.log(PoseInFrame(timestamp=stamp, frame_id="world", pose=_pose(pose)), log_time=nanoseconds)
            frames = [_transform(stamp, "robot", pose)]
            frames += [_transform(stamp, "odom", self._home)] if self._home else []
            self._tf.log(FrameTransforms(transforms=frames), log_time=nanoseconds)
        if believed is not None:
            message = PoseInFrame(timestamp=stamp, frame_id="odom", pose=_pose(believed))
            self._odometry.log(message, log_time=nanoseconds)
        if nanoseconds >= self._due:
            self._move(nanoseconds, stamp, mapping(world.get("movers")))
        if reading is not None:
            self._sense(nanoseconds, stamp, reading)

    def _move(self, nanoseconds: int, stamp: Timestamp, movers: Json) -> None:
        if movers == self._shown:
            return
        gone = [name for name in self._shown if name not in movers]
        kind = SceneEntityDeletionType.MatchingId
        deletions = [SceneEntityDeletion(timestamp=stamp, type=kind, id=name) for name in gone]
        places = [(look, row(movers.get(name))) for name, look in self._looks.items()]
        entities = [look.entity(stamp, at) for look, at in places if at is not None]
        self._movers.log(SceneUpdate(deletions=deletions, entities=entities), log_time=nanoseconds)
        self._shown, self._due = movers, nanoseconds + round(MOVERS_S * 1e9)

    def _sense(self, nanoseconds: int, stamp: Timestamp, reading: Reading) -> None:
        named = [("", reading.lidar), *((f"/{name}", one) for name, one in reading.others.items())]
        for name, one in named:
            match one:
                case Scan() if one.fresh and one.ranges.size and nanoseconds >= self._scans_due.get(name, 0):
                    self._scan_channel(name).log(_scan(one, stamp), log_time=nanoseconds)
                    self._scans_due[name] = nanoseconds + round(SCANS_S * 1e9) - 1
                case Ranges() if one.fresh:
                    self._sonar_channel(name).log(_cloud([one], stamp), log_time=nanoseconds)
                case _:
                    pass
        rings = [ring for ring in (reading.sonar, reading.skirt) if ring is not None]
        if any(ring.fresh for ring in rings):
            self._sonar_channel("").log(_cloud(rings, stamp), log_time=nanoseconds)

    def _scan_channel(self, name: str) -> LaserScanChannel:
        if name not in self._scans:
            self._scans[name] = LaserScanChannel(f"/scan{name}", context=self._context)
        return self._scans[name]

    def _sonar_channel(self, name: str) -> PointCloudChannel:
        if name not in self._sonars:
            self._sonars[name] = PointCloudChannel(f"/sonar{name}", context=self._context)
        return self._sonars[name]
