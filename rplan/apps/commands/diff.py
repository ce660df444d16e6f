"""`rplan diff A B`: the situations in which two plans differ."""

from __future__ import annotations

import click

from rplan.apps import talk


@click.command("diff", short_help="Say in which situations two plans differ.")
@click.argument("a")
@click.argument("b")
@click.option("--json", "as_json", is_flag=True, help="For programs.")
@talk.with_libraries
def command(a: str, b: str, as_json: bool) -> None:
    """Say in which situations the plans A and B set their outputs differently.

    Both run side by side from the first tick on; percepts of the same name are the same. Each difference is a
    condition, with the simplest trace that comes to it and the rules behind both sides. Exit code 0 if the plans are
    proven equal, 1 if they differ or it is not decided.
    """
    from rplan.apps.doing.diff import run

    run(a, b, as_json)
