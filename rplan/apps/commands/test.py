"""`rplan test PLAN`: the tests that stand in a plan (`deftest`), each on a plan that has just been started."""

from __future__ import annotations

import click

from rplan.apps import talk


@click.command("test", short_help="Run the tests that stand in a plan.")
@click.argument("plan")
@click.option("--json", "as_json", is_flag=True, help="For programs.")
@talk.with_libraries
def command(plan: str, as_json: bool) -> None:
    """Run every `deftest` of PLAN and say which fail, where, and what was expected.

    A test begins before the first tick, with every percept false or 0, and ends with its first failure. Exit code 1 if
    one fails.
    """
    from rplan.apps.doing.test import run

    run(plan, as_json)
