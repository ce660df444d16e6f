"""`rplan compile PLAN`: the circuit of a plan, and what a tick of it costs."""

from __future__ import annotations

from typing import Any

import click

from rplan.apps import talk

FORMS = ("sexp", "json", "dot", "svg", "python", "c")


@click.command("compile", short_help="Compile a plan and say what a tick costs.")
@click.argument("plan")
@click.option("--emit", "form", type=click.Choice(FORMS), help="Print the circuit so.")
@click.option("-o", "--output", type=click.Path(dir_okay=False, writable=True), help="Write it to a file.")
@click.option("--strict", is_flag=True, help="A name that nothing declares is an error.")
@click.option("--allow-holes", is_flag=True, help="A hole is a warning.")
@click.option("--json", "as_json", is_flag=True, help="The report for programs.")
@talk.with_libraries
def command(**asked: Any) -> None:
    """Compile PLAN. Without --emit a report: ways, gates, depth, operations a tick."""
    from rplan.apps.doing.compile import run

    run(**asked)
