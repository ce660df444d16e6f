"""`rplan repair RECORDING`: a recording of a run that was killed becomes a whole file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from rplan.apps.files import InputError, unreadable

if TYPE_CHECKING:
    from sim.repair import Saved


@click.command("repair", short_help="Make a whole file of a recording that was cut short.")
@click.argument("recording", type=click.Path(path_type=Path))
@click.option("-o", "--output", type=click.Path(dir_okay=False, path_type=Path), help="Default: in its place.")
def command(recording: Path, output: Path | None) -> None:
    """Save what RECORDING holds before it breaks off, with index and footer; a whole file is left as it is."""
    from sim.recording import RecordingError
    from sim.repair import repair as repaired

    try:
        saved = repaired(recording, output)
    except RecordingError as error:
        raise InputError(str(error)) from None
    except OSError as error:
        unreadable(Path(error.filename or recording), error)
    if saved.whole:
        click.echo(f"{recording} is whole ({_amount(saved)}): nothing to repair")
    else:
        click.echo(f"saved {_amount(saved)}")
        click.echo(f"wrote {output or recording}")


def _amount(saved: Saved) -> str:
    return f"{saved.ticks:,} tick{'' if saved.ticks == 1 else 's'}, {saved.seconds:.1f} s of simulated time"
