"""`rplan simulate PLAN`: a plan drives a robot through a world, and the verdict."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from rplan.apps import talk


@click.command("simulate", short_help="Drive a robot through a world by a plan.")
@click.argument("plan")
@click.option(
    "--scenario",
    help="A YAML file, the name of one beside the plan, FOLDER/NAME, or a world that `rplan import` takes "
    "(FILE#3: one of several). Default: the only one beside the plan.",
)
@click.option("--seed", default=0, show_default=True, type=click.IntRange(0), help="Everything by chance follows it.")
@click.option("--until", type=click.FloatRange(0, 1e6, min_open=True), help="Simulated seconds at most.")
@click.option("--record", type=click.Path(dir_okay=False, path_type=Path), help="Write a recording (MCAP).")
@click.option("--replay", type=click.Path(dir_okay=False, path_type=Path), help="Write a page that plays the run.")
@click.option("--plot", type=click.Path(dir_okay=False, path_type=Path), help="Write a picture of the run (PNG).")
@click.option("--allow-holes", is_flag=True, help="Drive a plan that has a hole.")
@click.option("--json", "as_json", is_flag=True, help="The verdict for programs.")
@talk.with_libraries
def command(**asked: Any) -> None:
    """Drive a robot by PLAN through a scenario and say whether the task was done, and why each switch happened.

    Exit code 0 only if the task is done.
    """
    from rplan.apps.doing.simulate import run

    run(**asked)
