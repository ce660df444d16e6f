"""Options that several commands share.

Takes: a command. Gives: the same with the options. Leaves alone: what they mean. Imports nothing heavy, so that help
and wrong options are answered at once.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

from rplan.apps import talk


def with_moment(command: Callable[..., Any]) -> Callable[..., Any]:
    """The argument and the options of a command that say which tick is meant; see asking.py."""
    for add in (
        click.option("--json", "as_json", is_flag=True, help="For programs."),
        click.option(
            "--trace", type=click.Path(path_type=Path), help="Ticks of a plan before, as `rplan tick` reads them."
        ),
        click.option("--given", metavar="PERCEPTS", help="Percepts of a tick of a plan: 'NAME, NAME=NUMBER'."),
        click.option("--at", type=float, metavar="SECONDS", help="Which tick of a recording."),
    ):
        command = add(command)
    return talk.with_libraries(command)
