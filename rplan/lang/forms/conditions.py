"""Conditions, values and the arguments of calls.

Takes: a `Scope` and a form. Gives: what it says, or a placeholder where it is wrong. Leaves alone: whether names exist
and types fit.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from rplan.lang.forms.parts import has_parts, parse_option, parse_time, parse_truth, parse_whole, split_options
from rplan.lang.forms.scope import Scope, head_of
from rplan.lang.forms.words import COMPARATORS, CONDITION_FORMS, MEMORY_FORMS, OPERATORS, RESERVED, TRUTHS, what_is
from rplan.lang.plan import (
    AllOf,
    AnyOf,
    Argument,
    Arithmetic,
    Call,
    Comparator,
    Compare,
    Condition,
    Expression,
    Memory,
    Not,
    Number,
    OutputIs,
    Past,
    Quantity,
    Truth,
)
from rplan.lang.reader import Form, ListForm, Numeral, Symbol, Variable


def parse_condition(scope: Scope, form: Form) -> Condition:
    match form:
        case Symbol(name="true" | "false" as name):
            return Truth(name == "true", form.span)
        case Variable():
            return scope.parameter(form)
        case Symbol(name=name) | ListForm(items=(Symbol(name=name), *_)):
            pass
        case ListForm():
            scope.no_head(form, "a condition")
            return Truth(False, form.span)
        case _:
            scope.unexpected(form, "a condition", "not-a-condition")
            return Truth(False, form.span)
    if scope.of_outputs and isinstance(form, ListForm) and (asked := _of_output(scope, form)):
        return asked
    if isinstance(form, ListForm) and name in CONDITION_FORMS:
        return _compound(scope, form, name)
    called = _call(scope, form, name, "condition")
    return called if called else Truth(False, form.span)


def _of_output(scope: Scope, form: ListForm) -> Condition | None:
    """`(= OUTPUT VALUE)`, `(/= OUTPUT VALUE)` or `(open OUTPUT)`, by the look of it."""
    match form.items:
        case (Symbol(name="open"), Symbol(name=output)):
            return OutputIs(output, None, form.span)
        case (Symbol(name="=" | "/=" as comparator), Symbol(name=output), value) if output not in RESERVED:
            if isinstance(value, ListForm) and head_of(value) in OPERATORS:
                return None
            asked = OutputIs(output, parse_expression(scope, value), form.span)
            return asked if comparator == "=" else Not(asked, form.span)
        case _:
            return None


def _compound(scope: Scope, form: ListForm, head: str) -> Condition:
    rest = form.items[1:]
    for comparator in COMPARATORS:
        if head == comparator:
            return _compare(scope, form, comparator)
    for form_of_memory in MEMORY_FORMS:
        if head == form_of_memory:
            return _memory(scope, form, form_of_memory)
    if head == "not":
        counted = has_parts(scope, "not", form, rest, 1)
        return Not(parse_condition(scope, rest[0]), form.span) if counted else Truth(False, form.span)
    if not rest:
        scope.error("wrong-parts", f"`{head}` joins one or more conditions; here are none", form.span)
    conditions = tuple(parse_condition(scope, one) for one in rest)
    return AllOf(conditions, form.span) if head == "and" else AnyOf(conditions, form.span)


def _memory(scope: Scope, form: ListForm, head: Past) -> Condition:
    rest, options = split_options(scope, form.items[1:], ("reset",) if head == "at-least" else ())
    wanted = 1 if head in ("once", "historically", "rose", "fell") else 2
    if not has_parts(scope, head, form, rest, wanted):
        return Truth(False, form.span)
    match head:
        case "delay":
            return Memory(head, (parse_condition(scope, rest[1]),), form.span, initial=parse_truth(scope, rest[0]))
        case "held-for" | "within":
            return Memory(head, (parse_condition(scope, rest[1]),), form.span, duration=_duration(scope, rest[0], head))
        case "at-least":
            counted = parse_condition(scope, rest[1])
            reset = parse_option(scope, options, "reset", parse_condition)
            conditions = (counted, reset) if reset else (counted,)
            return Memory(head, conditions, form.span, count=parse_whole(scope, rest[0], "`at-least` counts ticks"))
        case _:
            return Memory(head, tuple(parse_condition(scope, one) for one in rest), form.span)


def _duration(scope: Scope, form: Form, head: str) -> Number:
    seconds = parse_time(scope, form, f"`{head}` wants", "2s")
    return Number(1.0 if seconds is None else seconds, "s", form.span)


def _compare(scope: Scope, form: ListForm, comparator: Comparator) -> Condition:
    rest = form.items[1:]
    if len(rest) != 2:
        scope.wrong_parts(f"`{comparator}` compares two numbers", form, rest)
        return Truth(False, form.span)
    return Compare(comparator, _operand(scope, rest[0]), _operand(scope, rest[1]), form.span)


def _operand(scope: Scope, form: Form) -> Quantity:
    match form:
        case ListForm(items=(Symbol(name=name), *rest)) if name in OPERATORS:
            return _arithmetic(scope, form, name, rest)
        case Symbol(name="true" | "false"):
            hint = "a condition is itself true or false; `(not C)` turns it round"
            scope.unexpected(form, "a number", "not-a-number", hint)
        case Numeral() | Symbol() | ListForm() | Variable():
            value = parse_expression(scope, form)
            if not isinstance(value, Truth):
                return value
        case _:
            scope.unexpected(form, "a number", "not-a-number")
    return Number(0.0, "", form.span)


def _arithmetic(scope: Scope, form: ListForm, name: str, rest: Sequence[Form]) -> Quantity:
    operator = next(one for one in OPERATORS if one == name)
    if operator == "abs" and len(rest) != 1:
        scope.wrong_parts("`abs` takes one number", form, rest)
    elif operator == "/" and len(rest) != 2:
        scope.wrong_parts("`/` takes a number and a divisor", form, rest)
    elif not rest:
        scope.wrong_parts(f"`{operator}` takes one or more numbers", form, rest)
    else:
        return Arithmetic(operator, tuple(_operand(scope, one) for one in rest), form.span)
    return Number(0.0, "", form.span)


def parse_argument(scope: Scope, form: Form) -> Argument:
    """What is put in the place of a variable: a value, a condition, or a number that is worked out."""
    match form:
        case ListForm(items=(Symbol(name=name), *rest)) if name in OPERATORS:
            return _arithmetic(scope, form, name, rest)
        case ListForm(items=(Symbol(name=name), *_)) if name in CONDITION_FORMS:
            return parse_condition(scope, form)
        case Symbol(name=name) | ListForm(items=(Symbol(name=name), *_)) if name not in RESERVED:
            return _called(scope, form, name, parse_argument)
        case _:
            return parse_expression(scope, form)


def parse_expression(scope: Scope, form: Form) -> Expression:
    match form:
        case Variable():
            return scope.parameter(form)
        case Numeral(value=value, unit=unit):
            return Number(value, unit, form.span)
        case Symbol(name="true" | "false" as name):
            return Truth(name == "true", form.span)
        case Symbol(name=name) | ListForm(items=(Symbol(name=name), *_)):
            called = _call(scope, form, name, "value")
            return called if called else Truth(False, form.span)
        case ListForm():
            scope.no_head(form, "a value")
        case _:
            scope.unexpected(form, "a value", "not-a-value")
    return Truth(False, form.span)


def parse_fact(scope: Scope, form: Form) -> Call | None:
    match form:
        case Symbol(name=name) | ListForm(items=(Symbol(name=name), *_)):
            return _call(scope, form, name, "fact")
        case _:
            scope.unexpected(form, "a fact", "not-a-condition")
            return None


def _call(scope: Scope, form: Form, name: str, wanted: str) -> Call | None:
    """A call of `name`, None where the name is a word of the language."""
    if name not in RESERVED:
        return _called(scope, form, name, parse_argument if wanted == "condition" else parse_expression)
    if name in OPERATORS:
        hint = "compare numbers with `<`, `<=`, `>`, `>=`, `=` or `/=`"
        scope.error("misplaced-form", f"`{name}` makes a number; here a {wanted} is expected", form.span, hint)
    elif name in TRUTHS:
        scope.error("misplaced-form", f"`{name}` takes no parentheses", form.span, f"write `{name}`")
    else:
        what = what_is(name)
        scope.error("misplaced-form", f"`{name}` is {what}; here a {wanted} is expected", form.span)
    return None


def _called(scope: Scope, form: Form, name: str, parse_one: Callable[[Scope, Form], Argument]) -> Call:
    parts = form.items[1:] if isinstance(form, ListForm) else ()
    return Call(name, tuple(parse_one(scope, part) for part in parts), form.span)
