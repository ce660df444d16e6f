"""What `rplan simulate` does.

Takes: a plan, a scenario, a seed. Gives: the verdict, with what was done how long and why it changed; recordings and
pictures of the run. Leaves alone: options and their help; see rplan/apps/commands/simulate.py, which imports this
only when there is something to do.
"""

from __future__ import annotations

import math
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict
from importlib.util import find_spec
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table
from rich.text import Text

from rplan.apps import talk
from rplan.apps.files import InputError, plan_file, scenario_file, unreadable
from rplan.apps.simulation import Run, World, lasted, simulate, world_in
from rplan.apps.viewer.page import write_page
from rplan.driver import Compiled
from rplan.lang.diagnostic import PlanError
from sim.recording import read
from sim.scenarios.schema import ScenarioError

NOT_DONE = 1


def run(
    plan: str,
    scenario: str | None,
    seed: int,
    until: float | None,
    record: Path | None,
    replay: Path | None,
    plot: Path | None,
    allow_holes: bool,
    as_json: bool,
) -> None:
    """Do what was asked; leaves with the exit code of the command."""
    if until is not None and math.isnan(until):
        raise InputError("--until is not a number")
    path = plan_file(plan)
    compiled = talk.compiled(path, allow_holes=allow_holes, as_json=as_json)
    file = scenario_file(scenario, path)
    world = world_in(file)
    _check_targets(record, replay, plot)
    with _recording(record, replay, plot) as recording:
        try:
            run = _run(compiled, path, world, seed, until, recording)
        except ScenarioError as error:
            told = [f"{file.name}, seed {seed}: {one.path}: {one.message}" for one in error.problems]
            raise InputError("\n".join(told)) from None
        if recording is not None:
            _draw(recording, replay, plot, _line(run))
    if as_json:
        talk.result(_plain(run))
    else:
        _show(run, [target for target in (record, replay, plot) if target is not None])
    raise SystemExit(0 if run.verdict.done else NOT_DONE)


def _check_targets(*targets: Path | None) -> None:
    """Say before the run, not after it, that a file cannot be written."""
    for target in targets:
        if target is not None and not target.resolve().parent.is_dir():
            raise InputError(f"there is no folder {target.parent} to write {target.name} into")
    if targets[-1] is not None and find_spec("matplotlib") is None:
        raise InputError("--plot needs matplotlib: pip install 'rplan[plot]'")


@contextmanager
def _recording(record: Path | None, *pictures: Path | None) -> Iterator[Path | None]:
    """Where the run is recorded: as the user wishes, or for as long as pictures are drawn from it."""
    if record is not None or not any(pictures):
        yield record
        return
    with tempfile.TemporaryDirectory() as folder:
        yield Path(folder) / "run.mcap"


def _run(compiled: Compiled, path: Path, world: World, seed: int, until: float | None, record: Path | None) -> Run:
    limit = world.scenario.time_limit if until is None else until
    try:
        with _progress(limit) as progress:
            return simulate(
                compiled, world, seed, until=until, record=record, progress=progress, libraries=talk.libraries()
            )
    except PlanError as error:
        talk.wrong(error, path)
    except OSError as error:
        unreadable(record or path, error)


@contextmanager
def _progress(limit: float) -> Iterator[Callable[[float, str], None] | None]:
    """A bar on stderr with simulated time and phase; none where nobody looks."""
    console = Console(stderr=True)
    if not console.is_terminal:
        yield None
        return
    columns = (
        TextColumn("{task.fields[now]:>6.0f} s"),
        BarColumn(),
        TextColumn("{task.description}"),
        TimeElapsedColumn(),
    )
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task("starting", total=limit, now=0.0)

        def update(time: float, phase: str) -> None:
            bar.update(task, completed=time, now=time, description=phase)

        yield update


def _draw(recording: Path, replay: Path | None, plot: Path | None, verdict: str) -> None:
    if replay is not None:
        try:
            write_page(read(recording), replay, verdict, talk.libraries())
        except OSError as error:
            unreadable(replay, error)
    if plot is not None:
        from rplan.apps.drawing.plot import draw

        try:
            draw(read(recording), plot, verdict)
        except OSError as error:
            unreadable(plot, error)


# --- the verdict ------------------------------------------------------------------------------------


def _line(run: Run) -> str:
    verdict = run.verdict
    return f"done in {lasted(verdict.duration)}" if verdict.done else f"not done: {verdict.reason}"


def phases(run: Run) -> list[tuple[str, float | None]]:
    """Seconds of each phase of the task; None for what was not reached."""
    times, whole = run.verdict.times, ("in all", run.verdict.duration)
    match run.verdict.task:
        case "none":
            return [whole]
        case "reach":
            return [("to the goal", times.arrival), whole]
        case "round":
            return [("round", times.arrival), whole]
    marks = [0.0, times.departure, times.arrival, times.loaded, times.home]
    names = ["search, until departure", "to the donor (one way)", "hand-over", "return"]
    spans: list[tuple[str, float | None]] = []
    for name, begin, end in zip(names, marks, marks[1:], strict=False):
        spans.append((name, None if begin is None or end is None else end - begin))
    return [*spans, ("round trip", run.verdict.round_trip), whole]


def _show(run: Run, written: list[Path]) -> None:
    console = Console(file=sys.stdout, highlight=False, markup=False)
    verdict = run.verdict
    style, word = ("bold green", "DONE") if verdict.done else ("bold red", "NOT DONE")
    reason = _achieved(run) if verdict.done else verdict.reason
    console.print(Text.assemble((word, style), f": {reason}"))
    console.print(f"{run.plan} in {run.scenario}, seed {run.seed}\n")
    console.print(_verdict_table(run))
    console.print(_share_table(run))
    console.print(_switch_table(run))
    for fault in run.faults[:10]:
        console.print(Text.assemble(("fault", "red"), f" at {fault}"))
    for path in written:
        console.print(f"wrote {path}")


def _achieved(run: Run) -> str:
    match run.verdict.task:
        case "fetch":
            return "the object was fetched and brought home"
        case "reach":
            return f"the goal was reached in {lasted(run.verdict.duration)}"
        case "round":
            return f"round and back in {lasted(run.verdict.duration)}"
        case "none":
            return "the time is over; the scenario sets no task"


def _verdict_table(run: Run) -> Table:
    verdict = run.verdict
    into = verdict.driven_into
    table = Table(show_header=False, box=None, title="Verdict", title_justify="left", title_style="bold")
    table.add_column()
    table.add_column(justify="right")
    for name, seconds in phases(run):
        table.add_row(name, lasted(seconds))
    table.add_row("distance", f"{verdict.distance:.1f} m")
    table.add_row("contacts", f"{len(verdict.contacts)} ({into} driven into)" if verdict.contacts else "0")
    table.add_row("smallest clearance", f"{verdict.smallest_clearance:.2f} m")
    table.add_row("ticks", f"{run.ticks:,}")
    table.add_row("holes", f"{run.holes:,}")
    table.add_row("faults of competences", f"{len(run.faults):,}")
    table.add_row("real-time factor", f"{run.real_time_factor:.0f}")
    return table


def _share_table(run: Run) -> Table:
    table = Table("competence", box=None, title="\nCompetences", title_justify="left", title_style="bold")
    for name in ("ticks", "time", "switches to it"):
        table.add_column(name, justify="right")
    for name, share in run.shares.items():
        table.add_row(name, f"{share.ticks:,}", lasted(share.ticks * run.period), f"{share.switches:,}")
    return table


def _switch_table(run: Run) -> Table:
    table = Table(box=None, title="\nSwitches, and why", title_justify="left", title_style="bold")
    table.add_column("at", justify="right", no_wrap=True)
    table.add_column("channel")
    table.add_column("to", overflow="fold")
    table.add_column("because", overflow="fold")
    for switch in run.switches:
        table.add_row(f"{switch.time:.1f} s", switch.channel, switch.after, switch.because)
    return table


def _plain(run: Run) -> object:
    verdict = asdict(run.verdict)
    return {
        "plan": run.plan,
        "scenario": run.scenario,
        "seed": run.seed,
        **verdict,
        "phases": dict(phases(run)),
        "one_way": run.verdict.one_way,
        "round_trip": run.verdict.round_trip,
        "driven_into": run.verdict.driven_into,
        "ticks": run.ticks,
        "competences": {name: asdict(share) for name, share in run.shares.items()},
        "switches": [asdict(switch) for switch in run.switches],
        "holes": run.holes,
        "faults": list(run.faults),
        "real_time_factor": run.real_time_factor,
    }
