"""What the tests reached of each plan and what not: a table at the end of the run, and a page a plan.

Takes: a `Shelf` after the run. Gives: lines for the terminal, HTML files. Leaves alone: how it is counted, and what
would reach the rest; see rplan/ways/tally.py and rplan/ways/missing.py.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from rplan.apps.pytest_plugin.page import Section, page
from rplan.apps.pytest_plugin.shelf import Plan, Shelf
from rplan.lang.source import Span
from rplan.ways.exhaust import count_ways, exhaustible
from rplan.ways.missing import Missing, MissingWay, missing_branches, missing_conditions, missing_ways
from rplan.ways.sample import Samples
from rplan.ways.situations import Trace, brief
from rplan.ways.tally import Reached

MOST_MISSING = 4
"""So many of each kind are listed in the terminal."""
MOST_ON_PAGE = 40


@dataclass(frozen=True)
class Found:
    """A plan and what was reached of it; what was not is sought when it is first asked for."""

    plan: Plan
    seen: Reached
    most: int

    @cached_property
    def branches(self) -> tuple[Missing, ...]:
        return missing_branches(self.seen, self.plan.prover, self.most)

    @cached_property
    def conditions(self) -> tuple[Missing, ...]:
        return missing_conditions(self.seen, self.plan.prover, self.most)

    @cached_property
    def ways(self) -> tuple[MissingWay, ...]:
        if self._exactly == len(self.seen.ways):
            return ()
        return missing_ways(self.seen, self.plan.asked.ways, self.plan.prover, self.most)

    @cached_property
    def _exactly(self) -> int | None:
        ways = self.plan.compiled.ways
        return count_ways(ways) if exhaustible(ways) else None

    @cached_property
    def every_way(self) -> int:
        """Ways that can be taken; at least so many, where not all were counted."""
        if self._exactly is not None:
            return self._exactly
        return max(Samples(self.plan.compiled.ways).count_ways(), len(self.seen.ways) + len(self.ways))

    @property
    def count(self) -> str:
        """Ways taken, of those that can be; `≥` where they were not all counted."""
        return f"{len(self.seen.ways)}/{'≥' if self._exactly is None else ''}{self.every_way}"


def show(shelf: Shelf, terminal: Any, folder: Path | None) -> None:
    """Write the table, and the pages where a folder is given."""
    most = MOST_MISSING if folder is None else MOST_ON_PAGE
    found = {path: Found(plan, plan.reached(), most) for path, plan in shelf.plans.items()}
    terminal.write_sep("-", "coverage of plans")
    for line in table({_named(path): one for path, one in found.items()}):
        terminal.write_line(line)
    if folder is None:
        return
    try:
        for written in pages(folder, list(found.values())):
            terminal.write_line(f"{written}")
    except OSError as error:
        terminal.write_line(f"{folder}: {error.strerror or error}", red=True)


def table(found: dict[str, Found]) -> Iterator[str]:
    """One line a plan, and what is missing below it."""
    if not found:
        yield "no plan was tested"
        return
    width = max(len(name) for name in (*found, "plan"))
    yield f"{'plan':<{width}}  {'ticks':>7}  {'ways':>9}  {'branches':>14}  {'conditions':>14}"
    for name, one in found.items():
        yield (
            f"{name:<{width}}  {one.seen.ticks:>7,}  {one.count:>9}  "
            f"{share(*one.seen.arms):>14}  {share(*one.seen.conditions):>14}"
        )
        for section in sections(one) if one.seen.ticks else ():
            yield f"  {section.title}"
            for text, reached_by in section.lines[:MOST_MISSING]:
                yield f"    {text}"
                yield from [f"      given {reached_by}"] if reached_by else []
            more = section.count - min(MOST_MISSING, len(section.lines))
            yield from [f"    … and {more} more"] if more > 0 else []


def _named(path: Path) -> str:
    """The path from here, where it is below."""
    return str(path.relative_to(Path.cwd())) if path.is_relative_to(Path.cwd()) else str(path)


def share(some: int, every: int) -> str:
    """`5/6  83%`, rounded down, so that only all is 100%."""
    return f"{some}/{every} {100 if some == every else 100 * some // every:>4}%"


# --- what is missing ---


def sections(one: Found) -> Iterator[Section]:
    """What was not reached, each with what is to be perceived for it; what cannot be stands last."""
    arms, conditions = one.seen.arms, one.seen.conditions
    listed = [
        Section("ways not taken", [_way(one, way) for way in one.ways], one.every_way - len(one.seen.ways)),
        Section("branches not taken", [_missing(one, m) for m in one.branches], arms[1] - arms[0]),
        Section("never decided so", [_missing(one, m) for m in one.conditions], conditions[1] - conditions[0]),
    ]
    never = [(text, "") for text in _never(one)]
    listed.append(Section("cannot be reached, and does not count", never[: one.most], len(never)))
    yield from (section for section in listed if section.lines)


def _missing(one: Found, missing: Missing) -> tuple[str, str]:
    return f"{_place(one, missing.span)}: {missing.rule}: {missing.text}", _given(one, missing.trace)


def _place(one: Found, span: Span) -> str:
    """The line; of an included file with its name."""
    return str(span.line) if span.file == one.plan.compiled.source.name else f"{Path(span.file).name}:{span.line}"


def _way(one: Found, missing: MissingWay) -> tuple[str, str]:
    way = missing.way
    sets = " ".join(dict.fromkeys(f"{act.output}={act.value}" for act in way.acts)) or "sets nothing"
    gives_up = f", gives up {', '.join(lost.member for lost in way.given_up)}" if way.given_up else ""
    return f"{sets} by {', '.join(way.rules) or 'the top goal'}{gives_up}", _given(one, missing.trace)


def _given(one: Found, trace: Trace | None) -> str:
    return "" if trace is None else brief(trace, one.plan.asked.ways)


def _never(one: Found) -> Iterator[str]:
    for fork in one.seen.forks:
        for arm in fork.arms:
            if arm.never and fork.fork.kind != "rule":
                yield f"{_place(one, arm.arm.span)}: {fork.fork.rule}: {arm.arm.text}"
    for part in one.seen.parts:
        if part.never:
            yield f"{_place(one, part.part.span)}: {part.part.rule}: {part.part.text} as {part.never}"


def pages(folder: Path, found: list[Found]) -> Iterator[Path]:
    """Write a page for each plan; plans of one name are numbered. Raises OSError."""
    folder.mkdir(parents=True, exist_ok=True)
    names: dict[str, int] = {}
    for one in found:
        compiled = one.plan.compiled
        stem = Path(compiled.source.name).stem
        names[stem] = names.get(stem, 0) + 1
        path = folder / f"{stem}{'' if names[stem] == 1 else f'-{names[stem]}'}.html"
        path.write_text(page(compiled, one.seen, one.count, list(sections(one))), encoding="utf-8")
        yield path
