"""Goals.

Takes: a `Scope` and a form. Gives: the goal, or a placeholder where it is wrong. Leaves alone: whether there are rules
for it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Literal

from rplan.lang.depth import MAX_LEVELS
from rplan.lang.forms.conditions import parse_argument, parse_condition, parse_expression
from rplan.lang.forms.parts import has_parts, parse_name, parse_option, parse_whole, split_options
from rplan.lang.forms.scope import Scope, head_of
from rplan.lang.forms.words import CONDITION_FORMS, GOAL_FORMS, RESERVED, what_is
from rplan.lang.plan import Achieve, And, Anything, Condition, Do, Goal, If, Or, PrioAnd, Subgoal, Truth
from rplan.lang.reader import TOP_FORMS, Form, ListForm, Symbol
from rplan.lang.source import Span

Kind = Literal["ach", "maint"]


@dataclass(frozen=True, slots=True)
class _Branch:
    """A clause of `cond`; condition is None for `else`."""

    condition: Condition | None
    goal: Goal


def parse_goal(scope: Scope, form: Form, level: int) -> Goal:
    if level > MAX_LEVELS:
        scope.error("too-deep", f"goals nest more than {MAX_LEVELS:,} deep here", form.span)
        return Anything(form.span)
    if not isinstance(form, ListForm):
        return _no_goal(scope, form)
    match head_of(form):
        case "do":
            return _do(scope, form)
        case "if":
            return _if(scope, form, level)
        case "when":
            return _when(scope, form, level)
        case "cond":
            return _cond(scope, form, level)
        case "and" | "or" | "prio-and" as joint:
            return _joint(scope, form, joint, level)
        case "ach":
            return _subgoal(scope, form, "ach")
        case "maint":
            return _subgoal(scope, form, "maint")
        case None:
            scope.no_head(form, "a goal", GOAL_FORMS)
        case str() as head:
            _unknown_goal(scope, head, form)
    return Anything(form.span)


def _no_goal(scope: Scope, form: Form) -> Goal:
    match form:
        case Symbol(name="anything"):
            hint = "write `(do anything)`"
        case Symbol(name=name):
            hint = f"write `(ach {name})`, `(maint {name})` or `(do OUTPUT {name})`"
        case _:
            hint = ""
    scope.unexpected(form, "a goal", "not-a-goal", hint)
    return Anything(form.span)


def _unknown_goal(scope: Scope, head: str, form: ListForm) -> None:
    if head in TOP_FORMS:
        message = f"`({head} ...)` stands inside of a goal; it belongs to the top level"
        scope.error("misplaced-form", message, form.span)
    elif head in CONDITION_FORMS:
        message = f"`({head} ...)` is a condition; here a goal is expected"
        scope.error("misplaced-form", message, form.span, "conditions are asked with `if`, `when` and `cond`")
    else:
        scope.unknown(head, form, "goal", GOAL_FORMS)


def _do(scope: Scope, form: ListForm) -> Goal:
    match form.items[1:]:
        case (Symbol(name="anything"),):
            return Anything(form.span)
        case (Symbol(name="anything"), *_):
            scope.error("wrong-parts", "`(do anything)` takes no value", form.span)
        case (output, value):
            return Do(parse_name(scope, output, "an output"), parse_expression(scope, value), form.span)
        case rest:
            has_parts(scope, "do", form, rest, 2)
    return Anything(form.span)


def _if(scope: Scope, form: ListForm, level: int) -> Goal:
    rest = form.items[1:]
    if not has_parts(scope, "if", form, rest, 3):
        return _when_like(scope, rest, form.span, level)
    condition = parse_condition(scope, rest[0])
    return If(condition, parse_goal(scope, rest[1], level + 1), parse_goal(scope, rest[2], level + 1), form.span)


def _when(scope: Scope, form: ListForm, level: int) -> Goal:
    rest = form.items[1:]
    has_parts(scope, "when", form, rest, 2)
    return _when_like(scope, rest, form.span, level)


def _when_like(scope: Scope, rest: Sequence[Form], span: Span, level: int) -> Goal:
    """A condition and a goal, as far as they are there."""
    if len(rest) < 2:
        return Anything(span)
    return If(parse_condition(scope, rest[0]), parse_goal(scope, rest[1], level + 1), Anything(span), span)


def _cond(scope: Scope, form: ListForm, level: int) -> Goal:
    """Nested ifs, each with the place of its clause."""
    clauses = form.items[1:]
    if not has_parts(scope, "cond", form, clauses, 1, more=True):
        return Anything(form.span)
    if level + len(clauses) > MAX_LEVELS:
        message = f"with the branches of this `cond`, goals nest more than {MAX_LEVELS:,} deep"
        scope.error("too-deep", message, form.span)
        return Anything(form.span)
    branches = [_clause(scope, clause, level + i) for i, clause in enumerate(clauses)]
    goal: Goal = Anything(form.span)
    for i, branch in reversed(list(enumerate(branches))):
        if branch.condition is not None:
            goal = If(branch.condition, branch.goal, goal, clauses[i].span)
        elif i == len(branches) - 1:
            goal = branch.goal
        else:
            scope.error("misplaced-else", "`else` is not the last clause of its `cond`", clauses[i].span)
    return goal


def _clause(scope: Scope, form: Form, level: int) -> _Branch:
    match form:
        case ListForm(items=(Symbol(name="else"), body)):
            return _Branch(None, parse_goal(scope, body, level))
        case ListForm(items=(condition, body)):
            return _Branch(parse_condition(scope, condition), parse_goal(scope, body, level + 1))
        case ListForm(items=items):
            scope.wrong_parts("a clause of `cond` takes a condition and a goal", form, items)
        case _:
            scope.unexpected(form, "a clause `(CONDITION GOAL)`", "wrong-parts")
    return _Branch(Truth(False, form.span), Anything(form.span))


def _joint(scope: Scope, form: ListForm, head: str, level: int) -> Goal:
    if len(form.items) == 1:
        scope.error("wrong-parts", f"`{head}` joins one or more goals; here are none", form.span)
    goals = tuple(parse_goal(scope, one, level + 1) for one in form.items[1:])
    if head == "and":
        return And(goals, form.span)
    return Or(goals, form.span) if head == "or" else PrioAnd(goals, form.span)


def _subgoal(scope: Scope, form: ListForm, kind: Kind) -> Goal:
    rest, options = split_options(scope, form.items[1:], ("depth",) if kind == "ach" else ())
    depth = parse_option(scope, options, "depth", partial(parse_whole, counts="`:depth` counts steps"))
    match rest:
        case (ListForm(items=(Symbol(name=head), *_)),) if head in CONDITION_FORMS and kind == "ach":
            return Achieve(parse_condition(scope, rest[0]), form.span, depth)
    name, parts = parse_subgoal_name(scope, kind, form, rest)
    return Subgoal(kind, name, tuple(parse_argument(scope, part) for part in parts), form.span, depth)


def parse_subgoal_name(scope: Scope, kind: str, form: ListForm, rest: Sequence[Form]) -> tuple[str, Sequence[Form]]:
    """Name and arguments of `(ach NAME ARG...)` and `(ach (NAME ARG...))`."""
    match rest:
        case (ListForm(items=(Symbol(name=name, span=span), *arguments)),):
            if name in RESERVED:
                scope.error("misplaced-form", f"`{name}` is {what_is(name)}; here a goal is named", span)
                return "", ()
            return name, arguments
        case (name_form, *arguments):
            return _goal_name(scope, name_form), arguments
        case _:
            has_parts(scope, kind, form, rest, 1)
            return "", ()


def _goal_name(scope: Scope, form: Form) -> str:
    """A goal without arguments may be called as a form of the language; `(ach and x)` is a slip."""
    if isinstance(form, Symbol) and form.name in CONDITION_FORMS:
        hint = f"a condition stands in parentheses: `(ach ({form.name} …))`"
        scope.error("reserved-name", f"`{form.name}` makes a condition and cannot name a goal", form.span, hint)
        return ""
    return parse_name(scope, form, "a goal")
