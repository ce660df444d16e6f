"""An inspection as one HTML page that needs no network.

Takes: an `Inspection`. Gives: the page: table, goals, circuit, percepts and text, with folds and a search over all of
them. Leaves alone: runs; `rplan replay` shows those.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from html import escape
from importlib.resources import files

from rplan.apps.drawing.inspect import Branch, Inspection, Row
from rplan.apps.drawing.inspect_circuit import MOST_GATES, tagged
from rplan.apps.drawing.inspect_circuit_part import compact
from rplan.apps.drawing.inspect_svg import words
from rplan.apps.drawing.inspect_text import RANKED, WIDEST, where
from sim.replay import circuit_script

UNFOLDED = 80
"""A tree of no more places than these is shown whole; of a larger one the rules are folded."""
FEW = 6
"""Of more outputs or rules in a row than these (and two) the others are folded."""


def page(inspection: Inspection) -> str:
    """The page."""
    template = files("rplan.apps.drawing").joinpath("inspect.html").read_text(encoding="utf-8")
    parts = {
        "name": escape(inspection.name),
        "doc": escape(inspection.doc),
        "table": "\n".join(_table(inspection)),
        "goals": "\n".join(_tree(inspection.goals, _places(inspection.goals) <= UNFOLDED)),
        "circuit": _circuit(inspection),
        "percepts": "\n".join(_percepts(inspection)),
        "text": "\n".join(_text(inspection.text)),
        "script": circuit_script() if inspection.stats.gates > MOST_GATES else "",
    }
    head, *rest = template.split("{{")
    filled = [head]
    for piece in rest:
        name, _, after = piece.partition("}}")
        filled += [parts[name], after]
    return "".join(filled)


# --- the decision table ----------------------------------------------------------------------------


def _table(inspection: Inspection) -> Iterator[str]:
    table = inspection.table
    columns = table.conditions if len(table.conditions) <= WIDEST else ()
    names = "".join(f'<th class="lean"><div title="{escape(name)}">{escape(name)}</div></th>' for name in columns)
    yield f"<table><thead><tr>{names or '<th>when</th>'}<th>sets</th><th>by</th></tr></thead><tbody>"
    for row in table.rows:
        yield _row(row, columns)
    yield "</tbody></table>"
    if not table.exclusive:
        yield f'<p class="dim">{RANKED}</p>'


def _row(row: Row, columns: tuple[str, ...]) -> str:
    when = dict(row.when)
    if columns:
        cells = "".join(f"<td>{_mark(when.get(name), name)}</td>" for name in columns)
    else:
        cells = f"<td>{' '.join(f'<span class=literal>{_mark(v, n)} {escape(n)}</span>' for n, v in row.when)}</td>"
    sets = _few(row.sets)
    said = '<b class="no">hole: no way is open</b>' if row.hole else sets or '<span class="dim">nothing</span>'
    gives = "".join(f'<div class="no">gives up {escape(one)}</div>' for one in row.given_up)
    by = _few(row.rules)
    return f'<tr class="hit">{cells}<td class="sets">{said}</td><td class="dim">{by}{gives}</td></tr>'


def _few(items: Sequence[str]) -> str:
    """One below the other; of many the first ones, the others folded."""
    lines = [f"<div>{escape(one)}</div>" for one in items]
    if len(lines) <= FEW + 2:
        return "".join(lines)
    rest = f"<details><summary>{len(lines) - FEW} more</summary>{''.join(lines[FEW:])}</details>"
    return "".join(lines[:FEW]) + rest


def _mark(value: bool | None, name: str) -> str:
    if value is None:
        return ""
    kind, mark = ("yes", "✓") if value else ("no", "✗")
    return f'<b class="{kind}" title="{escape(name)}">{mark}</b>'


# --- the goal tree ---------------------------------------------------------------------------------


def _places(branch: Branch) -> int:
    return 1 + sum(map(_places, branch.inside))


def _tree(branch: Branch, whole: bool) -> Iterator[str]:
    line = (
        f' <a href="#line-{branch.line}">{branch.line}</a>'
        if branch.line
        else f" <i>{escape(where(branch).strip())}</i>"
    )
    said = f'<span class="{branch.kind}">{escape(words(branch))}</span>{line}'
    if not branch.inside:
        yield f'<div class="leaf place">{said}</div>'
        return
    unfolded = " open" if whole or branch.kind != "rule" else ""
    yield f'<details{unfolded}><summary class="place">{said}</summary>'
    for one in branch.inside:
        yield from _tree(one, whole)
    yield "</details>"


# --- circuit, percepts, text -----------------------------------------------------------------------


def _circuit(inspection: Inspection) -> str:
    costs = inspection.stats
    said = (
        f"<p>{costs.gates:,} gates, {costs.depth:,} deep; {costs.registers:,} registers; {costs.inputs:,} inputs, "
        f"{costs.outputs:,} outputs. Every tick costs {costs.operations:,} operations, the same whatever happens; "
        f"there is one every {inspection.period:g} s.</p>"
    )
    if costs.gates > MOST_GATES:
        values = json.dumps(compact(inspection.circuit), separators=(",", ":")).replace("<", "\\u003c")
        return f'{said}<div id="part"></div><script type="application/json" id="made">{values}</script>'
    return f'{said}<div class="wide">{tagged(inspection.circuit)}</div>'


def _percepts(inspection: Inspection) -> Iterator[str]:
    yield "<table><thead><tr><th>rule</th><th>asks</th></tr></thead><tbody>"
    for reads in inspection.percepts:
        asks = "".join(f"<div>{escape(one)}</div>" for one in (*reads.percepts, *reads.memory))
        line = (
            f' <a href="#line-{reads.line}">{reads.line}</a>'
            if reads.line
            else f" <i>{escape(where(reads).strip())}</i>"
        )
        yield f'<tr class="hit"><td class="rule">{escape(reads.rule)}{line}</td><td>{asks or "nothing"}</td></tr>'
    yield "</tbody></table>"


def _text(text: str) -> Iterator[str]:
    for number, line in enumerate(text.splitlines(), start=1):
        yield f'<div id="line-{number}" class="line"><i>{number}</i>{escape(line) or " "}</div>'
