"""`rplan ways PLAN`: the ways of a plan."""

from __future__ import annotations

import click

from rplan.apps import talk

LIMIT = 200


@click.command("ways", short_help="List the ways of a plan; --paper counts them as the paper does.")
@click.argument("plan")
@click.option("--paper", is_flag=True, help="Count as Bonasso, Antonisse and Slack (1992) count.")
@click.option("--limit", default=LIMIT, show_default=True, type=click.IntRange(1), help="List no more ways than this.")
@click.option("--json", "as_json", is_flag=True, help="For programs.")
@talk.with_libraries
def command(plan: str, paper: bool, limit: int, as_json: bool) -> None:
    """List the ways of PLAN that can be taken, each with its acts, what it gives up, and a situation that takes it.

    With --paper their number in the manner of the find-and-fetch paper: one way for each disjunct of the conditions.
    """
    from rplan.apps.doing.ways import run

    run(plan, paper, limit, as_json)
