"""What `rplan import` does.

Takes: a file of another format. Gives: a scenario, or the recording of a log, and what was left out of it. Leaves
alone: options and their help; see rplan/apps/commands/import_.py, which imports this only when there is something to
do.
"""

from __future__ import annotations

import sys
from dataclasses import asdict
from pathlib import Path

import click

from rplan.apps import talk
from rplan.apps.files import InputError, unreadable
from sim.scenarios.format import loads
from sim.scenarios.importers import (
    LOG,
    Imported,
    Options,
    WorldFileError,
    format_of,
    read,
    split,
    summary,
    text_of,
)
from sim.scenarios.importers.imported import MOST_METRES
from sim.scenarios.schema import ScenarioError


def run(
    file: str,
    output: Path | None,
    form: str | None,
    world: int | None,
    robot: str,
    model: str,
    start: tuple[float, float, float] | None,
    resolution: float | None,
    least_area: float,
    as_summary: bool,
    as_json: bool,
) -> None:
    """Do what was asked; leaves with the exit code of the command."""
    path, number = split(file)
    if start is not None and not all(abs(value) <= MOST_METRES for value in start):
        raise InputError(f"--start: expected numbers up to {MOST_METRES:g}")
    options = Options(form or "", number if world is None else world, robot, model, start, resolution, least_area)
    try:
        if (form or format_of(path)) == LOG:
            _record(path, output, as_json)
            return
        imported = read(path, options)
        text = text_of(imported)
        loads(text, path.name)
    except WorldFileError as error:
        raise InputError(str(error)) from None
    except ScenarioError as error:
        raise InputError(f"{path.name}: the scenario that comes of it is unsound: {error.problems[0]}") from None
    _say(imported, text, output, as_summary, as_json)


def _say(imported: Imported, text: str, output: Path | None, as_summary: bool, as_json: bool) -> None:
    for left_out in imported.left_out:
        click.echo(f"left out: {left_out}", err=True)
    if output is not None:
        _write(text, output)
    elif not as_summary and not as_json:
        sys.stdout.write(text)
    counts = asdict(summary(imported.document))
    if as_json:
        talk.result({"source": imported.document["source"], **counts, "left_out": list(imported.left_out)})
    elif as_summary:
        said = ", ".join(f"{value:,} {name}" for name, value in counts.items())
        click.echo(f"{imported.document['source']}: {said}")


def _write(text: str, output: Path) -> None:
    try:
        output.write_text(text, encoding="utf-8")
    except OSError as error:
        unreadable(output, error)


def _record(path: Path, output: Path | None, as_json: bool) -> None:
    from sim.scenarios.importers.log_recording import record_log

    if output is None:
        raise InputError(f"{path.name} is a log: say where its recording goes (-o FILE.mcap)")
    try:
        scans, seconds = record_log(path, output)
    except OSError as error:
        unreadable(output, error)
    if as_json:
        talk.result({"source": f"{path.name} ({LOG})", "scans": scans, "seconds": seconds})
    else:
        click.echo(f"{path.name} ({LOG}): {scans:,} scans in {seconds:,.1f} s")
