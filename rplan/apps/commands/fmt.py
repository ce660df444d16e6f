"""`rplan fmt PLAN…`: the text of plans in the canonical layout."""

from __future__ import annotations

from pathlib import Path

import click

from rplan.apps import talk
from rplan.apps.files import InputError, plan_file, unreadable
from rplan.lang.diagnostic import InternalError, PlanError
from rplan.lang.source import Source


@click.command("fmt", short_help="Lay out the text of plans, comments and all.")
@click.argument("plans", nargs=-1, required=True)
@click.option("--check", is_flag=True, help="Write nothing; exit code 1 if a text is not in the canonical layout.")
@click.option("--stdout", is_flag=True, help="Write to standard output, not to the files.")
@click.option("--json", "as_json", is_flag=True, help="Say for programs which texts change.")
def command(plans: tuple[str, ...], check: bool, stdout: bool, as_json: bool) -> None:
    """Lay out every PLAN: indentation, blank lines and lines that are too long; words and comments stay.

    Files are written only where something changes.
    """
    if stdout and (check or as_json):
        raise InputError("--stdout goes with neither --check nor --json")
    paths = [plan_file(plan) for plan in plans]
    changed = {path: _changes(path, check=check, stdout=stdout) for path in paths}
    if as_json:
        talk.result({"plans": [{"plan": str(path), "changed": change} for path, change in changed.items()]})
    elif not stdout:
        for path in (path for path, change in changed.items() if change):
            click.echo(f"{path}: {'not in the canonical layout' if check else 'laid out'}", err=True)
    if check and any(changed.values()):
        raise SystemExit(talk.PLAN_IS_WRONG)


def _changes(path: Path, *, check: bool, stdout: bool) -> bool:
    """Whether the text of the file is in another layout; then it is brought into the canonical one, unless checking."""
    from rplan.lang.reader import source_from_file

    try:
        source = source_from_file(path)
        text = _laid_out(source)
        if stdout:
            click.echo(text, nl=False)
        change = text != path.read_bytes().decode()
        if change and not check and not stdout:
            path.write_bytes(text.encode())
    except PlanError as error:
        talk.wrong(error, path)
    except OSError as error:
        unreadable(path, error)
    return change


def _laid_out(source: Source) -> str:
    from rplan.lang.formatter import comments, formatted
    from rplan.lang.reader import words_of

    text = formatted(source)
    if words_of(text) != words_of(source.text) or comments(text) != comments(source.text):
        raise InternalError(f"the layout of {source.name} would change what it says")
    return text
