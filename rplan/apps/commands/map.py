"""`rplan map RECORDING`: the map that the robot made, for ROS or as a picture."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

STYLES = ("paper", "ros")


@click.command("map", short_help="Make a map file or a picture of the map in a recording.")
@click.argument("recording", type=click.Path(path_type=Path))
@click.option(
    "-o",
    "--output",
    type=click.Path(dir_okay=False, path_type=Path),
    help="FILE.yaml or FILE.pgm: both, a map for ROS; FILE.png: a picture. Default: RECORDING.png.",
)
@click.option("--style", type=click.Choice(STYLES), default="paper", show_default=True, help="Greys of the picture.")
@click.option(
    "--at", type=click.FloatRange(0), metavar="SECONDS", help="The map as it stood then. Default: at the end."
)
@click.option("--view", metavar="NAME", help="Which of several maps. Default: the first.")
@click.option("--json", "as_json", is_flag=True, help="What is in it, for programs.")
def command(**asked: Any) -> None:
    """Put together the map in RECORDING from the patches that the robot sent, and write it.

    Its plan must use the library mapping. The picture also shows the ways: the true one, and those the robot believed.
    """
    from rplan.apps.doing.map import run

    run(**asked)
