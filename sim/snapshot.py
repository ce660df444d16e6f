"""The truth of a run as plain JSON values: what never changes, and what is so now.

Takes: a `World`, and of the run its stage and its command. Gives: `header` and `snapshot`, for recordings and for those
who draw. Leaves alone: where they go; the world itself.

Lengths are rounded to the millimetre, angles to 1e-4 rad; a number that is not finite is None.
"""

from __future__ import annotations

import math

from behaviours.interface import Command, Floats, Pose, Reading
from sim.raycast import Circle, Outline, Polygon, Rings
from sim.things.thing import Placed, Thing
from sim.world import TICK, World

Json = dict[str, object]


def header(world: World) -> Json:
    """What does not change: period, bounds, robot, home, donor, things that stand and things that move."""
    return {
        "scenario": world.scenario.name,
        "seed": world.seed,
        "period": TICK,
        "bounds": list(world.scenario.bounds),
        "robot": {"radius": world.robot.build.radius},
        "home": _pose(world.start),
        "donor": _described(world.donor.placed) | {"reach": world.hand_over.reach},
        "things": [_described(thing.placed) for thing in world.things if not _in_snapshots(thing)],
        "movers": [_described(thing.placed) for thing in world.things if _in_snapshots(thing)],
    }


def snapshot(world: World, stage: str, command: Command) -> Json:
    """What is so now."""
    reading, head = world.sense(), world.head.state
    return {
        "t": round(world.time, 3),
        "stage": stage,
        "robot": _pose(world.robot.pose),
        "odometry": _pose(reading.odometry.pose),
        "movers": {t.placed.id: _pose(t.pose) for t in world.things if _in_snapshots(t) and t.present},
        "contacts": [{"thing": touch.thing, "driven_into": touch.driven_into} for touch in world.touches],
        "head": [_angle(head.pan), _angle(head.tilt)],
        "command": _command(command),
        "on_board": reading.object_on_board,
    } | _sensed(reading)


def _in_snapshots(thing: Thing) -> bool:
    return thing.placed.moves or thing.index == 0


def _length(value: float) -> float | None:
    return round(value, 3) if math.isfinite(value) else None


def _angle(value: float) -> float | None:
    return round(value, 4) if math.isfinite(value) else None


def _pose(pose: Pose) -> list[float | None]:
    return [_length(pose.x), _length(pose.y), _angle(pose.theta)]


def _outline(outline: Outline) -> Json:
    match outline:
        case Circle(radius):
            return {"circle": radius}
        case Polygon(vertices):
            return {"polygon": [[x, y] for x, y in vertices]}
        case Rings(rings):
            return {"rings": [[[x, y] for x, y in ring] for ring in rings]}


def _described(placed: Placed) -> Json:
    return {
        "id": placed.id,
        "kind": placed.kind,
        "shape": _outline(placed.outline),
        "pose": _pose(placed.pose),
        "height": placed.height,
    }


def _command(command: Command) -> Json:
    drive, head = command.drive, command.head
    parts: Json = {}
    if drive is not None:
        parts["drive"] = [_length(drive.speed), _angle(drive.turn_rate)]
    if head is not None:
        parts["head"] = [_angle(head.pan), _angle(head.tilt)]
    return parts


def _sensed(reading: Reading) -> Json:
    """Only what was measured at this tick."""
    parts: Json = {}
    if reading.sonar and reading.skirt and reading.sonar.fresh:
        parts["sonar"] = [*_rounded(reading.sonar.ranges), *_rounded(reading.skirt.ranges)]
    if reading.ir and reading.ir.fresh:
        ir = reading.ir
        parts["ir"] = {
            "pan": _angle(ir.pan),
            "detected": ir.detected,
            "offset": _angle(ir.offset),
            "strength": _length(ir.strength),
        }
    if reading.stereo and reading.stereo.fresh:
        stereo = reading.stereo
        parts["stereo"] = {"pan": _angle(stereo.pan), "tilt": _angle(stereo.tilt), "range": _length(stereo.range)}
    return parts


def _rounded(ranges: Floats) -> list[float]:
    return [round(value, 3) for value in ranges.tolist()]
