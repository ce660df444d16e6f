"""Places in texts.

Takes: nothing. Gives: `Source` (a text with its name) and `Span` (a place in it). Leaves alone: what the text means.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Source:
    """A text and the name under which messages speak of it."""

    name: str
    text: str


@dataclass(frozen=True, slots=True, order=True)
class Span:
    """From (line, column) up to, not including, (end_line, end_column); all counted from 1."""

    file: str
    line: int
    column: int
    end_line: int
    end_column: int

    def __str__(self) -> str:
        return f"{self.file}:{self.line}:{self.column}"

    def to(self, last: Span) -> Span:
        """From here up to the end of `last`, which stands behind it in the same file."""
        return Span(self.file, self.line, self.column, last.end_line, last.end_column)


NOWHERE = Span("<built-in>", 1, 1, 1, 1)
"""The place of what no text says."""
