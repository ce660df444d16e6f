"""`rplan new FOLDER`: a fresh project with a plan, a room, tests and a library of one's own.

Takes: a folder, which may be there already. Gives: the files of templates/ with the name put in; all of them or none.
Leaves alone: every file that is there.
"""

from __future__ import annotations

import re
from pathlib import Path
from shlex import quote
from string import Template

import click

from rplan.apps.files import InputError

TEMPLATES = Path(__file__).parent.parent / "templates"
SUFFIX = ".txt"
"""Of every template, lest tools take it for what it will be."""
NAME = re.compile(r"[a-z][a-z0-9]*([-_][a-z0-9]+)*", re.IGNORECASE)
LONGEST_NAME = 64
SAYS = {
    ".md": "what is here, and the commands for it",
    ".rplan": "the plan",
    ".yaml": "a room to try it in",
    ".ticks": "golden ticks: what the plan decided once",
    ".toml": "what pytest and pip want to know",
}


@click.command("new", short_help="Make a fresh project with a plan of its own.")
@click.argument("folder", type=click.Path(file_okay=False, path_type=Path))
@click.option("--name", help="Of the plan and its files. Default: the folder's.")
@click.option("--bare", is_flag=True, help="The plan and its room alone: ten lines, no tests, no library.")
def command(folder: Path, name: str | None, bare: bool) -> None:
    """Make FOLDER a project: a plan, a room to try it in, tests, and a library with words of one's own.

    No file is written over; where one is in the way, none is written.
    """
    called = _name(folder.resolve().name if name is None else name, given=name is not None)
    files = project(called, bare=bare)
    _check_free(folder, files)
    folder.mkdir(parents=True, exist_ok=True)
    _write(folder, files)
    _show(folder, files, bare)


def project(name: str, *, bare: bool = False) -> dict[str, str]:
    """The files of a project: name → text."""
    words = {"name": name, "stem": name.replace("-", "_")}
    paths = [*(TEMPLATES / "both").iterdir(), *(TEMPLATES / ("bare" if bare else "full")).iterdir()]
    texts = {path.name.removesuffix(SUFFIX): path.read_text(encoding="utf-8") for path in paths}
    named = {path.replace("NAME", words["stem"]): text for path, text in texts.items()}
    return {path: Template(named[path]).substitute(words) for path in sorted(named)}


def _name(name: str, *, given: bool) -> str:
    if NAME.fullmatch(name) and len(name) <= LONGEST_NAME:
        return name
    hint = "" if given else "; give one with --name"
    raise InputError(
        f"{name!r} is no name for a plan: a letter, then letters and digits, in words joined by '-', "
        f"at most {LONGEST_NAME} in all{hint}"
    )


def _check_free(folder: Path, files: dict[str, str]) -> None:
    if any(place.exists() and not place.is_dir() for place in (folder, *folder.parents)):
        raise InputError(f"{folder} cannot be made: there is a file in its place")
    there = [path for path in files if (folder / path).exists() or (folder / path).is_symlink()]
    if there:
        raise InputError(f"{folder} has {', '.join(there)} already; nothing was written")


def _write(folder: Path, files: dict[str, str]) -> None:
    try:
        for path, text in files.items():
            (folder / path).write_text(text, encoding="utf-8")
    except OSError:
        for path in files:
            (folder / path).unlink(missing_ok=True)
        raise


def _show(folder: Path, files: dict[str, str], bare: bool) -> None:
    click.echo(f"{folder}:")
    wide = max(map(len, files))
    for path in files:
        click.echo(f"  {path:<{wide}}  {_says(path)}")
    click.echo(f"\nGo on with: cd {quote(str(folder))} && rplan check .{'' if bare else ' --library stroll.py'}")


def _says(path: str) -> str:
    if path.startswith("test_"):
        return "tests for pytest"
    return SAYS.get(Path(path).suffix, "a library with two words of its own")
