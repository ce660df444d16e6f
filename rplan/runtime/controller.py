"""A plan drives a robot: the meaning of one tick.

Takes: a `Decider` and a `Crew`. Gives: one command a reading, and the record of the tick. Leaves alone: when ticks
happen; whoever owns the clock calls `step`.

1. Estimators take the reading and last tick's reports; every percept is sampled once. 2. The plan decides. 3. What was
running and is not chosen is stopped before anything new starts. 4. Channels are filled in their declared order: a value
may read this tick's value of the channels before it and last tick's of the others. A competence that raises, gives a
number that is not finite or overruns its deadline is stopped, its channel takes the idle value for that tick, the fault
is recorded, and the plan sees `(competence-failed NAME)` in the next tick.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Generic

from rplan.goals.condition import Term
from rplan.goals.signature import COMPETENCE_FAILED
from rplan.runtime.encode import PerceptValue
from rplan.runtime.robot import C, Crew
from rplan.runtime.tick import Decider, Decision


@dataclass(frozen=True, slots=True)
class Fault:
    """A competence failed in a tick."""

    competence: str
    message: str


@dataclass(frozen=True, slots=True)
class Tick(Generic[C]):
    """The record of a tick. values: output -> what its channel holds (a command channel: the command).

    shown: by name, what people may look at, where it is new.
    """

    number: int
    percepts: Mapping[str, PerceptValue]
    decision: Decision
    values: Mapping[str, object]
    started: tuple[str, ...]
    stopped: tuple[str, ...]
    faults: tuple[Fault, ...]
    reports: Mapping[str, Any]
    command: C
    shown: Mapping[str, Mapping[str, object]] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Deadline:
    """A step may take so long [s] by this clock."""

    seconds: float
    clock: Callable[[], float]


class UnboundError(Exception):
    """The plan names functions that nothing brings to life."""

    def __init__(self, terms: tuple[Term, ...]) -> None:
        self.terms = terms
        super().__init__(", ".join(term.text for term in terms))


class Controller(Generic[C]):
    """A plan with its crew. `UnboundError` if the plan needs a function that the crew lacks.

    looked_at: somebody looks at what the crew shows; else its views are not asked.
    """

    def __init__(
        self, decider: Decider, crew: Crew[C], deadline: Deadline | None = None, *, looked_at: bool = True
    ) -> None:
        self.decider = decider
        self.crew = crew
        self._views = crew.views if looked_at else {}
        self._deadline = deadline
        self._commands = [name for name in (o.name for o in decider.goals.outputs) if self._is_command(name)]
        self._idle = {output.name: output.idle for output in decider.goals.outputs}
        self._percepts = self._bind()
        self._running: dict[str, str] = {}
        self._channels: dict[str, object] = dict.fromkeys(output.name for output in decider.goals.outputs)
        self._reports: dict[str, Any] = {}
        self._faults: list[Fault] = []
        self._started: list[str] = []
        self._stopped: list[str] = []
        self._number = 0

    def _is_command(self, output: str) -> bool:
        declared = next(o for o in self.decider.goals.outputs if o.name == output)
        return declared.type is not None and declared.type.name == "command"

    def _bind(self) -> list[tuple[str, Callable[[], PerceptValue]]]:
        bound: list[tuple[str, Callable[[], PerceptValue]]] = []
        missing: list[Term] = []
        for term in self.decider.goals.percepts(driving=True):
            if term.name == COMPETENCE_FAILED.name:
                bound.append((term.text, self._failed(term.arguments[0].name)))
            elif term.name in self.crew.percepts and not term.arguments:
                bound.append((term.text, self.crew.percepts[term.name]))
            else:
                missing.append(term)
        for output, term in self.decider.values():
            there = self.crew.competences if output in self._commands else self.crew.values
            if term.kind == "call" and (term.name not in there or term.arguments):
                missing.append(term)
        if missing:
            raise UnboundError(tuple({term.text: term for term in missing}.values()))
        return bound

    def _failed(self, name: str) -> Callable[[], bool]:
        return lambda: any(fault.competence == name for fault in self._faults)

    def step(self, reading: Any) -> Tick[C]:
        """One tick. What a percept or an estimator raises comes through: give the robot `crew.safe` then."""
        for estimator in self.crew.estimators:
            estimator.update(reading, self._reports, self._channels)
        percepts = {text: sample() for text, sample in self._percepts}
        decision = self.decider.tick(percepts)
        self._faults, self._reports = [], {}
        self._started, self._stopped = [], []
        self._stop_losers(decision)
        command = self.crew.safe
        for output, term in decision.sent.items():
            if output in self._commands:
                given = self._drive(output, term, reading)
                self._channels[output] = given
                command = command if given is None else command.merged(given)
            else:
                self._channels[output] = self._value(term)
        self._number += 1
        return Tick(
            self._number - 1,
            percepts,
            decision,
            dict(self._channels),
            tuple(self._started),
            tuple(self._stopped),
            tuple(self._faults),
            self._reports,
            command,
            {name: seen for name, view in self._views.items() if (seen := view()) is not None},
        )

    def close(self) -> C:
        """Stop whatever runs; gives the safe command."""
        for output in [*self._running]:
            self._stop(output)
        return self.crew.safe

    def _value(self, term: Term | None) -> object:
        if term is None:
            return None
        match term.kind:
            case "call":
                return self.crew.values[term.name](self._channels)
            case "number" | "truth":
                return term.value
            case _:
                return term.name

    def _stop_losers(self, decision: Decision) -> None:
        for output, name in [*self._running.items()]:
            term = decision.sent[output]
            if term is None or term.name != name:
                self._stop(output)

    def _stop(self, output: str) -> None:
        name = self._running.pop(output)
        self._stopped.append(name)
        try:
            self.crew.competences[name].stop()
        except Exception as error:
            self._faults.append(Fault(name, f"stopping: {type(error).__name__}: {error}"))

    def _drive(self, output: str, term: Term | None, reading: Any) -> C | None:
        """The command of a channel; where its competence fails that of its idle value, where that fails too none."""
        if term is None:
            return None
        given = self._step(output, term.name, reading)
        idle = self._idle[output]
        if given is None and idle is not None and idle.name != term.name:
            given = self._step(output, idle.name, reading)
            if given is not None:
                self._stop(output)
        return given

    def _step(self, output: str, name: str, reading: Any) -> C | None:
        competence = self.crew.competences[name]
        begin = self._deadline.clock() if self._deadline else 0.0
        try:
            if self._running.get(output) != name:
                self._running[output] = name
                self._started.append(name)
                competence.start(reading, self._channels)
            command, report = competence.step(reading, self._channels)
            failure = "" if command.is_finite() else "its command is not finite"
        except Exception as error:
            failure = f"{type(error).__name__}: {error}"
        if self._deadline and not failure and self._deadline.clock() - begin > self._deadline.seconds:
            failure = f"it overran its deadline of {self._deadline.seconds} s"
        if failure:
            self._faults.append(Fault(name, failure))
            self._stop(output)
            return None
        self._reports[name] = report
        return command
