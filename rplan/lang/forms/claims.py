"""What a plan says of itself: properties, assumptions and tests.

Takes: a `Scope` and a form of the top level. Gives: the claim. Leaves alone: whether it is so.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from rplan.lang.forms.conditions import parse_condition, parse_expression, parse_fact
from rplan.lang.forms.parts import (
    Parsed,
    has_parts,
    parse_name,
    parse_option,
    parse_truth,
    parse_whole,
    split_doc,
    split_options,
)
from rplan.lang.forms.scope import Scope
from rplan.lang.plan import Assumption, Condition, Expected, Given, Number, PlanTest, Property, Step, Truth
from rplan.lang.reader import Form, ListForm, Numeral, Symbol


def parse_property(scope: Scope, form: ListForm) -> Property:
    rest, options = split_options(scope, form.items[1:], ("always", "provided"))
    doc, rest = split_doc(rest, 1)
    name = parse_name(scope, rest[0], "a property") if has_parts(scope, "defproperty", form, rest, 1) else ""
    if "always" not in options:
        scope.error("wrong-parts", "a property says what must hold: `:always CONDITION`", form.span)
    always = parse_option(scope, options, "always", _claim)
    provided = parse_option(scope, options, "provided", _claim)
    return Property(name, doc, always or Truth(True, form.span), provided, form.span)


def parse_assumption(scope: Scope, form: ListForm) -> Assumption:
    rest = form.items[1:]
    condition = _claim(scope, rest[0]) if has_parts(scope, "assume", form, rest, 1) else Truth(True, form.span)
    return Assumption(condition, form.span)


def _claim(scope: Scope, form: Form) -> Condition:
    """A condition that may ask outputs."""
    return parse_condition(scope.asking_outputs(), form)


def parse_test(scope: Scope, form: ListForm) -> PlanTest:
    doc, rest = split_doc(form.items[1:], 1)
    name = parse_name(scope, rest[0], "a test") if has_parts(scope, "deftest", form, rest, 2, more=True) else ""
    return PlanTest(name, doc, tuple(step for one in rest[1:] if (step := _step(scope, one))), form.span)


def _step(scope: Scope, form: Form) -> Step | None:
    match form:
        case ListForm(items=(Symbol(name="tick"), *items)):
            rest, options = split_options(scope, items, ("times", "given", "expect", "hole"))
            has_parts(scope, "tick", form, rest, 0)
        case _:
            scope.unexpected(form, "a step `(tick ...)`", "wrong-parts")
            return None
    times = parse_option(scope, options, "times", partial(parse_whole, counts="`:times` counts ticks"))
    given = parse_option(scope, options, "given", partial(_pairs, parse_one=_given)) or ()
    expected = parse_option(scope, options, "expect", partial(_pairs, parse_one=_expected)) or ()
    hole = parse_option(scope, options, "hole", parse_truth)
    return Step(times or 1, given, expected, bool(hole), form.span)


def _pairs(scope: Scope, form: Form, parse_one: Callable[[Scope, ListForm], Parsed | None]) -> tuple[Parsed, ...]:
    if not isinstance(form, ListForm):
        scope.unexpected(form, "a list of pairs", "wrong-parts")
        return ()
    found: list[Parsed] = []
    for one in form.items:
        if not isinstance(one, ListForm) or len(one.items) != 2:
            scope.unexpected(one, "a pair of a name and a value", "wrong-parts")
        elif (parsed := parse_one(scope, one)) is not None:
            found.append(parsed)
    return tuple(found)


def _given(scope: Scope, form: ListForm) -> Given | None:
    percept, value = form.items
    called = parse_fact(scope, percept)
    match value:
        case Symbol(name="true" | "false" as truth):
            given: Number | Truth = Truth(truth == "true", value.span)
        case Numeral(value=number, unit=unit):
            given = Number(number, unit, value.span)
        case _:
            scope.unexpected(value, "`true`, `false` or a number", "bad-value")
            return None
    return Given(called, given, form.span) if called else None


def _expected(scope: Scope, form: ListForm) -> Expected:
    output, value = form.items
    match value:
        case Symbol(name="open"):
            return Expected(parse_name(scope, output, "an output"), None, form.span)
        case _:
            return Expected(parse_name(scope, output, "an output"), parse_expression(scope, value), form.span)
