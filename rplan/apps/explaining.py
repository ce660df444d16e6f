"""Why, and why not, for people and for programs.

Takes: a `Moment`, and what was found of it. Gives: lines, or plain values for JSON. Leaves alone: how it is found; see
rplan/ways/why.py and rplan/ways/why_not.py.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict

import click

from rplan.apps import talk
from rplan.apps.asking import Moment
from rplan.lang.units import canonical_number
from rplan.runtime.trace import way_json
from rplan.ways.kept import Kept, Literal
from rplan.ways.lost import Lost
from rplan.ways.why import Why
from rplan.ways.why_not import Change, PastChange, Wanted, WhyNot

VERDICTS = {
    "already": "it happens",
    "percepts": "it would have happened with",
    "kept": "no change of percepts would have made it happen, for what is kept from before holds it; "
    "it would have happened with",
    "never": "it never happens: no tick of this plan that can be does it",
    "undecided": "it could not be decided",
}
NO_PAST = (
    "no change of percepts would have made it happen, for what is kept from before holds it; "
    "what would have had to be kept was not found"
)


def _heading(tick: Moment) -> str:
    """Which tick of which plan."""
    return f"{tick.compiled.goals.name} at {tick.time:g} s (tick {tick.tick})"


def _by_hand(tick: Moment) -> Iterator[str]:
    """The percepts that someone forced."""
    readable = tick.readable()
    told = (f"{name} = {readable.get(name, str(value).lower())}" for name, value in tick.forced.items())
    yield from [f"  forced by hand: {', '.join(told)}"] if tick.forced else []


def why_lines(tick: Moment, why: Why) -> Iterator[str]:
    """Why, for people."""
    yield click.style(_heading(tick), bold=True)
    if why.way.hole:
        yield "  no way is open: a hole"
    for act in why.way.acts:
        since = _since(tick, act.output)
        yield f"  {act.output} is {act.value}: set by {act.rule}, {tick.place(act.span)}{since and f'; {since}'}"
    yield from _open(tick, why)
    yield from _by_hand(tick)
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
        yield f"  {_remembered(tick, kept)}"
    yield click.style("what lost", bold=True)
    shown = dict.fromkeys(_lost_line(tick, lost) for lost in why.lost if not lost.part_of)
    yield from shown or ["  nothing"]


def _since(tick: Moment, output: str) -> str:
    """Since when, and what was before; nothing where the tick is the first."""
    since = tick.since.get(output)
    if since is None or tick.tick == 0:
        return ""
    if since.first:
        return "so from the first tick on"
    when = "now" if since.tick == tick.tick else f"since {since.time:g} s"
    return f"{when}, instead of {since.before or 'nothing'}"


def _open(tick: Moment, why: Why) -> Iterator[str]:
    """What is not set; a line of its own for what was otherwise before."""
    acts = [act.output for act in why.way.acts]
    left = [output.name for output in tick.compiled.goals.outputs if output.name not in acts]
    words = {name: f"{name} ({tick.sent[name]} stands)" if tick.sent.get(name) else name for name in left}
    since = {name: _since(tick, name) for name in left if name in tick.since and not tick.since[name].first}
    yield from (f"  open: {words[name]}; {said}" for name, said in since.items())
    always = [said for name, said in words.items() if name not in since]
    yield from [f"  open: {', '.join(always)}"] if always else []


def _about(kept: Kept) -> tuple[str, str]:
    """What it is that is kept, and of when."""
    form, _, rest = kept.condition[1:-1].partition(" ")
    if form == "delay":
        return rest.partition(" ")[2], "in the tick before"
    return (rest, "in the tick before") if form in ("rose", "fell") else (kept.condition, "before")


def _counted(kept: Kept) -> str:
    return "left" if kept.condition.startswith("(within ") else "counted"


def _remembered(tick: Moment, kept: Kept) -> str:
    """What is kept of a condition with memory."""
    about, when = _about(kept)
    if isinstance(kept.value, bool):
        first = tick.tick == 0
        return f"{about} counts as {kept} before the first tick" if first else f"{about} was {kept} {when}"
    return f"{about} had {kept} {_counted(kept)} before"


def _values(tick: Moment, *texts: str) -> str:
    """The numbers that comparisons ask, where they are known."""
    readable = tick.readable()
    values = [f"{name} = {readable[name]}" for name in tick.numbers(texts)]
    return f" ({', '.join(values)})" if values else ""


def _lost_line(tick: Moment, lost: Lost) -> str:
    values = _values(tick, *(one.text for one in lost.literals))
    return f"  {lost.goal}, {tick.place(lost.span)}: {lost.because}{values}"


def why_values(tick: Moment, why: Why) -> dict[str, object]:
    """Why, for programs."""
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


def why_not_lines(tick: Moment, wishes: Wanted, found: WhyNot) -> Iterator[str]:
    """Why not, for people."""
    yield click.style(_heading(tick), bold=True)
    wanted = " and ".join(f"{name} open" if value is None else f"{name} = {value}" for name, value in wishes.items())
    yield from _by_hand(tick)
    yield from _held(tick, wishes, found)
    verdict = VERDICTS[found.verdict] if found.verdict != "kept" or found.way is not None else NO_PAST
    yield f"{wanted}: {verdict}"
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
    yield from _idle(tick, wishes, found)


def _held(tick: Moment, wishes: Wanted, found: WhyNot) -> Iterator[str]:
    """What is wanted and stands since it was set before."""
    holding = [output.name for output in tick.compiled.goals.outputs if output.hold]
    for name, value in wishes.items():
        if found.verdict != "already" and value is not None and name in holding and tick.sent.get(name) == value:
            yield f"  {name} is {value} already, held from before; this tick does not set it"


def _idle(tick: Moment, wishes: Wanted, found: WhyNot) -> Iterator[str]:
    """What is wanted and stands where nothing sets it."""
    if found.way is None:
        return
    acts = [act.output for act in found.way.acts]
    for output in tick.compiled.goals.outputs:
        if output.name not in acts and output.idle is not None and output.idle.text == wishes.get(output.name):
            yield f"  {output.name} is {output.idle.text}: its idle value, since nothing sets it"


def _past(past: PastChange) -> str:
    about, when = _about(past.was)
    if isinstance(past.was.value, bool):
        return f"{about} {past.becomes} {when}, not {past.was}"
    return f"{about} with {past.becomes} {_counted(past.was)} before, not {past.was}"


def _change(change: Change, unit: str, readable: str) -> str:
    if isinstance(change.becomes, bool):
        return f"{change.percept} {'true' if change.becomes else 'false'}, not {'true' if change.was else 'false'}"
    turned = " and ".join(map(str, change.comparisons)) or "it is otherwise"
    number = "" if change.becomes is None else f", such as {canonical_number(change.becomes, unit)}"
    was = "" if change.was is None else f", not {readable}"
    return f"{change.percept} so that {turned}{number}{was}"


def why_not_values(tick: Moment, wishes: Wanted, found: WhyNot) -> dict[str, object]:
    """Why not, for programs."""
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
