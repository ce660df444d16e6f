"""The whole pipeline on one page: text → Forms → Plan → Goals → Ways → Circuit.

Takes: a plan text and the signatures of the libraries that it may use. Gives: `Compiled`, every stage of it, and what
is to be said of it; `PlanError` with everything that is wrong. Leaves alone: robots; rplan/apps brings plans to life.
"""

from __future__ import annotations

import re
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
from rplan.lang.parse import parse_with_errors
from rplan.lang.plan import Plan
from rplan.lang.reader import capped
from rplan.lang.source import Source, Span
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


def compile_plan(
    source: Source, libraries: Libraries = NO_LIBRARIES, *, strict: bool = False, allow_holes: bool = False
) -> Compiled:
    """A plan checked and compiled.

    strict: a name that nothing declares is an error. allow_holes: a hole is a warning. Raises `PlanError` with all that
    is wrong; what was only noticed is in `Compiled.diagnostics`.
    """
    with deep_recursion():
        plan, said = parse_with_errors(source)
        found = list(said)
        broken = any(diagnostic.severity == "error" for diagnostic in said)
        try:
            goals, noticed = expand(plan, libraries, strict=strict)
            found += noticed
            ways = reduce(goals) if not broken else None
        except PlanError as error:
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
