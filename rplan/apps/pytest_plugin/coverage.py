"""What the tests reached of each plan: a table at the end of the run, and a page a plan.

Takes: a `Shelf` after the run. Gives: lines for the terminal, HTML files. Leaves alone: how it is counted; see
rplan/ways/tally.py.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from rplan.apps.pytest_plugin.page import page
from rplan.apps.pytest_plugin.shelf import Plan, Shelf
from rplan.ways.exhaust import count_ways, exhaustible
from rplan.ways.sample import Samples
from rplan.ways.tally import Reached, reached

MOST_MISSING = 6


def show(shelf: Shelf, terminal: Any, folder: Path | None) -> None:
    """Write the table, and the pages where a folder is given."""
    found = {path: (plan, reached(plan.compiled.ways, plan.ticks, plan.reach)) for path, plan in shelf.plans.items()}
    terminal.write_sep("-", "coverage of plans")
    for line in table({_named(path): pair for path, pair in found.items()}):
        terminal.write_line(line)
    if folder is None:
        return
    try:
        for written in pages(folder, list(found.values())):
            terminal.write_line(f"{written}")
    except OSError as error:
        terminal.write_line(f"{folder}: {error.strerror or error}", red=True)


def table(found: dict[str, tuple[Plan, Reached]]) -> Iterator[str]:
    """One line a plan, and what is missing below it."""
    if not found:
        yield "no plan was tested"
        return
    width = max(len(name) for name in (*found, "plan"))
    yield f"{'plan':<{width}}  {'ticks':>7}  {'ways':>9}  {'branches':>14}  {'conditions':>14}"
    for name, (plan, seen) in found.items():
        yield (
            f"{name:<{width}}  {seen.ticks:>7,}  {ways_text(plan, seen):>9}  "
            f"{share(*seen.arms):>14}  {share(*seen.conditions):>14}"
        )
        missing = list(_missing(seen)) if seen.ticks else []
        yield from (f"  {line}" for line in missing[:MOST_MISSING])
        if len(missing) > MOST_MISSING:
            yield f"  … and {len(missing) - MOST_MISSING} more"


def _named(path: Path) -> str:
    """The path from here, where it is below."""
    return str(path.relative_to(Path.cwd())) if path.is_relative_to(Path.cwd()) else str(path)


def ways_text(plan: Plan, seen: Reached) -> str:
    """Ways taken, of those that can be."""
    ways = plan.compiled.ways
    if exhaustible(ways):
        return f"{seen.ways}/{count_ways(ways)}"
    return f"{seen.ways}/≥{max(Samples(ways).count_ways(), seen.ways)}"


def share(some: int, every: int) -> str:
    """`5/6  83%`, rounded down, so that only all is 100%."""
    return f"{some}/{every} {100 if some == every else 100 * some // every:>4}%"


def _missing(seen: Reached) -> Iterator[str]:
    for fork in seen.forks:
        for arm in fork.arms:
            if not arm.times and not arm.never and fork.fork.kind != "rule":
                yield f"{arm.arm.span.line}: {fork.fork.rule}: not taken: {arm.arm.text}"
    for part in seen.parts:
        if values := part.missing:
            yield f"{part.span.line}: {part.rule}: {part.text} never decided as {values}"


def pages(folder: Path, found: list[tuple[Plan, Reached]]) -> Iterator[Path]:
    """Write a page for each plan; plans of one name are numbered. Raises OSError."""
    folder.mkdir(parents=True, exist_ok=True)
    names: dict[str, int] = {}
    for plan, seen in found:
        stem = Path(plan.compiled.source.name).stem
        names[stem] = names.get(stem, 0) + 1
        path = folder / f"{stem}{'' if names[stem] == 1 else f'-{names[stem]}'}.html"
        path.write_text(page(plan.compiled, seen, ways_text(plan, seen)), encoding="utf-8")
        yield path
