"""`rplan replay RECORDING`: a page that plays a run."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from rplan.apps import talk
from rplan.apps.files import InputError, unreadable

if TYPE_CHECKING:
    from sim.recording import Recording


@click.command("replay", short_help="Make a page that plays a recording.")
@click.argument("recording", type=click.Path(path_type=Path))
@click.option(
    "-o", "--output", type=click.Path(dir_okay=False, path_type=Path), help="The page. Default: RECORDING.html."
)
@talk.with_libraries
def command(recording: Path, output: Path | None) -> None:
    """Write one HTML file that plays RECORDING in any browser, without a network.

    It shows the world and what is sensed in it, the plan with what is active, why each switch happened, and the circuit
    with its wires.
    """
    from rplan.apps.recordings import recording_at

    target = output or recording.with_suffix(".html")
    if target.resolve() == recording.resolve():
        raise InputError(f"{target} is the recording itself: write elsewhere")
    run = recording_at(recording, "played")
    why_not = _write(run, recording, target)
    if why_not:
        click.echo(f"the page has no circuit: {why_not}", err=True)
    click.echo(f"wrote {target} ({target.stat().st_size / 1e6:.1f} MB)")


def _write(run: Recording, recording: Path, target: Path) -> str:
    from rplan.apps.viewer.page import write_page
    from sim.recording import RecordingError

    try:
        return write_page(run, target, libraries=talk.libraries())
    except RecordingError as error:
        raise InputError(str(error)) from None
    except OSError as error:
        unreadable(target if error.filename == str(target) else recording, error)
