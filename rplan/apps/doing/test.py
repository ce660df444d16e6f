"""What `rplan test` does.

Takes: a plan. Gives: the outcome of each `deftest`, each on a plan that has just been started. Leaves alone: options
and their help; see rplan/apps/commands/test.py, which imports this only when there is something to do.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import click

from rplan.apps import talk
from rplan.apps.files import plan_file
from rplan.apps.wiring import decider
from rplan.driver import Compiled
from rplan.goals.condition import Comparison, percept_terms
from rplan.goals.goal import Trial, TrialStep
from rplan.lang.source import Span
from rplan.runtime.tick import Decision
from rplan.runtime.trace import Trace, texts

OPEN = "open"
HOLE = "hole"
NO_HOLE = "no hole"


@dataclass(frozen=True, slots=True)
class Failure:
    """What differs in one tick. tick: from 0 in the test; differs: output (or `hole`) -> expected and got."""

    place: Span
    tick: int
    differs: Mapping[str, tuple[str, str]]
    rules: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Outcome:
    """A test and the first tick in which it fails, if any."""

    trial: Trial
    ticks: int
    failure: Failure | None


def run(plan: str, as_json: bool) -> None:
    """Do what was asked; leaves with the exit code of the command."""
    compiled = talk.compiled(plan_file(plan), allow_holes=True, as_json=as_json)
    outcomes = [outcome(compiled, trial) for trial in compiled.goals.tests]
    if as_json:
        talk.result({"ok": all(one.failure is None for one in outcomes), "tests": list(map(_plain, outcomes))})
    else:
        _show(outcomes)
    if any(one.failure for one in outcomes):
        raise SystemExit(talk.PLAN_IS_WRONG)


def outcome(compiled: Compiled, trial: Trial) -> Outcome:
    """Run one test on a plan that has just been started."""
    decide = decider(compiled)
    trace = Trace(compiled.ways)
    numbers = {t.text for a in compiled.ways.atoms if isinstance(a, Comparison) for t in percept_terms(a)}
    values: dict[str, bool | float] = {
        term.text: 0.0 if term.text in numbers else False for term in compiled.goals.percepts()
    }
    tick = 0
    for step in trial.steps:
        values |= dict(step.given)
        for _ in range(step.times):
            decision = decide.tick(values)
            if differs := dict(_differences(step, decision)):
                return Outcome(trial, tick + 1, Failure(step.span, tick, differs, trace.way(decision).rules))
            tick += 1
    return Outcome(trial, tick, None)


def _differences(step: TrialStep, decision: Decision) -> Iterator[tuple[str, tuple[str, str]]]:
    if decision.hole != step.hole:
        yield HOLE, (HOLE if step.hole else NO_HOLE, HOLE if decision.hole else NO_HOLE)
    got = texts(decision.outputs)
    for output, expected in step.expected:
        if got[output] != expected:
            yield output, (expected or OPEN, got[output] or OPEN)


def _show(outcomes: list[Outcome]) -> None:
    for one in outcomes:
        ticks = f"{one.ticks} tick{'' if one.ticks == 1 else 's'}"
        click.echo(f"{'failed' if one.failure else 'passed'}  {one.trial.name}  ({ticks})")
        if one.failure:
            _show_failure(one.failure)
    failed = sum(one.failure is not None for one in outcomes)
    said = f"{failed} of {len(outcomes)} failed" if failed else f"{len(outcomes)} passed"
    click.echo(said if outcomes else "the plan has no test")


def _show_failure(failure: Failure) -> None:
    click.echo(f"  --> {failure.place}, in tick {failure.tick}")
    for name, (expected, got) in failure.differs.items():
        what = "" if name == HOLE else f"`{name}`: "
        click.echo(f"  {what}expected {expected}, got {got}")
    click.echo(f"  by {', '.join(failure.rules) or 'the top goal'}")


def _plain(one: Outcome) -> Mapping[str, object]:
    failure = one.failure
    plain: dict[str, object] = {"name": one.trial.name, "passed": failure is None, "ticks": one.ticks}
    if failure is not None:
        plain["failure"] = {
            "place": talk.place(failure.place),
            "tick": failure.tick,
            "differs": {name: {"expected": e, "got": g} for name, (e, g) in failure.differs.items()},
            "rules": list(failure.rules),
        }
    return plain
