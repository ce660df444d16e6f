"""`rplan reproduce`: the experiments of a paper, run again, with the paper's figures beside ours."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

PRESETS = ("paper", "modern", "both")


@click.command("reproduce", short_help="Run the experiments of a paper again, its figures beside ours.")
@click.argument("rows", nargs=-1, metavar="[ROW… | PAPER…]")
@click.option("--seeds", default=20, show_default=True, type=click.IntRange(1, 10_000), help="Episodes of each kind.")
@click.option("--workers", type=click.IntRange(1, 4096), help="How many processes. Default: one a core.")
@click.option("--preset", type=click.Choice(PRESETS), help="Of the libraries. Default: those a row is judged by.")
@click.option(
    "--write", type=click.Path(file_okay=False, path_type=Path), help="Write pages with tables and pictures below it."
)
@click.option("--list", "listing", is_flag=True, help="Say which rows there are, and run nothing.")
@click.option("--case", help="With --replay: of which kind the one episode is.")
@click.option("--seed", type=click.IntRange(0), help="With --replay: its seed.")
@click.option(
    "--replay", "replay_file", type=click.Path(dir_okay=False, path_type=Path),
    help="Drive one episode of one row only, and write a page that plays it.",
)  # fmt: skip
@click.option("--json", "as_json", is_flag=True, help="Findings and the measures of every episode, for programs.")
def command(**asked: Any) -> None:
    """Run the experiments that papers report, all or those named (B4) or those of a paper (find-and-fetch).

    Seeds are fixed: the same command gives the same figures. Exit code 1 if an episode failed or a figure is missed.
    """
    from rplan.apps.doing.reproduce import run

    run(**asked)
