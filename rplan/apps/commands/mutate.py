"""`rplan mutate PLAN`: whether the tests of a plan notice a slip in it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from rplan.apps import talk

MOST = 1_000


@click.command("mutate", short_help="Say whether the tests of a plan notice a slip in it.")
@click.argument("plan")
@click.option(
    "--tests", multiple=True, type=click.Path(exists=True, path_type=Path), help="Tests for pytest that use the plan."
)
@click.option("--most", type=click.IntRange(1), default=MOST, show_default=True, help="Try so many changes at most.")
@click.option("--at-least", type=click.FloatRange(0, 100), help="Exit code 1 where a smaller share [%] is noticed.")
@click.option("--json", "as_json", is_flag=True, help="For programs.")
@talk.with_libraries
def command(**asked: Any) -> None:
    """Change PLAN in one place at a time and run its tests, properties and golden ticks on what comes of it.

    A change that no test notices survives, and is shown with a situation in which a test would notice it. Changes that
    are proven to make no difference are left out.
    """
    from rplan.apps.doing.mutate import run

    run(**asked)
