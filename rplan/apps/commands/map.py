"""`rplan map RECORDING`: the map that the robot made, for ROS or as a picture."""

from __future__ import annotations

import math
from pathlib import Path

import click

from rplan.apps import talk
from rplan.apps.drawing.map import BELIEVED, ODOMETRY, STYLES, MapError, Mapped, cell_map, draw, gather
from rplan.apps.files import InputError, unreadable
from rplan.apps.recordings import recording_at
from sim.maps import write_ros
from sim.recording import RecordingError

PICTURE, MAPS = ".png", (".yaml", ".pgm")


@click.command("map", short_help="Make a map file or a picture of the map in a recording.")
@click.argument("recording", type=click.Path(path_type=Path))
@click.option(
    "-o",
    "--output",
    type=click.Path(dir_okay=False, path_type=Path),
    help="FILE.yaml or FILE.pgm: both, a map for ROS; FILE.png: a picture. Default: RECORDING.png.",
)
@click.option("--style", type=click.Choice(STYLES), default="paper", show_default=True, help="Greys of the picture.")
@click.option(
    "--at", type=click.FloatRange(0), metavar="SECONDS", help="The map as it stood then. Default: at the end."
)
@click.option("--view", metavar="NAME", help="Which of several maps. Default: the first.")
@click.option("--json", "as_json", is_flag=True, help="What is in it, for programs.")
def command(
    recording: Path, output: Path | None, style: str, at: float | None, view: str | None, as_json: bool
) -> None:
    """Put together the map in RECORDING from the patches that the robot sent, and write it.

    Its plan must use the library mapping. The picture also shows the ways: the true one, and those the robot believed.
    """
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
