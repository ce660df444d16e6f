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


def _place(span: Span, message: str, texts: Mapping[str, str]) -> list[str]:
    lines = texts.get(span.file, "").split("\n")
    out = [f"  --> {span}" + (f"    {message}" if message else "")]
    if 1 <= span.line <= len(lines) and lines[span.line - 1].strip():
        line = lines[span.line - 1].replace("\t", " ")
        end = span.end_column if span.end_line == span.line else len(line) + 1
        number = str(span.line)
        out += [
            f"   {number} | {line}",
            f"   {' ' * len(number)} | {' ' * (span.column - 1)}{'^' * max(1, end - span.column)}",
        ]
    return out


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
