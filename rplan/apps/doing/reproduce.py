"""What `rplan reproduce` does.

Takes: names of rows or papers. Gives: the paper's figures beside ours, as a table and as pages. Leaves alone: options
and their help; see rplan/apps/commands/reproduce.py, which imports this only when there is something to do.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from difflib import get_close_matches
from importlib.util import find_spec
from pathlib import Path
from time import perf_counter

import click
from rich.console import Console
from rich.table import Table

from rplan.apps import talk
from rplan.apps.files import InputError, unreadable
from rplan.apps.progress import counting
from rplan.apps.reproduce import experiment, report
from rplan.apps.reproduce.experiment import Asked, Batch
from rplan.apps.reproduce.report import Result
from rplan.apps.reproduce.row import PRESETS, Measures, Preset, Row
from rplan.apps.reproduce.rows import every_row
from rplan.apps.reproduce.showing import find, replay
from rplan.apps.sweep import processes
from rplan.apps.sweep.grid import GridError
from rplan.apps.sweep.processes import EngineError
from sim.scenarios.schema import ScenarioError

MISSED = 1
LIKE = 0.5
"""How like a name must be to be the one that was meant; of two letters one."""
WIDE = 200  # columns, where the reader is no terminal


def run(
    rows: tuple[str, ...],
    seeds: int,
    workers: int | None,
    preset: str | None,
    write: Path | None,
    listing: bool,
    case: str | None,
    seed: int | None,
    replay_file: Path | None,
    as_json: bool,
) -> None:
    """Do what was asked; leaves with the exit code of the command."""
    chosen = chosen_rows(rows)
    if listing:
        _list(chosen, as_json)
        return
    asked = [Asked(row, one) for row in chosen for one in _presets(row, preset)]
    if replay_file is not None:
        _replay(asked, seeds, case, seed, replay_file)
        return
    if case is not None or seed is not None:
        raise InputError("--case and --seed say which episode --replay shows: give --replay FILE")
    if write is not None:
        _check_folder(write)
    begin = perf_counter()
    measures, stopped = _run(_batches(asked, seeds), workers or processes.cores())
    every = report.results(asked, measures, seeds)
    if as_json:
        talk.result({"seeds": seeds, "wall": perf_counter() - begin, "stopped": stopped, "rows": report.plain(every)})
    else:
        _show(every, len(measures), perf_counter() - begin)
    if write is not None and not stopped:
        _write(every, seeds, write)
    raise SystemExit(_code(every, stopped))


# --- which rows ---------------------------------------------------------------------------------------


def chosen_rows(names: Sequence[str]) -> list[Row]:
    """The rows that the user means, each once, in their own order; without names all. Raises InputError."""
    every = every_row()
    known = [*(row.name for row in every), *dict.fromkeys(row.paper for row in every)]
    wanted = [_known(name, known) for name in names]
    return [row for row in every if not wanted or row.name in wanted or row.paper in wanted]


def _known(name: str, known: Sequence[str]) -> str:
    for one in known:
        if one.lower() == name.lower():
            return one
    meant = get_close_matches(name.lower(), [one.lower() for one in known], 1, LIKE)
    hint = next((f"; did you mean {one}?" for one in known if meant and one.lower() == meant[0]), "")
    raise InputError(f"there is no row or paper {name}{hint} (there are: {', '.join(known)})")


def _presets(row: Row, asked: str | None) -> tuple[Preset, ...]:
    if not row.cases(1):
        return row.presets
    match asked:
        case None:
            return row.presets
        case "both":
            return PRESETS
        case _:
            return tuple(one for one in PRESETS if one == asked)


def _list(rows: Sequence[Row], as_json: bool) -> None:
    if as_json:
        talk.result([{"row": r.name, "paper": r.paper, "title": r.title, "set_up": r.set_up} for r in rows])
        return
    table = Table(box=None, pad_edge=False)
    for name in ("row", "paper", "presets", "experiment"):
        table.add_column(name, no_wrap=name != "experiment")
    for row in rows:
        table.add_row(row.name, row.paper, ", ".join(row.presets), f"{row.title}. {row.set_up}")
    _console().print(table)


# --- the run ------------------------------------------------------------------------------------------


def _batches(asked: Sequence[Asked], seeds: int) -> list[Batch]:
    try:
        return experiment.batches(asked, seeds)
    except GridError as error:
        raise InputError("nothing was run\n" + "\n".join(f"  {problem}" for problem in error.problems)) from None
    except ScenarioError as error:
        raise InputError("nothing was run\n" + "\n".join(f"  {problem}" for problem in error.problems)) from None


def _run(every: Sequence[Batch], workers: int) -> tuple[list[Measures], bool]:
    """Measures, and whether Ctrl-C ended it."""
    found: list[Measures] = []
    try:
        with counting(sum(len(batch.tasks) for batch in every)) as count:
            found.extend(experiment.run(every, workers, lambda measures: count(_episode(measures))))
    except KeyboardInterrupt:
        return found, True
    except EngineError as error:
        raise InputError(str(error)) from None
    return found, False


def _episode(measures: Measures) -> str:
    return f"{measures.get('row')} {measures.get('preset')}, {measures.get('case')}"


def _replay(asked: Sequence[Asked], seeds: int, case: str | None, seed: int | None, file: Path) -> None:
    if len(asked) != 1:
        raise InputError("--replay shows one episode: name one row, and --preset where it has several")
    if not file.resolve().parent.is_dir():
        raise InputError(f"there is no folder {file.parent} to write {file.name} into")
    try:
        said = replay(find(asked[0], seeds, case), seed, file)
    except (GridError, ScenarioError) as error:
        raise InputError("\n".join(map(str, error.problems))) from None
    except OSError as error:
        unreadable(file, error)
    click.echo(f"{said}\nwrote {file}")


# --- what came of it ----------------------------------------------------------------------------------


def _console() -> Console:
    console = Console(file=sys.stdout, highlight=False, markup=False, soft_wrap=False)
    if not console.is_terminal:
        console.width = WIDE
    return console


def _show(every: Sequence[Result], episodes: int, wall: float) -> None:
    console = _console()
    console.print(report.table(every))
    told = report.reasons(every)
    if told:
        console.print()
    for line in told:
        console.print(line)
    findings = [finding for result in every for finding in result.findings]
    counts = ", ".join(f"{sum(f.judgement == j for f in findings)} {j}" for j in report.STYLES)
    console.print(f"\n{episodes:,} episodes in {wall:.0f} s; {len(findings)} figures: {counts}")


def _check_folder(folder: Path) -> None:
    if find_spec("matplotlib") is None:
        raise InputError("--write needs matplotlib: pip install 'rplan[plot]'")
    if not folder.resolve().parent.is_dir():
        raise InputError(f"there is no folder {folder.parent} to write into")


def _write(every: Sequence[Result], seeds: int, folder: Path) -> None:
    from rplan.apps.reproduce import page

    try:
        for written in page.write(every, seeds, folder):
            click.echo(f"wrote {written}", err=True)
    except OSError as error:
        unreadable(folder, error)


def _code(every: Sequence[Result], stopped: bool) -> int:
    missed = any(finding.judgement == "missed" for result in every for finding in result.findings)
    return MISSED if stopped or missed or any(result.failed for result in every) else 0
