"""`rplan why`: why a tick of a run, or of a plan alone, did what it did, and what lost."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path

import click

from rplan.apps import talk
from rplan.apps.asking import Moment, moment, with_moment
from rplan.runtime.trace import way_json
from rplan.ways.kept import Literal
from rplan.ways.lost import Lost
from rplan.ways.way import Act
from rplan.ways.why import Reasons, Why


@click.command("why", short_help="Say why a tick did what it did, and what lost.")
@click.argument("about", metavar="RECORDING|PLAN")
@with_moment
def command(about: str, at: float | None, given: str | None, trace: Path | None, as_json: bool) -> None:
    """Why a tick did what it did: the way taken, the fewest conditions that are enough for it, every goal that lost.

    The tick is that of a RECORDING at a time (--at), or one of a PLAN alone: percepts are false or 0 unless --given,
    and what it keeps is as at its start, or as after the ticks of --trace. --trace alone asks about its last tick.
    """
    tick = moment(about, at, given, trace, as_json=as_json)
    why = Reasons(tick.compiled.ways).why(tick.atoms, tick.registers)
    if as_json:
        talk.result(_plain(tick, why))
    else:
        for line in _text(tick, why):
            click.echo(line)


def heading(tick: Moment) -> str:
    """Which tick of which plan."""
    return f"{tick.compiled.goals.name} at {tick.time:g} s (tick {tick.tick})"


def by_hand(tick: Moment) -> Iterator[str]:
    """The percepts that someone forced."""
    readable = tick.readable()
    told = (f"{name} = {readable.get(name, str(value).lower())}" for name, value in tick.forced.items())
    yield from [f"  forced by hand: {', '.join(told)}"] if tick.forced else []


def _text(tick: Moment, why: Why) -> Iterator[str]:
    yield click.style(heading(tick), bold=True)
    if why.way.hole:
        yield "  no way is open: a hole"
    for act in why.way.acts:
        yield f"  {act.output} is {act.value}: set by {act.rule}, {tick.place(act.span)}{_since(tick, act)}"
    yield from _open(tick, why)
    yield from by_hand(tick)
    if why.served:
        yield click.style("by way of", bold=True)
    for rule in why.served:
        yield f"  {rule.head}, {tick.place(rule.span)}"
    yield click.style("enough for that, whatever else is perceived", bold=True)
    if not (why.literals or why.kept):
        yield "  nothing: it is always so"
    for literal in why.literals:
        yield f"  {literal}{_values(tick, literal.text)}"
    for kept in why.kept:
        yield f"  {kept.condition} was kept as {kept} before"
    yield click.style("what lost", bold=True)
    shown = dict.fromkeys(_lost_line(tick, lost) for lost in why.lost if not lost.part_of)
    yield from shown or ["  nothing"]


def _since(tick: Moment, act: Act) -> str:
    """Since when, and what was before; nothing where the tick is the first."""
    since = tick.since.get(act.output)
    if since is None or tick.tick == 0:
        return ""
    if since.first:
        return "; so from the first tick on"
    when = "now" if since.tick == tick.tick else f"since {since.time:g} s"
    return f"; {when}, instead of {since.before or 'nothing'}"


def _open(tick: Moment, why: Why) -> Iterator[str]:
    acts = [act.output for act in why.way.acts]
    left = [output.name for output in tick.compiled.goals.outputs if output.name not in acts]
    if left:
        words = (f"{name} ({tick.sent[name]} stands)" if tick.sent.get(name) else name for name in left)
        yield f"  open: {', '.join(words)}"


def _values(tick: Moment, *texts: str) -> str:
    """The numbers that comparisons ask, where they are known."""
    readable = tick.readable()
    values = [f"{name} = {readable[name]}" for name in tick.numbers(texts)]
    return f" ({', '.join(values)})" if values else ""


def _lost_line(tick: Moment, lost: Lost) -> str:
    values = _values(tick, *(one.text for one in lost.literals))
    return f"  {lost.goal}, {tick.place(lost.span)}: {lost.because}{values}"


def _plain(tick: Moment, why: Why) -> dict[str, object]:
    return {
        "plan": tick.compiled.goals.name,
        "tick": tick.tick,
        "t": tick.time,
        "hole": why.way.hole,
        "sent": dict(tick.sent),
        "since": {output: asdict(one) for output, one in tick.since.items()},
        "way": way_json(why.way, tick.compiled.source.name),
        "rules": [{"rule": rule.head, "place": talk.place(rule.span)} for rule in why.served],
        "percepts": None if tick.percepts is None else dict(tick.percepts),
        "forced": dict(tick.forced),
        "literals": [_literal(tick, one) for one in why.literals],
        "smallest": why.smallest,
        "kept": [asdict(one) for one in why.kept],
        "lost": [_lost(tick, one) for one in why.lost],
    }


def _literal(tick: Moment, literal: Literal) -> dict[str, object]:
    """The literal, a comparison with the numbers that it asks where they are known."""
    found = tick.numbers([literal.text])
    return asdict(literal) | ({"numbers": found} if found else {})


def _lost(tick: Moment, lost: Lost) -> dict[str, object]:
    return {
        "goal": lost.goal,
        "reason": lost.reason,
        "because": lost.because,
        "condition": lost.condition,
        "literals": [_literal(tick, one) for one in lost.literals],
        "part_of": lost.part_of,
        "place": talk.place(lost.span),
        "by": talk.place(lost.by),
    }
