"""Recordings that commands are given.

Takes: a path. Gives: the recording, or an `InputError` (exit code 2) with a clear line. Leaves alone: what is in it.
"""

from __future__ import annotations

from pathlib import Path

import click

from rplan.apps.files import InputError, unreadable
from sim.recording import Recording, RecordingError, read


def recording_at(path: Path, done: str) -> Recording:
    """The recording in a file; of one that was cut short it says that only a part is `done` (played, exported)."""
    try:
        run = read(path)
    except RecordingError as error:
        raise InputError(str(error)) from None
    except OSError as error:
        unreadable(path, error)
    if run.cut_short:
        click.echo(f"{path} was cut short: what was written by then is {done}", err=True)
    return run
