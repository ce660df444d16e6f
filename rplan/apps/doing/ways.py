"""What `rplan ways` does.

Takes: a plan. Gives: its ways with their situations, or their number as the paper counts. Leaves alone: options and
their help; see rplan/apps/commands/ways.py, which imports this only when there is something to do.
"""

from __future__ import annotations

from collections.abc import Iterator

import click

from rplan.apps import talk
from rplan.apps.files import plan_file
from rplan.driver import Compiled
from rplan.runtime.trace import way_json
from rplan.ways.count import PaperCount, count
from rplan.ways.exhaust import count_situations, exhaustible
from rplan.ways.listing import taken_ways
from rplan.ways.situations import Trace, replay
from rplan.ways.way import Branch, TakenWay, taken_way


def run(plan: str, paper: bool, limit: int, as_json: bool) -> None:
    """Do what was asked; leaves with the exit code of the command."""
    compiled = talk.compiled(plan_file(plan), allow_holes=True, as_json=as_json)
    if paper:
        _paper(compiled, count(compiled.goals.top), as_json)
    else:
        _list(compiled, limit, as_json)


def _paper(compiled: Compiled, counted: PaperCount, as_json: bool) -> None:
    holes = _holes(compiled)
    if as_json:
        talk.result(
            {"ways": counted.total, "distinct": counted.distinct, "taken": counted.taken}
            | ({} if holes is None else {"situations": holes[1], "holes": holes[0]})
        )
        return
    click.echo(f"{counted.total} ways ({counted.distinct} distinct, {counted.taken} ever taken)")
    if holes is not None:
        click.echo(f"{holes[0] or 'no'} {'hole' if holes[0] in (0, 1) else 'holes'} in {holes[1]:,} situations")


def _holes(compiled: Compiled) -> tuple[int, int] | None:
    if not exhaustible(compiled.ways):
        return None
    return count_situations(compiled.ways, compiled.ways.hole), 1 << len(compiled.ways.atoms)


def _list(compiled: Compiled, limit: int, as_json: bool) -> None:
    found = list(_taken(compiled, limit))
    if as_json:
        ways = [
            dict(way_json(way, compiled.source.name)) | {"when": dict(trace[-1])} | _before(trace)
            for trace, way in found
        ]
        talk.result({"plan": compiled.goals.name, "ways": ways, "cut_short": len(found) == limit})
        return
    for number, (_, way) in enumerate(found, start=1):
        click.echo(f"{number:>3}  {_acts(way)}")
        for given in way.given_up:
            click.echo(f"     gives up {given.member}: {given.because}")
        click.echo(f"     by {', '.join(way.rules) or 'the top goal'}")
        click.echo(f"     when {_when(way)}")
    more = f"; there may be more (--limit {limit})" if len(found) == limit else ""
    click.echo(f"{len(found)} way{'' if len(found) == 1 else 's'} can be taken{more}")


def _before(trace: Trace) -> dict[str, object]:
    """The ticks that lead there, where it takes some."""
    return {"before": [dict(tick) for tick in trace[:-1]]} if len(trace) > 1 else {}


def _taken(compiled: Compiled, limit: int) -> Iterator[tuple[Trace, TakenWay]]:
    """The ways in the order of their places in the text, each with its simplest situation."""
    found = []
    for trace in taken_ways(compiled.ways, limit):
        seen = replay(compiled.ways, trace)
        found.append((trace, taken_way(compiled.ways, seen.atoms, seen.registers)))
    yield from sorted(found, key=lambda pair: _rank(pair[1]))


def _rank(way: TakenWay) -> tuple[list[tuple[int, int]], int]:
    return [(act.span.line, act.span.column) for act in way.acts], len(way.given_up)


def _when(way: TakenWay) -> str:
    """The conditions on the way, each once."""
    return " ".join(dict.fromkeys(map(_literal, way.branches))) or "always"


def _literal(branch: Branch) -> str:
    if branch.value:
        return branch.condition
    negated = branch.condition.startswith("(not ")
    return branch.condition[5:-1] if negated else f"(not {branch.condition})"


def _acts(way: TakenWay) -> str:
    return " ".join(dict.fromkeys(f"{act.output}={act.value}" for act in way.acts)) or "(sets nothing)"
