"""`rplan tick PLAN`: a plan alone, tick by tick (L22)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from rplan.apps import talk


@click.command("tick", short_help="Run a plan alone: percepts in, outputs out, one JSON object a line.")
@click.argument("plan")
@click.option("--input", "source", type=click.File("rb"), default="-", help="Default: standard input.")
@click.option("--readings", type=click.Path(path_type=Path), help="A recording, whose readings drive PLAN instead.")
@click.option("--switches", is_flag=True, help="With --readings: only the ticks in which something else is sent.")
@click.option("--strict", is_flag=True, help="A name that nothing declares is an error.")
@click.option("--allow-holes", is_flag=True, help="A hole is a warning.")
@talk.with_libraries
def command(**asked: Any) -> None:
    """Read one JSON object a line, percept → value (numbers in SI), and write what PLAN decides, one a line.

    A percept's key is its name, or its canonical text where it has arguments. The first bad line ends it with exit
    code 2. With --readings the percepts come from what a robot sensed in a recording, by PLAN's own libraries; nothing
    is moved by what PLAN decides.
    """
    from rplan.apps.doing.tick import run

    run(**asked)
