"""`rplan import FILE`: a world of another format as a scenario, or a log as a recording."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

OUTPUT = click.Path(dir_okay=False, path_type=Path)
FORMATS = ("barn", "dynabarn", "micromouse", "moving-ai", "picture", "ros-map", "stage", "wall-follower", "carmen")
MODELS = ("denning", "packbot", "ravon", "xrhex", "jackal", "pioneer", "turtlebot", "micromouse")
"""Named here too, so that help does not have to load what knows them."""


@click.command("import", short_help="Make a scenario of a world of another format.")
@click.argument("file")
@click.option("-o", "--output", type=OUTPUT, help="Write the scenario (YAML) here, or the recording of a log (MCAP).")
@click.option("--format", "form", type=click.Choice(FORMATS), help="What FILE is. Default: found out.")
@click.option("--world", type=click.IntRange(0), help="Which of several worlds; FILE#3 says the same.")
@click.option("--robot", default="", metavar="NAME", help="The model that is the robot (Stage).")
@click.option("--model", default="jackal", type=click.Choice(MODELS), help="The robot where FILE has none.")
@click.option("--start", nargs=3, type=float, metavar="X Y HEADING", help="Where the robot starts [m, m, rad].")
@click.option("--resolution", type=click.FloatRange(0.001, 100), help="Side of a cell [m] where FILE does not say.")
@click.option(
    "--least-area", default=0.0, type=click.FloatRange(0), help="Specks of a map smaller than this [m^2] are left out."
)
@click.option("--summary", "as_summary", is_flag=True, help="Say how much there is in it instead of the text.")
@click.option("--json", "as_json", is_flag=True, help="The summary for programs.")
def command(**asked: Any) -> None:
    """Make a scenario of FILE: a Stage world, a ROS map, a picture, a maze, a BARN world; or a recording of a log.

    Without -o the scenario goes to stdout. What of FILE is not in it is said on stderr and stands in the scenario.
    """
    from rplan.apps.doing.import_ import run

    run(**asked)
