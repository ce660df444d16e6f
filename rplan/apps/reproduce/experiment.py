"""Rows as episodes, and episodes on all cores.

Takes: rows, presets, how many seeds. Gives: `Batch`es, one a plan, and the measures of every episode in a fixed order,
however many workers there are. Leaves alone: what is measured (rows/) and how it is judged and shown.

The workers are those of sweeps (rplan/apps/sweep/processes.py): a killed one costs no result.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path
from time import perf_counter

from rplan.apps.files import plan_file, plans_folder, scenario_file
from rplan.apps.libraries import Catalogue, catalogue
from rplan.apps.reproduce.row import Case, Measures, Preset, Row
from rplan.apps.reproduce.rows import row_named
from rplan.apps.reproduce.watch import watch
from rplan.apps.simulation import World, load_world
from rplan.apps.sweep import processes
from rplan.apps.sweep.grid import GridError, path, with_value
from rplan.apps.sweep.processes import Worker
from rplan.apps.sweep.work import Change, Runner, Task, Variant, Work, changed, head, in_words
from rplan.apps.wiring import compile_file
from rplan.driver import Compiled
from sim.scenarios.format import loads

PRESET = "preset"


@dataclass(frozen=True, slots=True)
class Batch:
    """Episodes of one plan."""

    work: Work
    tasks: tuple[Task, ...]


@dataclass(frozen=True, slots=True)
class Asked:
    """A row with a preset."""

    row: Row
    preset: Preset


# --- what is to be run --------------------------------------------------------------------------------


def batches(asked: Sequence[Asked], seeds: int) -> list[Batch]:
    """All episodes, plan by plan. Raises InputError, GridError, ScenarioError, PlanError."""
    by_plan: dict[str, list[tuple[Asked, Case]]] = {}
    for one in asked:
        for case in one.row.cases_with(one.preset, seeds):
            by_plan.setdefault(case.plan, []).append((one, case))
    return [_batch(plan, cases) for plan, cases in by_plan.items()]


def _batch(plan: str, cases: Sequence[tuple[Asked, Case]]) -> Batch:
    file = plan_at(plan)
    compiled = compile_file(file)
    texts: dict[str, World] = {}
    variants, tasks = list[Variant](), list[Task]()
    for one, case in cases:
        world = texts.get(case.scenario) or load_world(scenario_at(case.scenario, file))
        texts[case.scenario] = world
        variants.append(variant_of(one, case, world, compiled))
        tasks += [Task(len(tasks) + k, len(variants) - 1, seed) for k, seed in enumerate(case.seeds)]
    return Batch(Work(compiled.sources, tuple(variants)), tuple(tasks))


def plan_at(plan: str) -> Path:
    """The file of a plan that comes with rplan. Raises InputError."""
    return plan_file(str(plans_folder() / plan))


def scenario_at(scenario: str, plan: Path) -> Path:
    """The file of a scenario that comes with rplan. Raises InputError."""
    return scenario_file(str(plans_folder() / f"{scenario}.yaml"), plan)


def variant_of(one: Asked, case: Case, world: World, compiled: Compiled) -> Variant:
    """A case with its scenario as its settings make it, and named after it. Raises GridError, ScenarioError."""
    name = world.scenario.name if case.is_plain else f"{one.row.name}, {case.name}"
    text = world.text if case.is_plain else with_value(world.text, ("name",), json.dumps(name))
    for key, value in case.settings:
        text = with_value(text, path(key), value)
    file = f"{Path(case.scenario).name}.yaml"
    loads(text, file)
    shown = (("row", one.row.name), (PRESET, one.preset), ("case", case.name))
    modern = one.row.modern if one.preset == "modern" else ()
    return Variant(name, file, text, (*presets(compiled, one.preset, catalogue()), *modern, *case.changes), shown)


def presets(compiled: Compiled, preset: Preset, libraries: Catalogue) -> tuple[Change, ...]:
    """The preset given to each library of the plan that knows presets. Raises GridError where none knows `modern`."""
    knowing = [
        bound.name
        for bound in compiled.goals.libraries
        if any(parameter.name == PRESET for parameter in libraries[bound.name].parameters)
    ]
    if not knowing and preset == "modern":
        raise GridError([f"no library of the plan {compiled.goals.name} has a preset"])
    return tuple(Change(name, PRESET, preset) for name in knowing)


# --- the worker's side --------------------------------------------------------------------------------


class Bench(Runner):
    """A worker that sees every tick: what it gives of an episode is what the row measures."""

    def row(self, task: Task) -> Measures:
        """Run an episode; what it raises is told in its measures."""
        variant = self._work.variants[task.variant]
        known = head(variant, task.seed)
        begin = perf_counter()
        try:
            row = row_named(str(known["row"]))
            compiled = changed(self._compiled, variant.changes)
            seen = watch(compiled, self._world(variant).scenario, task.seed, self._libraries)
            measured = row.measure(seen)
        except Exception as error:
            return known | {"error": in_words(error), "wall": perf_counter() - begin}
        return known | {"error": None} | measured | {"wall": perf_counter() - begin}


def serve(connection: Connection) -> None:
    """What a worker does: as in sweeps, with a `Bench`."""
    processes.serve(connection, Bench)


def start() -> Worker:
    """A worker process with a `Bench`."""
    return processes.start(serve)


# --- the run ------------------------------------------------------------------------------------------


def run(every: Iterable[Batch], workers: int, progress: Callable[[Measures], None]) -> Iterator[Measures]:
    """The measures of every episode, in the order in which they were asked for. Raises EngineError.

    progress: told of each episode when it is ready.
    """
    for batch in every:
        ready: dict[Task, Measures] = {}
        rows = processes.run(batch.work, batch.tasks, workers, start)
        try:
            for task, measures in rows:
                ready[task] = measures
                progress(measures)
        finally:
            rows.close()
        yield from (ready[task] for task in batch.tasks)
