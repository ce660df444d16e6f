"""What a plan says before its rules: header, libraries, functions and outputs.

Takes: a `Scope` and a form of the top level. Gives: the declaration. Leaves alone: whether libraries exist.
"""

from __future__ import annotations

from functools import partial

from rplan.lang.diagnostic import Related
from rplan.lang.forms.conditions import parse_expression
from rplan.lang.forms.parts import (
    Option,
    has_parts,
    parse_name,
    parse_new_name,
    parse_option,
    parse_time,
    split_doc,
    split_options,
)
from rplan.lang.forms.scope import Scope
from rplan.lang.forms.words import TYPES
from rplan.lang.plan import Declaration, Header, OutputDeclaration, Setting, Type, Use
from rplan.lang.reader import Form, ListForm, Symbol
from rplan.lang.source import Span
from rplan.lang.suggest import close
from rplan.lang.units import SI_UNITS, UNITS

DEFAULT_PERIOD = 0.1
"""The length of a tick [s] where the plan tells none."""

_TYPES_HINT = "the types: bool, (number UNIT), pose, command, symbol"


def parse_header(scope: Scope, form: ListForm) -> Header:
    rest, options = split_options(scope, form.items[1:], ("period",))
    doc, rest = split_doc(rest, 1)
    name = parse_name(scope, rest[0], "a plan") if has_parts(scope, "plan", form, rest, 1) else ""
    period = parse_option(scope, options, "period", partial(parse_time, owner="`:period` is", example="0.1s"))
    return Header(name, doc, DEFAULT_PERIOD if period is None else period, form.span)


def parse_use(scope: Scope, form: ListForm) -> Use:
    rest, options = split_options(scope, form.items[1:], None)
    library = parse_name(scope, rest[0], "a library") if has_parts(scope, "use", form, rest, 1) else ""
    settings = tuple(
        Setting(name, parse_expression(scope, option.value), option.keyword.span.to(option.value.span))
        for name, option in options.items()
        if option.value
    )
    return Use(library, settings, form.span)


def parse_declaration(scope: Scope, form: ListForm) -> Declaration:
    doc, rest = split_doc(form.items[1:], 2)
    if not has_parts(scope, "declare", form, rest, 2):
        return Declaration("", (), Type("bool"), doc, form.span)
    signature = rest[0].items if isinstance(rest[0], ListForm) else (rest[0],)
    if not signature:
        scope.no_head(rest[0], "a function")
    name = parse_new_name(scope, signature[0], "a function") if signature else ""
    parameters = tuple(_parameter(scope, one) for one in signature[1:])
    scope.distinct("argument", [(one, form.span) for form, (one, _) in zip(signature[1:], parameters, strict=True)])
    return Declaration(name, parameters, _type(scope, rest[1]), doc, form.span)


def _parameter(scope: Scope, form: Form) -> tuple[str, Type]:
    if isinstance(form, ListForm) and len(form.items) == 2:
        return parse_name(scope, form.items[0], "an argument"), _type(scope, form.items[1])
    scope.unexpected(form, "an argument `(NAME TYPE)`", "wrong-parts")
    return "", Type("bool")


def _type(scope: Scope, form: Form) -> Type:
    match form:
        case Symbol(name=name) if name in TYPES:
            return Type(name)
        case Symbol(name=name, span=span):
            _unknown_type(scope, name, span)
        case ListForm(items=(Symbol(name="number"), Symbol(name=unit, span=span))):
            return _number_type(scope, unit, span)
        case _:
            scope.unexpected(form, "a type", "unknown-type", _TYPES_HINT)
    return Type("bool")


def _unknown_type(scope: Scope, name: str, span: Span) -> None:
    if name in UNITS:
        scope.error("unknown-type", f"`{name}` is a unit, not a type", span, f"write `(number {UNITS[name].si})`")
    else:
        meant = close(name, TYPES, shortest=3)
        hint = f"did you mean `{meant}`? {_TYPES_HINT}" if meant else _TYPES_HINT
        scope.error("unknown-type", f"`{name}` is not a type", span, hint)


def _number_type(scope: Scope, unit: str, span: Span) -> Type:
    if unit in SI_UNITS:
        return Type("number", unit)
    hint = f"the units of types: {' '.join(SI_UNITS)}"
    if unit in UNITS:
        hint = f"numbers are kept in SI: write `(number {UNITS[unit].si})`"
    scope.error("unknown-unit", f"`{unit}` is not a unit of a type", span, hint)
    return Type("number")


def parse_output(scope: Scope, form: ListForm) -> OutputDeclaration:
    rest, options = split_options(
        scope, form.items[1:], ("idle", "hold", "initial", "required"), flags=("hold", "required")
    )
    name, kind = "", Type("bool")
    if has_parts(scope, "defoutput", form, rest, 2):
        name, kind = parse_new_name(scope, rest[0], "an output"), _type(scope, rest[1])
    hold, idle, initial = options.get("hold"), options.get("idle"), options.get("initial")
    _outdone(scope, options.get("required"), idle or hold)
    if hold and idle:
        message = "`:idle` and `:hold` exclude each other"
        related = (Related("`:hold` is here", hold.keyword.span),)
        scope.error("bad-option", message, idle.keyword.span, "for a first value of `:hold` write `:initial`", related)
    if initial and not hold and not idle:
        scope.error("bad-option", "`:initial` goes with `:hold`", initial.keyword.span)
    elif initial and not hold:
        scope.error("bad-option", "`:initial` goes with `:hold`, not with `:idle`", initial.keyword.span)
    required = "required" in options
    idle_value = parse_option(scope, options, "idle", parse_expression)
    initial_value = parse_option(scope, options, "initial", parse_expression)
    return OutputDeclaration(name, kind, idle_value, hold is not None, initial_value, form.span, required)


def _outdone(scope: Scope, required: Option | None, other: Option | None) -> None:
    if required and other:
        word = f"`:{other.keyword.name}`"
        message = f"`:required` lets no tick leave it open, so that {word} says nothing"
        related = (Related(f"{word} is here", other.keyword.span),)
        scope.error("bad-option", message, required.keyword.span, "leave one of them out", related)
