"""What a plan says of itself, tried on it: its `deftest`s and its golden ticks.

Takes: a `Decider`, a test or golden ticks. Gives: the first tick in which something differs, as readable lines. Leaves
alone: who asks; the pytest plugin, the fixtures and `rplan mutate` do.

Golden ticks stand in `NAME.ticks` or `NAME.ticks.jsonl`, by turns a line of percepts (an object percept → value, or a
list of those that are true) and the line that `rplan tick` prints for it. A percept that an object does not name keeps
its value; all begin false or 0. The first line may name the plan: `; FILE.rplan`, in `.jsonl` `{"plan": "FILE.rplan"}`.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from difflib import ndiff
from pathlib import Path

from rplan.apps.doing.test import HOLE, NO_HOLE, OPEN
from rplan.driver import Compiled
from rplan.goals.goal import Trial, TrialStep
from rplan.lang.suggest import close
from rplan.runtime.encode import PerceptError, PerceptValue
from rplan.runtime.tick import Decider, Decision
from rplan.runtime.trace import Trace, texts
from rplan.ways.reduce import Ways
from rplan.ways.situations import nothing, number_percepts

SUFFIXES = (".ticks", ".ticks.jsonl")
COMMENT = ";"
MOST_TICKS = 3
"""Golden ticks that differ are shown, so many."""
Watch = Callable[[Decision], None]
"""Sees every tick that is tried."""
Values = dict[str, PerceptValue]
__tracebackhide__ = True
"""For pytest: what cannot be used is shown where the test gives it."""


def unwatched(decision: Decision) -> None:
    """Nobody looks."""


class TicksError(ValueError):
    """Golden ticks, or percepts, that cannot be used; the message says where and why."""


@dataclass(frozen=True, slots=True)
class Difference:
    """What differs first. tick: from 0; differs: output (or `hole`) -> expected and got; step: of a test, else None."""

    tick: int
    differs: Mapping[str, tuple[str, str]]
    decision: Decision
    values: Mapping[str, PerceptValue]
    step: TrialStep | None = None


# --- tests that stand in a plan ---


def try_trial(decide: Decider, trial: Trial, start: Mapping[str, PerceptValue], watch: Watch) -> Difference | None:
    """Run a test on a plan that has not ticked yet; `start`: what percepts are before a step gives them."""
    values, tick = dict(start), 0
    for step in trial.steps:
        values |= dict(step.given)
        for _ in range(step.times):
            decision = decide.tick(values)
            watch(decision)
            if differs := dict(unexpected(decision, dict(step.expected), step.hole)):
                return Difference(tick, differs, decision, dict(values), step)
            tick += 1
    return None


def unexpected(
    decision: Decision, expected: Mapping[str, str | None], hole: bool
) -> Iterator[tuple[str, tuple[str, str]]]:
    """Output, or `hole` -> expected and got."""
    if decision.hole != hole:
        yield HOLE, (HOLE if hole else NO_HOLE, HOLE if decision.hole else NO_HOLE)
    got = texts(decision.outputs)
    for output, value in expected.items():
        if got[output] != value:
            yield output, (value or OPEN, got[output] or OPEN)


# --- golden ticks ---


@dataclass(frozen=True, slots=True)
class GoldenTick:
    """line: of the percepts, from 1; expected: what `rplan tick` printed, None where nothing stands yet."""

    line: int
    values: Mapping[str, PerceptValue]
    expected: Mapping[str, object] | None


@dataclass(frozen=True, slots=True)
class Golden:
    """The ticks of a file, and its text with what each line is, so that it can be written anew."""

    path: Path
    ticks: tuple[GoldenTick, ...]
    lines: tuple[str, ...]


def plan_of(path: Path) -> Path | None:
    """The plan that golden ticks belong to: that which the first line names, else that of the same name beside them."""
    with path.open(encoding="utf-8-sig", errors="replace") as file:
        first = file.readline(4096).strip()
    named = first.lstrip(f"{COMMENT}#/ ") if first.startswith((COMMENT, "#", "//")) else ""
    if first.startswith('{"plan"'):
        try:
            named = str(json.loads(first)["plan"])
        except (ValueError, TypeError, RecursionError):
            named = ""
    if named.endswith(".rplan"):
        return path.parent / named
    beside = path.parent / f"{path.name.partition('.')[0]}.rplan"
    return beside if beside.is_file() else None


def ticks_files(plan: Path) -> list[Path]:
    """The golden ticks beside a plan that belong to it."""
    found = [path for suffix in SUFFIXES for path in sorted(plan.parent.glob(f"*{suffix}"))]
    return [path for path in found if (of := plan_of(path)) is not None and of.resolve() == plan.resolve()]


def read_golden(path: Path, compiled: Compiled) -> Golden:
    """The golden ticks of a file; `TicksError` with file and line, `OSError`."""
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except UnicodeDecodeError as error:
        raise TicksError(
            f"{path}: this is not a text: {error.reason} at byte {error.start}, where UTF-8 is wanted"
        ) from None
    names = percept_names(compiled)
    values: Values = dict(nothing(compiled.ways))
    ticks: list[GoldenTick] = []
    for number, line in enumerate(lines, start=1):
        if not _counts(number, line):
            continue
        try:
            given = json.loads(line)
        except (ValueError, RecursionError) as error:
            raise TicksError(f"{path}:{number}: not JSON: {error}") from None
        if _is_output(given):
            if not ticks or ticks[-1].expected is not None:
                raise TicksError(f"{path}:{number}: a line of outputs without a line of percepts before it")
            ticks[-1] = GoldenTick(ticks[-1].line, ticks[-1].values, given)
            continue
        try:
            values = _given(given, values, names, compiled.ways)
        except TicksError as error:
            raise TicksError(f"{path}:{number}: {error}") from None
        ticks.append(GoldenTick(number, dict(values), None))
    return Golden(path, tuple(ticks), tuple(lines))


def _counts(number: int, line: str) -> bool:
    text = line.strip()
    return bool(text) and not text.startswith((COMMENT, "#", "//")) and not (number == 1 and text.startswith('{"plan"'))


def _is_output(given: object) -> bool:
    return isinstance(given, dict) and "outputs" in given


def _given(given: object, before: Values, names: Mapping[str, str], ways: Ways) -> Values:
    match given:
        case list():
            return dict(nothing(ways)) | {named(str(name), names): True for name in given}
        case dict():
            return before | {named(str(name), names): value for name, value in given.items()}
        case _:
            raise TicksError(f"an object percept → value or a list is wanted, not {json.dumps(given)[:40]}")


def percept_names(compiled: Compiled) -> dict[str, str]:
    """Names under which percepts may be given -> canonical text: those that the plan reads, or knows of."""
    known = {name: f"({name})" for name in _known(compiled)}
    read = {term.text if term.arguments else term.name: term.text for term in compiled.goals.percepts()}
    every = read | known
    return every | {text: text for text in every.values()}


def _known(compiled: Compiled) -> dict[str, str]:
    """Percepts without arguments that are declared, read or not -> their types."""
    return {
        one.name: one.type.name
        for one in compiled.goals.functions.values()
        if one.type is not None and one.type.name in ("bool", "number") and not one.parameters
    }


def named(name: str, names: Mapping[str, str]) -> str:
    """The canonical text of a percept; `TicksError` where the plan does not read it."""
    if name in names:
        return names[name]
    meant = close(name, names)
    hint = f"; did you mean `{meant}`?" if meant else ""
    raise TicksError(f"`{name}` is a percept that the plan neither declares nor reads{hint}")


def kind_of(compiled: Compiled, text: str) -> str:
    """What a percept is: `number` or `bool`."""
    return "number" if text in number_percepts(compiled.ways) else _known(compiled).get(text[1:-1], "bool")


def unit_of(compiled: Compiled, text: str) -> str:
    """The SI unit of a percept that is a number; nothing where it has none."""
    function = compiled.goals.functions.get(text[1:-1].partition(" ")[0])
    return function.type.unit if function is not None and function.type is not None else ""


def try_ticks(decide: Decider, golden: Golden, watch: Watch) -> Difference | None:
    """The first golden tick whose outputs, or hole, are others now; ways are not compared."""
    for number, tick in enumerate(golden.ticks):
        decision = decided(decide, golden, tick)
        watch(decision)
        expected = tick.expected or {}
        outputs = expected.get("outputs")
        wanted = outputs if isinstance(outputs, Mapping) else {}
        got = texts(decision.outputs)
        known = {output: value for output, value in wanted.items() if output in got}
        differs = dict(unexpected(decision, known, bool(expected.get("hole", False))))
        if differs and tick.expected is not None:
            return Difference(number, differs, decision, tick.values)
    return None


@dataclass(frozen=True, slots=True)
class Stood:
    """Golden ticks after they were tried. now: what `rplan tick` prints, a line a tick; differing: a text a tick."""

    now: tuple[str, ...]
    differing: tuple[str, ...]


def try_golden(decide: Decider, trace: Trace, golden: Golden, watch: Watch, *, ways: bool = True) -> Stood:
    """Every golden tick with all that stands in it; ways: also how it came about, where that stands there."""
    now, differing = [], []
    for number, tick in enumerate(golden.ticks):
        decision = decided(decide, golden, tick)
        watch(decision)
        now.append(trace.line(number, decision))
        differs = ["+ nothing stands there yet"]
        if tick.expected is not None:
            expected = {key: value for key, value in tick.expected.items() if ways or key != "way"}
            differs = compared(expected, json.loads(now[-1]))
        if differs:
            said = [f"{golden.path.name}:{tick.line}: tick {number}", *(f"    {line}" for line in differs)]
            differing.append("\n".join(said))
    return Stood(tuple(now), tuple(differing))


def shown(stood: Stood) -> str:
    """The first ticks that differ."""
    every, ticks = stood.differing, len(stood.now)
    more = [f"… and {len(every) - MOST_TICKS} more"] if len(every) > MOST_TICKS else []
    says = f"{len(every)} of {ticks} ticks differ (- golden, + now; --rplan-bless writes them anew)"
    return "\n".join([says, *every[:MOST_TICKS], *more])


def decided(decide: Decider, golden: Golden, tick: GoldenTick) -> Decision:
    """One golden tick decided; `TicksError` where its percepts have no proper values."""
    try:
        return decide.tick(tick.values)
    except PerceptError as error:
        raise TicksError(f"{golden.path}:{tick.line}: {error}") from None


def compared(expected: Mapping[str, object], got: Mapping[str, object]) -> list[str]:
    """Lines that differ, `-` what was and `+` what is; lines of the plan's text are not compared.

    Only those parts are looked at that stand in `expected`.
    """
    seen = {key: value for key, value in got.items() if key in expected}
    before, after = _lines(expected), _lines(seen)
    if before == after:
        return []
    return [line for line in ndiff(before, after) if line.startswith(("- ", "+ "))]


def _lines(tick: Mapping[str, object]) -> list[str]:
    """A tick as one line a fact."""
    found = [f"hole: {json.dumps(tick['hole'])}"] if "hole" in tick else []
    for key in ("outputs", "sent"):
        part = tick.get(key)
        if isinstance(part, Mapping):
            found += [f"{key}: {name} = {OPEN if value is None else value}" for name, value in part.items()]
    way = tick.get("way")
    return [*found, *(_way_lines(way) if isinstance(way, Mapping) else ())]


def _way_lines(way: Mapping[str, object]) -> Iterator[str]:
    for rule in _listed(way.get("rules")):
        yield f"way: {rule}"
    for branch in filter(_is_mapping, _listed(way.get("branches"))):
        yield f"way: {branch.get('rule')}: {branch.get('condition')} is {json.dumps(branch.get('value'))}"
    for act in filter(_is_mapping, _listed(way.get("acts"))):
        yield f"way: {act.get('rule')} sets {act.get('output')} to {act.get('value')}"
    for lost in filter(_is_mapping, _listed(way.get("given_up"))):
        yield f"way: {lost.get('member')} is given up: {lost.get('because')}"


def _is_mapping(value: object) -> bool:
    return isinstance(value, Mapping)


def _listed(value: object) -> Sequence[Mapping[str, object]]:
    return value if isinstance(value, list) else ()


def blessed(golden: Golden, lines: Sequence[str]) -> str:
    """The file's text with the lines that `rplan tick` prints now; comments and percepts stay."""
    new = iter(lines)
    starts = [tick.line for tick in golden.ticks]
    text: list[str] = []
    for number, line in enumerate(golden.lines, start=1):
        if number in starts:
            text += [line, next(new)]
        elif not (_counts(number, line) and _is_output(json.loads(line))):
            text.append(line)
    return "".join(f"{line}\n" for line in text)
