"""Coverage of one plan as a page: its text, what was taken of it, what decided, and what is missing.

Takes: a compiled plan, what was reached of it, and what was not in words. Gives: one HTML text without anything from
outside, light and dark.
Leaves alone: where it is written.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from html import escape
from itertools import groupby
from pathlib import Path

from rplan.driver import Compiled
from rplan.lang.source import Span
from rplan.ways.tally import ForkReached, PartReached, Reached

STYLE = """
:root { color-scheme: light dark; --paper: #fbfaf7; --card: #ffffff; --ink: #23262b; --faint: #6d737d; --line: #e4e1da;
  --yes: #dff1e3; --yes-ink: #17693a; --no: #fbdcd8; --no-ink: #a3271a; --never: #eceae4; --never-ink: #6d737d;
  --part: #fbecc6; --part-ink: #7a5200; --bar: #2f8f5b; }
@media (prefers-color-scheme: dark) { :root { --paper: #15171b; --card: #1c1f25; --ink: #e3e5e9; --faint: #8f96a3;
  --line: #2c3038; --yes: #173626; --yes-ink: #86d9a5; --no: #4a1f1d; --no-ink: #ff9d92; --never: #2a2d34;
  --never-ink: #9aa1ad; --part: #41330f; --part-ink: #f0c96a; --bar: #4fb57f; } }
* { box-sizing: border-box }
body { margin: 0; background: var(--paper); color: var(--ink); font: 15px/1.5 system-ui, sans-serif; }
main { max-width: 76rem; margin: 0 auto; padding: 2rem 1.5rem 4rem; }
h1 { font-size: 1.5rem; margin: 0; } p { margin: .2rem 0 1.4rem; color: var(--faint); }
.figures { display: grid; grid-template-columns: repeat(auto-fit, minmax(11rem, 1fr)); gap: .8rem; margin: 1rem 0; }
.figure { background: var(--card); border: 1px solid var(--line); border-radius: .6rem; padding: .7rem .9rem; }
.figure b { display: block; font-size: 1.35rem; font-variant-numeric: tabular-nums; }
.figure span { color: var(--faint); font-size: .85rem; }
.bar { height: .3rem; border-radius: .2rem; background: var(--line); margin-top: .45rem; overflow: hidden; }
.bar i { display: block; height: 100%; background: var(--bar); }
.key { display: flex; gap: 1.2rem; flex-wrap: wrap; font-size: .85rem; color: var(--faint); margin: .6rem 0 .8rem; }
.text { background: var(--card); border: 1px solid var(--line); border-radius: .6rem; overflow-x: auto; }
table { border-collapse: collapse; width: 100%; font: 13px/1.6 ui-monospace, Menlo, Consolas, monospace; }
td { padding: 0 .7rem; vertical-align: top; white-space: pre; }
td.n, td.t { text-align: right; color: var(--faint); user-select: none; border-right: 1px solid var(--line); }
td.t { font-variant-numeric: tabular-nums; } td:last-child { width: 100%; }
.notes { white-space: normal; font-size: 12px; margin: .1rem 0 .35rem; }
tr:first-child td { padding-top: .5rem } tr:last-child td { padding-bottom: .5rem }
.yes { background: var(--yes); } .no { background: var(--no); } .never { background: var(--never); }
.chip { display: inline-block; border-radius: .3rem; padding: 0 .4rem; margin: 0 .3rem .1rem 0; }
.swatch { display: inline-block; width: 1.1rem; height: .8rem; border-radius: .2rem; vertical-align: -1px; }
.swatch.part { background: var(--part); }
.chip.yes { color: var(--yes-ink) } .chip.no { color: var(--no-ink) } .chip.never { color: var(--never-ink) }
.chip.part { background: var(--part); color: var(--part-ink); }
h2 { font-size: 1.05rem; margin: 1.6rem 0 .5rem; } h2 span { color: var(--faint); font-weight: normal; }
ul { margin: 0; padding: .6rem .9rem; list-style: none; background: var(--card); border: 1px solid var(--line);
  border-radius: .6rem; font: 13px/1.6 ui-monospace, Menlo, Consolas, monospace; overflow-wrap: anywhere; }
li small { display: block; font-size: 12px; color: var(--faint); padding-left: 2ch; }
"""

KEY = (
    ("yes", "taken by a test"),
    ("no", "not taken"),
    ("never", "can never be taken"),
    ("part", "a part of a condition that never decided"),
)


@dataclass(frozen=True, slots=True)
class Section:
    """What was not reached of one kind. lines: what, and what is to be perceived for it (else false or 0), "" where
    that is not known; count: so many there are, those that are not listed among them.
    """

    title: str
    lines: Sequence[tuple[str, str]]
    count: int


def page(compiled: Compiled, seen: Reached, ways: str, missing: Sequence[Section]) -> str:
    """The page of a plan; ways: how many were taken, of how many."""
    name, said = escape(compiled.goals.name), (Path(compiled.source.name).name, compiled.goals.doc)
    figures = "".join(_figures(seen, ways))
    key = "".join(f'<span><span class="swatch {kind}"></span> {says}</span>' for kind, says in KEY)
    rows = "".join(_rows(compiled, seen))
    return (
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>{name}: coverage</title><style>{STYLE}</style></head><body><main>"
        f"<h1>{name}</h1><p>{escape(': '.join(filter(None, said)))}</p>"
        f'<div class="figures">{figures}</div><div class="key">{key}</div>'
        f'<div class="text"><table>{rows}</table></div>{"".join(map(_section, missing))}</main></body></html>\n'
    )


def _section(section: Section) -> str:
    items = "".join(
        f"<li>{escape(text)}{f'<small>given {escape(given)}</small>' if given else ''}</li>"
        for text, given in section.lines
    )
    more = section.count - len(section.lines)
    rest = f"<li>… and {more} more</li>" if more else ""
    return f"<h2>{escape(section.title)} <span>{section.count}</span></h2><ul>{items}{rest}</ul>"


def _figures(seen: Reached, ways: str) -> Iterator[str]:
    some, every = ways.replace("≥", "").split("/")
    yield _figure("ways taken", ways.replace("/", " of "), int(some), int(every))
    yield _figure("branches taken", "{} of {}".format(*seen.arms), *seen.arms)
    yield _figure("conditions that decided (MC/DC)", "{} of {}".format(*seen.conditions), *seen.conditions)
    yield f'<div class="figure"><b>{seen.ticks:,}</b><span>ticks seen</span></div>'


def _figure(what: str, text: str, some: int, every: int) -> str:
    width = 100 * some // every if every else 100
    bar = f'<div class="bar"><i style="width:{width}%"></i></div>'
    return f'<div class="figure"><b>{text}</b><span>{what}</span>{bar}</div>'


def _rows(compiled: Compiled, seen: Reached) -> Iterator[str]:
    file = compiled.source.name
    lines = compiled.source.text.splitlines()
    kinds = _painted(file, lines, seen.forks)
    for number, (line, painted) in enumerate(zip(lines, kinds, strict=True), start=1):
        arms = [
            (fork, arm)
            for fork in seen.forks
            for arm in fork.arms
            if (arm.arm.span.file, arm.arm.span.line) == (file, number)
        ]
        times = max((arm.times for _, arm in arms), default=None)
        chips = "".join(_chips(number, file, seen))
        indent = len(line) - len(line.lstrip())
        notes = f'<div class="notes" style="margin-left:{indent}ch">{chips}</div>' if chips else ""
        shown = "" if times is None else f"{times:,}×"
        yield (
            f'<tr><td class="n">{number}</td><td class="t">{shown}</td><td>{_marked(line, painted)}{notes}</td></tr>\n'
        )


def _painted(file: str, lines: Sequence[str], forks: Sequence[ForkReached]) -> list[list[str]]:
    """For each letter what became of the innermost arm that it stands in."""
    kinds = [[""] * len(line) for line in lines]
    every = [(arm.arm.span, _kind(arm.times, arm.never)) for fork in forks for arm in fork.arms]
    rules = {fork.fork.owner for fork in forks if fork.fork.kind == "rule"}
    spans = [(span, kind) for span, kind in every if span.file == file and (span not in rules or kind != "yes")]
    for span, kind in sorted(spans, key=lambda one: (one[0].line, one[0].column, -one[0].end_line, -one[0].end_column)):
        for row, first, last in _cells(span, lines):
            first = max(first, len(lines[row]) - len(lines[row].lstrip()))
            kinds[row][first:last] = [kind] * max(0, last - first)
    return kinds


def _cells(span: Span, lines: Sequence[str]) -> Iterator[tuple[int, int, int]]:
    for row in range(span.line - 1, min(span.end_line, len(lines))):
        first = span.column - 1 if row == span.line - 1 else 0
        last = span.end_column - 1 if row == span.end_line - 1 else len(lines[row])
        yield row, first, min(last, len(lines[row]))


def _kind(times: int, never: bool) -> str:
    return "yes" if times else "never" if never else "no"


def _marked(line: str, painted: Sequence[str]) -> str:
    parts = []
    for kind, letters in groupby(zip(line, painted, strict=True), key=lambda pair: pair[1]):
        text = escape("".join(letter for letter, _ in letters))
        parts.append(f'<span class="{kind}">{text}</span>' if kind else text)
    return "".join(parts)


def _chips(number: int, file: str, seen: Reached) -> Iterator[str]:
    """What is to be said below a line: what was not taken, or never decided, where it was asked; what cannot be."""
    asked = [fork for fork in seen.forks if any(arm.times for arm in fork.arms)]
    spans = [fork.fork.span for fork in asked]
    for fork in asked:
        for arm in fork.arms:
            if not arm.times and (fork.fork.span.file, fork.fork.span.line) == (file, number):
                says = "never: " if arm.never else "not taken: "
                yield f'<span class="chip {_kind(0, arm.never)}">{says}{escape(arm.arm.text)}</span>'
    for part in seen.parts:
        span = part.part.span
        if (span.file, span.line) == (file, number):
            yield from _part_chips(part, asked=span in spans)


def _part_chips(part: PartReached, *, asked: bool) -> Iterator[str]:
    text = escape(part.part.text)
    if asked and part.missing:
        yield f'<span class="chip part">{text} never decided as {part.missing}</span>'
    if part.never:
        yield f'<span class="chip never">{text} cannot decide as {part.never}</span>'
