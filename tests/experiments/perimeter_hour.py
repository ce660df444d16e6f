"""An hour along the walls of imported worlds: whether the robot touches anything, and what it gets to see.

Takes: world files that can be imported (Stage's cave is `simple.world`, its laboratory `autolab.world`), a seed,
presets. Gives: a line for each: contacts, distance, share of the reachable wall that the lidar met, simulated seconds a
second.
Leaves alone: how it is done. `python tests/experiments/perimeter_hour.py cave.world --minutes 60 --seed 0`.

The robot is a Pioneer 3-DX with a lidar that looks all round 0.2 m above the floor, lower than the other robots of the
laboratory are high. It starts where the world's robot does. Reachable is the wall beside which a disc of the stand-off
can come; `--alone` takes the other robots away, which in the laboratory stand about the robot and in doorways.
"""

from __future__ import annotations

import argparse
import math
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from behaviours.interface import Pose
from rplan.apps.wiring import PlanBrain, compile_source
from rplan.driver import Compiled
from rplan.lang.source import Source
from sim.episode import Episode
from sim.raycast import Circle, Polygon, Rings
from sim.scenarios.format import loads
from sim.scenarios.importers.choose import read, text_of
from sim.scenarios.importers.imported import Options
from sim.scenarios.scenario import Scenario
from sim.world import Touch, World

PLAN = Path(__file__).parents[2] / "plans" / "perimeter" / "perimeter.rplan"
CELL = 0.05  # [m] of the map on which walls are counted
BESIDE = 0.2  # [m] more than the stand-off from where the disc can be a wall counts as reachable
SEEN = 0.1  # [m] from where a beam ended, a wall has been seen
LOOKS = 2.0  # [s] from look to look
SENSORS = [
    {"kind": "lidar", "height": 0.2, "beams": 360, "max_range": 8.0, "sd": 0.01, "period": 0.1},
    {"kind": "odometry", "scale_sd": 0.01, "turn_sd": 0.004},
]
ROBOT = {"model": "pioneer", "sensors": SENSORS}
Bools = NDArray[np.bool_]


def scenario(path: Path, alone: bool = False) -> Scenario:
    """The world with the Pioneer in it; alone: without other robots."""
    imported = read(path, Options())
    document = imported.document
    robot = ROBOT | {"start": document["robot"]["start"], "heading": document["robot"]["heading"]}
    things = [thing for thing in document["things"] if not (alone and thing["kind"] == "disc")]
    return loads(text_of(replace(imported, document=document | {"robot": robot, "things": things})), path.name)


def plan(preset: str, side: str, stand_off: float, cruise: float) -> Compiled:
    """The plan of the perimeter with parameters for the room there is indoors."""
    window = stand_off + 1.0
    hull = "hull-length 0.455m :hull-width 0.381m :slip 1 :acceleration 1 :turn-acceleration 5"
    other = "right" if side == "left" else "left"
    text = PLAN.read_text(encoding="utf-8")
    for used, parameters in (
        ("(use perimeter)", f"(use perimeter :preset {preset} :side {side} :stand-off {stand_off}m :look-ahead 1m)"),
        ("(use svfh :when-blocked right)", f"(use svfh :preset {preset} :when-blocked {other} :window {window}m"
         f" :clearance 0.35m :cruise {cruise}m/s :{hull})"),
    ):  # fmt: skip
        if used not in text:
            raise SystemExit(f"{PLAN.name} has no {used}")
        text = text.replace(used, parameters)
    return compile_source(Source(str(PLAN), text))


class Watch:
    """What the lidar has met, and where the robot has been."""

    def __init__(self, world: World, bounds: tuple[float, float, float, float]) -> None:
        self._corner = np.array(bounds[:2])
        self.shape = tuple(math.ceil((high - low) / CELL) for low, high in zip(bounds[:2], bounds[2:], strict=True))
        self.met: Bools = np.zeros(self.shape, dtype=bool)
        self._next = 0.0
        self.track: list[tuple[float, float, float]] = []

    def observe(self, episode: Episode) -> None:
        if episode.time < self._next:
            return
        self._next = episode.time + LOOKS
        pose, scan = episode.world.robot.pose, episode.world.sense().lidar
        self.track.append((pose.x, pose.y, pose.theta))
        if scan is None:
            return
        met = np.isfinite(scan.ranges) & (scan.ranges < scan.max_range)
        angle = scan.bearings[met] + pose.theta
        ends = scan.ranges[met, None] * np.column_stack([np.cos(angle), np.sin(angle)]) + _mounted(scan.mount, pose)
        self.mark(self.met, ends)

    def cells(self, points: NDArray[np.float64]) -> NDArray[np.intp]:
        """Of points in the world, those inside the bounds."""
        at = np.floor((points - self._corner) / CELL).astype(np.intp)
        inside: NDArray[np.intp] = at[((at >= 0) & (at < self.shape)).all(axis=1)]
        return inside

    def mark(self, grid: Bools, points: NDArray[np.float64]) -> None:
        at = self.cells(points)
        grid[at[:, 0], at[:, 1]] = True


def _mounted(mount: Pose, pose: Pose) -> tuple[float, float]:
    """Where the sensor is in the world."""
    c, s = math.cos(pose.theta), math.sin(pose.theta)
    return pose.x + c * mount.x - s * mount.y, pose.y + s * mount.x + c * mount.y


def outlines(world: World) -> list[list[NDArray[np.float64]]]:
    """Rings of corners in the world, thing by thing."""
    found = []
    for thing in world.things:
        pose: Pose = thing.pose
        match thing.placed.outline:
            case Circle(radius):
                turn = np.arange(24) * math.tau / 24
                rings = [radius * np.column_stack([np.cos(turn), np.sin(turn)])]
            case Polygon(vertices):
                rings = [np.array(vertices)]
            case Rings(many):
                rings = [np.array(ring) for ring in many]
        c, s = math.cos(pose.theta), math.sin(pose.theta)
        found.append([ring @ np.array([[c, s], [-s, c]]) + (pose.x, pose.y) for ring in rings])
    return found


def walls(world: World, watch: Watch) -> Bools:
    """The edges of everything that stands."""
    grid = np.zeros(watch.shape, dtype=bool)
    for rings in outlines(world):
        for ring in rings:
            for a, b in zip(ring, np.roll(ring, -1, axis=0), strict=True):
                steps = np.linspace(0.0, 1.0, max(2, math.ceil(2 * float(np.hypot(*(b - a))) / CELL)))
                watch.mark(grid, a + steps[:, None] * (b - a))
    return grid


def reachable(wall: Bools, watch: Watch, start: Pose, stand_off: float) -> Bools:
    """The wall beside which a disc of the stand-off can come from where the robot starts."""
    room = ndimage.distance_transform_edt(~wall) * CELL
    x, y = watch.cells(np.array([[start.x, start.y]]))[0]
    parts, _ = ndimage.label(room > min(stand_off, float(room[x, y]) - CELL))
    part = parts == parts[x, y]
    near = ndimage.distance_transform_edt(~part) * CELL <= stand_off + BESIDE
    free, _ = ndimage.label(~wall)
    border = ndimage.binary_dilation(near & (free == free[x, y]), np.ones((3, 3)))
    return np.asarray(wall & border, dtype=bool)


def drove_into(touches: tuple[Touch, ...]) -> str:
    """The first ones, in words."""
    return ", ".join(f"{touch.thing} at {touch.time:.1f} s" for touch in touches[:5])


def hour(world: Scenario, compiled: Compiled, given: argparse.Namespace) -> tuple[str, Watch]:
    """Drive; what there is to be said of it."""
    episode = Episode(world, given.seed)
    watch = Watch(episode.world, world.bounds)
    wall = reachable(walls(episode.world, watch), watch, episode.world.robot.pose, given.stand_off)
    began = time.process_time()
    verdict = episode.run(PlanBrain(compiled), given.minutes * 60.0, watch)
    took = time.process_time() - began
    seen = ndimage.binary_dilation(watch.met, iterations=round(SEEN / CELL))
    share = float((wall & seen).sum()) / max(1, int(wall.sum()))
    said = (
        f"contacts {len(verdict.contacts)} ({verdict.driven_into} driven into), {verdict.distance:.0f} m, "
        f"least clearance {verdict.smallest_clearance:.2f} m, wall seen {100 * share:.0f} %, "
        f"{verdict.duration / took:.0f} x real time"
    )
    return said + (f"; {drove_into(verdict.contacts)}" if verdict.contacts else ""), watch


def main() -> None:
    """Print a line for each world and preset."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("worlds", type=Path, nargs="+", help="files that can be imported")
    parser.add_argument("--minutes", type=float, default=60.0, help="how long each")
    parser.add_argument("--seed", type=int, default=0, help="of the run")
    parser.add_argument("--preset", choices=("paper", "modern"), action="append", help="which (both)")
    parser.add_argument("--side", choices=("left", "right"), default="left", help="where the wall is kept")
    parser.add_argument("--stand-off", type=float, default=0.5, help="from the wall [m]")
    parser.add_argument("--cruise", type=float, default=0.4, help="greatest speed [m/s]")
    parser.add_argument("--alone", action="store_true", help="without other robots")
    parser.add_argument("--track", action="store_true", help="print where the robot is every minute")
    given = parser.parse_args()
    for path in given.worlds:
        for preset in given.preset or ("paper", "modern"):
            compiled = plan(preset, given.side, given.stand_off, given.cruise)
            said, watch = hour(scenario(path, given.alone), compiled, given)
            print(f"{path.name}, {preset}: {said}", flush=True)
            if given.track:
                print(*(f"({x:.2f}, {y:.2f}, {theta:.2f})" for x, y, theta in watch.track[::30]))


if __name__ == "__main__":
    main()
