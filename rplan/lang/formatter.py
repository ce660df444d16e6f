"""The text of a plan laid out anew: `rplan fmt`.

Takes: a text that can be read. Gives: the same forms and the same comments in the canonical layout. Leaves alone:
words, texts and comments as they are written, and where the lines of a form that fits are broken.

What was broken stays broken, with at most one blank line between; what does not fit on a line is broken. A part on a
new line stands under the first argument, in a definition or a `when` two columns further than that, and in a list that
begins with a list (a clause of `cond`) under that.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

from rplan.lang.depth import deep_recursion
from rplan.lang.reader import TOP_FORMS, Piece, pieces, read
from rplan.lang.source import Source

WIDTH = 100
"""Letters of a line that the layout fills, at most."""

_BODY = 2
_WITH_BODY = (*TOP_FORMS, "when")


@dataclass(slots=True)
class _Part:
    """A word, a comment or a list. flat: its text on one line, None where it cannot be on one.

    newlines: before it in the text. parts: of a list, with comments.
    """

    piece: Piece
    newlines: int
    flat: str | None
    parts: tuple[_Part, ...] | None = None

    @property
    def is_comment(self) -> bool:
        return self.piece.kind == "comment"


def formatted(source: Source) -> str:
    """The text in the canonical layout. Raises PlanError where it cannot be read."""
    read(source)
    with deep_recursion():
        layout = _Layout()
        for part, before in _with_previous(_tree(source.text)):
            if before is not None:
                trailing = part.is_comment and not part.newlines
                layout.write("  ") if trailing else layout.new_line(0, blank=part.newlines > 1)
            layout.part(part, 0)
        text = layout.text()
    return f"{text}\n" if text else ""


def comments(text: str) -> tuple[str, ...]:
    """Every comment of a text, without white space at its end."""
    return tuple(piece.text.rstrip() for piece in pieces(text) if piece.kind in ("comment", "region"))


# --- text to parts ----------------------------------------------------------------------------------


def _tree(text: str) -> tuple[_Part, ...]:
    stack: list[tuple[Piece, list[_Part]]] = []
    here: list[_Part] = []
    for piece in pieces(text):
        if piece.kind == "open":
            stack.append((piece, here))
            here = []
        elif piece.kind == "close":
            opener, outer = stack.pop()
            outer.append(_Part(opener, opener.newlines, _flat(here), tuple(here)))
            here = outer
        else:
            one_line = piece.kind != "comment" and "\n" not in piece.text
            here.append(_Part(piece, piece.newlines, piece.text if one_line else None))
    return tuple(here)


def _flat(parts: list[_Part]) -> str | None:
    texts = [part.flat for part in parts]
    if any(part.newlines for part in parts[1:]):
        return None
    whole = [text for text in texts if text is not None]
    return f"({' '.join(whole)})" if len(whole) == len(texts) else None


def _with_previous(parts: tuple[_Part, ...]) -> Iterator[tuple[_Part, _Part | None]]:
    if parts:
        yield parts[0], None
    for before, part in pairwise(parts):
        yield part, before


# --- parts to text ----------------------------------------------------------------------------------


class _Layout:
    """The lines so far; column: where the next letter goes."""

    def __init__(self) -> None:
        self._written: list[str] = []
        self.column = 0

    def text(self) -> str:
        return "".join(self._written)

    def write(self, text: str) -> None:
        self._written.append(text)
        line = text.rfind("\n")
        self.column = len(text) - line - 1 if line >= 0 else self.column + len(text)

    def new_line(self, column: int, *, blank: bool = False) -> None:
        self.write(("\n\n" if blank else "\n") + " " * column)

    def part(self, part: _Part, closers: int) -> None:
        """closers: how many parentheses close right behind it."""
        if part.parts is None:
            self.write(part.piece.text.rstrip() if part.is_comment else part.piece.text)
        elif part.flat is not None and self.column + len(part.flat) + closers <= WIDTH:
            self.write(part.flat)
        else:
            self._list(part.parts, closers, forced=part.flat is not None)

    def _list(self, parts: tuple[_Part, ...], closers: int, *, forced: bool) -> None:
        start = self.column
        breaks = _breaks(parts) if forced else [False] * len(parts)
        self.write("(")
        under: int | None = None
        head = next((part for part in parts if part.piece.kind not in ("comment", "region")), None)
        for index, (part, before) in enumerate(_with_previous(parts)):
            if before is not None:
                column = _column(head, start, under)
                broken = part.newlines > 0 or before.is_comment or breaks[index]
                self._between(part, column, broken=broken)
                if before is head and not broken and not part.is_comment:
                    under = self.column
            self.part(part, closers + 1 if index == len(parts) - 1 else 0)
        if parts and parts[-1].is_comment:
            self.new_line(start)
        self.write(")")

    def _between(self, part: _Part, column: int, *, broken: bool) -> None:
        if broken:
            self.new_line(column, blank=part.newlines > 1)
        else:
            self.write("  " if part.is_comment else " ")


def _column(head: _Part | None, start: int, under: int | None) -> int:
    """Where a part on a new line begins; under: where the first argument stands, if on the line of the head."""
    if head is None or head.parts is not None or head.piece.text == "else":
        return start + 1
    if head.piece.text in _WITH_BODY or under is None:
        return start + _BODY
    return under


def _breaks(parts: tuple[_Part, ...]) -> list[bool]:
    """Which parts of a list that does not fit on a line begin a new one; a value stays behind its keyword."""
    kept = 1 if parts and parts[0].parts is not None else 2
    after_keyword = [False, *(part.piece.text.startswith(":") for part in parts[:-1])]
    return [index >= kept and not behind for index, behind in enumerate(after_keyword)]
