"""The whole pipeline on one page: text → Forms → Plan → Goals → Ways → Circuit.

Takes: a plan text and the signatures of the libraries that it may use. Gives: `Compiled`, every stage of it, and what
is to be said of it; `PlanError` with everything that is wrong. Leaves alone: robots; rplan/apps brings plans to life.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import NamedTuple

from rplan.circuit import passes
from rplan.circuit.build import build
from rplan.circuit.circuit import Circuit
from rplan.goals.expand import expand
from rplan.goals.goal import Goals
from rplan.goals.signature import Libraries
from rplan.lang.depth import deep_recursion, no_collection
from rplan.lang.diagnostic import Diagnostic, PlanError
from rplan.lang.include import OpenFile, gather, no_files
from rplan.lang.parse import parse_gathered
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


def texts_of(sources: Iterable[Source]) -> Mapping[str, str]:
    """File name -> text."""
    return {source.name: source.text for source in sources}


class Loaded(NamedTuple):
    """A plan, what is to be said of it, and the texts that it comes from, its own first."""

    plan: Plan
    diagnostics: tuple[Diagnostic, ...]
    sources: tuple[Source, ...]


def load(source: Source, open_file: OpenFile = no_files) -> Loaded:
    """Text → Plan, names not looked up, with the definitions of the files that it includes.

    open_file: path → source, for `include`; paths are relative to where the plan's own name is. Where there are errors
    among the diagnostics, the plan has placeholders. Raises PlanError where nothing could be read.
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
    with deep_recursion(), no_collection():
        plan, said, sources = load(source, open_file)
        texts = texts_of(sources)
        found = list(said)
        broken = any(diagnostic.severity == "error" for diagnostic in said)
        try:
            goals, noticed = expand(plan, libraries, strict=strict)
            found += noticed
            ways = reduce(goals) if not broken else None
        except PlanError as error:
            more = [d for d in error.diagnostics if not broken or _stands_alone(d, said, sources)]
            every = [*found, *more]
            raise PlanError(capped(_in_order(every, sources)) if broken else every, texts) from None
        if ways is None:
            raise PlanError(capped(said), texts)
        found += [*find(ways, allow_holes=allow_holes), *checks(ways)]
        if any(diagnostic.severity == "error" for diagnostic in found):
            raise PlanError(found, texts)
        return Compiled(source, plan, goals, ways, passes.run(build(ways)), tuple(found), sources)


def _in_order(found: Iterable[Diagnostic], sources: Sequence[Source]) -> list[Diagnostic]:
    order = {source.name: number for number, source in enumerate(sources)}
    return sorted(found, key=lambda one: (order.get(one.span.file, 0), one.span))


LOCAL = (
    "misspelt", "unknown-library", "unknown-parameter", "type-mismatch", "unit-mismatch", "wrong-arity", "no-rule",
    "two-channels", "goal-circle", "condition-circle",
)  # fmt: skip
"""What is wrong with names and types whatever else is wrong with the text."""


def _stands_alone(found: Diagnostic, before: tuple[Diagnostic, ...], sources: Sequence[Source]) -> bool:
    """Whether a finding in a plan with placeholders would be there without them: one mistake is told once."""
    if found.code not in LOCAL or "``" in found.message:
        return False
    if found.code == "no-rule" and any(one.code.endswith("-parenthesis") for one in before):
        head = found.message.partition("`(")[2].partition(")")[0]
        rule = rf"\(\s*defgoalr\s+\(\s*{re.escape(head)}[\s)]"
        if any(re.search(rule, source.text) for source in sources):
            return False
    return not any(_contains(found.span, one.span) for one in before if one.severity == "error")


def _contains(outer: Span, inner: Span) -> bool:
    if outer.file != inner.file:
        return False
    begins = (outer.line, outer.column) <= (inner.line, inner.column)
    return begins and (inner.end_line, inner.end_column) <= (outer.end_line, outer.end_column)
