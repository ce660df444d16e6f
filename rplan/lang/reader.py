"""Text to forms: symbols, keywords, variables, numbers, strings and lists, each with its place (L1-L4).

Takes: a source text. Gives: forms, and every error of the text at once. Leaves alone: what the forms say.

The lexer is lark's (plan.lark); the fold into lists is our own, without recursion. A `(` in the first column that
opens a form of the top level begins a new *chunk*. An error of parentheses, strings or comments spoils its chunk and no
other, and is reported once.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Literal

from lark import Lark, Token

from rplan.lang.depth import MAX_LEVELS, no_collection
from rplan.lang.diagnostic import Diagnostic, PlanError, Related
from rplan.lang.source import Source, Span
from rplan.lang.suggest import close
from rplan.lang.units import BadNumberError, read_number

TOP_FORMS = (
    "plan", "include", "use", "declare", "defoutput", "defcond", "defgoalr", "defop", "goalem", "goallem",
    "defproperty", "assume", "deftest",
)  # fmt: skip
"""What a form of the top level may begin with."""

MAX_ERRORS = 50


@dataclass(frozen=True, slots=True)
class Symbol:
    name: str
    span: Span


@dataclass(frozen=True, slots=True)
class Keyword:
    """`:name`, without the colon."""

    name: str
    span: Span


@dataclass(frozen=True, slots=True)
class Variable:
    """`?name`, without the question mark."""

    name: str
    span: Span


@dataclass(frozen=True, slots=True)
class Numeral:
    """value in SI; unit: its SI unit, "" for none; text: as it was written."""

    value: float
    unit: str
    text: str
    span: Span


@dataclass(frozen=True, slots=True)
class Text:
    """A string, escapes resolved."""

    value: str
    span: Span


@dataclass(frozen=True, slots=True)
class Broken:
    """Something that has been reported already; `read` never returns one."""

    span: Span


@dataclass(frozen=True, slots=True)
class ListForm:
    items: tuple[Form, ...]
    span: Span


Form = Symbol | Keyword | Variable | Numeral | Text | Broken | ListForm


def source_from_file(path: Path) -> Source:
    """The text of a file, UTF-8, line ends made `\\n`. Raises OSError, and PlanError (`not-text`)."""
    data = path.read_bytes()
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise PlanError([_undecodable(str(path), data, error.start)]) from None
    return Source(str(path), text.replace("\r\n", "\n").replace("\r", "\n"))


def read(source: Source) -> tuple[Form, ...]:
    """The forms of the text in order. Raises PlanError with everything that is wrong with it."""
    forms, errors = read_with_errors(source)
    if errors:
        raise PlanError(capped(errors))
    return forms


def read_with_errors(source: Source) -> tuple[tuple[Form, ...], tuple[Diagnostic, ...]]:
    """The forms of all chunks that could be read, and the errors of the text, for who wants to check on."""
    control = _CONTROL.search(source.text)
    if control:
        return (), (_control_character(source, control.start()),)
    errors: list[Diagnostic] = []
    text = _without_regions(source, errors)
    fold = _Fold(Source(source.name, text), errors)
    with no_collection():
        for token in _tokens(text):
            fold.take(token)
    fold.end_chunk(None)
    errors.sort(key=lambda error: error.span)
    return tuple(fold.top), tuple(errors)


def capped(diagnostics: Iterable[Diagnostic]) -> tuple[Diagnostic, ...]:
    """The first fifty errors and a word on how many more there are; warnings and notes all stay."""
    kept: list[Diagnostic] = []
    beyond: list[Diagnostic] = []
    count = 0
    for diagnostic in diagnostics:
        count += diagnostic.severity == "error"
        (beyond if diagnostic.severity == "error" and count > MAX_ERRORS else kept).append(diagnostic)
    if not beyond:
        return tuple(kept)
    more = "and 1 more error" if len(beyond) == 1 else f"and {len(beyond):,} more errors"
    return (*kept, Diagnostic("too-many-errors", "error", more, beyond[0].span))


# --- text that is no text -------------------------------------------------------------------------

_CONTROL = re.compile("[\x00-\x08\x0b\x0e-\x1f\x7f\ud800-\udfff]")


def _undecodable(name: str, data: bytes, at: int) -> Diagnostic:
    line_start = data.rfind(b"\n", 0, at) + 1
    column = len(data[line_start:at].decode("utf-8-sig", "replace")) + 1
    line = data.count(b"\n", 0, at) + 1
    message = f"this is not a text: the byte 0x{data[at]:02x} is not UTF-8"
    return Diagnostic("not-text", "error", message, Span(name, line, column, line, column + 1))


def _control_character(source: Source, at: int) -> Diagnostic:
    message = f"this is not a text: the character U+{ord(source.text[at]):04X} stands in it"
    return Diagnostic("not-text", "error", message, _span_at(source, at, 1))


def _span_at(source: Source, start: int, length: int) -> Span:
    """The place of `length` characters of one line from the offset `start`."""
    line = source.text.count("\n", 0, start) + 1
    column = start - source.text.rfind("\n", 0, start)
    return Span(source.name, line, column, line, column + length)


# --- comments of a region -------------------------------------------------------------------------

_BEFORE_REGION = re.compile(r'"[^"\\]*(?:\\.[^"\\]*)*(?:"|\\?\Z)|;[^\n]*|#\||[^\s()";]+', re.DOTALL)
_REGION_EDGE = re.compile(r"#\||\|#")
_UNREADABLE = "\x00"
"""Stands where a comment region never ends; no text that gets this far has the character."""


def _without_regions(source: Source, errors: list[Diagnostic]) -> str:
    """The text with every `#| ... |#` blanked, so that all places stay."""
    text = source.text
    if "#|" not in text:
        return text
    pieces: list[str] = []
    done = position = 0
    while match := _BEFORE_REGION.search(text, position):
        position = match.end()
        if match[0] != "#|":
            continue
        pieces.append(text[done : match.start()])
        end = _end_of_region(text, position)
        if end is None:
            message = "this comment is never closed"
            span = _span_at(source, match.start(), 2)
            errors.append(Diagnostic("open-comment", "error", message, span, hint="close it with `|#`; comments nest"))
            return "".join(pieces) + _UNREADABLE
        pieces.append(re.sub(r"[^\n]", " ", text[match.start() : end]))
        done = position = end
    return "".join(pieces) + text[done:]


def _end_of_region(text: str, start: int) -> int | None:
    depth = 1
    for edge in _REGION_EDGE.finditer(text, start):
        depth += 1 if edge[0] == "#|" else -1
        if depth == 0:
            return edge.end()
    return None


# --- words with comments --------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Piece:
    """A word of the text as it stands there, or a comment. newlines: how many stand between it and what is before."""

    kind: Literal["open", "close", "word", "comment", "region"]
    text: str
    newlines: int


def pieces(text: str) -> Iterator[Piece]:
    """The words and comments of a text that `read` takes, in order; white space between them is left out."""
    done = position = 0
    while match := _PIECE.search(text, position):
        end = match.end()
        kind = _KINDS.get(match[0][:2] if match[0].startswith("#|") else match[0][0], "word")
        if kind == "region":
            end = _end_of_region(text, end) or len(text)
        yield Piece(kind, text[match.start() : end], text.count("\n", done, match.start()))
        done = position = end


def words_of(text: str) -> tuple[str, ...]:
    """The words of such a text, without comments."""
    return tuple(piece.text for piece in pieces(text) if piece.kind not in ("comment", "region"))


_PIECE = re.compile(_BEFORE_REGION.pattern + r"|[()]", re.DOTALL)
_KINDS: dict[str, Literal["open", "close", "word", "comment", "region"]] = {
    "(": "open", ")": "close", ";": "comment", "#|": "region",
}  # fmt: skip


# --- words ----------------------------------------------------------------------------------------

_HEAD = re.compile(r'\(([^\s()";]+)')


_MAX_RESUMPTIONS = 10


@cache
def _lexer() -> Lark:
    return Lark.open("plan.lark", rel_to=__file__, parser="lalr", lexer="basic")


def _opens_top_form(text: str, position: int) -> bool:
    """Whether the form here begins like one of the top level, slips of the pen included."""
    head = _HEAD.match(text, position)
    return head is not None and _is_top_name(head[1])


def _is_top_name(name: str) -> bool:
    return name in TOP_FORMS or name.startswith("def") or close(name, TOP_FORMS) is not None


def _tokens(text: str) -> list[Token]:
    """The words of the text. Where a string is never closed, reading goes on at the next form of the top level."""
    words: list[Token] = []
    start = 0
    for _ in range(_MAX_RESUMPTIONS):
        skipped = text.count("\n", 0, start)
        part = [_moved(token, skipped, start) for token in _lexer().lex(text[start:])]
        resumption = _resumption(text, part)
        if resumption is None:
            return words + part
        index, start = resumption
        opening = part[index]
        words += [*part[:index], Token.new_borrow_pos("OPEN_TEXT", opening.value, opening)]
    return words


def _resumption(text: str, words: list[Token]) -> tuple[int, int] | None:
    """Which word is the string that is never closed, and the offset where reading can go on."""
    if not words or words[-1].type != "OPEN_TEXT":
        return None
    for index, word in enumerate(words):
        if word.type in ("TEXT", "OPEN_TEXT") and (start := _top_form_inside(text, word)) is not None:
            return index, start
    return None


def _top_form_inside(text: str, word: Token) -> int | None:
    """The offset of the first form of the top level that a string seems to have swallowed."""
    starts = (edge.start() + 1 for edge in re.finditer(r"\n\(", word))
    inside = ((word.start_pos or 0) + start for start in starts)
    return next((position for position in inside if _opens_top_form(text, position)), None)


def _moved(token: Token, lines: int, characters: int) -> Token:
    if not characters:
        return token
    token.line = (token.line or 0) + lines
    token.end_line = (token.end_line or 0) + lines
    token.start_pos = (token.start_pos or 0) + characters
    return token


# --- lists ----------------------------------------------------------------------------------------


class _Fold:
    """Words into lists. top: the forms so far; all of the current chunk are dropped when it proves spoilt."""

    def __init__(self, source: Source, errors: list[Diagnostic]) -> None:
        self.source = source
        self.errors = errors
        self.top: list[Form] = []
        self.items = self.top
        self.open: list[tuple[Token, list[Form]]] = []
        self.chunk_start = 0
        self.spoilt = False
        self.line = 0
        self.suspect: Token | None = None
        self.atoms: dict[str, Callable[[Token], Form]] = {
            "SYMBOL": self._symbol,
            "NUMBER": self._number,
            "TEXT": self._text,
            "KEYWORD": lambda word: Keyword(word[1:], self.span(word)),
            "VARIABLE": lambda word: Variable(word[1:], self.span(word)),
        }

    def take(self, word: Token) -> None:
        if word.line != self.line:
            self._begin_line(word)
        kind = word.type
        if kind == "OPEN":
            self._push(word)
        elif kind == "CLOSE":
            self._pop(word)
        elif kind == "OPEN_TEXT":
            self._open_text(word)
        elif word == "|#":
            hint = "comments begin with `#|`"
            self.error("unopened-comment", "`|#` ends a comment that never began", self.span(word), hint)
        else:
            self.items.append(self.atoms[kind](word))

    def end_chunk(self, next_form: Token | None) -> None:
        """Settle what is open or spoilt; next_form: where the next chunk begins, None at the end of the text."""
        if self.open and not self.spoilt:
            self._missing(next_form)
        if self.spoilt or self.open:
            del self.top[self.chunk_start :]
        self.open.clear()
        self.items = self.top
        self.chunk_start = len(self.top)
        self.spoilt = False
        self.suspect = None

    def span(self, word: Token) -> Span:
        return Span(self.source.name, word.line or 1, word.column or 1, word.end_line or 1, word.end_column or 1)

    def error(self, code: str, message: str, span: Span, hint: str = "", related: tuple[Related, ...] = ()) -> None:
        self.errors.append(Diagnostic(code, "error", message, span, related, hint))

    def _begin_line(self, word: Token) -> None:
        """Chunks begin here; an open list that the indentation says is over is remembered."""
        self.line = word.line or 0
        opens = word.type == "OPEN"
        if opens and word.column == 1 and (not self.open or _opens_top_form(self.source.text, word.start_pos or 0)):
            self.end_chunk(word)
        elif self.open and not self.suspect and word.type != "CLOSE":
            innermost = self.open[-1][0]
            if (word.column or 0) <= (innermost.column or 0):
                self.suspect = innermost

    def _push(self, word: Token) -> None:
        self.open.append((word, self.items))
        self.items = []
        if len(self.open) > MAX_LEVELS and not self.spoilt:
            self.error("too-deep", f"forms nest more than {MAX_LEVELS:,} deep here", self.span(word))
            self.spoilt = True

    def _pop(self, word: Token) -> None:
        if self.open:
            opener, outer = self.open.pop()
            outer.append(ListForm(tuple(self.items), self.span(opener).to(self.span(word))))
            self.items = outer
        elif not self.spoilt:
            self._extra(word)

    def _extra(self, word: Token) -> None:
        self.spoilt = True
        related: tuple[Related, ...] = ()
        if len(self.top) > self.chunk_start:
            last = self.top[-1].span
            end = Span(last.file, last.end_line, last.end_column - 1, last.end_line, last.end_column)
            related = (Related("the form before it ends here", end),)
        self.error("extra-parenthesis", "this `)` closes nothing", self.span(word), related=related)

    def _missing(self, next_form: Token | None) -> None:
        opener = self.open[0][0]
        head = _HEAD.match(self.source.text, opener.start_pos or 0)
        name = f"`({head[1]}`" if head else "`(`"
        count = len(self.open)
        missing = "a `)` is missing" if count == 1 else f"{count} `)` are missing"
        related: tuple[Related, ...] = ()
        if self.suspect and self.suspect is not opener:
            related += (Related("by the indentation this one is not closed", self.span(self.suspect)),)
        if next_form:
            related += (Related("the next form begins here", self.span(next_form)),)
        self.error("missing-parenthesis", f"{missing}: the form {name} is not closed", self.span(opener), "", related)

    def _open_text(self, word: Token) -> None:
        span = self.span(word)
        self.spoilt = True
        quote = Span(span.file, span.line, span.column, span.line, span.column + 1)
        self.error("open-string", "this string is never closed", quote, 'close it with `"`')

    def _symbol(self, word: Token) -> Form:
        span = self.span(word)
        if word[0] == _UNREADABLE:
            self.spoilt = True
            return Broken(span)
        return Symbol(str(word), span)

    def _number(self, word: Token) -> Form:
        span = self.span(word)
        try:
            value, unit = read_number(word)
        except BadNumberError as error:
            self.error("bad-number", str(error), span, error.hint)
            return Broken(span)
        return Numeral(value, unit, str(word), span)

    def _text(self, word: Token) -> Form:
        body = word[1:-1]
        if "\\" in body:
            body = _ESCAPE.sub(lambda escape: self._escaped(word, escape), body)
        return Text(str(body), self.span(word))

    def _escaped(self, word: Token, escape: re.Match[str]) -> str:
        if escape[1] not in _ESCAPES:
            place = _span_at(self.source, (word.start_pos or 0) + 1 + escape.start(), 2)
            hint = '`\\"`, `\\\\` and `\\n` are known'
            self.error("bad-escape", "an escape that strings do not have", place, hint)
        return _ESCAPES.get(escape[1], escape[0])


_ESCAPE = re.compile(r"\\(.)", re.DOTALL)
_ESCAPES = {'"': '"', "\\": "\\", "n": "\n"}
