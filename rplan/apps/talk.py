"""How commands speak: diagnostics to stderr, results to stdout, `--json` for programs.

Takes: diagnostics, plain values. Gives: text, and the exit code where a plan is wrong. Leaves alone: what is said.
Imports the compiler and the libraries only where they are wanted, so that help and wrong options are answered at once.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

import click

from rplan.apps.files import InputError, unreadable
from rplan.lang.diagnostic import Diagnostic, PlanError, render

if TYPE_CHECKING:
    from rplan.apps.libraries import Catalogue
    from rplan.driver import Checks, Compiled

PLAN_IS_WRONG = 1
MOST_NOTES = 8


def compiled(
    path: Path,
    *,
    strict: bool = False,
    allow_holes: bool = False,
    as_json: bool = False,
    checks: Checks | None = None,
    verbose: bool = False,
    notes: int = 0,
) -> Compiled:
    """The plan in a file, compiled; says what is to be said and leaves with 1 if it is wrong.

    notes: so many are shown, the others counted.
    """
    from rplan.apps.wiring import compile_file
    from rplan.driver import no_checks

    asked = checks or no_checks
    try:
        plan = compile_file(path, strict=strict, allow_holes=allow_holes, checks=asked, libraries=libraries())
    except PlanError as error:
        wrong(error, path, as_json=as_json, verbose=verbose)
    except OSError as error:
        unreadable(path, error)
    if not as_json:
        say(plan.diagnostics, plan.texts, every_note=verbose, notes=notes)
    return plan


KEY = "rplan.libraries"
FILES = "rplan.library_files"


def with_libraries(command: Callable[..., Any]) -> Callable[..., Any]:
    """The option `--library FILE.py` of a command; `libraries` gives what it names."""

    def keep(context: click.Context, _: click.Parameter, files: tuple[Path, ...]) -> None:
        from rplan.apps.libraries import LibraryError, catalogue

        try:
            context.meta[KEY] = catalogue(files)
            context.meta[FILES] = tuple(file.resolve() for file in files)
        except LibraryError as error:
            raise InputError(str(error)) from None

    kind = click.Path(path_type=Path)
    says = "A library of behaviours in a Python file; may be given more than once."
    option = click.option(
        "--library", "library_files", multiple=True, type=kind, callback=keep, expose_value=False, help=says
    )
    return option(command)


def libraries() -> Catalogue:
    """Every library that there is for the command that runs."""
    found: Catalogue = click.get_current_context().meta[KEY]
    return found


def library_files() -> tuple[Path, ...]:
    """The files that were given with `--library`, from the root."""
    found: tuple[Path, ...] = click.get_current_context().meta[FILES]
    return found


def wrong(error: PlanError, path: Path, *, as_json: bool = False, verbose: bool = False) -> NoReturn:
    """Say everything that is wrong with a plan and leave with 1."""
    if as_json:
        result({"ok": False, "diagnostics": [as_plain(d) for d in error.diagnostics]})
    else:
        texts = error.texts or {str(path): path.read_bytes().decode("utf-8", errors="replace")}
        say(error.diagnostics, texts, every_note=verbose)
    raise SystemExit(PLAN_IS_WRONG)


def say(
    diagnostics: Iterable[Diagnostic], texts: Mapping[str, str], *, every_note: bool = False, notes: int = MOST_NOTES
) -> None:
    """Print diagnostics to stderr, errors first, and count them; many notes are cut short."""
    every = list(diagnostics)
    for severity in ("error", "warning", "note"):
        some = [d for d in every if d.severity == severity]
        shown = some[:notes] if severity == "note" and not every_note else some
        for diagnostic in shown:
            click.echo(printable(render(diagnostic, texts)) + "\n", err=True)
        if shown and len(shown) < len(some):
            click.echo(f"… and {len(some) - len(shown)} more notes (all of them with --json)\n", err=True)
    if every:
        counts = {s: sum(d.severity == s for d in every) for s in ("error", "warning", "note")}
        words = [f"{count} {name}{'' if count == 1 else 's'}" for name, count in counts.items() if count]
        more = " (`rplan check` says them)" if counts["note"] and not notes and not every_note else ""
        click.echo(", ".join(words) + more, err=True)


def printable(text: str) -> str:
    """The text without what a terminal would obey."""
    return "".join(letter if letter.isprintable() or letter == "\n" else "\ufffd" for letter in text)


def as_plain(diagnostic: Diagnostic) -> Mapping[str, object]:
    """A diagnostic as plain JSON values."""
    return {
        "code": diagnostic.code,
        "severity": diagnostic.severity,
        "message": diagnostic.message,
        "place": place(diagnostic.span),
        "related": [{"message": r.message, "place": place(r.span)} for r in diagnostic.related],
        "hint": diagnostic.hint,
        "when": diagnostic.when,
        "trace": [json.loads(line) for line in diagnostic.trace],
    }


def place(span: Any) -> Mapping[str, object]:
    """A place as plain JSON values, lines and columns from 1."""
    names = ("file", "line", "column", "end_line", "end_column")
    return {name: getattr(span, name) for name in names}


def result(value: object) -> None:
    """Print a result for programs."""
    click.echo(json.dumps(value, indent=2, ensure_ascii=False))
