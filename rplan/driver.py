"""The whole pipeline on one page: text → Forms → Plan → Goals → Ways → Circuit.

Takes: a plan text and the signatures of the libraries that it may use. Gives: `Compiled`, every stage of it, and what
is to be said of it; `PlanError` with everything that is wrong. Leaves alone: robots; rplan/apps brings plans to life.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from rplan.circuit import passes
from rplan.circuit.build import build
from rplan.circuit.circuit import Circuit
from rplan.goals.expand import expand
from rplan.goals.goal import Goals
from rplan.goals.signature import Libraries
from rplan.lang.depth import deep_recursion
from rplan.lang.diagnostic import Diagnostic, PlanError
from rplan.lang.parse import parse_text
from rplan.lang.plan import Plan
from rplan.lang.source import Source
from rplan.ways.coverage import find
from rplan.ways.reduce import Ways, reduce

NO_LIBRARIES: Libraries = MappingProxyType({})


@dataclass(frozen=True, slots=True)
class Compiled:
    """A plan after every stage. diagnostics: warnings and notes in the order in which they were found."""

    source: Source
    plan: Plan
    goals: Goals
    ways: Ways
    circuit: Circuit
    diagnostics: tuple[Diagnostic, ...]

    @property
    def texts(self) -> Mapping[str, str]:
        """File name -> text, for messages with caret lines."""
        return {self.source.name: self.source.text}


def load(source: Source) -> tuple[Plan, tuple[Diagnostic, ...]]:
    """Text → Plan: well formed, names not looked up."""
    with deep_recursion():
        return parse_text(source)


def compile_plan(
    source: Source, libraries: Libraries = NO_LIBRARIES, *, strict: bool = False, allow_holes: bool = False
) -> Compiled:
    """A plan checked and compiled.

    strict: a name that nothing declares is an error. allow_holes: a hole is a warning. Raises `PlanError` with all that
    is wrong; what was only noticed is in `Compiled.diagnostics`.
    """
    with deep_recursion():
        plan, said = load(source)
        found = list(said)
        try:
            goals, noticed = expand(plan, libraries, strict=strict)
            found += noticed
            ways = reduce(goals)
        except PlanError as error:
            raise PlanError([*found, *error.diagnostics]) from None
        found += find(ways, allow_holes=allow_holes)
        if any(diagnostic.severity == "error" for diagnostic in found):
            raise PlanError(found)
        return Compiled(source, plan, goals, ways, passes.run(build(ways)), tuple(found))
