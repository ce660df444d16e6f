"""`rplan import FILE`: a world of another format as a scenario, or a log as a recording."""

from __future__ import annotations

import sys
from dataclasses import asdict
from pathlib import Path

import click

from rplan.apps import talk
from rplan.apps.files import InputError, unreadable
from sim.robots.models import MODELS
from sim.scenarios.format import loads
from sim.scenarios.importers import (
    FORMATS,
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

OUTPUT = click.Path(dir_okay=False, path_type=Path)


@click.command("import", short_help="Make a scenario of a world of another format.")
@click.argument("file")
@click.option("-o", "--output", type=OUTPUT, help="Write the scenario (YAML) here, or the recording of a log (MCAP).")
@click.option("--format", "form", type=click.Choice(FORMATS), help="What FILE is. Default: found out.")
@click.option("--world", type=click.IntRange(0), help="Which of several worlds; FILE#3 says the same.")
@click.option("--robot", default="", metavar="NAME", help="The model that is the robot (Stage).")
@click.option("--model", default="jackal", type=click.Choice(tuple(MODELS)), help="The robot where FILE has none.")
@click.option("--start", nargs=3, type=float, metavar="X Y HEADING", help="Where the robot starts [m, m, rad].")
@click.option("--resolution", type=click.FloatRange(0.001, 100), help="Side of a cell [m] where FILE does not say.")
@click.option(
    "--least-area", default=0.0, type=click.FloatRange(0), help="Specks of a map smaller than this [m^2] are left out."
)
@click.option("--summary", "as_summary", is_flag=True, help="Say how much there is in it instead of the text.")
@click.option("--json", "as_json", is_flag=True, help="The summary for programs.")
def command(
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
    """Make a scenario of FILE: a Stage world, a ROS map, a picture, a maze, a BARN world; or a recording of a log.

    Without -o the scenario goes to stdout. What of FILE is not in it is said on stderr and stands in the scenario.
    """
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
