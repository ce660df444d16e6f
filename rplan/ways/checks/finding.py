"""How checks put findings into words.

Takes: places, words, traces. Gives: diagnostics. Leaves alone: what is found.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

from rplan.goals.goal import Goal
from rplan.lang.diagnostic import Diagnostic, Related, Severity
from rplan.lang.source import Span
from rplan.ways.layout import Node
from rplan.ways.reduce import Ways
from rplan.ways.situations import Trace, describe, lines


def not_decided(what: str, span: Span) -> Diagnostic:
    """A question that was too hard."""
    return Diagnostic("not-decided", "warning", f"{what} could not be decided", span)


def shown(
    ways: Ways,
    trace: Trace,
    code: str,
    severity: Severity,
    message: str,
    span: Span,
    related: tuple[Related, ...] = (),
    hint: str = "",
) -> Diagnostic:
    """A finding with the trace that shows it."""
    return Diagnostic(code, severity, message, span, related, hint, describe(trace, ways), lines(trace))


@dataclass(frozen=True, slots=True)
class Place:
    """A place in the text and every node of the reduced goal that came from it; a rule may stand in several."""

    goal: Goal
    nodes: tuple[Node, ...]


def places(ways: Ways, key: Callable[[Node], object | None]) -> list[Place]:
    """The nodes of a layout by what `key` says of them (None: left out), in textual order."""
    found: dict[object, list[Node]] = {}
    for node in ways.layout.nodes:
        name = key(node)
        if name is not None:
            found.setdefault(name, []).append(node)
    return [Place(nodes[0].goal, tuple(nodes)) for nodes in found.values()]


def also(message: str, spans: Iterable[Span]) -> tuple[Related, ...]:
    """The same said of several places, each once."""
    return tuple(Related(message, span) for span in dict.fromkeys(spans))
