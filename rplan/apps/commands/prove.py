"""`rplan prove PLAN [NAME…]`: what a plan promises, proven or broken."""

from __future__ import annotations

import click

from rplan.apps import talk


@click.command("prove", short_help="Prove what a plan promises, or show how it breaks it.")
@click.argument("plan")
@click.argument("names", nargs=-1, metavar="[NAME]...")
@click.option(
    "--trace", "trace", type=click.Path(dir_okay=False, writable=True), help="Write a trace for `rplan tick`."
)
@click.option("--json", "as_json", is_flag=True, help="For programs.")
@talk.with_libraries
def command(plan: str, names: tuple[str, ...], trace: str | None, as_json: bool) -> None:
    """Prove the properties of PLAN, all or the named ones: `defproperty`, and the goal maintained above all.

    A property that does not hold comes with the shortest trace that breaks it; --trace writes the first such trace as
    lines for `rplan tick`. Exit code 1 if a property is refuted.
    """
    from rplan.apps.doing.prove import run

    run(plan, names, trace, as_json)
