"""`rplan check PLAN`: what is wrong with a plan, before it runs."""

from __future__ import annotations

from functools import partial

import click

from rplan.apps import talk
from rplan.apps.files import plan_file


@click.command("check", short_help="Say what is wrong with a plan before it runs.")
@click.argument("plan")
@click.option("--strict", is_flag=True, help="A name that nothing declares is an error.")
@click.option("--allow-holes", is_flag=True, help="A hole is a warning.")
@click.option("--verbose", is_flag=True, help="Also notes: what never goes together, ties, outputs of one value.")
@click.option("--json", "as_json", is_flag=True, help="For programs; has the notes too.")
@talk.with_libraries
def command(plan: str, strict: bool, allow_holes: bool, verbose: bool, as_json: bool) -> None:
    """Check PLAN: malformed or untyped text, goals without a rule, circles, holes, parts that are never reached.

    What a situation shows comes with the simplest one. PLAN is a file, a folder with one plan, or the name of a plan
    that comes with rplan. Exit code 1 if it is wrong.
    """
    from rplan.ways.coverage import review

    checks = partial(review, notes=verbose or as_json)
    path = plan_file(plan)
    compiled = talk.compiled(
        path,
        strict=strict,
        allow_holes=allow_holes,
        as_json=as_json,
        checks=checks,
        verbose=verbose,
        notes=talk.MOST_NOTES,
    )
    if as_json:
        talk.result({"ok": True, "diagnostics": [talk.as_plain(d) for d in compiled.diagnostics]})
    else:
        holes = any(d.code == "hole" for d in compiled.diagnostics)
        undecided = any(d.code == "not-decided" for d in compiled.diagnostics)
        found = "holes allowed" if holes else "holes not decided" if undecided else "no hole"
        click.echo(f"{compiled.goals.name}: the plan is sound ({found})")
