"""`rplan why-not`: what would have made a tick of a run, or of a plan alone, do otherwise."""

from __future__ import annotations

from pathlib import Path

import click

from rplan.apps import talk
from rplan.apps.files import InputError
from rplan.apps.options import with_moment


@click.command("why-not", short_help="Say what would have made a tick do otherwise.")
@click.argument("about", metavar="RECORDING|PLAN")
@click.argument("wanted", metavar="OUTPUT=VALUE[,…]")
@with_moment
def command(about: str, wanted: str, at: float | None, given: str | None, trace: Path | None, as_json: bool) -> None:
    """What would have made a tick set OUTPUT to VALUE: the fewest percepts that would have had to be otherwise.

    OUTPUT= asks for an output that stays open. The tick is said as for `rplan why`. Where no percepts can do it, it
    says what would have had to be kept from the ticks before.
    """
    from rplan.apps.asking import moment, wishes
    from rplan.apps.explaining import why_not_lines, why_not_values
    from rplan.ways.why_not import Changes, WantedError

    tick = moment(about, at, given, trace, as_json=as_json)
    wish = wishes(wanted, tick.compiled.ways)
    try:
        found = Changes(tick.compiled.ways, wish).why_not(tick.atoms, tick.registers, tick.percepts)
    except WantedError as error:
        raise InputError(str(error)) from None
    if as_json:
        talk.result(why_not_values(tick, wish, found))
    else:
        for line in why_not_lines(tick, wish, found):
            click.echo(line)
