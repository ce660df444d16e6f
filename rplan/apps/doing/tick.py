"""What `rplan tick` does.

Takes: a plan, and percepts or a recording. Gives: what the plan decides, one JSON object a line (L22). Leaves alone:
options and their help; see rplan/apps/commands/tick.py, which imports this only when there is something to do.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any, BinaryIO

import click

from rplan.apps import talk
from rplan.apps.files import InputError, plan_file, unreadable
from rplan.apps.wiring import PlanBrain, decider
from rplan.driver import Compiled
from rplan.lang.diagnostic import PlanError
from rplan.lang.suggest import close
from rplan.runtime.encode import PerceptError, PerceptValue, wrong_number
from rplan.runtime.trace import Trace, texts
from sim.recording import RecordingError
from sim.recording import readings as recorded


def run(plan: str, source: BinaryIO, readings: Path | None, switches: bool, strict: bool, allow_holes: bool) -> None:
    """Do what was asked; leaves with the exit code of the command."""
    if switches and readings is None:
        raise InputError("--switches goes with --readings")
    path = plan_file(plan)
    compiled = talk.compiled(path, strict=strict, allow_holes=allow_holes)
    if readings is None:
        _over_lines(compiled, source)
    else:
        _over_readings(compiled, path, readings, switches)


def _over_lines(compiled: Compiled, source: BinaryIO) -> None:
    decide = decider(compiled)
    trace = Trace(compiled.ways)
    keys = Keys(compiled)
    number = 0
    for line_number, raw in enumerate(source, start=1):
        line = _text(raw, line_number)
        if not line.strip():
            continue
        values = keys.read(line, line_number)
        try:
            decision = decide.tick(values)
        except PerceptError as error:
            raise keys.wrong(line_number, error) from None
        click.echo(trace.line(number, decision))
        number += 1


def _over_readings(compiled: Compiled, plan: Path, recording: Path, switches: bool) -> None:
    """The plan and its competences over what was sensed then."""
    try:
        brain = PlanBrain(compiled, talk.libraries())
    except PlanError as error:
        talk.wrong(error, plan)
    before: tuple[object, ...] | None = None
    try:
        for number, reading in enumerate(recorded(recording)):
            brain.step(reading)
            assert brain.tick is not None
            decision = brain.tick.decision
            now = (decision.hole, *texts(decision.sent).values())
            if not switches or now != before:
                click.echo(_stamped(reading.stamp, brain.trace.line(number, decision)))
            before = now
    except RecordingError as error:
        raise InputError(str(error)) from None
    except OSError as error:
        unreadable(recording, error)
    finally:
        brain.close()


def _stamped(stamp: float, line: str) -> str:
    """The line with the time of the reading [s] in front."""
    return f'{{"t": {json.dumps(round(stamp, 6))}, {line[1:]}'


def _text(raw: bytes, number: int) -> str:
    try:
        return raw.decode("utf-8-sig" if number == 1 else "utf-8")
    except UnicodeDecodeError:
        raise InputError(f"line {number}: not text in UTF-8") from None


class Keys:
    """Which keys a line may have."""

    def __init__(self, compiled: Compiled) -> None:
        self._texts: dict[str, str] = {}
        self._types: dict[str, str] = {}
        for function in compiled.goals.functions.values():
            if function.type is not None and function.type.name in ("bool", "number") and not function.parameters:
                self._texts[function.name] = f"({function.name})"
                self._types[f"({function.name})"] = function.type.name
        for term in compiled.goals.percepts():
            self._texts[term.text if term.arguments else term.name] = term.text
        self._names = {text: name for name, text in self._texts.items()}

    def wrong(self, number: int, error: PerceptError) -> InputError:
        """The error of a line, with the key as the user writes it."""
        said = str(error).removeprefix(f"{error.key}: ")
        return InputError(f"line {number}: `{self._names.get(error.key, error.key)}`: {said}")

    def read(self, line: str, number: int) -> Mapping[str, PerceptValue]:
        """The percept values of a line by canonical text; `InputError` naming line and key."""

        def unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
            seen: dict[str, Any] = {}
            for key, value in pairs:
                if key in seen:
                    raise InputError(f"line {number}: `{key}` is there twice")
                seen[key] = value
            return seen

        try:
            value = json.loads(line.rstrip(), object_pairs_hook=unique)
        except json.JSONDecodeError as error:
            raise InputError(f"line {number}: not JSON: {error.msg} at column {error.colno}") from None
        except ValueError:
            raise InputError(f"line {number}: a number has too many digits") from None
        except RecursionError:
            raise InputError(f"line {number}: nested too deep") from None
        if not isinstance(value, dict):
            raise InputError(f"line {number}: an object percept → value is wanted, not {json.dumps(value)[:40]}")
        values: dict[str, PerceptValue] = {}
        for key, given in value.items():
            text = self._texts.get(key) or (key if key in self._names else None)
            if text is None:
                meant = close(key, self._texts)
                hint = f" (did you mean `{meant}`?)" if meant else ""
                raise InputError(f"line {number}: `{key}` is a percept that the plan neither declares nor reads{hint}")
            if text in values:
                raise InputError(f"line {number}: `{self._names.get(text, text)}` is there twice, also as `{text}`")
            self._check(number, text, given)
            values[text] = given
        return values

    def _check(self, number: int, text: str, value: object) -> None:
        """A percept that is declared has a value of its type, whether the plan reads it or not."""
        kind = self._types.get(text)
        if (kind == "bool" and not isinstance(value, bool)) or (kind == "number" and wrong_number(value)):
            wanted = "true or false" if kind == "bool" else "a finite number"
            raise InputError(f"line {number}: `{self._names[text]}`: {wanted} is wanted, not {json.dumps(value)[:40]}")
