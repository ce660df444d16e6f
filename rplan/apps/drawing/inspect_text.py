"""An inspection as text.

Takes: an `Inspection`. Gives: the lines of each of its parts. Leaves alone: the terminal.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import takewhile
from pathlib import PurePath

from rplan.apps.drawing.inspect import Branch, Inspection, Reads, Row, Table
from rplan.apps.drawing.inspect_words import register_words

WIDEST = 24
"""So many conditions have a column each; of more, each row says those that it asks."""
WIDTH, LEAST = 110, 50
"""Letters of a line, and how many at least what stands in it may have, however far it is indented."""
RANKED = "several rows may hold: one gives way to those above it with which it does not go together"
MARKS = {True: "✓", False: "✗", None: "·"}


def table_text(inspection: Inspection) -> str:
    """The decision table: ✓ must hold, ✗ must not, · does not matter."""
    table = inspection.table
    lines = list(_columns(table) if len(table.conditions) <= WIDEST else listed(table))
    if not table.exclusive:
        lines.append(RANKED)
    return "\n".join(lines)


def _columns(table: Table) -> Iterator[str]:
    width = len(str(len(table.conditions)))
    for number, name in enumerate(table.conditions, start=1):
        yield f"{number:>{width + 2}}  {name}"
    if table.conditions:
        yield ""
        yield "  " + " ".join(f"{number:>{width}}" for number in range(1, len(table.conditions) + 1))
    for row in table.rows:
        when = dict(row.when)
        marks = " ".join(f"{MARKS[when.get(name)]:>{width}}" for name in table.conditions) or "always"
        blank = " " * len(marks)
        lines = [*_sets(row, len(marks) + 4), *_about(row, len(marks) + 4)]
        yield from (f"  {marks if n == 0 else blank}  {line}".rstrip() for n, line in enumerate(lines))


def listed(table: Table) -> Iterator[str]:
    """Of each row what it does not share with the one above."""
    before: Sequence[tuple[str, bool]] = ()
    for number, row in enumerate(table.rows, start=1):
        same = len(list(takewhile(lambda pair: pair[0] == pair[1], zip(before, row.when, strict=False))))
        literals = [f"{MARKS[value]} {name}" for name, value in row.when[same:]]
        shared = [f"as above up to {row.when[same - 1][0]}"] if same else []
        first, *more = _sets(row, 6)
        yield f"{number:>4}  {first}"
        whens = _packed([*shared, *literals] or ["always"], "when ", 6)
        yield from (f"      {line}" for line in (*more, *whens, *_about(row, 6)))
        before = row.when


def _sets(row: Row, indent: int) -> list[str]:
    return ["HOLE"] if row.hole else _packed(row.sets or ("(sets nothing)",), "", indent, " ")


def _about(row: Row, indent: int) -> Iterator[str]:
    if row.rules:
        yield from _packed(row.rules, "by ", indent)
    if row.given_up:
        yield from _packed(row.given_up, "gives up ", indent)


def _packed(items: Sequence[str], lead: str, indent: int, between: str = ", ") -> list[str]:
    """As many items on a line as go there, one at least; further lines stand below the first item."""
    room, blank = max(WIDTH - indent, LEAST) - len(between.rstrip()), " " * len(lead)
    lines = [lead + items[0]]
    for item in items[1:]:
        if len(lines[-1]) + len(between) + len(item) > room:
            lines[-1] += between.rstrip()
            lines.append(blank + item)
        else:
            lines[-1] += between + item
    return lines


def goals_text(inspection: Inspection) -> str:
    """The goal tree."""
    return "\n".join(_tree(inspection.goals, "", ""))


def _tree(branch: Branch, first: str, rest: str) -> Iterator[str]:
    words = {"if": f"if {branch.says}", "do": f"do {branch.says}"}.get(branch.kind, branch.says)
    under = f"{branch.under}: " if branch.under else ""
    line = where(branch) if branch.kind in ("rule", "do") else ""
    yield f"{first}{under}{words}{line}"
    for number, one in enumerate(branch.inside):
        last = number == len(branch.inside) - 1
        yield from _tree(one, rest + ("└─ " if last else "├─ "), rest + ("   " if last else "│  "))


def where(one: Branch | Reads) -> str:
    """The line in the plan's own text; of an included text its file as well, without the folder."""
    if one.line is not None:
        return f"  :{one.line}"
    return f"  {PurePath(one.place.rpartition(':')[0]).name}" if one.place else ""


def circuit_text(inspection: Inspection) -> str:
    """What the circuit has, and what a tick of it costs whatever happens."""
    costs, circuit = inspection.stats, inspection.circuit
    kinds = [cell.op.value for cell in circuit.cells if cell.operands]
    counts = ", ".join(f"{kinds.count(kind)} {kind}" for kind in ("and", "or", "not") if kind in kinds)
    tick = f"{_many(costs.operations, 'operation')}, the same whatever happens, every {inspection.period:g} s"
    rows = [
        ("inputs", f"{costs.inputs:,}"),
        ("outputs", f"{costs.outputs:,}"),
        ("gates", f"{costs.gates:,}" + (f" ({counts})" if counts else "")),
        ("depth", f"{_many(costs.depth, 'gate')} one after another"),
        ("registers", f"{costs.registers:,}"),
        ("every tick", tick),
    ]
    lines = [f"{name:<12}{value}" for name, value in rows]
    lines += [
        f"{'register' if n == 0 else '':<12}{register_words(one.name)}" for n, one in enumerate(circuit.registers)
    ]
    return "\n".join(lines)


def percepts_text(inspection: Inspection) -> str:
    """What each rule asks, and by how many each percept is asked."""
    lines: list[str] = []
    for reads in inspection.percepts:
        lines.append(reads.rule + where(reads))
        lines += [f"    {one}" for one in (*reads.percepts, *reads.memory)] or ["    asks nothing"]
    counts: dict[str, int] = {}
    for reads in inspection.percepts:
        for one in reads.percepts:
            counts[one] = counts.get(one, 0) + 1
    often = sorted(counts.items(), key=lambda pair: -pair[1])
    asked = (
        f"{_many(len(counts), 'percept')}, by the number of rules that ask them:" if counts else "no percept is asked"
    )
    return "\n".join([*lines, *([""] if lines else []), asked, *(f"{count:>6}  {name}" for name, count in often)])


def _many(count: int, name: str) -> str:
    return f"{count:,} {name}{'' if count == 1 else 's'}"


PARTS = {"table": table_text, "goals": goals_text, "circuit": circuit_text, "percepts": percepts_text}


def text(inspection: Inspection, parts: Sequence[str]) -> str:
    """The parts, one below the other."""
    if len(parts) == 1:
        return PARTS[parts[0]](inspection)
    titles = {"table": "Decision table", "goals": "Goals", "circuit": "Circuit", "percepts": "Percepts"}
    return "\n\n".join(f"{titles[part]}\n\n{PARTS[part](inspection)}" for part in parts)
