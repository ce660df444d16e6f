"""`rplan why`: why a tick of a run, or of a plan alone, did what it did, and what lost."""

from __future__ import annotations

from pathlib import Path

import click

from rplan.apps import talk
from rplan.apps.options import with_moment


@click.command("why", short_help="Say why a tick did what it did, and what lost.")
@click.argument("about", metavar="RECORDING|PLAN")
@with_moment
def command(about: str, at: float | None, given: str | None, trace: Path | None, as_json: bool) -> None:
    """Why a tick did what it did: the way taken, the fewest conditions that are enough for it, every goal that lost.

    The tick is that of a RECORDING at a time (--at), or one of a PLAN alone: percepts are false or 0 unless --given,
    and what it keeps is as at its start, or as after the ticks of --trace. --trace alone asks about its last tick.
    """
    from rplan.apps.asking import moment
    from rplan.apps.explaining import why_lines, why_values
    from rplan.ways.why import Reasons

    tick = moment(about, at, given, trace, as_json=as_json)
    why = Reasons(tick.compiled.ways).why(tick.atoms, tick.registers)
    if as_json:
        talk.result(why_values(tick, why))
    else:
        for line in why_lines(tick, why):
            click.echo(line)
