"""The truth of a run as plain JSON values: what never changes, and what is so now.

Takes: a `World`, and of the run its stage and its command. Gives: `header` and `snapshot`, for recordings and for those
who draw. Leaves alone: where they go; the world itself.

Lengths are rounded to the millimetre, angles to 1e-4 rad; a number that is not finite is None.
"""

from __future__ import annotations

import math

import numpy as np

from behaviours.interface import Command, Floats, Pose, Reading, wrap
from sim.raycast import Circle, Outline, Polygon, Rings
from sim.things.ground import Slope
from sim.things.thing import Placed, Thing
from sim.world import World

Json = dict[str, object]


def header(world: World) -> Json:
    """What does not change: period, bounds, robot, home, donor, goal, place to go round, slopes, what stands and moves.

    A part that the scenario does not have is None or empty.
    """
    scenario, build = world.scenario, world.robot.build
    standing = [thing for thing in world.things if not _in_snapshots(world, thing)]
    return {
        "scenario": scenario.name,
        "seed": world.seed,
        "period": world.period,
        "bounds": list(scenario.bounds),
        "robot": {"radius": build.radius, "shape": _outline(build.hull), "height": build.height},
        "home": _pose(world.start),
        "donor": _donor(world),
        "goal": _goal(world),
        "round": _round(world),
        "slopes": [_slope(slope) for slope in scenario.ground.slopes],
        "things": [_described(thing.placed) for thing in standing],
        "movers": [_described(thing.placed) for thing in world.things if _in_snapshots(world, thing)],
    }


def snapshot(world: World, stage: str, command: Command) -> Json:
    """What is so now."""
    reading, head = world.sense(), world.head.state
    return {
        "t": round(world.time, 3),
        "stage": stage,
        "robot": _pose(world.robot.pose),
        "odometry": _pose(reading.odometry.pose),
        "movers": _movers(world),
        "contacts": _contacts(world),
        "head": [_angle(head.pan), _angle(head.tilt)],
        "command": _command(command),
        "on_board": reading.object_on_board,
    } | _sensed(reading)


def _contacts(world: World) -> list[Json]:
    """What touches the robot, but for curbs that it can climb."""
    touches = world.touches
    ground = {thing.placed.id for thing in world.things if world.can_climb(thing)} if touches else set()
    return [{"thing": one.thing, "driven_into": one.driven_into} for one in touches if one.thing not in ground]


def _in_snapshots(world: World, thing: Thing) -> bool:
    """Whether it may be elsewhere later, or gone."""
    return thing.placed.moves or thing in world.donors


def _movers(world: World) -> Json:
    """Where the things are that may be elsewhere, without those that are not there."""
    movers: Json = {}
    for thing in world.things:
        if thing.present and (thing.placed.moves or thing in world.donors):
            movers[thing.placed.id] = [round(thing.x, 3), round(thing.y, 3), round(wrap(thing.theta), 4)]
    return movers


def _donor(world: World) -> Json | None:
    """The first one; all are among the things that move."""
    if not world.donors:
        return None
    return _described(world.donors[0].placed) | {"reach": world.errand.donors[0].reach}


def _goal(world: World) -> Json | None:
    goal = world.scenario.goal
    return None if goal is None else {"at": list(goal.at), "within": goal.within}


def _round(world: World) -> Json | None:
    task = world.scenario.round
    return None if task is None else {"about": list(task.about), "turns": task.turns, "within": task.within}


def _slope(slope: Slope) -> Json:
    return {"region": list(slope.region), "rise": _angle(slope.rise), "uphill": _angle(slope.uphill)}


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
    if command.flippers is not None:
        parts["flippers"] = command.flippers.deployed
    return parts


def _sensed(reading: Reading) -> Json:
    """Only what was measured at this tick."""
    parts: Json = {}
    if reading.sonar and reading.sonar.fresh:
        skirt = [] if reading.skirt is None else _rounded(reading.skirt.ranges)
        parts["sonar"] = [*_rounded(reading.sonar.ranges), *skirt]
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
    listed: list[float] = np.round(ranges, 3).tolist()
    return listed
