"""Where plans, behaviours and worlds meet.

Takes: libraries of behaviours, compiled plans. Gives: their signatures for the compiler, a crew for the runtime, and
`PlanBrain`, a plan as the brain of an episode. Leaves alone: which robot or world; a brain sees readings only.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from pathlib import Path

from behaviours.interface import STOP, Command, Competence, Library, Pose, Reading, View, Workshop
from rplan.apps.libraries import Catalogue, catalogue
from rplan.backends.python import PythonEngine
from rplan.driver import Checks, Compiled, compile_plan, no_checks
from rplan.goals.signature import FunctionSignature, Libraries, LibrarySignature, ParameterSignature
from rplan.lang.diagnostic import Diagnostic, PlanError
from rplan.lang.include import OpenFile
from rplan.lang.plan import Type
from rplan.lang.reader import source_from_file
from rplan.lang.source import Source
from rplan.runtime.controller import Controller, Tick, UnboundError
from rplan.runtime.robot import Channels, Crew
from rplan.runtime.tick import Decider
from rplan.runtime.trace import Trace
from sim.world import LONGEST, SHORTEST


def signature(library: Library) -> LibrarySignature:
    """A library as the compiler sees it."""
    functions = tuple(
        FunctionSignature(f.name, (), Type(f.type, f.unit), f.doc, f.actuators, f.reads, library.name)
        for f in library.functions
    )
    parameters = tuple(ParameterSignature(p.name, Type(p.type, p.unit), p.default, p.doc) for p in library.parameters)
    return LibrarySignature(library.name, functions, parameters, library.doc, library.works_unasked)


def signatures(libraries: Catalogue | None = None) -> Libraries:
    """The libraries as the compiler sees them; without any named, every one that there is."""
    return {name: signature(library) for name, library in (libraries or catalogue()).items()}


def compile_file(
    path: Path,
    *,
    strict: bool = False,
    allow_holes: bool = False,
    checks: Checks = no_checks,
    libraries: Catalogue | None = None,
) -> Compiled:
    """The plan in a file, compiled against the libraries; `PlanError`, `OSError`."""
    source = source_from_file(path)
    return compile_source(source, strict=strict, allow_holes=allow_holes, checks=checks, libraries=libraries)


def compile_source(
    source: Source,
    *,
    strict: bool = False,
    allow_holes: bool = False,
    checks: Checks = no_checks,
    open_file: OpenFile | None = None,
    libraries: Catalogue | None = None,
) -> Compiled:
    """A plan compiled against the libraries; `PlanError`, also where a library refuses its parameters.

    open_file: where included files come from, without it the disk. libraries: without any, every one that there is.
    """
    offered = libraries or catalogue()
    compiled = compile_plan(
        source,
        signatures(offered),
        strict=strict,
        allow_holes=allow_holes,
        checks=checks,
        open_file=open_file or from_disk,
    )
    try:
        crew(compiled, offered)
    except PlanError as error:
        raise PlanError(error.diagnostics, compiled.texts) from None
    return compiled


def from_disk(path: str) -> Source:
    """The text of a file; `OSError`, `PlanError`."""
    return source_from_file(Path(path))


def decider(compiled: Compiled) -> Decider:
    """A plan that decides, run by generated Python."""
    return Decider(
        compiled.goals, compiled.ways.atoms[: compiled.ways.asking], compiled.circuit, PythonEngine(compiled.circuit)
    )


def crew(compiled: Compiled, libraries: Catalogue | None = None) -> Crew[Command]:
    """The libraries of a plan brought to life; `PlanError` where a library refuses its parameters."""
    offered = libraries or catalogue()
    workshop = Workshop()
    percepts: dict[str, Callable[[], bool | float]] = {}
    values: dict[str, Callable[[Channels], object]] = {}
    competences: dict[str, Competence] = {}
    views: dict[str, Callable[[], View | None]] = {}
    refused: list[Diagnostic] = []
    for bound in compiled.goals.libraries:
        try:
            offer = offered[bound.name].build(bound.settings, workshop)
        except ValueError as error:
            refused.append(Diagnostic("bad-parameter", "error", f"`{bound.name}`: {error}", bound.span))
            continue
        percepts |= offer.percepts
        values |= offer.values
        competences |= offer.competences
        views |= offer.views
    if refused:
        raise PlanError(refused)
    return Crew(percepts, values, competences, workshop.estimators, STOP, views)


class PlanBrain:
    """A plan as the brain of an episode.

    looked_at: somebody looks at its ticks; else they show nothing, and no note is made of them.

    `PlanError` if nothing brings a function of the plan to life, or if the world cannot tick as it does.
    """

    def __init__(self, compiled: Compiled, libraries: Catalogue | None = None, *, looked_at: bool = True) -> None:
        _check_tick(compiled)
        self.compiled = compiled
        self._libraries = libraries or catalogue()
        self._looked_at = looked_at
        self.trace = Trace(compiled.ways, _show)
        self.tick: Tick[Command] | None = None
        self._controller = self._new()

    def _new(self) -> Controller[Command]:
        try:
            crew_of_it = crew(self.compiled, self._libraries)
            return Controller(decider(self.compiled), crew_of_it, looked_at=self._looked_at)
        except UnboundError as error:
            raise PlanError(
                Diagnostic(
                    "unbound",
                    "error",
                    f"nothing brings `{term.text}` to life",
                    term.span,
                    hint="`use` a library that offers it",
                )
                for term in error.terms
            ) from None

    def reset(self) -> None:
        """A new crew: nothing lasts from one run to the next."""
        self.tick = None
        self._controller = self._new()

    def step(self, reading: Reading) -> Command:
        """One tick of the plan."""
        self.tick = self._controller.step(reading)
        return self.tick.command

    def note(self) -> str:
        """The last tick as JSON text."""
        return "null" if self.tick is None or not self._looked_at else self.trace.note(self.tick)

    def close(self) -> None:
        """Stop what runs."""
        self._controller.close()


def _check_tick(compiled: Compiled) -> None:
    """The world ticks as the plan does, within bounds."""
    period = compiled.goals.period
    if not SHORTEST <= period <= LONGEST:
        message = f"a tick of the plan takes {period:g} s; the simulated world can have {SHORTEST:g} s to {LONGEST:g} s"
        raise PlanError(
            [Diagnostic("other-tick", "error", message, compiled.plan.header.span, hint="write `:period 0.1s`")]
        )


def plan_header(compiled: Compiled) -> Mapping[str, object]:
    """What a recording says of its plan; sha256 is of its text and of those that it includes, in their order."""
    goals = compiled.goals
    included = [source for source in compiled.sources if source.name != compiled.source.name]
    every = "".join(source.text for source in (compiled.source, *included))
    return {
        "name": goals.name,
        "file": Path(compiled.source.name).name,
        "text": compiled.source.text,
        "included": [{"file": Path(source.name).name, "text": source.text} for source in included],
        "sha256": hashlib.sha256(every.encode()).hexdigest(),
        "inputs": [atom.text for atom in compiled.ways.atoms[: compiled.ways.asking]],
        "outputs": [output.name for output in goals.outputs],
        "rules": [
            {"rule": r.head, "line": r.span.line, "end_line": r.span.end_line}
            for r in goals.rules
            if r.span.file == compiled.source.name
        ],
    }


def _show(value: object) -> object:
    match value:
        case Pose(x, y, theta):
            return [round(x, 3), round(y, 3), round(theta, 4)]
        case bool() | int() | float() | str() | None:
            return value
        case _:
            return str(value)
