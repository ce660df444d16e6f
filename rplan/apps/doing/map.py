"""What `rplan map` does.

Takes: a recording. Gives: the map in it, for ROS or as a picture, and what is to be said of it. Leaves alone: options
and their help; see rplan/apps/commands/map.py, which imports this only when there is something to do.
"""

from __future__ import annotations

import math
from pathlib import Path

import click

from rplan.apps import talk
from rplan.apps.drawing.map import BELIEVED, ODOMETRY, MapError, Mapped, cell_map, draw, gather
from rplan.apps.files import InputError, unreadable
from rplan.apps.recordings import recording_at
from sim.maps import write_ros
from sim.recording import RecordingError

PICTURE, MAPS = ".png", (".yaml", ".pgm")


def run(recording: Path, output: Path | None, style: str, at: float | None, view: str | None, as_json: bool) -> None:
    """Do what was asked; leaves with the exit code of the command."""
    target = output or recording.with_suffix(PICTURE)
    if target.suffix not in (PICTURE, *MAPS):
        raise InputError(f"{target}: expected FILE.yaml or FILE.pgm (a map for ROS), or FILE.png (a picture)")
    run = recording_at(recording, "mapped")
    try:
        mapped = gather(run, view, math.inf if at is None else at)
        wrote = _write(mapped, target, style)
    except (MapError, RecordingError) as error:
        raise InputError(f"{recording}: {error}" if isinstance(error, MapError) else str(error)) from None
    if as_json:
        talk.result({"wrote": [str(path) for path in wrote], **_figures(mapped)})
    else:
        _say(mapped, wrote)


def _write(mapped: Mapped, target: Path, style: str) -> tuple[Path, ...]:
    try:
        if target.suffix in MAPS:
            return write_ros(cell_map(mapped), target)
        draw(mapped, target, style)
    except OSError as error:
        unreadable(target, error)
    return (target,)


def _figures(mapped: Mapped) -> dict[str, object]:
    off = {name: mapped.off(name) for name in (BELIEVED, ODOMETRY)}
    rows, columns = cell_map(mapped).percents.shape
    return {
        "metres": [round(columns * mapped.reader.cell, 3), round(rows * mapped.reader.cell, 3)],
        "known": round(mapped.known, 2),
        "patches": mapped.patches,
        "bytes_per_second": round(mapped.rate(), 1),
        "off": {
            name: {"at_the_end": round(some[0], 3), "at_most": round(some[1], 3), "heading": round(some[2], 4)}
            for name, some in off.items()
            if some is not None
        },
    }


def _say(mapped: Mapped, wrote: tuple[Path, ...]) -> None:
    rows, columns = cell_map(mapped).percents.shape
    side = mapped.reader.cell
    click.echo(f"wrote {' and '.join(map(str, wrote))}")
    click.echo(f"{columns * side:.1f} x {rows * side:.1f} m in cells of {side:g} m, {mapped.known:,.0f} m² known")
    click.echo(f"sent in {mapped.patches:,} patches, {mapped.rate() * 8 / 1000:.1f} kbit/s")
    for name in (BELIEVED, ODOMETRY):
        some = mapped.off(name)
        if some is not None:
            end, most, turn = some
            told = f"{end:.2f} m off at the end, {most:.2f} m at most, its heading {math.degrees(turn):.0f}°"
            click.echo(f"{name}: {told}")
