"""The work of a sweep, and one worker's part of it: episodes in, rows out.

Takes: texts of a plan and of scenarios, changes of parameters, seeds. Gives: `Task`, one episode of it, and `Runner`,
which compiles the plan once and makes a `Row` of each task. Leaves alone: who runs the tasks (processes.py, cluster.py)
and where rows go (rows.py).

All of it travels to other processes and machines, so it is texts and numbers.
"""

from __future__ import annotations

import hashlib
import math
import posixpath
from collections.abc import Generator, Iterable, Iterator, Mapping
from dataclasses import asdict, dataclass, replace
from importlib.metadata import version
from pathlib import Path
from time import perf_counter

from rplan.apps.libraries import catalogue
from rplan.apps.simulation import Run, World, simulate
from rplan.apps.wiring import compile_source
from rplan.driver import Compiled
from rplan.goals.goal import BoundLibrary
from rplan.lang.source import Source
from sim.judge import Verdict
from sim.scenarios.format import loads

Value = bool | int | float | str
Row = dict[str, Value | None]
"""Column -> value; a column that is not there is None."""

LONGEST_ERROR = 500


@dataclass(frozen=True, slots=True)
class Change:
    """Another value (SI) of a parameter of a library in use."""

    library: str
    parameter: str
    value: float | bool | str


@dataclass(frozen=True, slots=True)
class Variant:
    """A scenario with values of the swept parameters. file, text: of the scenario; shown: column -> value."""

    scenario: str
    file: str
    text: str
    changes: tuple[Change, ...] = ()
    shown: tuple[tuple[str, Value], ...] = ()


@dataclass(frozen=True, slots=True)
class Work:
    """All that is the same for every episode. sources: the plan's own text first; until: simulated seconds at most."""

    sources: tuple[Source, ...]
    variants: tuple[Variant, ...]
    library_files: tuple[Path, ...] = ()
    until: float | None = None
    allow_holes: bool = False

    def fingerprints(self) -> tuple[str, ...]:
        """A text for each variant that differs where its episodes would."""
        common = [
            version("rplan"),
            [(Path(source.name).name, source.text) for source in self.sources],
            [file.read_bytes() for file in self.library_files],
            self.until,
            self.allow_holes,
        ]
        return tuple(
            hashlib.sha256(repr([*common, one.scenario, one.text, one.changes]).encode()).hexdigest()[:16]
            for one in self.variants
        )


@dataclass(frozen=True, slots=True)
class Task:
    """One episode. index: its place in the table."""

    index: int
    variant: int
    seed: int


Rows = Generator[tuple[Task, Row], None, None]
"""Tasks with their rows, in the order in which they are ready; closing it ends what runs."""


def tasks(work: Work, seeds: Iterable[int]) -> Iterator[Task]:
    """Every variant with every seed, in the order of the table."""
    pairs = ((variant, seed) for variant in range(len(work.variants)) for seed in seeds)
    return (Task(index, variant, seed) for index, (variant, seed) in enumerate(pairs))


class Runner:
    """A plan, compiled and warm. Raises `PlanError`, `LibraryError`."""

    def __init__(self, work: Work) -> None:
        self._work = work
        self._libraries = catalogue(work.library_files)
        sources = {posixpath.normpath(source.name): source for source in work.sources}
        self._compiled = compile_source(
            work.sources[0], allow_holes=work.allow_holes, open_file=sources.__getitem__, libraries=self._libraries
        )
        self._latest: World | None = None

    def row(self, task: Task) -> Row:
        """Run an episode; what it raises is told in its row."""
        variant = self._work.variants[task.variant]
        known = head(variant, task.seed)
        begin = perf_counter()
        try:
            compiled = changed(self._compiled, variant.changes)
            run = simulate(compiled, self._world(variant), task.seed, until=self._work.until, libraries=self._libraries)
        except Exception as error:
            return known | {"done": False, "wall": perf_counter() - begin, "error": in_words(error)}
        return known | row_of(run)

    def _world(self, variant: Variant) -> World:
        """The scenario of a variant; the latest one is kept, since tasks come variant by variant."""
        if self._latest is None or self._latest.text != variant.text:
            self._latest = World(loads(variant.text, variant.file), variant.text)
        return self._latest


def head(variant: Variant, seed: int) -> Row:
    """What is known of a row before its episode runs."""
    return {"scenario": variant.scenario, **dict(variant.shown), "seed": seed}


def changed(compiled: Compiled, changes: Iterable[Change]) -> Compiled:
    """The plan with other values of parameters: its circuit is the same, since none of them is asked in it."""
    libraries = tuple(_with(bound, changes) for bound in compiled.goals.libraries)
    return replace(compiled, goals=replace(compiled.goals, libraries=libraries))


def _with(bound: BoundLibrary, changes: Iterable[Change]) -> BoundLibrary:
    new = {change.parameter: change.value for change in changes if change.library == bound.name}
    return replace(bound, settings={**bound.settings, **new})


def in_words(error: Exception) -> str:
    """An exception as a row tells it: its name and its first words."""
    said = f"{type(error).__name__}: {error}".rstrip(": ")
    return said if len(said) <= LONGEST_ERROR else said[: LONGEST_ERROR - 1] + "…"


# --- a run as a row -----------------------------------------------------------------------------------


def row_of(run: Run) -> Row:
    """The verdict and the counts of a run; times in seconds, lengths in metres, what is not finite is None."""
    verdict = run.verdict
    row: dict[str, object] = {
        **_verdict(verdict),
        "one_way": verdict.one_way,
        "round_trip": verdict.round_trip,
        "driven_into": verdict.driven_into,
        "ticks": run.ticks,
        "holes": run.holes,
        "faults": len(run.faults),
        "wall": run.wall,
        "real_time_factor": run.real_time_factor,
        "error": None,
    }
    return {name: _plain(value) for name, value in row.items()}


def _verdict(verdict: Verdict) -> dict[str, object]:
    """Its fields, those of its times beside them; of what is a list the count."""
    flat: dict[str, object] = {}
    for name, value in asdict(verdict).items():
        match value:
            case Mapping():
                flat |= value
            case tuple() | list():
                flat[name] = len(value)
            case _:
                flat[name] = value
    return flat


def _plain(value: object) -> Value | None:
    match value:
        case float():
            return value if math.isfinite(value) else None
        case bool() | int() | str() | None:
            return value
        case _:
            return str(value)
