"""Wall-following cases: a map, and for each case where the robot starts and ends, and which wall it follows.

Takes: a JSON file (`map`, `tests: [{name, side, velocity, desired_distance, start_x, …}]`). Gives: `Imported`.
Leaves alone: side, speed and distance, which are for the plan: they are said.
Source: the wall follower course of MIT's RACECAR.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from sim.scenarios.importers import ros_map
from sim.scenarios.importers.imported import (
    Document,
    Imported,
    Options,
    WorldFileError,
    metres,
    number,
    place,
    radians,
    shown,
)
from sim.scenarios.importers.sources import listed, read_json

RACECAR: Document = {
    "shape": {"box": [0.5, 0.2]},
    "mass": 4.5,
    "height": 0.2,
    "drive": {"kind": "ackermann", "max_speed": 4.0, "wheelbase": 0.325, "max_steering": 0.34},
    "sensors": [
        {"kind": "odometry", "name": "odometry"},
        {
            "kind": "lidar",
            "name": "lidar",
            "height": 0.15,
            "period": 0.02,
            "field_of_view": 4.71,
            "beams": 100,
            "max_range": 30.0,
            "sd": 0.01,
        },
    ],
}


def read(path: Path, options: Options) -> Imported:
    """One case of the file: number 1 is the first, which also comes unasked. Raises WorldFileError."""
    whole, file = read_json(path), path.name
    tests, name = listed(whole.get("tests"), file, "tests"), whole.get("map")
    if not isinstance(name, str):
        raise WorldFileError(file, 0, f"map: expected the name of a file, got {shown(name)}")
    case = 1 if options.world is None else options.world
    if not 1 <= case <= len(tests) or not isinstance(test := tests[case - 1], dict):
        raise WorldFileError(file, 0, f"there is no case {case}; there are 1 to {len(tests)}")
    start = options.start or _numbers(test, file, "start_x", "start_y", "start_z")
    chart = ros_map.read(path.parent / name, Options(start=start, least_area=options.least_area))
    end = _numbers(test, file, "end_x", "end_y")
    within = number(whole.get("end_threshold_m", 1.0), file, "end_threshold_m", 0.01, 100)
    document = {
        "name": str(test.get("name", f"case {case}"))[:80],
        "bounds": chart.document["bounds"],
        "robot": RACECAR | {"start": place(start), "heading": radians(start[2])},
        "goal": {"at": place(end), "within": metres(within)},
        "things": chart.document["things"],
        "time_limit": number(whole.get("max_time_s", 120), file, "max_time_s", 1, 86400),
    }
    return Imported(document, (*chart.left_out, *_wishes(test)))


def _numbers(test: dict[str, Any], file: str, *keys: str) -> Any:
    return tuple(number(test.get(key), file, key) for key in keys)


def _wishes(test: dict[str, Any]) -> tuple[str, ...]:
    wishes = [(key, test.get(key)) for key in ("side", "velocity", "desired_distance")]
    said = [f"{key} {value:g}" for key, value in wishes if isinstance(value, int | float) and math.isfinite(value)]
    return (f"what the plan shall do: {', '.join(said)}",) if said else ()
