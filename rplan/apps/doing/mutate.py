"""What `rplan mutate` does.

Takes: a plan and its tests. Gives: which slips in the plan no test notices, each with a situation that would show it.
Leaves alone: options and their help; see rplan/apps/commands/mutate.py, which imports this only when there is
something to do.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import combinations
from pathlib import Path
from time import perf_counter

import click
import numpy as np

from rplan.apps import talk
from rplan.apps.files import InputError, plan_file, unreadable
from rplan.apps.testing import given_words
from rplan.apps.trying import (
    Golden,
    TicksError,
    Values,
    read_golden,
    ticks_files,
    try_ticks,
    try_trial,
    unwatched,
)
from rplan.apps.wiring import signatures
from rplan.backends.interpreter import Interpreter
from rplan.circuit.build import build
from rplan.driver import Compiled
from rplan.goals.expand import expand
from rplan.lang.depth import deep_recursion, no_collection
from rplan.lang.diagnostic import PlanError
from rplan.runtime.tick import Decider, Decision
from rplan.runtime.trace import texts
from rplan.ways.mutate import Mutant, equal, mutants
from rplan.ways.prove import promises, prove
from rplan.ways.reach import Reach
from rplan.ways.reduce import Ways, reduce
from rplan.ways.simplest import bounds
from rplan.ways.situations import nothing, number_percepts

CHECK = "check"
TRACES = 64
TICKS = 24
MOST_PAIRS = 2_000


@dataclass(frozen=True, slots=True)
class Fate:
    """What became of a mutant. by: what noticed it; shown: a situation in which it can be told apart, in words."""

    mutant: Mutant
    verdict: str
    by: str = ""
    shown: str = ""


KILLED, SURVIVED, EQUAL, INVALID, UNDECIDED = "killed", "survived", "equal", "invalid", "undecided"


def run(plan: str, tests: tuple[Path, ...], most: int, at_least: float | None, as_json: bool) -> None:
    """Do what was asked; leaves with the exit code of the command."""
    path = plan_file(plan)
    compiled = talk.compiled(path, allow_holes=True, as_json=as_json)
    begin = perf_counter()
    every = list(mutants(compiled.plan, compiled.source.name))
    fates = list(_fates(compiled, path, tests, spread(every, most)))
    seconds = perf_counter() - begin
    if as_json:
        talk.result(_plain(compiled, fates, len(every), seconds))
    else:
        _say(compiled, fates, len(every), seconds)
    if at_least is not None and 100 * share(fates) < at_least:
        raise SystemExit(talk.PLAN_IS_WRONG)


def share(fates: Sequence[Fate]) -> float:
    """The part of the mutants that can be told apart that was noticed; 1 where there is none."""
    counts = Counter(one.verdict for one in fates)
    every = counts[KILLED] + counts[SURVIVED] + counts[UNDECIDED]
    return counts[KILLED] / every if every else 1.0


def spread(every: Sequence[Mutant], most: int) -> list[Mutant]:
    """At most so many of them, evenly from all over the plan."""
    if len(every) <= most:
        return list(every)
    return [every[number * len(every) // most] for number in range(most)]


# --- one mutant after the other ---


def _fates(compiled: Compiled, path: Path, tests: Sequence[Path], every: Sequence[Mutant]) -> Iterator[Fate]:
    with deep_recursion(), no_collection():
        trial = _Trial(compiled, _golden(compiled, path))
        trial.check_itself()
        first = [trial.fate(mutant) for mutant in every]
        left = [n for n, fate in enumerate(first) if fate.verdict in (SURVIVED, UNDECIDED)]
        if tests and left:
            noticed = _by_pytest(compiled, path, tests, [first[n].mutant for n in left], trial)
            for n, by in zip(left, noticed, strict=True):
                if by:
                    first[n] = replace(first[n], verdict=KILLED, by=by, shown="")
        yield from first


def _golden(compiled: Compiled, path: Path) -> list[Golden]:
    try:
        return [read_golden(file, compiled) for file in ticks_files(path)]
    except TicksError as error:
        raise InputError(str(error)) from None
    except OSError as error:
        unreadable(path, error)


class _Trial:
    """The tests of a plan, for one mutant after the other."""

    def __init__(self, compiled: Compiled, golden: Sequence[Golden]) -> None:
        self.compiled = compiled
        self.golden = golden
        self.signatures = signatures(talk.libraries())
        self.start = nothing(compiled.ways)
        self.situations = list(_simple(compiled.ways))
        self.traces = list(_traces(compiled.ways))
        self.holes = Reach(compiled.ways).possible((compiled.ways.hole, True)) is not False

    def check_itself(self) -> None:
        """Tests that fail on the plan itself notice nothing."""
        by = self._noticed(self.compiled.ways) or self._broken(self.compiled.ways)
        if by:
            raise InputError(f"{by} fails on the plan as it stands: mend that first")

    def ways(self, mutant: Mutant) -> Ways | None:
        """The mutant compiled as far as is needed; None where it is no plan."""
        try:
            return reduce(expand(mutant.plan, self.signatures)[0])
        except PlanError:
            return None

    def fate(self, mutant: Mutant) -> Fate:
        """What becomes of it."""
        ways = self.ways(mutant)
        if ways is None:
            return Fate(mutant, INVALID)
        by = self._noticed(ways)
        if by:
            return Fate(mutant, KILLED, by)
        shown = self._told_apart(ways)
        same = False if shown else equal(self.compiled.ways, ways)
        if same:
            return Fate(mutant, EQUAL)
        by = self._broken(ways)
        if by:
            return Fate(mutant, KILLED, by)
        return Fate(mutant, UNDECIDED if same is None else SURVIVED, "", shown)

    def _noticed(self, ways: Ways) -> str:
        """What of the tests and golden ticks fails; each begins on a new plan."""
        decide = _decider(ways)
        for trial in ways.goals.tests:
            decide.reset()
            if try_trial(decide, trial, self.start, unwatched):
                return f"test {trial.name}"
        for golden in self.golden:
            decide.reset()
            try:
                if try_ticks(decide, golden, unwatched):
                    return golden.path.name
            except TicksError as error:
                raise InputError(str(error)) from None
        return ""

    def _broken(self, ways: Ways) -> str:
        """Which property does not hold any more; or that there is a hole now, which is an error."""
        reach = Reach(ways)
        if not self.holes and reach.possible((ways.hole, True)) is True:
            return CHECK
        for promise in promises(ways)[: len(ways.goals.properties)]:
            if prove(reach, promise).verdict == "refuted":
                return f"property {promise.name}"
        return ""

    # --- telling two plans apart ---

    def _told_apart(self, ways: Ways) -> str:
        """A situation in which they decide differently, the simplest first, in words; empty where none was found."""
        if self.compiled.ways.assumed:
            return ""
        mine, other = _decider(self.compiled.ways), _decider(ways)
        for values in self.situations:
            mine.reset()
            other.reset()
            differs = _differs(mine.tick(values), other.tick(values))
            if differs:
                return f"given {given_words(self.compiled, values)}: {differs}"
        for trace in self.traces:
            mine.reset()
            other.reset()
            for tick, values in enumerate(trace):
                differs = _differs(mine.tick(values), other.tick(values))
                if differs:
                    last = given_words(self.compiled, values)
                    return f"after {tick} tick{'s' * (tick != 1)}, then given {last}: {differs}"
        return ""


def _decider(ways: Ways) -> Decider:
    circuit = build(ways)
    return Decider(ways.goals, ways.atoms[: ways.asking], circuit, Interpreter(circuit))


def _differs(mine: Decision, other: Decision) -> str:
    """What differs in words: what the plan does, and what the mutant does."""
    if mine.hole != other.hole:
        return "no way is open" if mine.hole else "a way is open, and not with the slip"
    a, b = texts(mine.outputs), texts(other.outputs)
    parts = [
        f"{name} is {a.get(name) or 'open'}, with the slip {b.get(name) or 'open'}"
        for name in a
        if a.get(name) != b.get(name)
    ]
    return ", ".join(parts)


def _choices(ways: Ways) -> dict[str, list[bool | float]]:
    """Values worth trying for each percept, the first is what it begins with."""
    numbers = number_percepts(ways)
    return {
        term.text: _numbers(ways, term.text) if term.text in numbers else [False, True]
        for term in ways.goals.percepts(driving=True)
    }


def _numbers(ways: Ways, text: str) -> list[bool | float]:
    """Nought, the numbers that it is compared with, and those a little beside them and far away."""
    near = [float(bound) + step for bound in bounds(ways, text) for step in (0.0, -0.01, 0.01)]
    near += [float(bound) * factor for bound in bounds(ways, text) for factor in (0.95, 1.05)]
    return list(dict.fromkeys([0.0, *near, max(near, default=0.0) + 1, min(near, default=0.0) - 1]))


def _simple(ways: Ways) -> Iterator[Values]:
    """Situations in which at most two percepts are not as they begin."""
    start: Values = dict(nothing(ways))
    others = [(text, value) for text, values in _choices(ways).items() for value in values[1:]]
    yield start
    for text, value in others:
        yield start | {text: value}
    for (a, x), (b, y) in list(combinations(others, 2))[:MOST_PAIRS]:
        if a != b:
            yield start | {a: x, b: y}


def _traces(ways: Ways) -> Iterator[list[Values]]:
    """Runs by chance, always the same; one percept in eight changes from tick to tick."""
    chance = np.random.default_rng(0)
    choices = _choices(ways)
    for _ in range(TRACES):
        values: Values = dict(nothing(ways)) | {t: v[chance.integers(len(v))] for t, v in choices.items()}
        trace = [values]
        for _ in range(TICKS - 1):
            changed = {t: v[chance.integers(len(v))] for t, v in choices.items() if chance.integers(8) == 0}
            trace.append(trace[-1] | changed)
        yield trace


# --- tests of pytest ---


def _by_pytest(
    compiled: Compiled, path: Path, tests: Sequence[Path], left: Sequence[Mutant], trial: _Trial
) -> list[str]:
    """For each mutant the test that notices it, or nothing."""
    try:
        from rplan.apps.pytest_plugin.mutants import failing
    except ImportError:
        raise InputError("--tests needs pytest: pip install pytest") from None

    def whole(mutant: Mutant) -> Compiled:
        ways = trial.ways(mutant)
        assert ways is not None
        return replace(compiled, plan=mutant.plan, goals=ways.goals, ways=ways, circuit=build(ways))

    try:
        return failing(tests, path, [partial(whole, mutant) for mutant in left])
    except ValueError as error:
        raise InputError(str(error)) from None


# --- what is said ---


def _say(compiled: Compiled, fates: Sequence[Fate], every: int, seconds: float) -> None:
    counts = Counter(one.verdict for one in fates)
    of = f" of {every}" if every > len(fates) else ""
    click.echo(f"{compiled.goals.name}: {len(fates)}{of} changes ({seconds:.2f} s)")
    apart = counts[KILLED] + counts[SURVIVED] + counts[UNDECIDED]
    click.echo(f"  {counts[KILLED]} of {apart} noticed ({int(100 * share(fates))} %){_by(fates)}")
    rest = [
        (counts[SURVIVED], "survived"),
        (counts[UNDECIDED], "survived and may make no difference"),
        (counts[EQUAL], "make no difference"),
        (counts[INVALID], "are no plan"),
    ]
    if any(count for count, _ in rest):
        click.echo("  " + ", ".join(f"{count} {words}" for count, words in rest if count))
    for one in fates:
        if one.verdict in (SURVIVED, UNDECIDED):
            click.echo(f"{one.mutant.span}: {one.mutant.where}: {one.mutant.change}")
            if one.shown:
                click.echo(f"  {one.shown}")


def _by(fates: Sequence[Fate]) -> str:
    """How many each kind of test noticed."""
    kinds = Counter(_kind(one.by) for one in fates if one.verdict == KILLED)
    return f": {', '.join(f'{count} by {kind}' for kind, count in kinds.items())}" if kinds else ""


def _kind(by: str) -> str:
    first = by.split(" ", 1)[0]
    known: Mapping[str, str] = {"test": "deftest", "property": "properties", CHECK: "`rplan check`"}
    return known.get(first, "pytest" if "::" in by else "golden ticks")


def _plain(compiled: Compiled, fates: Sequence[Fate], every: int, seconds: float) -> Mapping[str, object]:
    counts = Counter(one.verdict for one in fates)
    return {
        "plan": compiled.goals.name,
        "possible": every,
        "share": round(share(fates), 4),
        "counts": {verdict: counts[verdict] for verdict in (KILLED, SURVIVED, UNDECIDED, EQUAL, INVALID)},
        "seconds": round(seconds, 3),
        "mutants": [
            {
                "kind": one.mutant.kind,
                "where": one.mutant.where,
                "change": one.mutant.change,
                "place": talk.place(one.mutant.span),
                "verdict": one.verdict,
                "by": one.by,
                "shown": one.shown,
            }
            for one in fates
        ],
    }
