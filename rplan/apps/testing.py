"""A plan under test: percepts given by hand, episodes in a world, recordings played to an edited plan.

Takes: a compiled plan, and what a test in Python says of it. Gives: `PlanUnderTest` with `given`, `episode` and
`replayed`; what is not as expected is an `AssertionError` that shows the way taken and the conditions on it. Leaves
alone: pytest, whose fixture `plan` makes these; without pytest `PlanUnderTest.of(path)` does.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Self, TypeVar

from rplan.apps.doing.test import OPEN
from rplan.apps.libraries import Catalogue
from rplan.apps.simulation import load_world
from rplan.apps.trying import (
    TicksError,
    Values,
    Watch,
    kind_of,
    named,
    percept_names,
    read_golden,
    shown,
    try_golden,
    unexpected,
    unit_of,
    unwatched,
)
from rplan.apps.wiring import PlanBrain, compile_file, decider
from rplan.driver import Compiled
from rplan.lang.diagnostic import PlanError
from rplan.lang.suggest import close
from rplan.lang.units import BadNumberError, canonical_number, read_number
from rplan.runtime.encode import PerceptValue
from rplan.runtime.tick import Decision
from rplan.runtime.trace import Trace, texts
from rplan.ways.situations import nothing
from rplan.ways.way import TakenWay
from sim.episode import Episode
from sim.judge import Verdict
from sim.recording import RecordingError, read
from sim.scenarios.schema import ScenarioError

Thing = TypeVar("Thing")
LONGEST = 1_000_000
"""Ticks in a row, at most."""
__tracebackhide__ = True
"""For pytest: what is not as expected is shown where the test says it."""


@dataclass(frozen=True, slots=True)
class Moment:
    """A tick: its time [s] from the start, what was decided, and on what way."""

    time: float
    decision: Decision
    way: TakenWay

    @property
    def outputs(self) -> dict[str, str | None]:
        """Output -> canonical text as the way sets it; None where it is open."""
        return texts(self.decision.outputs)

    @property
    def sent(self) -> dict[str, str | None]:
        """Output -> canonical text after idle and held values."""
        return texts(self.decision.sent)


class PlanUnderTest:
    """A plan; each `given`, `golden`, `episode` and `replayed` begins on one that has just been started.

    ways: golden ticks are compared with the way taken too; where a slip was made in the plan on purpose they are not,
    since its conditions read otherwise whether or not it does otherwise.
    """

    def __init__(
        self, compiled: Compiled, libraries: Catalogue | None = None, watch: Watch = unwatched, *, ways: bool = True
    ) -> None:
        self.compiled = compiled
        self.libraries = libraries
        self.watch = watch
        self.ways = ways

    @classmethod
    def of(cls, path: Path | str, libraries: Catalogue | None = None, watch: Watch = unwatched) -> Self:
        """The plan in a file, holes allowed; `PlanError`, `OSError`."""
        return cls(compile_file(Path(path), allow_holes=True, libraries=libraries), libraries, watch)

    def given(self, *percepts: str) -> Run:
        """The first tick. `name` is true, `not name` false, `name=0.3m` a number; others are false or 0."""
        return Run(self).then(*percepts)

    def golden(self, ticks: Path | str) -> Self:
        """Golden ticks stand. A file that is not found as it stands is one beside the plan; `TicksError`, OSError."""
        golden = _read(lambda: read_golden(self._beside(ticks), self.compiled))
        trace = Trace(self.compiled.ways)
        stood = try_golden(decider(self.compiled), trace, golden, self.watch, ways=self.ways)
        if stood.differing:
            raise AssertionError(shown(stood))
        return self

    def episode(self, scenario: Path | str, seed: int = 0) -> EpisodeUnderTest:
        """An episode in a world, not yet run. A scenario that is not found as it stands is one beside the plan."""
        return EpisodeUnderTest(self, self._beside(scenario), seed)

    def _beside(self, given: Path | str) -> Path:
        path = Path(given)
        beside = Path(self.compiled.source.name).parent / path
        return beside if not path.is_file() and beside.is_file() else path

    def replayed(self, recording: Path | str) -> tuple[Changed, ...]:
        """The ticks of a recorded run in which this plan would have decided otherwise, by what was sensed then.

        Nothing is moved by what this plan decides. Raises RecordingError, PlanError, OSError.
        """
        return tuple(_changed(self, Path(recording)))


def _read(how: Callable[[], Thing]) -> Thing:
    """What is read; where it cannot be, the error begins here, without the frames of who reads it."""
    try:
        return how()
    except (OSError, PlanError, ScenarioError, RecordingError) as error:
        raise error.with_traceback(None) from None


# --- ticks by hand ---


class Run:
    """Ticks in a row. Percepts keep their values from one tick to the next."""

    def __init__(self, plan: PlanUnderTest) -> None:
        self._plan = plan
        self._decide = decider(plan.compiled)
        self._trace = Trace(plan.compiled.ways)
        self._names = percept_names(plan.compiled)
        self._values: Values = dict(nothing(plan.compiled.ways))
        self._ticks = 0
        self._last: list[Decision] = []

    def then(self, *percepts: str) -> Self:
        """One more tick, with these percepts changed."""
        for text in percepts:
            key, value = self._read(text)
            self._values[key] = value
        return self._tick(1)

    def after(self, duration: str) -> Self:
        """As many more ticks as take so long (`2s`, `500ms`), with the percepts as they are."""
        try:
            seconds, unit = read_number(duration)
        except BadNumberError as error:
            raise TicksError(str(error)) from None
        ticks = round(seconds / self._plan.compiled.goals.period)
        if unit != "s" or not 1 <= ticks <= LONGEST:
            raise TicksError(f"a time of 1 to {LONGEST} ticks is wanted, such as `2s`, not {duration!r}")
        return self._tick(ticks)

    def expect(self, *, hole: bool = False, **outputs: str | float | None) -> Self:
        """The tick now sets these outputs so; `open` or None: leaves it open. `a_b=…` is the output `a-b`."""
        self._check(self._last[-1:], hole, outputs)
        return self

    def throughout(self, *, hole: bool = False, **outputs: str | float | None) -> Self:
        """As `expect`, of every tick since the last `given`, `then` or `after` began."""
        self._check(self._last, hole, outputs)
        return self

    @property
    def now(self) -> Moment:
        """The last tick."""
        return self._moment(self._ticks - 1, self._last[-1])

    def _tick(self, times: int) -> Self:
        self._last = []
        for _ in range(times):
            decision = self._decide.tick(self._values)
            self._plan.watch(decision)
            self._last.append(decision)
        self._ticks += times
        return self

    def _moment(self, tick: int, decision: Decision) -> Moment:
        return Moment(tick * self._plan.compiled.goals.period, decision, self._trace.way(decision))

    def _read(self, text: str) -> tuple[str, PerceptValue]:
        """`name`, `not name`, `(not (name))`, `name=value`."""
        name, equals, value = (part.strip() for part in text.partition("="))
        if not equals and name.startswith(("not ", "(not ")):
            return self._truth(name.removeprefix("(not ").removeprefix("not ").strip(), False, name[0] == "(")
        if not equals:
            return self._truth(name, True, False)
        key = named(name, self._names)
        if value in ("true", "false"):
            return self._truth(name, value == "true", False)
        if kind_of(self._plan.compiled, key) != "number":
            raise TicksError(f"`{name}` is true or false, not {value}")
        return key, self._number(name, value, unit_of(self._plan.compiled, key))

    def _number(self, name: str, value: str, unit: str) -> float:
        try:
            number, found = read_number(value)
        except BadNumberError as error:
            raise TicksError(f"`{name}`: {error}") from None
        if found not in ("", unit):
            raise TicksError(f"`{name}={value}`: its unit is {unit or 'none'}, not {found}")
        return number

    def _truth(self, name: str, value: bool, wrapped: bool) -> tuple[str, bool]:
        key = named(name.removesuffix(")") if wrapped else name, self._names)
        if kind_of(self._plan.compiled, key) == "number":
            raise TicksError(f"`{name}` is a number: write `{name}=0.3`")
        return key, value

    def _check(self, decisions: list[Decision], hole: bool, outputs: Mapping[str, str | float | None]) -> None:
        wanted = dict(self._expected(outputs))
        first = self._ticks - len(decisions)
        for number, decision in enumerate(decisions, start=first):
            if differs := dict(unexpected(decision, wanted, hole)):
                moment = self._moment(number, decision)
                raise AssertionError(said(self._plan.compiled, number, differs, moment, self._values))

    def _expected(self, outputs: Mapping[str, str | float | None]) -> Iterator[tuple[str, str | None]]:
        known = [output.name for output in self._plan.compiled.goals.outputs]
        for given, value in outputs.items():
            name = given if given in known else given.replace("_", "-")
            _check_output(name, known)
            yield name, self._value(name, value)

    def _value(self, output: str, value: str | float | None) -> str | None:
        """The canonical text of what a test calls a value: `flee` for `(flee)` where that is meant."""
        if value is None or value == OPEN:
            return None
        text = str(value).lower() if isinstance(value, bool) else str(value)
        texts = list(dict.fromkeys(term.text for name, term in self._decide.values() if name == output))
        if isinstance(value, float):
            text = canonical_number(value, "")
        return f"({text})" if text not in texts and f"({text})" in texts else text


def _check_output(name: str, known: Sequence[str]) -> None:
    if name not in known:
        meant = close(name, known)
        hint = f"did you mean `{meant}`?" if meant else f"there are: {', '.join(known)}"
        raise TicksError(f"the plan has no output `{name}`; {hint}")


def said(
    compiled: Compiled,
    tick: int,
    differs: Mapping[str, tuple[str, str]],
    moment: Moment,
    values: Mapping[str, PerceptValue],
) -> str:
    """What differs in a tick, with the way taken and the conditions on it, as lines."""
    lines = [f"{compiled.goals.name}: not as expected in tick {tick} (at {moment.time:g} s)"]
    for name, (expected, got) in differs.items():
        stands = moment.sent.get(name) if got == OPEN else None
        sent = f", so that {stands} is sent" if stands is not None else ""
        lines.append(f"  {f'`{name}`: ' if name in moment.outputs else ''}expected {expected}, got {got}{sent}")
    return "\n".join([*lines, f"  given: {given_words(compiled, values)}", *way_lines(moment.way)])


def given_words(compiled: Compiled, values: Mapping[str, PerceptValue]) -> str:
    """Percepts in words: those that are true, and every number."""
    units = {term.text: term.type.unit for term in compiled.goals.percepts() if term.type is not None}
    parts = [
        text if value is True else f"{text} = {canonical_number(value, units.get(text, ''))}"
        for text, value in values.items()
        if value is not False
    ]
    return ", ".join(parts) or "nothing"


def way_lines(way: TakenWay) -> Iterator[str]:
    """The way taken, one line a branch, an act and a member given up."""
    yield f"  by: {', '.join(way.rules) or ('no way is open' if way.hole else 'the top goal')}"
    for branch in way.branches:
        yield f"    {branch.span.line}: {branch.condition} is {'true' if branch.value else 'false'}"
    for act in way.acts:
        yield f"    {act.span.line}: {act.rule} sets {act.output} to {act.value}"
    for lost in way.given_up:
        yield f"    {lost.span.line}: {lost.member} is given up: {lost.because}"


# --- episodes ---


@dataclass(frozen=True, slots=True)
class EpisodeRun:
    """What came of an episode. trace: every tick; faults: (time [s], competence, message)."""

    verdict: Verdict
    trace: tuple[Moment, ...]
    faults: tuple[tuple[float, str, str], ...]

    def expect(self, *, done: bool = True) -> Self:
        """The task that the scenario sets is done, or not: where there is a donor, its object is fetched."""
        if self.verdict.done != done:
            raise AssertionError(self._said(done))
        return self

    def switches(self, output: str) -> list[tuple[float, str | None]]:
        """When [s] another value was sent, and which."""
        found: list[tuple[float, str | None]] = []
        for moment in self.trace:
            _check_output(output, list(moment.sent))
            value = moment.sent[output]
            if not found or found[-1][1] != value:
                found.append((moment.time, value))
        return found

    def _said(self, done: bool) -> str:
        verdict = self.verdict
        lines = [f"the task is {'not done' if done else 'done'} after {verdict.duration:g} s: {verdict.reason}"]
        lines += [f"  at {time:g} s ({name}) failed: {message}" for time, name, message in self.faults[:3]]
        if self.trace:
            last = self.trace[-1]
            lines += [f"  the last tick, at {last.time:g} s:", *way_lines(last.way)]
        return "\n".join(lines)


class EpisodeUnderTest:
    """One episode of a plan in a world."""

    def __init__(self, plan: PlanUnderTest, scenario: Path, seed: int) -> None:
        self._plan, self._scenario, self._seed = plan, scenario, seed

    def run(self, until: float | None = None) -> EpisodeRun:
        """Run it, at most until so many seconds. Raises PlanError, ScenarioError, OSError."""
        compiled = self._plan.compiled
        world = _read(lambda: load_world(self._scenario))
        brain = _read(lambda: PlanBrain(compiled, self._plan.libraries))
        episode = Episode(world.scenario, self._seed, compiled.goals.period)
        seen = _Seen(brain, self._plan.watch)
        try:
            verdict = episode.run(brain, until, seen)
        finally:
            brain.close()
        return EpisodeRun(verdict, tuple(seen.moments), tuple(seen.faults))


class _Seen:
    """Keeps every tick of an episode."""

    def __init__(self, brain: PlanBrain, watch: Watch) -> None:
        self._brain, self._watch = brain, watch
        self.moments: list[Moment] = []
        self.faults: list[tuple[float, str, str]] = []

    def observe(self, episode: Episode) -> None:
        tick = self._brain.tick
        if episode.over or tick is None:
            return
        self._watch(tick.decision)
        self.moments.append(Moment(episode.time, tick.decision, self._brain.trace.way(tick.decision)))
        self.faults += [(episode.time, fault.competence, fault.message) for fault in tick.faults]


# --- what would this plan have done? ---


@dataclass(frozen=True, slots=True)
class Changed:
    """A tick decided otherwise. differs: output (or `hole`) -> then and now; way: of the plan now."""

    tick: int
    time: float
    differs: Mapping[str, tuple[str, str]]
    way: TakenWay

    def __str__(self) -> str:
        what = "; ".join(f"{name} was {then}, would be {now}" for name, (then, now) in self.differs.items())
        return "\n".join([f"tick {self.tick} (at {self.time:g} s): {what}", *way_lines(self.way)])


def _changed(plan: PlanUnderTest, path: Path) -> Iterator[Changed]:
    recording = _read(lambda: read(path))
    brain = _read(lambda: PlanBrain(plan.compiled, plan.libraries))
    try:
        for number, (reading, recorded) in enumerate(zip(recording.readings, recording.ticks, strict=False)):
            note = recorded.get("plan")
            if not isinstance(note, Mapping):
                continue
            brain.step(reading)
            assert brain.tick is not None
            decision = brain.tick.decision
            plan.watch(decision)
            if differs := dict(_otherwise(note, decision)):
                yield Changed(number, reading.stamp, differs, brain.trace.way(decision))
    finally:
        brain.close()


def _otherwise(note: Mapping[str, object], decision: Decision) -> Iterator[tuple[str, tuple[str, str]]]:
    then, now = note.get("outputs"), texts(decision.outputs)
    before = then if isinstance(then, Mapping) else {}
    if bool(note.get("hole")) != decision.hole:
        yield "hole", (str(bool(note.get("hole"))).lower(), str(decision.hole).lower())
    for output in dict.fromkeys((*before, *now)):
        if before.get(output) != now.get(output):
            yield output, (str(before.get(output) or OPEN), now.get(output) or OPEN)
