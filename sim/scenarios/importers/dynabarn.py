"""Worlds of DynaBARN: discs that move on keyframed tracks through a room, in JSON.

Takes: a file of worlds (number to discs) and trajectories (keyframes [t, x, y] by name). Gives: `Imported`.
Leaves alone: how discs turn corners between keyframes: they go straight.
Source: Nair, Jiang, Hou, Xu, Li, Xiao and Stone 2022, "DynaBARN".
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

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
from sim.scenarios.importers.sources import asked_world, listed, numbers, read_json

START, GOAL, WITHIN, TIMEOUT = (11.0, 0.0, math.pi), (-9.0, 0.0), 1.0, 100.0
HALF_ROOM, HEIGHT, THICKNESS, MARGIN = 10.0, 1.0, 0.1, 1.0
WALLS = (((-10, -10), (-10, 10)), ((-10, -10), (10, -10)), ((-10, 10), (10, 10)))


def read(path: Path, options: Options) -> Imported:
    """One world of the file: the one asked for, or the first. Raises WorldFileError."""
    whole, file = read_json(path), path.name
    worlds, tracks = (_mapping(whole.get(key), file, key) for key in ("worlds", "trajectories"))
    known = [int(key) for key in worlds if key.isascii() and key.isdigit() and len(key) < 10]
    if not known:
        raise WorldFileError(file, 0, "worlds: expected numbers of worlds as keys")
    index = asked_world(options, known, file)
    discs = worlds[next(key for key in worlds if key.isascii() and key.isdigit() and int(key) == index)]
    discs = listed(discs, file, f"worlds.{index}")
    start = options.start or START
    document = {
        "name": f"DynaBARN {index}",
        "bounds": [-HALF_ROOM - MARGIN, -HALF_ROOM - MARGIN, START[0] + MARGIN, HALF_ROOM + MARGIN],
        "robot": {"model": "jackal", "start": place(start), "heading": radians(start[2])},
        "goal": {"at": place(GOAL), "within": WITHIN, "no_contact": True},
        "things": [*map(_wall, WALLS), *(_disc(disc, tracks, file) for disc in discs)],
        "time_limit": TIMEOUT,
    }
    others = f"the other worlds of the file ({len(known) - 1}); this is number {index}"
    return Imported(document, (others,) if options.world is None and len(known) > 1 else ())


def _mapping(value: object, file: str, what: str) -> dict[str, Any]:
    if not isinstance(value, dict) or not value:
        raise WorldFileError(file, 0, f"{what}: expected a mapping, got {shown(value)}")
    return value


def _wall(ends: tuple[tuple[float, float], tuple[float, float]]) -> Document:
    return {"kind": "wall", "from": list(ends[0]), "to": list(ends[1]), "thickness": THICKNESS, "height": HEIGHT}


def _disc(disc: object, tracks: dict[str, Any], file: str) -> Document:
    track = disc.get("plugin") if isinstance(disc, dict) else None
    if not isinstance(disc, dict) or not isinstance(track, str) or track not in tracks:
        raise WorldFileError(file, 0, f"trajectories: there is none for the disc {shown(track)}")
    radius = number(disc.get("radius"), file, f"{track}.radius", 1e-3, 100)
    keyframes = _keyframes(_mapping(tracks[track], file, track).get("keyframes_t_x_y"), track, file)
    return {"kind": "disc", "radius": metres(radius), "height": HEIGHT, "keyframes": keyframes}


def _keyframes(value: object, track: str, file: str) -> list[list[float]]:
    """Keyframes whose times grow; of several at one time the last counts."""
    frames: dict[float, list[float]] = {}
    latest = -math.inf
    for index, row in enumerate(listed(value, file, f"{track}.keyframes_t_x_y")):
        t, x, y = numbers(row, file, f"{track}.keyframes_t_x_y[{index}]", 3)
        if t < max(latest, 0.0):
            raise WorldFileError(file, 0, f"{track}.keyframes_t_x_y[{index}]: the time {t:g} s comes too early")
        latest = metres(t)
        frames[latest] = [latest, *place((x, y))]
    return list(frames.values())
