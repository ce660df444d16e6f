"""The whole pipeline on one page: text → Forms → Plan → Goals → Ways → Circuit.

Takes: a plan text and the signatures of the libraries that it may use. Gives: `Compiled`, every stage of it, and what
is to be said of it; `PlanError` with everything that is wrong. Leaves alone: robots; rplan/apps brings plans to life.
"""

from __future__ import annotations

<<<<<<< HEAD
from collections.abc import Callable, Iterable, Mapping
=======
import re
from collections.abc import Mapping
>>>>>>> main
from dataclasses import dataclass
from types import MappingProxyType
from typing import NamedTuple

from rplan.circuit import passes
from rplan.circuit.build import build
from rplan.circuit.circuit import Circuit
from rplan.goals.expand import expand
from rplan.goals.goal import Goals
from rplan.goals.signature import Libraries
from rplan.lang.depth import deep_recursion
from rplan.lang.diagnostic import Diagnostic, PlanError
<<<<<<< HEAD
from rplan.lang.include import OpenFile, gather, no_files
from rplan.lang.parse import parse_gathered
=======
from rplan.lang.parse import parse_with_errors
>>>>>>> main
from rplan.lang.plan import Plan
from rplan.lang.reader import capped
from rplan.lang.source import Source, Span
from rplan.ways.coverage import find
from rplan.ways.reduce import Ways, reduce

Checks = Callable[[Ways], tuple[Diagnostic, ...]]
"""More to be said of a plan than whether it is wrong."""

NO_LIBRARIES: Libraries = MappingProxyType({})


@dataclass(frozen=True, slots=True)
class Compiled:
    """A plan after every stage. diagnostics: warnings and notes in the order in which they were found.

    sources: every text that is part of it, the plan's own first.
    """

    source: Source
    plan: Plan
    goals: Goals
    ways: Ways
    circuit: Circuit
    diagnostics: tuple[Diagnostic, ...]
    sources: tuple[Source, ...] = ()

    @property
    def texts(self) -> Mapping[str, str]:
        """File name -> text, for messages with caret lines."""
        return texts_of(self.sources or (self.source,))


<<<<<<< HEAD
def texts_of(sources: Iterable[Source]) -> Mapping[str, str]:
    """File name -> text."""
    return {source.name: source.text for source in sources}


class Loaded(NamedTuple):
    """A well-formed plan, what is to be said of it, and the texts that it comes from, its own first."""

    plan: Plan
    diagnostics: tuple[Diagnostic, ...]
    sources: tuple[Source, ...]


def load(source: Source, open_file: OpenFile = no_files) -> Loaded:
    """Text → Plan: well formed, names not looked up, with the definitions of the files that it includes.

    open_file: path → source, for `include`; paths are relative to where the plan's own name is.
    """
    gathered = gather(source, open_file)
    try:
        plan, said = parse_gathered(gathered)
    except PlanError as error:
        raise PlanError(error.diagnostics, texts_of(gathered.sources)) from None
    return Loaded(plan, said, tuple(gathered.sources))


def no_checks(ways: Ways) -> tuple[Diagnostic, ...]:  # noqa: ARG001
    """Nothing more."""
    return ()


=======
>>>>>>> main
def compile_plan(
    source: Source,
    libraries: Libraries = NO_LIBRARIES,
    *,
    open_file: OpenFile = no_files,
    strict: bool = False,
    allow_holes: bool = False,
    checks: Checks = no_checks,
) -> Compiled:
    """A plan checked and compiled; `rplan.ways.coverage.review` has more checks to ask for.

    strict: a name that nothing declares is an error. allow_holes: a hole is a warning. Raises `PlanError` with all that
    is wrong; what was only noticed is in `Compiled.diagnostics`.
    """
    with deep_recursion():
<<<<<<< HEAD
        loaded = load(source, open_file)
        found = list(loaded.diagnostics)
=======
        plan, said = parse_with_errors(source)
        found = list(said)
        broken = any(diagnostic.severity == "error" for diagnostic in said)
>>>>>>> main
        try:
            goals, noticed = expand(loaded.plan, libraries, strict=strict)
            found += noticed
            ways = reduce(goals) if not broken else None
        except PlanError as error:
<<<<<<< HEAD
            raise PlanError([*found, *error.diagnostics], texts_of(loaded.sources)) from None
        found += [*find(ways, allow_holes=allow_holes), *checks(ways)]
        if any(diagnostic.severity == "error" for diagnostic in found):
            raise PlanError(found, texts_of(loaded.sources))
        circuit = passes.run(build(ways))
        return Compiled(source, loaded.plan, goals, ways, circuit, tuple(found), loaded.sources)
=======
            more = [d for d in error.diagnostics if not broken or _stands_alone(d, said, source)]
            every = [*found, *more]
            raise PlanError(capped(sorted(every, key=lambda d: d.span)) if broken else every) from None
        if ways is None:
            raise PlanError(capped(said))
        found += find(ways, allow_holes=allow_holes)
        if any(diagnostic.severity == "error" for diagnostic in found):
            raise PlanError(found)
        return Compiled(source, plan, goals, ways, passes.run(build(ways)), tuple(found))


LOCAL = (
    "misspelt", "unknown-library", "unknown-parameter", "type-mismatch", "unit-mismatch", "wrong-arity", "no-rule",
    "two-channels", "goal-circle", "condition-circle",
)  # fmt: skip
"""What is wrong with names and types whatever else is wrong with the text."""


def _stands_alone(found: Diagnostic, before: tuple[Diagnostic, ...], source: Source) -> bool:
    """Whether a finding in a plan with placeholders would be there without them: one mistake is told once."""
    if found.code not in LOCAL or "``" in found.message:
        return False
    if found.code == "no-rule" and any(one.code.endswith("-parenthesis") for one in before):
        head = found.message.partition("`(")[2].partition(")")[0]
        if re.search(rf"\(\s*defgoalr\s+\(\s*{re.escape(head)}[\s)]", source.text):
            return False
    return not any(_contains(found.span, one.span) for one in before if one.severity == "error")


def _contains(outer: Span, inner: Span) -> bool:
    begins = (outer.line, outer.column) <= (inner.line, inner.column)
    return begins and (inner.end_line, inner.end_column) <= (outer.end_line, outer.end_column)
>>>>>>> main
