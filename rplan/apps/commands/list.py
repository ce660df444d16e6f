"""`rplan list`: what comes with rplan."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from rplan.apps import talk
from rplan.apps.files import InputError, packaged_plans

if TYPE_CHECKING:
    from behaviours.interface import Library


@click.command("list", short_help="List plans, libraries and what they offer.")
@click.argument("library", required=False)
@click.option("--json", "as_json", is_flag=True, help="For programs.")
@talk.with_libraries
def command(library: str | None, as_json: bool) -> None:
    """List the plans and libraries that come with rplan; with LIBRARY its functions and parameters."""
    if library is not None and library not in talk.libraries():
        raise InputError(f"there is no library {library} (there are: {', '.join(talk.libraries())})")
    if as_json:
        talk.result(_plain(library))
    elif library is None:
        _overview()
    else:
        _details(talk.libraries()[library])


def _plain(library: str | None) -> object:
    if library is not None:
        return _plain_library(talk.libraries()[library])
    return {
        "plans": [{"plan": str(plan), "scenarios": [str(s) for s in _scenarios(plan)]} for plan in packaged_plans()],
        "libraries": [_plain_library(one) for one in talk.libraries().values()],
    }


def _plain_library(library: Library) -> object:
    return {
        "name": library.name,
        "doc": library.doc,
        "functions": [{"name": f.name, "type": f.type, "unit": f.unit, "doc": f.doc} for f in library.functions],
        "parameters": [
            {"name": p.name, "type": p.type, "unit": p.unit, "default": p.default, "doc": p.doc}
            for p in library.parameters
        ],
    }


def _scenarios(plan: Path) -> list[Path]:
    return sorted(plan.parent.glob("*.yaml"))


def _overview() -> None:
    click.echo("Plans")
    for plan in packaged_plans():
        scenarios = ", ".join(scenario.name for scenario in _scenarios(plan))
        click.echo(f"  {plan.parent.name}/{plan.name}" + (f"  (scenarios: {scenarios})" if scenarios else ""))
    click.echo("Libraries (rplan list LIBRARY says more)")
    for library in talk.libraries().values():
        click.echo(f"  {library.name:<16}{library.doc}")


def _details(library: Library) -> None:
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    console = Console(highlight=False, markup=False)
    console.print(Text.assemble((library.name, "bold"), f": {library.doc}"))
    functions = Table("function", "type", "says", title="Functions", title_justify="left", box=None)
    for f in library.functions:
        functions.add_row(f"({f.name})", f"{f.type} {f.unit}".strip(), f.doc)
    console.print(functions)
    if library.parameters:
        parameters = Table("parameter", "default", "says", title="Parameters", title_justify="left", box=None)
        for p in library.parameters:
            default = f"{p.default:g} {p.unit}".strip() if isinstance(p.default, float) else str(p.default)
            parameters.add_row(f":{p.name}", default, p.doc)
        console.print(parameters)
