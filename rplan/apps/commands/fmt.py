"""`rplan fmt PLAN…`: the text of plans in the canonical layout."""

from __future__ import annotations

from pathlib import Path

import click

from rplan.apps import talk
from rplan.apps.files import InputError, plan_file, unreadable
from rplan.lang.diagnostic import InternalError, PlanError
from rplan.lang.formatter import comments, formatted
from rplan.lang.reader import source_from_file, words_of
from rplan.lang.source import Source


@click.command("fmt", short_help="Lay out the text of plans, comments and all.")
@click.argument("plans", nargs=-1, required=True)
@click.option("--check", is_flag=True, help="Write nothing; exit code 1 if a text is not in the canonical layout.")
@click.option("--stdout", is_flag=True, help="Write to standard output, not to the files.")
def command(plans: tuple[str, ...], check: bool, stdout: bool) -> None:
    """Lay out every PLAN: indentation, blank lines and lines that are too long; words and comments stay.

    Files are written only where something changes.
    """
    if check and stdout:
        raise InputError("--check and --stdout exclude each other")
    different = [path for path in map(plan_file, plans) if not _done(path, check=check, stdout=stdout)]
    if different:
        raise SystemExit(talk.PLAN_IS_WRONG)


def _done(path: Path, *, check: bool, stdout: bool) -> bool:
    """Whether the text of the file is in the canonical layout, or has been brought into it."""
    try:
        source = source_from_file(path)
        text = _laid_out(source)
        if stdout:
            click.echo(text, nl=False)
        elif text != path.read_bytes().decode():
            click.echo(f"{path}: {'not in the canonical layout' if check else 'laid out'}", err=True)
            if check:
                return False
            path.write_bytes(text.encode())
    except PlanError as error:
        talk.wrong(error, path)
    except OSError as error:
        unreadable(path, error)
    return True


def _laid_out(source: Source) -> str:
    text = formatted(source)
    if words_of(text) != words_of(source.text) or comments(text) != comments(source.text):
        raise InternalError(f"the layout of {source.name} would change what it says")
    return text
