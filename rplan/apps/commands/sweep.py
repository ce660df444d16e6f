"""`rplan sweep PLAN`: many episodes of a plan, as rows of a table, and what they say together."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from rplan.apps import talk


@click.command("sweep", short_help="Run many episodes of a plan and keep a row of each.")
@click.argument("plan")
@click.option(
    "--seeds", "seed_texts", multiple=True, default=("0..9",), show_default=True, help="Such as 0..99 or 3,5."
)
@click.option(
    "--scenario",
    "scenario_texts",
    multiple=True,
    help="As in simulate, or such as '*.yaml'; repeatable.",
)
@click.option(
    "--param", "params", multiple=True, help="LIBRARY.PARAMETER=V1,V2 or scenario.KEY=V1,V2; may be repeated."
)
@click.option("--until", type=click.FloatRange(0, 1e6, min_open=True), help="Simulated seconds at most.")
@click.option(
    "-o", "--output", required=True, type=click.Path(dir_okay=False, path_type=Path), help="rows.parquet or rows.csv."
)
@click.option("--resume", is_flag=True, help="Continue a sweep that was stopped.")
@click.option("--workers", type=click.IntRange(1, 4096), help="How many processes. Default: one a core.")
@click.option("--engine", type=click.Choice(["processes", "dask"]), default="processes", show_default=True)
@click.option("--scheduler", help="With dask: the address of a scheduler, such as tcp://host:8786.")
@click.option("--require-done", type=click.FloatRange(0, 1), help="Exit code 1 if a smaller share is done anywhere.")
@click.option("--allow-holes", is_flag=True, help="Drive a plan that has a hole.")
@click.option("--json", "as_json", is_flag=True, help="The summary for programs.")
@talk.with_libraries
def command(**asked: Any) -> None:
    """Run PLAN in every combination of scenario, parameter values and seed, each on a core of its own.

    One row an episode, in a fixed order; they are the same however many workers there are. What is wrong with the
    options is told before anything runs. Ctrl-C keeps the rows that are there, and --resume continues.
    """
    from rplan.apps.doing.sweep import run

    run(**asked)
