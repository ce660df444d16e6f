"""Worlds of the BARN challenge: cylinders, a start and a goal in JSON.

Takes: a file of many worlds (`worlds: [{index, cylinders, path}, …]`) or of one (`cylinders`). Gives: `Imported`.
Leaves alone: the score of the challenge, but for the optimal time that it needs, which is said.
Source: Perille, Truong, Xiao and Stone 2020, "Benchmarking metric ground navigation".
"""

from __future__ import annotations

import math
from itertools import pairwise
from pathlib import Path
from typing import Any

from sim.scenarios.importers.imported import (
    Imported,
    Options,
    WorldFileError,
    box_round,
    metres,
    number,
    place,
    radians,
)
from sim.scenarios.importers.sources import asked_world, listed, numbers, read_json

RADIUS, START, GOAL, WITHIN, TIMEOUT = 0.075, [-2.25, 3.0, 1.57], [-2.25, 13.0], 1.0, 100.0
HEIGHT = 1.0
OPTIMAL_SPEED = 2.0
"""[m/s] at which the optimal time of the challenge is reckoned."""


def read(path: Path, options: Options) -> Imported:
    """One world of the file: the one asked for, or the first. Raises WorldFileError."""
    whole, file = read_json(path), path.name
    world, name, left_out = _world(whole, options, file)
    radius = number(whole.get("radius", RADIUS), file, "radius", 1e-3, 100)
    start = numbers(whole.get("start", START), file, "start", 3)
    goal = numbers(whole.get("goal", GOAL), file, "goal", 2)
    cylinders = listed(world.get("cylinders"), file, "cylinders")
    centres = [numbers(centre, file, f"cylinders[{index}]", 2) for index, centre in enumerate(cylinders)]
    begin = options.start or (start[0], start[1], start[2])
    document = {
        "name": name,
        "bounds": box_round([*centres, start, goal], 1.0),
        "robot": {"model": "jackal", "start": place(begin), "heading": radians(begin[2])},
        "goal": {
            "at": place(goal),
            "within": metres(number(whole.get("goal_tolerance", WITHIN), file, "goal_tolerance", 0.01, 100)),
            "no_contact": True,
        },
        "things": [{"kind": "disc", "at": place(c), "radius": metres(radius), "height": HEIGHT} for c in centres],
        "time_limit": number(whole.get("timeout_s", TIMEOUT), file, "timeout_s", 1, 86400),
    }
    return Imported(document, (*left_out, *_path(world, start, goal, file)))


def _world(whole: dict[str, Any], options: Options, file: str) -> tuple[dict[str, Any], str, tuple[str, ...]]:
    """The world meant, its name, and what is to be said of the others."""
    if "worlds" not in whole:
        return whole, file.rsplit(".", 1)[0], ()
    worlds = listed(whole["worlds"], file, "worlds")
    by_index: dict[int, dict[str, Any]] = {}
    for place_in_file, world in enumerate(worlds):
        if not isinstance(world, dict):
            raise WorldFileError(file, 0, f"worlds[{place_in_file}]: expected a mapping")
        what = f"worlds[{place_in_file}].index"
        by_index[int(number(world.get("index", place_in_file), file, what, 0, 1e9))] = world
    index = asked_world(options, list(by_index), file)
    others = f"the other worlds of the file ({len(worlds) - 1}); this is number {index}"
    return by_index[index], f"BARN {index}", (others,) if options.world is None and len(worlds) > 1 else ()


def _path(world: dict[str, Any], start: list[float], goal: list[float], file: str) -> tuple[str, ...]:
    if "path" not in world:
        return ()
    way = [numbers(point, file, f"path[{index}]", 2) for index, point in enumerate(listed(world["path"], file, "path"))]
    stops = [start[:2], *way, goal]
    length = sum(math.dist(a, b) for a, b in pairwise(stops))
    return (f"the planned path; the optimal time by it is {length / OPTIMAL_SPEED:.4g} s",)
