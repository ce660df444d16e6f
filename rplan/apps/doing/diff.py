"""What `rplan diff` does.

Takes: two plans. Gives: the situations in which they differ, each with the rules behind both sides. Leaves alone:
options and their help; see rplan/apps/commands/diff.py, which imports this only when there is something to do.
"""

from __future__ import annotations

import click

from rplan.apps import talk
from rplan.apps.files import InputError, plan_file
from rplan.driver import Compiled
from rplan.runtime.trace import way_json
from rplan.ways.differ import ClashError, Difference, Differences, Side, differences
from rplan.ways.situations import describe

DIFFERENT = 1


def run(a: str, b: str, as_json: bool) -> None:
    """Do what was asked; leaves with the exit code of the command."""
    first, second = (talk.compiled(plan_file(plan), allow_holes=True, as_json=True) for plan in (a, b))
    try:
        found = differences(first.ways, second.ways)
    except ClashError as error:
        raise InputError(str(error)) from None
    if as_json:
        talk.result(_plain(found, first, second))
    else:
        _say(found, first)
    if not found.equal:
        raise SystemExit(DIFFERENT)


def _plain(found: Differences, first: Compiled, second: Compiled) -> dict[str, object]:
    return {
        "equal": found.equal,
        "decided": not found.undecided,
        "cut_short": found.cut_short,
        "differences": [
            {
                "output": one.output,
                "when": dict(one.cube),
                "trace": [dict(tick) for tick in one.trace],
                "a": {"value": one.first.value, "way": way_json(one.first.way, first.source.name)},
                "b": {"value": one.second.value, "way": way_json(one.second.way, second.source.name)},
            }
            for one in found.found
        ],
    }


def _say(found: Differences, first: Compiled) -> None:
    for one in found.found:
        click.echo(f"{one.output}: {_when(one)}")
        for name, side in (("a", one.first), ("b", one.second)):
            click.echo(f"  {name}: {side.value}{_by(side, one.output)}")
        click.echo(f"  for example when {describe(one.trace, first.ways)}")
    if found.equal:
        click.echo("equal: both set the same in every situation that can be")
    elif found.found:
        more = f"; these are the first {len(found.found)}" if found.cut_short else ""
        click.echo(f"{len(found.found)} {'difference' if len(found.found) == 1 else 'differences'}{more}")
    if found.undecided:
        click.echo("not everything could be decided")


def _when(one: Difference) -> str:
    words = [text if value else f"(not {text})" for text, value in one.cube.items()]
    return f"where {' and '.join(words)}" if words else "always"


def _by(side: Side, output: str) -> str:
    """The rules that set it, or what was given up."""
    acts = dict.fromkeys(f"{act.rule} at {act.span}" for act in side.way.acts if act.output == output)
    given = dict.fromkeys(f"{one.member} is given up at {one.span}: {one.because}" for one in side.way.given_up)
    said = "; ".join(acts or given)
    return f", by {said}" if acts else f" ({said})" if said else ""
