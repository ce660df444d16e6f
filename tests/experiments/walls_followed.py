"""Walls that others have drawn: the cases of MIT's wall follower, the mazes of micromouse contests, Stage's cave.

Takes: which of them (`mit`, `mazes`, `cave`), files, minutes, followers. Gives: a table. Of a case whether its end was
reached and the mean |distance - desired| by its own rule; of a maze or a cave contacts, distance, the share of the
reachable wall that the lidar met, and simulated seconds a second. Leaves alone: how it is done.

`python tests/experiments/walls_followed.py mazes DIRECTORY --minutes 60`; `mit tests.json`; `cave simple.world`.

The cases are driven by a differential drive in the place of the car, of the same hull and lidar: the followers turn on
the spot where they must. Mazes are enlarged eightfold, to cells of 1.44 m, and driven by X-RHex, which carries a lidar;
a mouse carries none. The cave is driven by a Pioneer 3-DX whose lidar looks all round.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from perimeter_hour import Watch, reachable, walls
from perimeter_hour import scenario as with_pioneer
from scipy import ndimage

from rplan.apps.wiring import PlanBrain, compile_source
from rplan.driver import Compiled
from rplan.lang.source import Source
from sim.episode import Episode
from sim.scenarios.format import loads
from sim.scenarios.importers.choose import read, text_of
from sim.scenarios.importers.imported import Options
from sim.scenarios.scenario import Scenario

FOLLOWERS = ("wall-by-ransac", "wall-by-hough")
PLAN = """
(plan along-walls :period {period})
(use robot)
(use {follower} :preset modern :side {side} :stand-off {stand_off}m :speed {speed}m/s {more})
(defoutput action command :idle (stop))
(goalem (do action (follow-wall)))
"""
ENLARGED = 8.0
CELL_SEEN = 0.1  # [m] from where a beam ended, a wall has been seen
CAR = {"kind": "differential", "max_speed": 4.0, "max_turn_rate": 4.0, "acceleration": 4.0, "turn_acceleration": 20.0}
CAR_HULL = 0.27
PIONEER_HULL = 0.3


ROOM = 0.3
"""[m]: wall along which a disc of this radius can come is reachable."""


def plan(follower: str, period: str, side: str, stand_off: float, speed: float, more: str) -> Compiled:
    """Follow the wall."""
    text = PLAN.format(follower=follower, period=period, side=side, stand_off=stand_off, speed=speed, more=more)
    return compile_source(Source("along_walls.rplan", text))


# --- the cases of MIT -----------------------------------------------------------------------------


class Loss:
    """|distance - desired| by the rule of the cases: the mean |y| of what lies on the side up to 1.5 m ahead."""

    def __init__(self, side: int, desired: float) -> None:
        self._side, self._desired = side, desired
        self.losses: list[float] = []

    def observe(self, episode: Episode) -> None:
        scan = episode.world.sense().lidar
        if scan is None or not scan.fresh:
            return
        met = scan.ranges < scan.max_range
        x, y = scan.ranges[met] * np.cos(scan.bearings[met]), scan.ranges[met] * np.sin(scan.bearings[met])
        beside = (self._side * y > 0) & (x > 0) & (x < 1.5)
        if beside.any():
            self.losses.append(abs(float(np.abs(y[beside]).mean()) - self._desired))


def case(path: Path, number: int) -> Scenario:
    """A case of the file with the differential drive."""
    imported = read(path, Options(world=number + 1))
    robot = imported.document["robot"] | {"drive": CAR | {"track": 0.2}}
    return loads(text_of(replace(imported, document=imported.document | {"robot": robot})), path.name)


def mit(path: Path, followers: list[str], seed: int) -> Iterator[str]:
    """A line for each case and follower."""
    for number, test in enumerate(json.loads(path.read_text(encoding="utf-8"))["tests"]):
        side = "left" if test["side"] > 0 else "right"
        for follower in followers:
            more = f":hull-radius {CAR_HULL}m :most 3rad/s :acceleration 4 :turn-acceleration 20"
            more += " :least 8 :reach 8m" if follower == FOLLOWERS[0] else ""
            compiled = plan(follower, "20ms", side, test["desired_distance"], test["velocity"], more)
            loss = Loss(test["side"], test["desired_distance"])
            verdict = Episode(case(path, number), seed, compiled.goals.period).run(PlanBrain(compiled), None, loss)
            reached = "reached" if verdict.done else f"not reached in {verdict.duration:.0f} s"
            mean = float(np.mean(loss.losses))
            yield (
                f"{test['name']:20} {follower:15} {reached:22} {verdict.duration:6.1f} s  loss {mean:.3f} m  "
                f"contacts {len(verdict.contacts)}"
            )


# --- an hour in mazes and in the cave -------------------------------------------------------------


def enlarged(path: Path) -> Scenario:
    """The maze, eight times as large, with X-RHex in it and no goal to end the run."""
    imported = read(path, Options())
    was = imported.document
    robot = {"model": "xrhex", "start": _times(was["robot"]["start"]), "heading": was["robot"]["heading"]}
    things = [thing | {"rings": [_ring(ring) for ring in thing["rings"]], "height": 0.4} for thing in was["things"]]
    document: dict[str, Any] = was | {"bounds": _times(was["bounds"]), "robot": robot, "things": things}
    document = {key: value for key, value in document.items() if key != "goal"} | {"time_limit": 7200.0}
    return loads(text_of(replace(imported, document=document)), path.name)


def _times(numbers: list[float]) -> list[float]:
    return [round(ENLARGED * number, 4) for number in numbers]


def _ring(text: str) -> str:
    corners = [corner.split() for corner in text.split(",")]
    return ", ".join(" ".join(f"{ENLARGED * float(number):.6g}" for number in corner) for corner in corners)


def hour(name: str, world: Scenario, compiled: Compiled, minutes: float, seed: int) -> str:
    """Drive; what there is to be said of it."""
    episode = Episode(world, seed, compiled.goals.period)
    watch = Watch(episode.world, world.bounds)
    wall = reachable(walls(episode.world, watch), watch, episode.world.robot.pose, ROOM)
    began = time.process_time()
    verdict = episode.run(PlanBrain(compiled), minutes * 60.0, watch)
    took = time.process_time() - began
    seen = ndimage.binary_dilation(watch.met, iterations=round(CELL_SEEN / 0.05))
    share = 100.0 * float((wall & seen).sum()) / max(1, int(wall.sum()))
    return (
        f"{name:18} contacts {len(verdict.contacts)}  {verdict.distance:6.0f} m  "
        f"clearance {verdict.smallest_clearance:.2f} m  "
        f"wall seen {share:3.0f} %  {verdict.duration / took:.0f} x real time"
    )


def mazes(directory: Path, followers: list[str], minutes: float, seed: int, side: str) -> Iterator[str]:
    """A line for each maze and follower."""
    for path in sorted(directory.glob("*.txt")) if directory.is_dir() else [directory]:
        for follower in followers:
            compiled = plan(follower, "28ms", side, 0.65, 0.45, ":door 0.3m")
            yield f"{follower:15} {hour(path.stem, enlarged(path), compiled, minutes, seed)}"


def cave(path: Path, followers: list[str], minutes: float, seed: int, side: str) -> Iterator[str]:
    """A line for each follower."""
    for follower in followers:
        more = f":hull-radius {PIONEER_HULL}m :acceleration 1 :turn-acceleration 5 :door 0.5m"
        compiled = plan(follower, "0.1s", side, 0.6, 0.4, more)
        yield f"{follower:15} {hour(path.stem, with_pioneer(path), compiled, minutes, seed)}"


def main() -> None:
    """Print the table, line by line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("mit", "mazes", "cave"), help="which walls")
    parser.add_argument("path", type=Path, help="tests.json; a maze or a directory of them; a world of Stage")
    parser.add_argument("--minutes", type=float, default=60.0, help="how long each (mazes, cave)")
    parser.add_argument("--seed", type=int, default=0, help="of the runs")
    parser.add_argument("--side", choices=("left", "right"), default="right", help="where the wall is (mazes, cave)")
    parser.add_argument("--follower", choices=FOLLOWERS, action="append", help="which (both)")
    given = parser.parse_args()
    followers = given.follower or list(FOLLOWERS)
    match given.what:
        case "mit":
            lines = mit(given.path, followers, given.seed)
        case "mazes":
            lines = mazes(given.path, followers, given.minutes, given.seed, given.side)
        case _:
            lines = cave(given.path, followers, given.minutes, given.seed, given.side)
    for line in lines:
        print(line, flush=True)


if __name__ == "__main__":
    main()
