"""Items of plans: one a rule, one a `deftest`, one a `defproperty`, and one a file of golden ticks.

Takes: files. Gives: pytest items; a failure says what differs and on what way, with the situation that shows it.
Leaves alone: how any of it is decided. A rule, or a property, that could not be decided within the budget fails too:
what is not shown does not count as shown, and the budget is the same on every machine.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from os import PathLike
from pathlib import Path
from typing import Any

import pytest
from _pytest._code.code import ReprExceptionInfo, ReprFileLocation, ReprTracebackNative

from rplan.apps.libraries import LibraryError
from rplan.apps.pytest_plugin import shelf_of
from rplan.apps.pytest_plugin.shelf import Plan, rendered
from rplan.apps.testing import Moment, said, way_lines
from rplan.apps.trying import TicksError, blessed, read_golden, shown, try_golden, try_trial
from rplan.apps.wiring import decider
from rplan.goals.goal import RuleInfo, Trial
from rplan.lang.diagnostic import PlanError, render
from rplan.runtime.trace import Trace
from rplan.ways.forks import Fork, taken, witness
from rplan.ways.prove import Promise, promises, prove
from rplan.ways.situations import Undecided, describe, nothing, replay
from rplan.ways.way import taken_way

MOST_EXPLAINED = 5
"""So many failing rules of a plan are shown with situations; those after them say what can never be taken alone."""
LARGE = 200
"""Plans with more forks are not asked for the reasons; `rplan check` says them."""
PLACE = re.compile(r"^.+?(:\d+){1,2}: ")
"""Before a message: where it is."""
NEVER_TEXTS = ("dead", "shadowed", "always-true", "always-false", "duplicate-condition", "duplicate-rule")


class FailedError(Exception):
    """An item failed; the message is all that is to be said."""


class PlanItem(pytest.Item):
    """Fails with text alone, never with a traceback of rplan's own."""

    parent: PlanFile | TicksFile

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> Any:
        if isinstance(excinfo.value, FailedError):
            return _told(str(excinfo.value), self.reportinfo(), whole=self.config.getoption("tbstyle") != "line")
        return super().repr_failure(excinfo, style)

    def place(self, line: int) -> tuple[PathLike[str], int, str]:
        """For reports: file, line from 0, name."""
        return self.path, line - 1, self.name


def _told(message: str, place: tuple[str | PathLike[str], int | None, str], *, whole: bool) -> ReprExceptionInfo:
    """The message as the failure, for `--tb=line` nothing of it; for the summary its first line without the place.

    Elsewhere pytest cuts that line to the width of the terminal; where `CI` is set it does not.
    """
    path, line, _ = place
    first = PLACE.sub("", message.partition("\n")[0])
    return ReprExceptionInfo(
        reprtraceback=ReprTracebackNative([f"{message}\n"] if whole else []),
        reprcrash=ReprFileLocation(path=str(path), lineno=(line or 0) + 1, message=first),
    )


class PlanFile(pytest.File):
    """A plan. One that does not compile is an error of collection."""

    @property
    def plan(self) -> Plan:
        return shelf_of(self.config).plan(self.path)

    @property
    def _is_a_part(self) -> bool:
        """Whether the file has no header, as those that other plans include."""
        return re.search(r"^\s*\(plan\s", self.path.read_text(encoding="utf-8", errors="replace"), re.MULTILINE) is None

    def collect(self) -> Iterable[pytest.Item]:
        try:
            goals = self.plan.compiled.goals
        except PlanError as error:
            if self._is_a_part and {d.code for d in error.diagnostics if d.severity == "error"} == {"no-goal"}:
                return  # the plans that include it are tested
            raise
        own = self.plan.compiled.source.name
        for rule in goals.rules:
            if rule.span.file == own:
                yield RuleItem.of(self, f"{rule.head}/branches", rule)
        for trial in goals.tests:
            yield TrialItem.of(self, f"test {trial.name}", trial)
        for promise in promises(self.plan.compiled.ways)[: len(goals.properties)]:
            yield PropertyItem.of(self, f"property {promise.name}", promise)

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> Any:  # noqa: ARG002
        return _readable(excinfo.value) or super().repr_failure(excinfo)


def _readable(error: BaseException) -> str | None:
    match error:
        case PlanError():
            return rendered(error)
        case TicksError() | LibraryError() | OSError():
            return str(error)
        case _:
            return None


class RuleItem(PlanItem):
    """Whether each branch of a rule can be taken."""

    def __init__(self, *, rule: RuleInfo, **rest: Any) -> None:
        super().__init__(**rest)
        self.rule = rule

    @classmethod
    def of(cls, parent: PlanFile, name: str, rule: RuleInfo) -> RuleItem:
        found: RuleItem = cls.from_parent(parent, name=name, rule=rule)
        return found

    def runtest(self) -> None:
        assert isinstance(self.parent, PlanFile)
        plan = self.parent.plan
        here = plan.by_rule.get(self.rule.span)
        if not here:
            raise FailedError(f"{self.rule.span}: nothing asks for {self.rule.head}, so that none of it is ever done")
        served = taken(plan.reach, here[0].arms[0])
        if served is not True or any(taken(plan.reach, arm) is not True for fork in here[1:] for arm in fork.arms):
            raise FailedError("\n".join(_branches(plan, self.rule, here)))

    def reportinfo(self) -> tuple[PathLike[str] | str, int | None, str]:
        return self.place(self.rule.span.line)


def _branches(plan: Plan, rule: RuleInfo, here: list[Fork]) -> Iterator[str]:
    """Every branch of a rule, those that cannot be taken marked, the others each with its simplest situation."""
    yield f"{rule.span}: not every branch of {rule.head} can be taken"
    plan.explained += 1
    for arm in (arm for fork in here for arm in fork.arms):
        answer = taken(plan.reach, arm)
        mark = {True: "  ", False: "- "}.get(answer, "? ") if isinstance(answer, bool) else "? "
        yield f"  {mark}{arm.span.line}: {arm.text}: {_when(plan, arm, answer)}"
    for finding in plan.never if len(plan.forks) <= LARGE else ():
        if finding.code in NEVER_TEXTS and _inside(finding.span.line, rule):
            yield "\n" + render(finding, plan.compiled.texts)


def _inside(line: int, rule: RuleInfo) -> bool:
    return rule.span.line <= line <= rule.span.end_line


def _when(plan: Plan, arm: Any, answer: bool | Undecided) -> str:
    if answer is True and plan.explained > MOST_EXPLAINED:
        return "taken"
    if answer is True:
        trace = witness(plan.reach, arm.guards)
        return "taken" if trace is None else f"taken when {describe(trace, plan.compiled.ways)}"
    return "can never be taken" if answer is False else "could not be decided"


class TrialItem(PlanItem):
    """A `deftest`."""

    def __init__(self, *, trial: Trial, **rest: Any) -> None:
        super().__init__(**rest)
        self.trial = trial

    @classmethod
    def of(cls, parent: PlanFile, name: str, trial: Trial) -> TrialItem:
        found: TrialItem = cls.from_parent(parent, name=name, trial=trial)
        return found

    def runtest(self) -> None:
        assert isinstance(self.parent, PlanFile)
        plan = self.parent.plan
        compiled = plan.compiled
        found = try_trial(decider(compiled), self.trial, nothing(compiled.ways), plan.watch)
        if found is not None:
            moment = Moment(
                found.tick * compiled.goals.period, found.decision, Trace(compiled.ways).way(found.decision)
            )
            place = found.step.span if found.step is not None else self.trial.span
            raise FailedError(f"{place}: {said(compiled, found.tick, found.differs, moment, found.values)}")

    def reportinfo(self) -> tuple[PathLike[str] | str, int | None, str]:
        return self.place(self.trial.span.line)


class PropertyItem(PlanItem):
    """A `defproperty`: proven, or it fails."""

    def __init__(self, *, promise: Promise, **rest: Any) -> None:
        super().__init__(**rest)
        self.promise = promise

    @classmethod
    def of(cls, parent: PlanFile, name: str, promise: Promise) -> PropertyItem:
        found: PropertyItem = cls.from_parent(parent, name=name, promise=promise)
        return found

    def runtest(self) -> None:
        assert isinstance(self.parent, PlanFile)
        plan = self.parent.plan
        proof = prove(plan.reach, self.promise)
        lines = [f"{self.promise.span}: {self.promise.name} is {proof.verdict}", f"  {self.promise.claim}"]
        if proof.verdict == "proven":
            return
        if proof.verdict == "refuted":
            seen = replay(plan.compiled.ways, proof.trace)
            lines.append(f"  broken when {describe(proof.trace, plan.compiled.ways)}")
            lines += way_lines(taken_way(plan.compiled.ways, seen.atoms, seen.registers))
        else:
            lines.append("  the budget did not suffice; what is not proven is not promised")
        raise FailedError("\n".join(lines))

    def reportinfo(self) -> tuple[PathLike[str] | str, int | None, str]:
        return self.place(self.promise.span.line)


# --- golden ticks ---


class TicksFile(pytest.File):
    """Golden ticks of a plan."""

    def __init__(self, *, plan: Path, **rest: Any) -> None:
        super().__init__(**rest)
        self.plan = plan

    def collect(self) -> Iterable[pytest.Item]:
        yield TicksItem.from_parent(self, name="ticks")

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> Any:  # noqa: ARG002
        return _readable(excinfo.value) or super().repr_failure(excinfo)


class TicksItem(PlanItem):
    """What a plan decides is what stands in the file; `--rplan-bless` writes it there."""

    def runtest(self) -> None:
        assert isinstance(self.parent, TicksFile)
        try:
            plan = shelf_of(self.config).plan(self.parent.plan)
            golden = read_golden(self.path, plan.compiled)
            stood = try_golden(decider(plan.compiled), Trace(plan.compiled.ways), golden, plan.watch)
            if stood.differing and self.config.getoption("--rplan-bless"):
                self.path.write_text(blessed(golden, stood.now), encoding="utf-8")
                return
        except (PlanError, TicksError, LibraryError, OSError) as error:
            raise FailedError(_readable(error)) from None
        if stood.differing:
            raise FailedError(shown(stood))

    def reportinfo(self) -> tuple[PathLike[str] | str, int | None, str]:
        return self.place(1)
