"""The text of Stage world files: entities with properties, read through includes and defines.

Takes: a `.world` file. Gives: the entities of the world with what their defines say already in them, and what could
not be included. Leaves alone: what entities mean (`stage.py`).

    include "file"    define NAME BASE ( … )    TYPE ( property value   property [a b c]   TYPE ( … ) )
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from sim.scenarios.importers.imported import WorldFileError
from sim.scenarios.importers.sources import read_text

MOST_BYTES = 2**23
MOST_TOKENS, MOST_DEPTH, MOST_INCLUDES = 1_000_000, 40, 64
TOKEN = re.compile(r'#[^\n]*|"[^"\n]*"|[A-Za-z_]\w*\[\d+\]|[()\[\]]|[^\s()\[\]"#]+|\n|"')

Value = str | tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Token:
    """A word of the text; quoted: it stood in quotation marks."""

    text: str
    file: str
    line: int
    quoted: bool = False


@dataclass(frozen=True, slots=True)
class Entity:
    """A model or part of one. kinds: its type and what that is defined from, the last one being Stage's own."""

    kinds: tuple[str, ...]
    file: str
    line: int
    properties: Mapping[str, Value]
    parts: tuple[Entity, ...]

    @property
    def kind(self) -> str:
        """The type in which all its defines end."""
        return self.kinds[-1]

    def fault(self, message: str) -> WorldFileError:
        """An error at this entity."""
        return WorldFileError(self.file, self.line, message)


@dataclass(slots=True)
class World:
    """What a file says: properties of the world itself, its entities, and files that are missing."""

    properties: dict[str, Value] = field(default_factory=dict)
    entities: list[Entity] = field(default_factory=list)
    missing: list[str] = field(default_factory=list)
    folder: Path = Path()


def read(path: Path) -> World:
    """The world in a file and the files that it includes. Raises WorldFileError."""
    return _Reader(path).world


class _Reader:
    """Reads one world file; the tokens of includes are read in their place."""

    def __init__(self, path: Path) -> None:
        self.world = World(folder=path.parent)
        self._defines: dict[str, Entity] = {}
        self._count = self._includes = 0
        self._file(path, ())

    def _file(self, path: Path, within: tuple[Path, ...]) -> None:
        self._includes += 1
        if path.resolve() in within or self._includes > MOST_INCLUDES:
            raise WorldFileError(path.name, 1, "the file includes itself, or includes go too far")
        tokens = self._tokens(path)
        while (token := next(tokens, None)) is not None:
            self._statement(token, tokens, path, (*within, path.resolve()))

    def _tokens(self, path: Path) -> Iterator[Token]:
        line = 1
        for match in TOKEN.finditer(read_text(path, MOST_BYTES)):
            text = match[0]
            if text == "\n":
                line += 1
            elif text == '"':
                raise WorldFileError(path.name, line, "a quotation mark that is never closed")
            elif not text.startswith("#"):
                self._count += 1
                if self._count > MOST_TOKENS:
                    raise WorldFileError(path.name, line, f"the world has more than {MOST_TOKENS:,} words")
                quoted = text.startswith('"')
                yield Token(text.strip('"') if quoted else text, path.name, line, quoted)

    def _statement(self, token: Token, tokens: Iterator[Token], path: Path, within: tuple[Path, ...]) -> None:
        if token.text == "include" and not token.quoted:
            self._include(_word(tokens, token), path, within)
        elif token.text == "define" and not token.quoted:
            name, base = _word(tokens, token), _word(tokens, token)
            self._expect("(", tokens, base)
            self._defines[name.text] = self._entity(base, tokens, 1, name.text)
        else:
            self._member(token, tokens, 0, self.world.properties, self.world.entities)

    def _include(self, name: Token, path: Path, within: tuple[Path, ...]) -> None:
        included = path.parent / name.text
        if "\0" in name.text or not _is_file(included):
            self.world.missing.append(f"{name.text}, included in {name.file}:{name.line}: there is no such file")
        else:
            self._file(included, within)

    def _member(
        self,
        token: Token,
        tokens: Iterator[Token],
        depth: int,
        properties: dict[str, Value],
        parts: list[Entity],
    ) -> None:
        """A property, or an entity, that begins with this token."""
        if token.quoted or token.text in "()[]":
            raise WorldFileError(token.file, token.line, f"expected a name, got {token.text[:40]!r}")
        value = _next(tokens, token)
        if value.text == "(" and not value.quoted:
            parts.append(self._entity(token, tokens, depth + 1))
        elif value.text == "[" and not value.quoted:
            properties[token.text] = _tuple(tokens, value)
        elif value.text in ")]" and not value.quoted:
            raise WorldFileError(value.file, value.line, f"{token.text[:40]} has no value")
        else:
            properties[token.text] = value.text

    def _entity(self, kind: Token, tokens: Iterator[Token], depth: int, name: str = "") -> Entity:
        """The entity whose opening parenthesis has just been read, on top of what its type defines."""
        if depth > MOST_DEPTH:
            raise WorldFileError(kind.file, kind.line, f"blocks are nested more than {MOST_DEPTH} deep")
        base = self._defines.get(kind.text)
        kinds = base.kinds if base else (kind.text,)
        if len(kinds) > MOST_DEPTH:
            raise WorldFileError(kind.file, kind.line, f"more than {MOST_DEPTH} defines on top of one another")
        properties = dict(base.properties) if base else {}
        parts = list(base.parts) if base else []
        while (token := _next(tokens, kind)).text != ")" or token.quoted:
            self._member(token, tokens, depth, properties, parts)
        return Entity((name, *kinds) if name else kinds, kind.file, kind.line, properties, tuple(parts))

    def _expect(self, sign: str, tokens: Iterator[Token], before: Token) -> None:
        if (token := _next(tokens, before)).text != sign:
            raise WorldFileError(token.file, token.line, f"expected {sign!r}, got {token.text[:40]!r}")


def _is_file(path: Path) -> bool:
    try:
        return path.is_file()
    except OSError:
        return False


def _next(tokens: Iterator[Token], before: Token) -> Token:
    token = next(tokens, None)
    if token is None:
        raise WorldFileError(before.file, before.line, f"the file ends within {before.text[:40]!r}")
    return token


def _word(tokens: Iterator[Token], before: Token) -> Token:
    token = _next(tokens, before)
    if token.text in ("(", ")", "[", "]", ""):
        raise WorldFileError(token.file, token.line, f"expected a name after {before.text!r}, got {token.text!r}")
    return token


def _tuple(tokens: Iterator[Token], opening: Token) -> tuple[str, ...]:
    values: list[str] = []
    while (token := _next(tokens, opening)).text != "]":
        if token.text in ("(", ")", "["):
            raise WorldFileError(token.file, token.line, f"expected a number or ']', got {token.text!r}")
        values.append(token.text)
    return tuple(values)
