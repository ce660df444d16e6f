"""`rplan inspect PLAN`: how a plan decides, before it runs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

import click

from rplan.apps import talk
from rplan.apps.files import InputError, plan_file, unreadable

if TYPE_CHECKING:
    from rplan.apps.drawing.inspect import Inspection

FILE = click.Path(dir_okay=False, path_type=Path)


@click.command("inspect", short_help="Show how a plan decides: table, goals, circuit, percepts.")
@click.argument("plan")
@click.option("--table", is_flag=True, help="Which outputs are set where: the decision table.")
@click.option("--goals", is_flag=True, help="The goal tree: the top goal, the rules in it, their branches.")
@click.option("--circuit", is_flag=True, help="Gates, depth, registers, and what a tick costs.")
@click.option("--percepts", is_flag=True, help="What each rule asks.")
@click.option("--svg", type=FILE, help="Draw the part that is asked for; the goal tree if none is.")
@click.option("--of", help="Draw of the circuit what makes this output, or what reads this percept, register or gate.")
@click.option("--html", type=FILE, help="Write all parts as one page, with folds and a search.")
@click.option("--json", "as_json", is_flag=True, help="For programs.")
@talk.with_libraries
def command(
    plan: str,
    table: bool,
    goals: bool,
    circuit: bool,
    percepts: bool,
    svg: Path | None,
    of: str | None,
    html: Path | None,
    as_json: bool,
) -> None:
    """Show how PLAN decides. Without a part asked for it shows all of them."""
    from rplan.apps.drawing.inspect import inspect
    from rplan.apps.drawing.inspect_text import PARTS, text

    flags = {"table": table, "goals": goals, "circuit": circuit, "percepts": percepts}
    asked = [part for part, wanted in flags.items() if wanted]
    if svg is not None and len(asked) > 1:
        raise InputError("--svg draws one part: give one of --table, --goals, --circuit, --percepts")
    if of is not None and (svg is None or asked != ["circuit"]):
        raise InputError("--of goes with --circuit --svg")
    compiled = talk.compiled(plan_file(plan), allow_holes=True, as_json=as_json)
    found = inspect(compiled)
    if svg is not None:
        _write(svg, lambda: _drawn(found, asked[0] if asked else "goals", of or ""))
    if html is not None:
        _write(html, lambda: _page(found))
    if as_json:
        talk.result(_plain(found, asked or list(PARTS)))
    elif svg is None and html is None:
        click.echo(talk.printable(text(found, asked or list(PARTS))))


def _drawn(found: Inspection, part: str, of: str) -> str:
    from rplan.apps.drawing.inspect_svg import draw

    try:
        return draw(found, part, of)
    except ValueError as error:
        raise InputError(str(error)) from None


def _page(found: Inspection) -> str:
    from rplan.apps.drawing.inspect_page import page

    return page(found)


def _write(target: Path, make: Callable[[], str]) -> None:
    try:
        target.write_text(make(), encoding="utf-8")
    except OSError as error:
        unreadable(target, error)
    click.echo(f"wrote {target}", err=True)


def _plain(found: Inspection, parts: list[str]) -> dict[str, object]:
    rows = [
        {"when": dict(r.when), "sets": r.sets, "hole": r.hole, "rules": r.rules, "given_up": r.given_up}
        for r in found.table.rows
    ]
    every: dict[str, object] = {
        "table": {"conditions": found.table.conditions, "rows": rows, "exclusive": found.table.exclusive},
        "goals": asdict(found.goals),
        "circuit": asdict(found.stats) | {"period": found.period},
        "percepts": [asdict(reads) for reads in found.percepts],
    }
    return {"plan": found.name} | {part: every[part] for part in parts}
