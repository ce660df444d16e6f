"""What is said of a plan: code, severity, place, where else to look, a hint how to mend it.

Takes: spans and words. Gives: `Diagnostic`, its text with caret lines, `PlanError` and `InternalError`.
Leaves alone: where the words go (diagnostics are printed to stderr by the command line).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Literal

from rplan.lang.source import Span

Severity = Literal["error", "warning", "note"]


@dataclass(frozen=True, slots=True)
class Related:
    """Another place that has to do with it."""

    message: str
    span: Span


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """One finding. when: the situation that shows it, for findings that have a witness.

    trace: the same as lines for `rplan tick`, one JSON object a tick.
    """

    code: str
    severity: Severity
    message: str
    span: Span
    related: tuple[Related, ...] = ()
    hint: str = ""
    when: str = ""
    trace: tuple[str, ...] = ()


class PlanError(Exception):
    """The plan is wrong; carries every diagnostic, at least one of them an error.

    texts: file name -> its text, as far as it is known where the error is raised.
    """

    def __init__(self, diagnostics: Iterable[Diagnostic], texts: Mapping[str, str] | None = None) -> None:
        self.diagnostics = tuple(diagnostics)
        self.texts = texts or {}
        super().__init__("; ".join(f"{d.span}: {d.message}" for d in self.diagnostics if d.severity == "error"))


class InternalError(Exception):
    """rplan itself is wrong."""


GARBLED = "\ufffd"
"""Stands for what a terminal would obey instead of print; a line full of it is not shown."""
WIDEST = 120
"""Columns of a line of the text that are shown, at most."""


def _place(span: Span, message: str, texts: Mapping[str, str]) -> list[str]:
    lines = texts.get(span.file, "").split("\n")
    out = [f"  --> {span}" + (f"    {message}" if message else "")]
    line = lines[span.line - 1].replace("\t", " ").rstrip() if 1 <= span.line <= len(lines) else ""
    line = "".join(character if character.isprintable() else GARBLED for character in line)
    if not line or line.count(GARBLED) > len(line) // 8:
        return out
    first = max(0, span.column - 1 - WIDEST // 2) if len(line) > WIDEST else 0
    shown = line[first : first + WIDEST]
    end = span.end_column if span.end_line == span.line else len(line) + 1
    start = span.column - 1 - first
    length = max(1, min(end - 1 - first, len(shown)) - start)
    number = str(span.line)
    return [*out, f"   {number} | {shown}", f"   {' ' * len(number)} | {' ' * start}{'^' * length}"]


def render(diagnostic: Diagnostic, texts: Mapping[str, str]) -> str:
    """The finding as people read it; texts: file name -> its text, for the caret lines."""
    lines = [f"{diagnostic.severity}[{diagnostic.code}]: {diagnostic.message}"]
    lines += _place(diagnostic.span, "", texts)
    for related in diagnostic.related:
        lines += _place(related.span, related.message, texts)
    if diagnostic.when:
        lines.append(f"when: {diagnostic.when}")
    if diagnostic.hint:
        lines.append(f"hint: {diagnostic.hint}")
    return "\n".join(lines)
