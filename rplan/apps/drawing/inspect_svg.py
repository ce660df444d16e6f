"""An inspection as drawings in SVG.

Takes: an `Inspection` and which part. Gives: an SVG text that needs nothing else. Leaves alone: circuits, which svg.py
draws, of a large one the part that is named; `ValueError` for what is too large to be read.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from html import escape

from rplan.apps.drawing.inspect import Branch, Inspection
from rplan.apps.drawing.inspect_circuit_part import choice
from rplan.apps.drawing.inspect_circuit_part import part as circuit_part
from rplan.apps.drawing.inspect_text import WIDEST, WIDTH, listed, percepts_text
from rplan.apps.drawing.svg import MOST_GATES
from rplan.apps.drawing.svg import svg as circuit_svg

LINE, INDENT, LETTER, MARGIN = 18.0, 18.0, 6.7, 16.0
MOST_LINES = 5000
SHORT = 90
"""Letters of a text in a drawing; more end in an ellipsis, with all of it as its tooltip."""
STYLE = """
text { font: 11px ui-monospace, Menlo, Consolas, monospace; fill: #1c2733; } .head { font: bold 15px sans-serif; }
.dim { fill: #6b7788; } .rule { font-weight: bold; } .do { fill: #23508e; } .if { fill: #7a4a00; }
.hole { fill: #c2261d; }
.edge { fill: none; stroke: #aab4c2; } .yes { fill: #0b7a4b; font-weight: bold; } .no { fill: #c2261d; }
.row { fill: #f3f5f8; } .dot { fill: #23508e; }
""".strip()


def draw(inspection: Inspection, part: str, of: str = "") -> str:
    """The drawing of a part: table, goals, circuit or percepts; of the circuit, of what `of` names."""
    match part:
        case "circuit" if of or inspection.stats.gates > MOST_GATES:
            found = circuit_part(inspection.circuit, choice(inspection.circuit, of))
            return circuit_svg(found.circuit, found.numbers)
        case "circuit":
            return circuit_svg(inspection.circuit)
        case "table" if len(inspection.table.conditions) > WIDEST:
            return _lines(f"{inspection.name}: decision table", list(listed(inspection.table)))
        case "percepts" if len(_asked(inspection)) > WIDEST:
            return _lines(f"{inspection.name}: percepts", percepts_text(inspection).splitlines())
        case "table":
            return _matrix(f"{inspection.name}: decision table", *_table(inspection))
        case "percepts":
            return _matrix(f"{inspection.name}: percepts", *_percepts(inspection))
        case _:
            return _goals(inspection)


def words(branch: Branch) -> str:
    """What stands at a place of the goal tree, on one line."""
    says = {"if": f"if {branch.says}", "do": f"do {branch.says}"}.get(branch.kind, branch.says)
    return f"{branch.under}: {says}" if branch.under else says


# --- the goal tree ---------------------------------------------------------------------------------


def _goals(inspection: Inspection) -> str:
    flat = list(_flat(inspection.goals, 0))
    _check(len(flat))
    lines, last = list[str](), dict[int, float]()
    widest = 0.0
    for number, (depth, branch) in enumerate(flat):
        x, y = MARGIN + INDENT * depth, 50 + LINE * number
        if depth:
            side = x - INDENT + 5
            lines.append(f'<path class="edge" d="M{side:g} {last[depth - 1] + 5:g}V{y - 4:g}H{x - 3:g}"/>')
        last[depth] = y
        said = words(branch)
        lines.append(_text(x, y, said, branch.kind, branch.place))
        widest = max(widest, x + LETTER * min(len(said), SHORT))
    return _sheet(inspection.name, lines, widest + MARGIN, 50 + LINE * len(flat))


def _flat(branch: Branch, depth: int) -> Iterator[tuple[int, Branch]]:
    """Every place with its depth; what stands in an `else` of an `if` alone does not go deeper."""
    yield depth, branch
    for one in branch.inside:
        chained = branch.kind == "if" and one.kind == "if" and one.under == "else"
        yield from _flat(one, depth if chained else depth + 1)


# --- matrices --------------------------------------------------------------------------------------

Cells = Sequence[str]
Rows = list[tuple[Cells, str, str]]


def _table(inspection: Inspection) -> tuple[Sequence[str], Rows]:
    table = inspection.table
    rows: Rows = []
    for row in table.rows:
        when = dict(row.when)
        cells = ["" if name not in when else "✓" if when[name] else "✗" for name in table.conditions]
        about = " ".join((*row.rules, *(f"gives up {one}" for one in row.given_up)))
        rows.append((cells, "HOLE" if row.hole else " ".join(row.sets) or "(sets nothing)", about))
    return table.conditions, rows


def _percepts(inspection: Inspection) -> tuple[Sequence[str], Rows]:
    names = _asked(inspection)
    rows: Rows = [
        (["●" if one in reads.percepts else "" for one in names], reads.rule, ", ".join(reads.memory))
        for reads in inspection.percepts
    ]
    return names, rows


def _asked(inspection: Inspection) -> tuple[str, ...]:
    return tuple(dict.fromkeys(one for reads in inspection.percepts for one in reads.percepts))


def _lines(title: str, said: Sequence[str]) -> str:
    """Lines of text, those that are indented least in bold: what has more columns than an eye can follow."""
    _check(len(said))
    lines = []
    for number, line in enumerate(said):
        words = line.lstrip()
        indent, kind = len(line) - len(words), "dim" if line.startswith("    ") and not words[:1].isdigit() else "rule"
        x, y = MARGIN + LETTER * indent, 50 + LINE * number
        lines.append(_text(x, y, words, kind, "", WIDTH))
    widest = max((len(line) for line in said), default=0)
    return _sheet(title, lines, MARGIN * 2 + LETTER * 1.05 * min(widest, WIDTH + 6), 50 + LINE * len(said))


def _matrix(title: str, columns: Sequence[str], rows: Rows) -> str:
    """Rows of marks under names that lean, each row with what it says at its end."""
    _check(max(len(rows), len(columns)))
    step, top = 20.0, 60 + 0.62 * LETTER * max((min(len(name), SHORT) for name in columns), default=0)
    end = MARGIN + step * len(columns) + 14
    lines = []
    for number, name in enumerate(columns):
        x = MARGIN + step * number + 8
        lines.append(f'<g transform="translate({x:g} {top - 12:g}) rotate(-38)">{_text(0, 0, name, "", name)}</g>')
    widest = max((MARGIN + step * k + 8 + 0.79 * LETTER * min(len(n), SHORT) for k, n in enumerate(columns)), default=0)
    for number, (cells, says, about) in enumerate(rows):
        y = top + LINE * number + 6
        if number % 2 == 0:
            lines.append(f'<rect class="row" x="{MARGIN:g}" y="{y - 13:g}" width="{end + 600:g}" height="{LINE:g}"/>')
        for column, mark in enumerate(cells):
            if mark:
                kind = {"✓": "yes", "✗": "no"}.get(mark, "dot")
                lines.append(_text(MARGIN + step * column + 4, y, mark, kind, f"{columns[column]}: {says}"))
        lines.append(_text(end, y, says, "hole" if says == "HOLE" else "rule", about))
        widest = max(widest, end + 1.05 * LETTER * min(len(says), SHORT))
    return _sheet(title, lines, widest + MARGIN, top + LINE * len(rows) + MARGIN)


# --- text ------------------------------------------------------------------------------------------


def _check(lines: int) -> None:
    if lines > MOST_LINES:
        raise ValueError(f"{lines:,} lines are too many to be drawn (at most {MOST_LINES:,}): use --html")


def _text(x: float, y: float, said: str, kind: str, tip: str, longest: int = SHORT) -> str:
    short = said if len(said) <= longest else f"{said[: longest - 1]}…"
    title = f"<title>{_escaped(tip)}</title>" if tip else ""
    return f'<text class="{kind}" x="{x:g}" y="{y:g}">{title}{_escaped(short)}</text>'


def _sheet(title: str, lines: Sequence[str], width: float, height: float) -> str:
    size = f'width="{width:.0f}" height="{height:.0f}" viewBox="0 0 {width:.0f} {height:.0f}"'
    head = [
        f'<svg xmlns="http://www.w3.org/2000/svg" {size}>',
        f"<style>{STYLE}</style>",
        f'<rect width="{width:.0f}" height="{height:.0f}" fill="#ffffff"/>',
        f'<text class="head" x="{MARGIN:g}" y="26">{_escaped(title)}</text>',
    ]
    return "\n".join([*head, *lines, "</svg>"]) + "\n"


def _escaped(text: str) -> str:
    return escape("".join(letter if letter.isprintable() else "?" for letter in text))
