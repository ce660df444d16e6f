"""`rplan export RECORDING`: a table or a film of a run."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import click

from rplan.apps.files import InputError, unreadable

if TYPE_CHECKING:
    from sim.recording import Recording

FILE = click.Path(dir_okay=False, path_type=Path)


@click.command("export", short_help="Make a table or a film of a recording.")
@click.argument("recording", type=click.Path(path_type=Path))
@click.option("--csv", type=FILE, help="Write a table, one row a tick.")
@click.option("--parquet", type=FILE, help="The same table as Parquet; needs duckdb.")
@click.option("--video", type=FILE, help="Write a film (MP4); needs matplotlib and ffmpeg.")
@click.option("--fps", default=25, show_default=True, type=click.IntRange(1, 120), help="Frames a second of the film.")
@click.option("--speed", default=4.0, show_default=True, help="Simulated seconds in a second of the film.")
def command(
    recording: Path, csv: Path | None, parquet: Path | None, video: Path | None, fps: int, speed: float
) -> None:
    """Write what RECORDING holds into files that other programs read."""
    from rplan.apps.recordings import recording_at
    from rplan.apps.table import write_csv, write_parquet

    if csv is None and parquet is None and video is None:
        raise InputError("nothing is asked for: give --csv FILE, --parquet FILE or --video FILE")
    if not (math.isfinite(speed) and 0.01 <= speed <= 1000):
        raise InputError("--speed must lie between 0.01 and 1000")
    run = recording_at(recording, "exported")
    if csv is not None:
        _write(recording, csv, lambda: f"{write_csv(run, csv):,} rows")
    if parquet is not None:
        _write(recording, parquet, lambda: f"{write_parquet(run, parquet):,} rows")
    if video is not None:
        _write(recording, video, lambda: f"{_film(run, video, fps, speed):,} frames")


def _write(recording: Path, target: Path, write: Callable[[], str]) -> None:
    from sim.recording import RecordingError

    if target.resolve() == recording.resolve():
        raise InputError(f"{target} is the recording itself: write elsewhere")
    try:
        amount = write()
    except (RecordingError, ImportError, ValueError) as error:
        raise InputError(str(error)) from None
    except OSError as error:
        unreadable(target, error)
    click.echo(f"wrote {target} ({amount})")


def _film(run: Recording, target: Path, fps: int, speed: float) -> int:
    from rplan.apps.drawing.video import VideoError, film

    try:
        return film(run, target, fps=fps, speed=speed)
    except VideoError as error:
        raise InputError(str(error)) from None
