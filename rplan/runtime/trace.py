"""A tick as JSON, for recordings and for `rplan tick`.

Takes: decisions and ticks of a compiled plan. Gives: JSON text in the form of L22 (`way` names rules, branches and
members given up), and from the text of a recorded tick what it set and sent. Leaves alone: where it is written.

A way depends on inputs and registers alone, so it is put into words once for each pair of them.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import asdict
from typing import Any

from rplan.circuit.evaluate import Bits
from rplan.goals.condition import Comparison, Term, percept_terms
from rplan.lang.source import Span
from rplan.runtime.controller import Tick
from rplan.runtime.tick import Decision, Setting
from rplan.ways.reduce import Ways
from rplan.ways.way import TakenWay, taken_way

NOTE = ',"plan":{"inputs":"'
"""How the plan's part of a recorded tick begins."""
SENT = '},"sent":{'

Show = Callable[[object], object]
"""A value of the run-time world -> plain JSON value."""


class Trace:
    """Puts ticks of one plan into words."""

    def __init__(self, ways: Ways, show: Show = str) -> None:
        self._ways = ways
        self._file = ways.goals.top.span.file
        self._show = show
        self._numbers = numbers(ways)
        self._known: dict[tuple[Bits, Bits], tuple[TakenWay, str]] = {}
        self._stood: dict[str, tuple[object, int]] = {}

    def way(self, decision: Decision) -> TakenWay:
        """The way that was taken."""
        return self._way(decision)[0]

    def _way(self, decision: Decision) -> tuple[TakenWay, str]:
        key = (decision.inputs, decision.registers)
        if key not in self._known:
            way = taken_way(self._ways, decision.inputs, decision.registers)
            self._known[key] = way, _compact(way_json(way, self._file))
        return self._known[key]

    def line(self, number: int, decision: Decision) -> str:
        """One line of `rplan tick` (L22)."""
        line = {
            "tick": number,
            "hole": decision.hole,
            "outputs": texts(decision.outputs),
            "sent": texts(decision.sent),
            "way": way_json(self.way(decision), self._file),
        }
        return json.dumps(line, ensure_ascii=False)

    def _sent(self, term: Term | None, value: object) -> object:
        """What a channel holds: the text of a competence or literal, a value of the run-time world as it came out."""
        if term is None or (term.kind == "call" and value is None):
            return None
        is_value = term.kind == "call" and (term.type is None or term.type.name != "command")
        return self._show(value) if is_value else term.text

    def note(self, tick: Tick[Any]) -> str:
        """The plan's part of a recorded tick; asked of every tick in order, a tick 0 begins anew."""
        decision = tick.decision
        sent = {name: self._sent(term, tick.values[name]) for name, term in decision.sent.items()}
        outputs = texts(decision.outputs)
        rest = {
            "inputs": _bits(decision.inputs),
            "registers": _bits(decision.registers),
            "hole": decision.hole,
            "outputs": outputs,
            "sent": sent,
            "since": self._since(tick.number, outputs, sent),
            "percepts": {text: tick.percepts[text] for text in self._numbers},
            "started": list(tick.started),
            "stopped": list(tick.stopped),
            "faults": [asdict(fault) for fault in tick.faults],
            "reports": {
                f"({name})": {"status": report.status, "details": report.details}
                for name, report in tick.reports.items()
            },
        }
        if tick.shown:
            rest["shown"] = dict(tick.shown)
        return f'{_compact(rest)[:-1]},"way":{self._way(decision)[1]}}}'

    def _since(self, number: int, outputs: Mapping[str, str | None], sent: Mapping[str, object]) -> Mapping[str, int]:
        """Output -> the tick since which it sets the same, or is sent the same where the way leaves it open."""
        stood = self._stood if number else {}
        now = {name: sent[name] if value is None else value for name, value in outputs.items()}
        self._stood = {
            name: (value, stood[name][1] if name in stood and stood[name][0] == value else number)
            for name, value in now.items()
        }
        return {name: since for name, (_, since) in self._stood.items()}


def numbers(ways: Ways) -> tuple[str, ...]:
    """The percepts that a plan compares, by canonical text; all others are truth values, and inputs themselves."""
    atoms = ways.atoms[: ways.asking]
    compared = {term.text for atom in atoms if isinstance(atom, Comparison) for term in percept_terms(atom)}
    return tuple(term.text for term in ways.goals.percepts(driving=True) if term.text in compared)


def outputs_and_sent(text: str) -> str:
    """The part of a recorded tick's text that has its outputs and what was sent; "" where it is not written like one.

    Ticks with the same part set and sent the same, so that not every tick of a long run has to be decoded.
    """
    begin = text.find('"outputs":{', text.find(NOTE))
    middle = text.find(SENT, begin)
    end = text.find('},"', middle + len(SENT) - 1)  # neither outputs nor what is sent hold objects
    if text.count(NOTE) != 1 or not 0 <= begin < middle < end:
        return ""
    return f"{{{text[begin : end + 1]}}}"


def texts(setting: Setting) -> dict[str, str | None]:
    """Output -> canonical text."""
    return {output: None if term is None else term.text for output, term in setting.items()}


def way_json(way: TakenWay, file: str) -> Mapping[str, object]:
    """A way as plain JSON values; lines are those of `file`, what stands in an included file has its place as `at`."""
    return {
        "rules": list(way.rules),
        "branches": [
            {"condition": b.condition, "value": b.value, "rule": b.rule, **_line(b.span, file)} for b in way.branches
        ],
        "acts": [{"output": a.output, "value": a.value, "rule": a.rule, **_line(a.span, file)} for a in way.acts],
        "given_up": [{"member": g.member, "because": g.because, **_line(g.span, file)} for g in way.given_up],
    }


def _line(span: Span, file: str) -> Mapping[str, object]:
    return {"line": span.line} if span.file == file else {"line": None, "at": str(span)}


def _bits(bits: Bits) -> str:
    return "".join("1" if bit else "0" for bit in bits)


def _compact(value: object) -> str:
    return json.dumps(value, separators=(",", ":"), ensure_ascii=False)
