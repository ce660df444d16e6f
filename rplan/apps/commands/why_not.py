"""`rplan why-not`: what would have made a tick of a run, or of a plan alone, do otherwise."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path

import click

from rplan.apps import talk
from rplan.apps.asking import Moment, moment, split, with_moment
from rplan.apps.commands.why import by_hand, heading
from rplan.apps.files import InputError
from rplan.lang.units import BadNumberError, canonical_number, read_number
from rplan.runtime.trace import way_json
from rplan.ways.reduce import Ways
from rplan.ways.why_not import Change, Changes, PastChange, Wanted, WantedError, WhyNot

VERDICTS = {
    "already": "it happens",
    "percepts": "it would have happened with",
    "kept": "no change of percepts would have made it happen, for what is kept holds it; it would have happened with",
    "never": "it never happens: no tick of this plan that can be does it",
    "undecided": "it could not be decided",
}


@click.command("why-not", short_help="Say what would have made a tick do otherwise.")
@click.argument("about", metavar="RECORDING|PLAN")
@click.argument("wanted", metavar="OUTPUT=VALUE[,…]")
@with_moment
def command(about: str, wanted: str, at: float | None, given: str | None, trace: Path | None, as_json: bool) -> None:
    """What would have made a tick set OUTPUT to VALUE: the fewest percepts that would have had to be otherwise.

    OUTPUT= asks for an output that stays open. The tick is said as for `rplan why`. Where no percepts can do it, it
    says what would have had to be kept from the ticks before.
    """
    tick = moment(about, at, given, trace, as_json=as_json)
    wishes = _wishes(wanted, tick.compiled.ways)
    try:
        found = Changes(tick.compiled.ways, wishes).why_not(tick.atoms, tick.registers, tick.percepts)
    except WantedError as error:
        raise InputError(str(error)) from None
    if as_json:
        talk.result(_plain(tick, wishes, found))
    else:
        for line in _text(tick, wishes, found):
            click.echo(line)


def _wishes(text: str, ways: Ways) -> Wanted:
    """`OUTPUT=VALUE, OUTPUT=, (open OUTPUT)` as outputs and canonical texts."""
    wishes: dict[str, str | None] = {}
    for part in split(text):
        name, equals, value = (one.strip() for one in part.partition("="))
        if not equals and name.startswith("(open ") and name.endswith(")"):
            name = name[len("(open ") : -1].strip()
        elif not equals:
            raise InputError(f"`{part.strip()}`: OUTPUT=VALUE is wanted, or OUTPUT= for one that stays open")
        if name in wishes:
            raise InputError(f"`{name}` is there twice")
        wishes[name] = _canonical(value, ways.sets.get(name, {})) if value else None
    if not wishes:
        raise InputError("OUTPUT=VALUE is wanted")
    return wishes


def _canonical(value: str, known: dict[str, int]) -> str:
    """The value as the plan has it: spaces once, numbers in SI, parentheses around a call."""
    words = " ".join(value.split()).replace("( ", "(").replace(" )", ")")
    if words not in known and f"({words})" in known:
        return f"({words})"
    try:
        return canonical_number(*read_number(words))
    except BadNumberError:
        return words


def _text(tick: Moment, wishes: Wanted, found: WhyNot) -> Iterator[str]:
    yield click.style(heading(tick), bold=True)
    wanted = " and ".join(f"{name} open" if value is None else f"{name} = {value}" for name, value in wishes.items())
    yield from by_hand(tick)
    yield f"{wanted}: {VERDICTS[found.verdict]}"
    units = {term.text: "" if term.type is None else term.type.unit for term in tick.compiled.goals.percepts()}
    was = tick.readable()
    for past in found.past:
        yield f"  {_past(past)}"
    for change in found.changes:
        yield f"  {_change(change, units.get(change.percept, ''), was.get(change.percept, ''))}"
    if found.way is not None and found.verdict != "already":
        yield click.style("and then", bold=True)
    for act in found.way.acts if found.way is not None else ():
        yield f"  {act.output} is {act.value}: set by {act.rule}, {tick.place(act.span)}"


def _past(past: PastChange) -> str:
    return f"{past.was.condition} kept as {past.becomes} before, not {past.was}"


def _change(change: Change, unit: str, readable: str) -> str:
    if isinstance(change.becomes, bool):
        return f"{change.percept} {'true' if change.becomes else 'false'}, not {'true' if change.was else 'false'}"
    turned = " and ".join(map(str, change.comparisons)) or "it is otherwise"
    number = "" if change.becomes is None else f", such as {canonical_number(change.becomes, unit)}"
    was = "" if change.was is None else f", not {readable}"
    return f"{change.percept} so that {turned}{number}{was}"


def _plain(tick: Moment, wishes: Wanted, found: WhyNot) -> dict[str, object]:
    return {
        "plan": tick.compiled.goals.name,
        "tick": tick.tick,
        "t": tick.time,
        "wanted": dict(wishes),
        "verdict": found.verdict,
        "forced": dict(tick.forced),
        "changes": [asdict(one) for one in found.changes],
        "past": [
            {"condition": one.was.condition, "was": one.was.value, "becomes": one.becomes.value} for one in found.past
        ],
        "way": None if found.way is None else way_json(found.way, tick.compiled.source.name),
    }
