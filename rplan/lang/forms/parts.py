"""What forms are made of: options, texts, names, whole numbers and times.

Takes: a `Scope` and the items of a form. Gives: them sorted, counted and read. Leaves alone: conditions, values and
goals.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar

from rplan.lang.diagnostic import Diagnostic
from rplan.lang.forms.scope import Scope, first_is_here
from rplan.lang.forms.words import HINTS, RESERVED, TAKES
from rplan.lang.reader import Form, Keyword, ListForm, Numeral, Symbol, Text
from rplan.lang.suggest import close
from rplan.lang.units import dimension

Parsed = TypeVar("Parsed")
ParseOne = Callable[[Scope, Form], Parsed]


@dataclass(frozen=True, slots=True)
class Option:
    """`:name value`; value is None for a keyword that takes none."""

    keyword: Keyword
    value: Form | None


def split_options(
    scope: Scope, items: Sequence[Form], known: tuple[str, ...] | None, flags: tuple[str, ...] = ()
) -> tuple[tuple[Form, ...], dict[str, Option]]:
    """Plain parts and options; known: the keywords that may be (None: any), flags: those without a value."""
    plain: list[Form] = []
    options: dict[str, Option] = {}
    position = 0
    while position < len(items):
        item = items[position]
        position += 1
        if not isinstance(item, Keyword):
            plain.append(item)
            continue
        follows = items[position] if position < len(items) else None
        value = None if item.name in flags or isinstance(follows, Keyword) else follows
        position += value is not None
        _add_option(scope, Option(item, value), options, known, flags)
    return tuple(plain), options


def _add_option(
    scope: Scope, option: Option, options: dict[str, Option], known: tuple[str, ...] | None, flags: tuple[str, ...]
) -> None:
    keyword = option.keyword
    if known is not None and keyword.name not in known:
        meant = close(keyword.name, known, shortest=3)
        hint = f"did you mean `:{meant}`? " if meant else ""
        hint += "known here: " + " ".join(f"`:{name}`" for name in known)
        scope.error("unknown-keyword", f"`:{keyword.name}` is not known here", keyword.span, hint)
    elif keyword.name in options:
        first = options[keyword.name].keyword.span
        scope.error("duplicate", f"`:{keyword.name}` is there twice", keyword.span, "", first_is_here(first))
    else:
        if option.value is None and keyword.name not in flags:
            scope.error("wrong-parts", f"`:{keyword.name}` takes a value; here is none", keyword.span)
        options[keyword.name] = option


def split_doc(items: Sequence[Form], at: int) -> tuple[str, tuple[Form, ...]]:
    """The text that stands after `at` parts, if any, and the rest."""
    if len(items) > at and isinstance(doc := items[at], Text):
        return doc.value, (*items[:at], *items[at + 1 :])
    return "", tuple(items)


def has_parts(scope: Scope, head: str, form: ListForm, rest: Sequence[Form], least: int, *, more: bool = False) -> bool:
    """Whether there are as many parts as there must be. more: there may be more than the least."""
    if len(rest) == least or (more and len(rest) > least):
        return True
    scope.wrong_parts(f"`{head}` takes {TAKES[head]}", form, rest, HINTS.get((head, len(rest)), ""))
    return False


def parse_name(scope: Scope, form: Form, owner: str) -> str:
    if isinstance(form, Symbol):
        return form.name
    scope.unexpected(form, f"the name of {owner}", "not-a-name")
    return ""


def parse_new_name(scope: Scope, form: Form, owner: str) -> str:
    name = parse_name(scope, form, owner)
    if name in RESERVED:
        scope.error("reserved-name", f"`{name}` is a word of the language and cannot name {owner}", form.span)
        return ""
    return name


def parse_option(scope: Scope, options: Mapping[str, Option], name: str, parse_one: ParseOne[Parsed]) -> Parsed | None:
    """The value of an option, None where there is none."""
    option = options.get(name)
    return parse_one(scope, option.value) if option and option.value else None


def parse_whole(scope: Scope, form: Form, counts: str) -> int:
    if isinstance(form, Numeral) and not form.unit and form.value >= 1 and form.value == int(form.value):
        return int(form.value)
    if isinstance(form, Numeral):
        scope.error("bad-value", f"{counts}: a whole number from 1 up, not `{form.text}`", form.span)
    else:
        scope.unexpected(form, "a whole number from 1 up", "bad-value")
    return 1


def parse_time(scope: Scope, form: Form, owner: str, example: str) -> float | None:
    """A time longer than nothing [s]; a bare number is seconds, with a warning. owner: what says it, with its verb."""
    if not isinstance(form, Numeral):
        scope.unexpected(form, f"a time such as `{example}`", "bad-value")
    elif form.unit not in ("s", ""):
        message = f"{owner} a time, `{form.text}` is a {dimension(form.unit)}"
        scope.error("unit-mismatch", message, form.span, "times have the units `s`, `ms` or `min`")
    elif form.value <= 0:
        scope.error("bad-value", f"{owner} a time longer than nothing", form.span)
    else:
        if not form.unit:
            message = f"`{form.text}` has no unit; it is taken as seconds"
            scope.found.append(Diagnostic("bare-number", "warning", message, form.span, hint=f"write `{form.text}s`"))
        return form.value
    return None


def parse_truth(scope: Scope, form: Form) -> bool:
    match form:
        case Symbol(name="true" | "false" as name):
            return name == "true"
        case _:
            scope.unexpected(form, "`true` or `false`", "bad-value")
    return False
