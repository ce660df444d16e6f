"""What `rplan sweep` does.

Takes: a plan, scenarios, parameters, seeds. Gives: a row an episode, and what they say together. Leaves alone:
options and their help; see rplan/apps/commands/sweep.py, which imports this only when there is something to do.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path
from time import perf_counter

from rich.console import Console
from rich.table import Table

from rplan.apps import talk
from rplan.apps.files import InputError, plan_file, scenario_file, unreadable
from rplan.apps.progress import counting
from rplan.apps.simulation import load_world
from rplan.apps.sweep import processes
from rplan.apps.sweep.grid import MOST, GridError, Loaded, axes, seeds, variants
from rplan.apps.sweep.processes import EngineError
from rplan.apps.sweep.rows import Journal, JournalError, journal_of, write
from rplan.apps.sweep.summary import Group, Median, group
from rplan.apps.sweep.work import Row, Rows, Task, Work, head, tasks
from sim.scenarios.importers.imported import WorldFileError
from sim.scenarios.schema import ScenarioError

MISSED = 1
SUFFIXES = (".parquet", ".csv")
SHOWN_ERRORS = 5
WIDE = 160  # columns, where the reader is no terminal


@dataclass(frozen=True, slots=True)
class Asked:
    """A sweep as it is asked for."""

    plan: str
    work: Work
    tasks: tuple[Task, ...]
    workers: int
    engine: str
    scheduler: str | None
    output: Path


@dataclass(slots=True)
class State:
    """How far a sweep is. resumed: rows that were there before; wall [s]: since it was asked for."""

    rows: dict[Task, Row] = field(default_factory=dict)
    resumed: int = 0
    stopped: bool = False
    wall: float = 0.0

    def counts(self) -> str:
        """In words, for those who wait."""
        failed = sum(row.get("error") is not None for row in self.rows.values())
        done = sum(row.get("done") is True for row in self.rows.values())
        words = f"{done:,} done, {len(self.rows) - done - failed:,} not done"
        return words + (f", {failed:,} failed" if failed else "")


def run(
    plan: str,
    seed_texts: tuple[str, ...],
    scenario_texts: tuple[str, ...],
    params: tuple[str, ...],
    until: float | None,
    output: Path,
    resume: bool,
    workers: int | None,
    engine: str,
    scheduler: str | None,
    require_done: float | None,
    allow_holes: bool,
    as_json: bool,
) -> None:
    """Do what was asked; leaves with the exit code of the command."""
    if until is not None and math.isnan(until):
        raise InputError("--until is not a number")
    _check_engine(engine, scheduler)
    _check_output(output, resume)
    path = plan_file(plan)
    compiled = talk.compiled(path, allow_holes=allow_holes, as_json=as_json)
    try:
        chosen = seeds(seed_texts)
        grid = axes(params, compiled, talk.libraries())
        files = [file for text in scenario_texts or (None,) for file in _files(text, path)]
        _check_size(len(chosen), len(files), *(len(axis.choices) for axis in grid))
        loaded = [_loaded(file) for file in files]
        every = variants(loaded, grid, compiled, talk.libraries())
    except GridError as error:
        raise InputError("nothing was run\n" + "\n".join(f"  {problem}" for problem in error.problems)) from None
    work = Work(compiled.sources, every, talk.library_files(), until, allow_holes)
    all_tasks = tuple(tasks(work, chosen))
    asked = Asked(compiled.goals.name, work, all_tasks, workers or processes.cores(), engine, scheduler, output)
    state = sweep(asked, resume)
    groups = _groups(asked, state)
    if as_json:
        talk.result(_plain(asked, state, groups))
    else:
        _show(asked, state, groups)
    raise SystemExit(_code(state, groups, require_done))


def _check_engine(engine: str, scheduler: str | None) -> None:
    if scheduler is not None and engine != "dask":
        raise InputError("--scheduler is for --engine dask")
    if engine == "dask" and find_spec("distributed") is None:
        raise InputError("--engine dask needs dask: pip install 'rplan[cluster]'")


def _check_output(output: Path, resume: bool) -> None:
    """Say before the sweep, not after it, that its table cannot be written."""
    if output.suffix not in SUFFIXES:
        raise InputError(f"--output {output}: expected a name that ends in {' or '.join(SUFFIXES)}")
    if output.suffix == ".parquet" and find_spec("duckdb") is None:
        raise InputError("Parquet needs DuckDB: pip install 'rplan[data]', or write a .csv")
    if not output.resolve().parent.is_dir():
        raise InputError(f"there is no folder {output.parent} to write {output.name} into")
    journal = journal_of(output)
    if journal.exists() and not resume:
        raise InputError(f"{journal} has rows of a sweep that was stopped: --resume continues it, or remove the file")


def _check_size(*counts: int) -> None:
    if math.prod(counts) > MOST:
        raise GridError([f"{math.prod(counts):,} episodes are more than {MOST:,}"])


def _files(text: str | None, plan: Path) -> list[Path]:
    """The scenarios that a text names: one, or those that a pattern fits, in the order of their names."""
    if text is None or not any(letter in text for letter in "*?["):
        return [scenario_file(text, plan)]
    pattern = Path(text)
    found = sorted(Path(pattern.anchor).glob(str(pattern.relative_to(pattern.anchor))))
    if not found:
        raise InputError(f"no file fits --scenario {text}")
    return [scenario_file(str(name), plan) for name in found]


def _loaded(path: Path) -> Loaded:
    try:
        return Loaded(path, load_world(path))
    except ScenarioError as error:
        raise GridError(map(str, error.problems)) from None
    except WorldFileError as error:
        raise GridError([str(error)]) from None
    except OSError as error:
        unreadable(path, error)


# --- the run ------------------------------------------------------------------------------------------


def sweep(asked: Asked, resume: bool) -> State:
    """Run what is not in the journal yet, and write the table once every row is there."""
    begin = perf_counter()
    journal = Journal(journal_of(asked.output), asked.work)
    state = State()
    try:
        if resume and journal.path.exists():
            state.rows = journal.resumed(asked.tasks)
            state.resumed = len(state.rows)
        _run(asked, state, journal)
        if not state.stopped:
            write(asked.output, asked.work, [state.rows[task] for task in asked.tasks])
            journal.path.unlink(missing_ok=True)
    except (JournalError, EngineError) as error:
        kept = f"\n{len(state.rows):,} rows are kept in {journal.path}" if journal.path.exists() else ""
        raise InputError(f"{error}{kept}") from None
    except OSError as error:
        unreadable(asked.output, error)
    finally:
        journal.close()
    state.wall = perf_counter() - begin
    return state


def _run(asked: Asked, state: State, journal: Journal) -> None:
    open_tasks = [task for task in asked.tasks if task not in state.rows]
    if not open_tasks:
        return
    with counting(len(asked.tasks), state.resumed, state.counts()) as count:
        rows = _engine(asked, open_tasks)
        try:
            for task, row in rows:
                journal.add(task, row)
                state.rows[task] = row
                count(state.counts())
        except KeyboardInterrupt:
            state.stopped = True
        finally:
            rows.close()


def _engine(asked: Asked, open_tasks: Sequence[Task]) -> Rows:
    match asked.engine:
        case "dask":
            from rplan.apps.sweep import cluster

            return cluster.run(asked.work, open_tasks, asked.workers, asked.scheduler)
        case _:
            return processes.run(asked.work, open_tasks, asked.workers)


# --- the summary --------------------------------------------------------------------------------------


def _groups(asked: Asked, state: State) -> list[Group]:
    """Of each variant that has a row."""
    rows: dict[int, list[Row]] = {}
    for task in asked.tasks:
        if task in state.rows:
            rows.setdefault(task.variant, []).append(state.rows[task])
    variants = asked.work.variants
    return [group(variants[index].scenario, variants[index].shown, some) for index, some in rows.items()]


def _code(state: State, groups: Sequence[Group], require_done: float | None) -> int:
    missed = require_done is not None and any(one.share < require_done for one in groups)
    return MISSED if state.stopped or missed or any(one.failed for one in groups) else 0


def _show(asked: Asked, state: State, groups: Sequence[Group]) -> None:
    console = Console(file=sys.stdout, highlight=False, markup=False, soft_wrap=True)
    if not console.is_terminal:
        console.width = WIDE
    console.print(_line(asked, state))
    if groups:
        console.print(_table(groups))
    failed = [(task, row["error"]) for task, row in state.rows.items() if row.get("error") is not None]
    for task, error in sorted(failed, key=lambda pair: pair[0].index)[:SHOWN_ERRORS]:
        console.print(f"failed: {_said(asked.work, task)}: {error}")
    if len(failed) > SHOWN_ERRORS:
        console.print(f"… and {len(failed) - SHOWN_ERRORS:,} more")
    if state.stopped:
        kept = journal_of(asked.output)
        console.print(f"stopped by hand; the rows are in {kept}, and --resume continues")
    else:
        console.print(f"wrote {asked.output}")


def _line(asked: Asked, state: State) -> str:
    ran = len(state.rows) - state.resumed
    again = f", {state.resumed:,} of them before" if state.resumed else ""
    return f"{asked.plan}: {len(state.rows):,} of {len(asked.tasks):,} episodes{again}: {state.counts()}" + (
        f" ({state.wall:.0f} s, {state.wall / ran:.2f} s an episode)\n" if ran else "\n"
    )


def _said(work: Work, task: Task) -> str:
    known = head(work.variants[task.variant], task.seed)
    return ", ".join(str(value) if name == "scenario" else f"{name} {value}" for name, value in known.items())


def _table(groups: Sequence[Group]) -> Table:
    table = Table(box=None, pad_edge=False)
    for name in ("scenario", *(name for name, _ in groups[0].params)):
        table.add_column(name, overflow="fold")
    for name in ("n", "done", "95 %", "one way [s]", "round trip [s]", "total [s]", "contacts", "driven into"):
        table.add_column(name, justify="right", no_wrap=True)
    for one in groups:
        table.add_row(
            one.scenario,
            *(f"{value:g}" if isinstance(value, float) else str(value) for _, value in one.params),
            f"{one.episodes:,}",
            f"{100 * one.share:.1f} %",
            f"{100 * one.interval[0]:.1f} … {100 * one.interval[1]:.1f}",
            *(_median(median) for _, median in one.times),
            f"{one.contacts:,}",
            f"{one.driven_into:,}",
        )
    return table


def _median(median: Median) -> str:
    if median.value is None:
        return "-"
    between = f" ({median.interval[0]:.1f} … {median.interval[1]:.1f})" if median.interval else ""
    return f"{median.value:.1f}{between}"


def _plain(asked: Asked, state: State, groups: Sequence[Group]) -> object:
    return {
        "plan": asked.plan,
        "episodes": len(asked.tasks),
        "rows": len(state.rows),
        "resumed": state.resumed,
        "stopped": state.stopped,
        "engine": asked.engine,
        "workers": asked.workers,
        "wall": state.wall,
        "output": str(journal_of(asked.output) if state.stopped else asked.output),
        "groups": [_plain_group(one) for one in groups],
    }


def _plain_group(one: Group) -> object:
    return {
        "scenario": one.scenario,
        "params": dict(one.params),
        "episodes": one.episodes,
        "done": one.done,
        "failed": one.failed,
        "share": one.share,
        "interval": list(one.interval),
        **{
            name: {"n": m.count, "median": m.value, "interval": list(m.interval) if m.interval else None}
            for name, m in one.times
        },
        "contacts": one.contacts,
        "driven_into": one.driven_into,
        "untouched": one.untouched,
    }
