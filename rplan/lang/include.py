"""Texts that include one another, as one sequence of forms.

Takes: a source, and how further files are opened. Gives: all forms in the order in which they count, the sources that
they come from, and every error. Leaves alone: what the forms say, but for `(include "FILE")`.

The forms of an included file stand where the `include` stands. A file that is included again is read once. Only its
definitions count: its header, its top goal and its tests are its own.
"""

from __future__ import annotations

import posixpath
from collections.abc import Callable
from dataclasses import dataclass, field

from rplan.lang.diagnostic import Diagnostic, PlanError, Related
from rplan.lang.reader import Form, ListForm, Symbol, Text, read_with_errors
from rplan.lang.source import Source, Span

OpenFile = Callable[[str], Source]
"""The source of a path; raises OSError, and PlanError where the file is no text."""

ITS_OWN = ("plan", "goalem", "goallem", "deftest")
"""Forms of a file that do not count where another file includes it."""

DEEPEST = 100


def no_files(path: str) -> Source:
    """For texts that come from no folder."""
    raise FileNotFoundError(2, "no such file", path)


@dataclass(slots=True)
class Gathered:
    """sources: the first is the one that was asked for, the others in the order in which they were opened."""

    forms: list[Form] = field(default_factory=list)
    sources: list[Source] = field(default_factory=list)
    errors: list[Diagnostic] = field(default_factory=list)


def gather(source: Source, open_file: OpenFile = no_files) -> Gathered:
    """The forms of a source with those of all files that it includes."""
    gatherer = _Gatherer(open_file)
    gatherer.take(source, [])
    return gatherer.gathered


@dataclass(slots=True)
class _Gatherer:
    """path: the includes that led here, each with the file that it names."""

    open_file: OpenFile
    gathered: Gathered = field(default_factory=Gathered)

    def take(self, source: Source, path: list[tuple[str, Span]]) -> None:
        self.gathered.sources.append(source)
        forms, errors = read_with_errors(source)
        self.gathered.errors += errors
        for form in forms:
            match form:
                case ListForm(items=(Symbol(name="include"), *rest)):
                    self._include(form, rest, source, path)
                case ListForm(items=(Symbol(name=head), *_)) if path and head in ITS_OWN:
                    pass
                case _:
                    self.gathered.forms.append(form)

    def _include(self, form: ListForm, rest: list[Form], source: Source, path: list[tuple[str, Span]]) -> None:
        match rest:
            case (Text(value=value),) if value:
                name = posixpath.normpath(posixpath.join(posixpath.dirname(source.name.replace("\\", "/")), value))
            case _:
                hint = 'write `(include "file.rplan")`'
                self._error("wrong-parts", "`include` takes the name of a file as a text", form.span, hint)
                return
        files = [posixpath.normpath(self.gathered.sources[0].name), *(file for file, _ in path)]
        if name in files:
            self._circle(files[files.index(name) :], name, form.span, path)
        elif name not in (posixpath.normpath(one.name) for one in self.gathered.sources):
            self._open(name, value, form.span, path)

    def _open(self, name: str, said: str, span: Span, path: list[tuple[str, Span]]) -> None:
        if len(path) >= DEEPEST:
            self._error("too-deep", f"files include one another deeper than {DEEPEST}", span)
            return
        try:
            source = self.open_file(name)
        except PlanError as error:
            self.gathered.errors += error.diagnostics
        except OSError as error:
            reason = error.strerror or str(error)
            message = f'`"{said}"` cannot be read: {reason[:1].lower()}{reason[1:]}'
            self._error("missing-file", message, span, "the name is relative to the file that includes it")
        else:
            self.take(source, [*path, (name, span)])

    def _circle(self, files: list[str], name: str, span: Span, path: list[tuple[str, Span]]) -> None:
        steps = [Related(f"which includes `{_short(file)}`", place) for file, place in path if file in files]
        way = " → ".join(map(_short, [*files, name]))
        message = f"`{_short(name)}` includes itself: {way}"
        self.gathered.errors.append(Diagnostic("include-circle", "error", message, span, tuple(steps)))

    def _error(self, code: str, message: str, span: Span, hint: str = "") -> None:
        self.gathered.errors.append(Diagnostic(code, "error", message, span, (), hint))


def _short(file: str) -> str:
    return posixpath.basename(file)
