"""Which tick of which plan a question is about.

Takes: a recording and a time, or a plan with percepts and a trace. Gives: `Moment`: the compiled plan, the atoms and
registers of the tick, and what each output was before. Leaves alone: the answer; see explaining.py.

The plan of a recording is compiled again from the text that stands in its header, with the texts that it includes. A
tick says since when its outputs are so; where it does not, those before it are looked at, the latest first.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from rplan.apps import talk
from rplan.apps.doing.tick import Keys
from rplan.apps.files import InputError, plan_file, unreadable
from rplan.apps.wiring import compile_source, decider
from rplan.driver import Compiled
from rplan.goals.condition import Comparison, Percept, percept_terms
from rplan.lang.diagnostic import PlanError
from rplan.lang.include import OpenFile
from rplan.lang.source import Source, Span
from rplan.lang.units import BadNumberError, canonical_number, read_number
from rplan.runtime.encode import PerceptError, PerceptValue, wrong_number
from rplan.runtime.tick import Decider, Decision
from rplan.runtime.trace import numbers, outputs_and_sent, texts
from rplan.ways.reduce import Ways
from rplan.ways.situations import atom_value, nothing
from rplan.ways.why_not import Wanted
from sim.chunks import MAGIC
from sim.recording import Backwards, RecordingError, backwards, read

LATE = 1e-6
"""Times nearer than this [s] are one."""


@dataclass(frozen=True, slots=True)
class Since:
    """An output has had its value since tick `tick` (time [s]); before it had `before`, None for open or no tick."""

    tick: int
    time: float
    before: str | None
    first: bool


@dataclass(frozen=True, slots=True)
class Moment:
    """One tick. time: of the tick [s]; percepts: their values, None where only the atoms are known (in recordings of
    earlier days).

    sent: output -> what its channel was sent, after idle and held values; since: output -> since when. forced: the
    percepts that someone who watched had set by hand.
    """

    compiled: Compiled
    tick: int
    time: float
    atoms: tuple[bool, ...]
    registers: tuple[bool, ...]
    sent: Mapping[str, str | None]
    since: Mapping[str, Since]
    percepts: Mapping[str, PerceptValue] | None = None
    forced: Mapping[str, PerceptValue] = field(default_factory=dict)

    def numbers(self, texts: Iterable[str]) -> dict[str, float]:
        """The numbers that the comparisons in these conditions ask, by percept, where they are known."""
        comparisons = [one for one in self.compiled.ways.atoms if isinstance(one, Comparison)]
        asked = [one for text in texts for one in comparisons if one.text in text]
        known = self.percepts or {}
        return {t.text: float(known[t.text]) for one in asked for t in percept_terms(one) if t.text in known}

    def readable(self) -> dict[str, str]:
        """The numbers with their units, to three digits or as many as no comparison needs to come out otherwise."""
        if self.percepts is None:
            return {}
        values = dict(self.percepts)
        atoms = [*zip(self.compiled.ways.atoms, self.atoms, strict=False)]
        for name in numbers(self.compiled.ways):
            every = (values | {name: float(f"{values[name]:.{digits}g}")} for digits in range(3, 18))
            values = next(one for one in every if all(atom_value(atom, one) == value for atom, value in atoms))
        terms = {term.text: term for term in self.compiled.goals.percepts(driving=True)}
        units = {name: "" if term.type is None else term.type.unit for name, term in terms.items()}
        return {name: canonical_number(float(values[name]), units[name]) for name in numbers(self.compiled.ways)}

    def place(self, span: Span) -> str:
        """A place without the folder."""
        return f"{Path(span.file).name}:{span.line}"


def moment(about: str, at: float | None, given: str | None, trace: Path | None, *, as_json: bool = False) -> Moment:
    """The tick that is asked about; `InputError` where there is none, leaves with 1 where the plan is wrong."""
    if is_recording(Path(about)):
        if given is not None or trace is not None:
            raise InputError("--given and --trace go with a plan; a recording has its own percepts")
        try:
            return _recorded(Path(about), at)
        except RecordingError as error:
            raise InputError(str(error)) from None
        except OSError as error:
            unreadable(Path(about), error)
    if at is not None:
        raise InputError("--at goes with a recording; --trace and --given say which tick of a plan is meant")
    if given is None and trace is None:
        raise InputError("say which tick is meant: --given 'PERCEPT, PERCEPT=NUMBER', or --trace FILE")
    return _alone(talk.compiled(plan_file(about), allow_holes=True, as_json=as_json), given, trace)


def is_recording(path: Path) -> bool:
    """Whether the file is a recording, or is called like one."""
    if path.suffix == ".mcap":
        return True
    try:
        with path.open("rb") as stream:
            return stream.read(len(MAGIC)) == MAGIC
    except OSError:
        return False


@dataclass(slots=True)
class _Before:
    """What each output has been sent, and since when."""

    last: Mapping[str, str | None] = field(default_factory=dict)
    since: dict[str, Since] = field(default_factory=dict)

    def add(self, tick: int, time: float, sent: Mapping[str, str | None]) -> None:
        for output, value in sent.items():
            if output not in self.last or self.last[output] != value:
                self.since[output] = Since(tick, time, self.last.get(output), output not in self.last)
        self.last = sent


# --- recordings -------------------------------------------------------------------------------------


def _recorded(path: Path, at: float | None) -> Moment:
    begun = read(path)
    compiled = _compiled_again(path, begun.header.get("plan"))
    run = backwards(path)
    ticks = _ticks_back(run, math.nan if at is None else at + LATE)
    found, period = next(ticks, None), compiled.goals.period
    if at is None or found is None or (at > found.time + period + LATE and at > _last(run) + period + LATE):
        lasts = f"{path} lasts from 0 s to {_last(run):g} s{', where it was cut short' if begun.cut_short else ''}"
        raise InputError(f"say when: --at SECONDS ({lasts})" if at is None else f"--at {at:g}: {lasts}")
    atoms, registers = _bits(path, found.plan, compiled)
    percepts = _percepts(path, found.plan, compiled, atoms)
    since = _since_as_noted(run, found, period) or _since(found, ticks)
    forced = _forced(found.text, compiled)
    return Moment(compiled, found.number, found.time, atoms, registers, found.shown, since, percepts, forced)


def _last(run: Backwards) -> float:
    """When the plan decided last [s]."""
    return next((one.time for one in _ticks_back(run, math.inf)), 0.0)


@dataclass(frozen=True, slots=True)
class _Recorded:
    """A tick in which the plan decided, as its text; what it showed stands ready, the rest is decoded when asked."""

    text: str
    shown: Mapping[str, str | None]

    @property
    def number(self) -> int:
        number = json.loads(self.text).get("tick")
        return number if isinstance(number, int) else 0

    @property
    def time(self) -> float:
        return float(json.loads(self.text)["t"])

    @property
    def plan(self) -> Mapping[str, object]:
        plan: Mapping[str, object] = json.loads(self.text)["plan"]
        return plan


def _ticks_back(run: Backwards, until: float) -> Iterator[_Recorded]:
    """The ticks up to a time [s] in which the plan decided, the latest first."""
    known: str = ""
    shown: Mapping[str, str | None] = {}
    for text in run.latest(until):
        part = outputs_and_sent(text)
        if not part or part != known:
            known, parts = _parts(text, part)
            if parts is None:
                continue
            shown = _shown(parts)
        yield _Recorded(text, shown)


def _parts(text: str, part: str) -> tuple[str, Mapping[str, object] | None]:
    """What has outputs and sent: the part of the text that has, or else the plan's part of the whole; None: no tick."""
    try:
        return part, json.loads(part)
    except ValueError:
        tick = json.loads(text)
    plan = tick.get("plan")
    return "", plan if isinstance(tick.get("t"), int | float) and isinstance(plan, Mapping) else None


def _since_as_noted(run: Backwards, found: _Recorded, period: float) -> Mapping[str, Since] | None:
    """Since when each output of a tick has its value, by the numbers that the tick itself gives; None where it gives
    none, or others than the ticks that they lead to.
    """
    noted = found.plan.get("since")
    numbers = noted if isinstance(noted, Mapping) else {}
    known: dict[object, tuple[_Recorded, _Recorded | None]] = {}
    since: dict[str, Since] = {}
    for output, value in found.shown.items():
        number = numbers.get(output)
        if number not in known:
            if not isinstance(number, int) or not 0 <= number <= found.number:
                return None
            back = _ticks_back(run, found.time - (found.number - number) * period + LATE)
            known[number] = next(back, found), next(back, None)
        then, before = known[number]
        if then.number != number or then.shown.get(output) != value:
            return None
        if before is not None and (before.number != number - 1 or before.shown.get(output, "") == value):
            return None
        was = None if before is None else before.shown.get(output)
        since[output] = Since(then.number, then.time, was, before is None or output not in before.shown)
    return since


def _since(found: _Recorded, before: Iterator[_Recorded]) -> dict[str, Since]:
    """Since when each output of a tick has its value."""
    since: dict[str, Since] = {}
    then = found
    for tick in before:
        if tick.shown is not then.shown:
            for output in [name for name in found.shown if name not in since]:
                if output not in tick.shown or tick.shown[output] != found.shown[output]:
                    is_new = output not in tick.shown
                    since[output] = Since(then.number, then.time, tick.shown.get(output), is_new)
            if len(since) == len(found.shown):
                break
        then = tick
    begin = {name: Since(then.number, then.time, None, True) for name in found.shown if name not in since}
    return {name: (since | begin)[name] for name in found.shown}


def _shown(plan: Mapping[str, object]) -> dict[str, str | None]:
    """What each output set or, where the way left it open, what was sent."""
    outputs, sent = plan.get("outputs"), plan.get("sent")
    if not isinstance(outputs, Mapping) or not isinstance(sent, Mapping):
        return {}
    every = {output: sent.get(output) if value is None else value for output, value in outputs.items()}
    return {output: _text(value) for output, value in every.items()}


def _text(value: object) -> str | None:
    return value if value is None or isinstance(value, str) else json.dumps(value)


def _bits(path: Path, plan: Mapping[str, object], compiled: Compiled) -> tuple[tuple[bool, ...], tuple[bool, ...]]:
    wanted = (compiled.ways.asking, compiled.ways.driving)
    found = [tuple(bit == "1" for bit in str(plan.get(name, ""))) for name in ("inputs", "registers")]
    if (len(found[0]), len(found[1])) != wanted:
        raise _read_otherwise(path)
    return found[0], found[1]


def _forced(text: str, compiled: Compiled) -> dict[str, PerceptValue]:
    by_hand = json.loads(text).get("by_hand")
    forced = by_hand.get("forced") if isinstance(by_hand, Mapping) else None
    known = forced if isinstance(forced, Mapping) else {}
    read = [term.text for term in compiled.goals.percepts(driving=True)]
    return {name: known[name] for name in read if isinstance(known.get(name), bool | int | float)}


def _percepts(
    path: Path, plan: Mapping[str, object], compiled: Compiled, atoms: tuple[bool, ...]
) -> Mapping[str, PerceptValue] | None:
    """The values of the percepts: truth values are atoms, numbers stand beside them; None where they do not."""
    given, compared = plan.get("percepts"), numbers(compiled.ways)
    known = given if isinstance(given, Mapping) else {}
    if not all(name in known for name in compared):
        return None
    values: dict[str, PerceptValue] = {name: known[name] for name in compared}
    if any(wrong_number(value) for value in values.values()):
        raise _read_otherwise(path)
    asked = compiled.ways.atoms[: compiled.ways.asking]
    values |= {atom.text: value for atom, value in zip(asked, atoms, strict=True) if isinstance(atom, Percept)}
    if any(atom_value(atom, values) != value for atom, value in zip(asked, atoms, strict=True)):
        raise _read_otherwise(path)
    return values


def _read_otherwise(path: Path) -> InputError:
    return InputError(
        f"{path}: this rplan reads the plan in it otherwise than the one that recorded it; record it again"
    )


def _compiled_again(path: Path, header: object) -> Compiled:
    if not isinstance(header, Mapping) or not isinstance(header.get("text"), str):
        raise InputError(f"{path} holds no plan: only runs of a plan can be asked why")
    source = Source(str(header.get("file", "plan.rplan")), str(header["text"]))
    try:
        compiled = compile_source(
            source, allow_holes=True, open_file=_included(header.get("included")), libraries=talk.libraries()
        )
    except PlanError as error:
        talk.say(error.diagnostics, error.texts or {source.name: source.text})
        raise InputError(f"{path}: the plan in it does not compile with the libraries that there are") from None
    inputs = [atom.text for atom in compiled.ways.atoms[: compiled.ways.asking]]
    if header.get("inputs") != inputs:
        raise _read_otherwise(path)
    return compiled


def _included(texts: object) -> OpenFile:
    """Gives the texts in the order in which they were opened then."""
    rest = [one for one in texts if isinstance(one, Mapping)] if isinstance(texts, Sequence) else []

    def open_file(name: str) -> Source:
        if not rest:
            raise FileNotFoundError(2, "it is not in the recording", name)
        return Source(name, str(rest.pop(0).get("text", "")))

    return open_file


# --- plans alone --------------------------------------------------------------------------------------


def _alone(compiled: Compiled, given: str | None, trace: Path | None) -> Moment:
    decide, keys, before = decider(compiled), Keys(compiled), _Before()
    period = compiled.goals.period
    percepts: Mapping[str, PerceptValue] = {}
    decision: Decision | None = None
    number = -1
    for line, text in [] if trace is None else _lines(trace):
        percepts = _read(keys, text, line, f"{trace}: ")
        decision = _decided(decide, keys, percepts, line, f"{trace}: ")
        number += 1
        before.add(number, _time(number, period), texts(decision.sent))
    if given is not None:
        values = json.dumps(_given(given, compiled), ensure_ascii=False)
        percepts = nothing(compiled.ways) | dict(_read(keys, values, 1, "--given: "))
        decision = _decided(decide, keys, percepts, 1, "--given: ")
        number += 1
        before.add(number, _time(number, period), texts(decision.sent))
    if decision is None:
        raise InputError(f"{trace} has no tick")
    driving = {term.text: percepts[term.text] for term in compiled.goals.percepts(driving=True)}
    time = _time(number, period)
    return Moment(compiled, number, time, decision.inputs, decision.registers, before.last, before.since, driving)


def _time(number: int, period: float) -> float:
    """When a tick of a plan alone is [s], without what sums of floats add."""
    return round(number * period, 9)


def _lines(trace: Path) -> Iterator[tuple[int, str]]:
    try:
        text = trace.read_bytes().decode("utf-8-sig", errors="replace")
    except OSError as error:
        unreadable(trace, error)
    yield from ((number, line) for number, line in enumerate(text.splitlines(), start=1) if line.strip())


def _read(keys: Keys, line: str, number: int, where: str) -> Mapping[str, PerceptValue]:
    try:
        return keys.read(line, number)
    except InputError as error:
        raise _placed(error, where) from None


def _decided(decide: Decider, keys: Keys, percepts: Mapping[str, PerceptValue], number: int, where: str) -> Decision:
    try:
        return decide.tick(percepts)
    except PerceptError as error:
        raise _placed(keys.wrong(number, error), where) from None


def _placed(error: InputError, where: str) -> InputError:
    """The error with the name of where it is; what is given by hand has no lines."""
    said = error.format_message()
    return InputError(where + (said.removeprefix("line 1: ") if where.startswith("--") else said))


def _given(text: str, compiled: Compiled) -> dict[str, PerceptValue]:
    """`NAME, NAME=VALUE, …` as keys and values; a name alone is true."""
    values: dict[str, PerceptValue] = {}
    for part in split(text):
        name, equals, value = (word.strip() for word in part.rpartition("=")) if "=" in part else (part.strip(), "", "")
        name = _spaced(name)
        if not name or name in values:
            raise InputError(f"--given: `{part.strip()}`: " + ("it is there twice" if name else "a percept is wanted"))
        if " " in name and not name.startswith("("):
            raise InputError(f"--given: `{part.strip()}`: a percept is wanted; several are separated by commas")
        function = compiled.goals.functions.get("".join(_words(name)[:1]))
        unit = function.type.unit if function is not None and function.type is not None else ""
        values[name] = _value(part.strip(), value, unit) if equals else True
    return values


def _value(part: str, text: str, unit: str) -> PerceptValue:
    if text in ("true", "false"):
        return text == "true"
    try:
        number, found = read_number(text)
        if found in ("", unit):
            return number
        raise InputError(f"--given: `{part}`: its unit is {unit or 'none'}, not {found}")
    except BadNumberError as error:
        hint = f" ({error.hint})" if error.hint else ""
        wrong = f"{error}{hint}" if text[:1].isdigit() else "true, false or a number is wanted"
        raise InputError(f"--given: `{part}`: {wrong}") from None


def wishes(text: str, ways: Ways) -> Wanted:
    """`OUTPUT=VALUE, OUTPUT=, (open OUTPUT)` as outputs and canonical texts."""
    found: dict[str, str | None] = {}
    for part in split(text):
        name, equals, value = (one.strip() for one in part.partition("="))
        if not equals and name.startswith("(open ") and name.endswith(")"):
            name = name[len("(open ") : -1].strip()
        elif not equals:
            raise InputError(f"`{part.strip()}`: OUTPUT=VALUE is wanted, or OUTPUT= for one that stays open")
        if not name or name in found:
            raise InputError(f"`{name}` is there twice" if name else f"`{part.strip()}`: OUTPUT=VALUE is wanted")
        found[name] = _canonical(value, ways.sets.get(name, {})) if value else None
    if not found:
        raise InputError("OUTPUT=VALUE is wanted")
    return found


def _canonical(value: str, known: Iterable[str]) -> str:
    """The value as the plan has it: spaces once, numbers in SI, parentheses around what is called at any depth."""
    meant = [one for one in known if _words(one) == _words(value)]
    if len(meant) == 1 and value.count("(") == value.count(")"):
        return meant[0]
    try:
        return canonical_number(*read_number(value.strip()))
    except BadNumberError:
        return _spaced(value)


def _spaced(text: str) -> str:
    """A call with its spaces as in canonical text."""
    return " ".join(text.split()).replace("( ", "(").replace(" )", ")")


def _words(text: str) -> list[str]:
    return text.replace("(", " ").replace(")", " ").split()


def split(text: str) -> list[str]:
    """The parts between commas that stand outside parentheses; none of an empty text."""
    parts, depth = [""], 0
    for letter in text:
        depth += (letter == "(") - (letter == ")")
        if letter == "," and depth <= 0:
            parts.append("")
        else:
            parts[-1] += letter
    return parts if text.strip() else []
