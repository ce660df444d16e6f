"""Plans with one slip each: what a test of the plan should notice.

Takes: a `Plan` (syntax). Gives: `Mutant`s in textual order, each a whole plan with one change, its place and the change
in words; and whether two plans can be told apart. Leaves alone: which tests notice; see rplan/apps/doing/mutate.py.

Changed are the bodies of rules, the top goal, named conditions and preconditions of operators: a part of a condition
negated, `and` and `or` exchanged, a comparison or a number shifted, branches swapped or dropped, members dropped or
their order exchanged, the value of an output exchanged with another. Lists of such operators: DeMillo, Lipton and
Sayward (1978); Offutt et al. (1996).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal, TypeVar

from rplan.lang import plan as p
from rplan.lang.printer import canonical, print_goal, print_head
from rplan.lang.source import Span
from rplan.ways.differ import differences
from rplan.ways.reduce import Ways

T = TypeVar("T")
MOST_LETTERS = 48
Kind = Literal["negate", "connective", "number", "comparison", "swap", "drop", "order", "value"]
KINDS: tuple[Kind, ...] = ("negate", "connective", "number", "comparison", "swap", "drop", "order", "value")
Values = Mapping[str, Sequence[p.Expression]]
"""Output -> the values that the plan sets it to, once each, in textual order."""


@dataclass(frozen=True, slots=True)
class Mutant:
    """where: the rule, or what else it stands in; change: in words."""

    kind: Kind
    where: str
    span: Span
    change: str
    plan: p.Plan


@dataclass(frozen=True, slots=True)
class Slip:
    """One change inside something; what came of it."""

    kind: Kind
    span: Span
    change: str


Goals = Iterator[tuple[Slip, p.Goal]]
Conditions = Iterator[tuple[Slip, p.Condition]]


def mutants(plan: p.Plan, file: str | None = None) -> Iterator[Mutant]:
    """Every plan with one slip. file: only slips in this file, where parts come from others."""
    for mutant in _everywhere(plan):
        if file is None or mutant.span.file == file:
            yield mutant


def _everywhere(plan: p.Plan) -> Iterator[Mutant]:
    values = _values(plan)
    for n, named in enumerate(plan.conditions):
        for slip, condition in in_condition(named.condition):
            changed = replace(named, condition=condition)
            whole = replace(plan, conditions=_put(plan.conditions, n, changed))
            yield Mutant(slip.kind, f"({named.name})", slip.span, slip.change, whole)
    for n, rule in enumerate(plan.rules):
        for slip, goal in in_goal(rule.goal, values):
            whole = replace(plan, rules=_put(plan.rules, n, replace(rule, goal=goal)))
            yield Mutant(slip.kind, print_head(rule), slip.span, slip.change, whole)
    for n, operator in enumerate(plan.operators):
        for slip, condition in in_condition(operator.precondition):
            changed_operator = replace(operator, precondition=condition)
            whole = replace(plan, operators=_put(plan.operators, n, changed_operator))
            yield Mutant(slip.kind, f"(defop {operator.name})", slip.span, slip.change, whole)
    if plan.top is not None:
        for slip, goal in in_goal(plan.top.goal, values):
            whole = replace(plan, top=replace(plan.top, goal=goal))
            yield Mutant(slip.kind, "(goalem)", slip.span, slip.change, whole)


def _put(items: tuple[T, ...], place: int, item: T) -> tuple[T, ...]:
    return (*items[:place], item, *items[place + 1 :])


def _values(plan: p.Plan) -> Values:
    found: dict[str, dict[str, p.Expression]] = {}
    goals = [rule.goal for rule in plan.rules] + ([plan.top.goal] if plan.top else [])
    while goals:
        here = goals.pop(0)
        if isinstance(here, p.Do) and not isinstance(here.value, p.Variable) and not _has_variable(here.value):
            found.setdefault(here.output, {}).setdefault(canonical(here.value), here.value)
        goals[:0] = _inside(here)
    return {output: list(values.values()) for output, values in found.items()}


def _has_variable(value: p.Argument) -> bool:
    match value:
        case p.Variable():
            return True
        case p.Call(arguments=arguments):
            return any(map(_has_variable, arguments))
        case _:
            return False


def _inside(goal: p.Goal) -> list[p.Goal]:
    match goal:
        case p.If(then=then, otherwise=otherwise):
            return [then, otherwise]
        case p.And(goals) | p.Or(goals) | p.PrioAnd(goals):
            return list(goals)
        case _:
            return []


# --- goals ---


def in_goal(goal: p.Goal, values: Values) -> Goals:
    """Every slip in a goal, the outermost first."""
    match goal:
        case p.Do():
            yield from _other_value(goal, values)
        case p.If():
            yield from _in_if(goal, values)
        case p.And(goals) | p.Or(goals) | p.PrioAnd(goals):
            yield from _in_several(goal, goals, values)
        case p.Achieve(condition=condition):
            for slip, changed in in_condition(condition):
                yield slip, replace(goal, condition=changed)
        case p.Anything() | p.Subgoal():
            return


def _other_value(goal: p.Do, values: Values) -> Goals:
    own = canonical(goal.value)
    every = values.get(goal.output, ())
    texts = [canonical(value) for value in every]
    others = [*every[texts.index(own) + 1 :], *every[: texts.index(own)]] if own in texts else list(every)
    if not others and isinstance(goal.value, p.Truth):
        others = [replace(goal.value, value=not goal.value.value)]
    for other in others[:1]:
        change = f"`{goal.output}` is set to {canonical(other)} instead of {own}"
        yield Slip("value", goal.span, change), replace(goal, value=other)


def _in_if(goal: p.If, values: Values) -> Goals:
    nothing = p.Anything(goal.span)
    said = canonical(goal.condition)
    swapped = replace(goal, then=goal.otherwise, otherwise=goal.then)
    yield Slip("swap", goal.span, f"the branches after {said} are swapped"), swapped
    if not isinstance(goal.then, p.Anything):
        change = f"what is done where {said} is dropped: {shortened(print_goal(goal.then))}"
        yield Slip("drop", goal.then.span, change), replace(goal, then=nothing)
    if not isinstance(goal.otherwise, p.Anything):
        change = f"what is done where not {said} is dropped: {shortened(print_goal(goal.otherwise))}"
        yield Slip("drop", goal.otherwise.span, change), replace(goal, otherwise=nothing)
    for slip, condition in in_condition(goal.condition, whole=False):
        yield slip, replace(goal, condition=condition)
    for slip, inner in in_goal(goal.then, values):
        yield slip, replace(goal, then=inner)
    for slip, inner in in_goal(goal.otherwise, values):
        yield slip, replace(goal, otherwise=inner)


def _in_several(goal: p.And | p.Or | p.PrioAnd, goals: tuple[p.Goal, ...], values: Values) -> Goals:
    if isinstance(goal, p.And | p.Or) and len(goals) > 1:
        other: p.Goal = p.Or(goals, goal.span) if isinstance(goal, p.And) else p.And(goals, goal.span)
        words = ("and", "or") if isinstance(goal, p.And) else ("or", "and")
        yield Slip("connective", goal.span, f"`{words[0]}` of goals became `{words[1]}`"), other
    for n, inner in enumerate(goals):
        if len(goals) > 1:
            change = f"the member {shortened(print_goal(inner))} is dropped"
            yield Slip("drop", inner.span, change), replace(goal, goals=(*goals[:n], *goals[n + 1 :]))
        if n and not isinstance(goal, p.And):
            exchanged = (*goals[: n - 1], inner, goals[n - 1], *goals[n + 1 :])
            change = f"{shortened(print_goal(inner))} comes before {shortened(print_goal(goals[n - 1]))}"
            yield Slip("order", inner.span, change), replace(goal, goals=exchanged)
        for slip, changed in in_goal(inner, values):
            yield slip, replace(goal, goals=_put(goals, n, changed))


def shortened(text: str) -> str:
    """A text cut short."""
    return text if len(text) <= MOST_LETTERS else f"{text[: MOST_LETTERS - 1]}…"


# --- conditions ---


def in_condition(condition: p.Condition, whole: bool = True) -> Conditions:
    """Every slip in a condition. whole: also that all of it is negated (an `if` has its branches swapped instead)."""
    if whole and not isinstance(condition, p.Truth):
        yield _negation(condition)
    match condition:
        case p.Not(inner):
            for slip, changed in in_condition(inner, whole=False):
                yield slip, replace(condition, condition=changed)
        case p.AllOf(parts) | p.AnyOf(parts):
            yield from _in_parts(condition, parts)
        case p.Compare():
            yield from _in_comparison(condition)
        case p.Memory(conditions=conditions):
            yield from _in_memory(condition)
            for n, inner in enumerate(conditions):
                for slip, changed in in_condition(inner):
                    yield slip, replace(condition, conditions=_put(conditions, n, changed))
        case p.Truth() | p.Call() | p.OutputIs() | p.Variable():
            return


def _negation(condition: p.Condition) -> tuple[Slip, p.Condition]:
    said = canonical(condition)
    if isinstance(condition, p.Not):
        slip = Slip("negate", condition.span, f"{said} became {canonical(condition.condition)}")
        return slip, condition.condition
    return Slip("negate", condition.span, f"{said} became (not {said})"), p.Not(condition, condition.span)


def _in_parts(condition: p.AllOf | p.AnyOf, parts: tuple[p.Condition, ...]) -> Conditions:
    if len(parts) > 1:
        every = isinstance(condition, p.AllOf)
        other = p.AnyOf(parts, condition.span) if every else p.AllOf(parts, condition.span)
        words = ("and", "or") if every else ("or", "and")
        change = f"`{words[0]}` became `{words[1]}` in {shortened(canonical(condition))}"
        yield Slip("connective", condition.span, change), other
    for n, part in enumerate(parts):
        for slip, changed in in_condition(part):
            yield slip, replace(condition, conditions=_put(parts, n, changed))


STRICTNESS: Mapping[p.Comparator, p.Comparator] = {"<": "<=", "<=": "<", ">": ">=", ">=": ">"}


def _in_comparison(condition: p.Compare) -> Conditions:
    other = STRICTNESS.get(condition.operator)
    if other is not None:
        changed = replace(condition, operator=other)
        slip = Slip("comparison", condition.span, f"{canonical(condition)} became {canonical(changed)}")
        yield slip, changed
    sides: tuple[tuple[p.Quantity, Callable[[p.Quantity], p.Compare]], ...] = (
        (condition.left, lambda q: replace(condition, left=q)),
        (condition.right, lambda q: replace(condition, right=q)),
    )
    for side, put in sides:
        for before, after, shifted in _shifted(side):
            slip = Slip("number", before.span, f"{canonical(before)} became {canonical(after)}")
            yield slip, put(shifted)


def _shifted(quantity: p.Quantity) -> Iterator[tuple[p.Number, p.Number, p.Quantity]]:
    match quantity:
        case p.Number():
            for other in (_number(quantity, 1), _number(quantity, -1)):
                yield quantity, other, other
        case p.Arithmetic(operands=operands):
            for n, operand in enumerate(operands):
                for before, after, shifted in _shifted(operand):
                    yield before, after, replace(quantity, operands=_put(operands, n, shifted))
        case _:
            return


def _number(number: p.Number, sign: int) -> p.Number:
    """A tenth more or less; nought becomes one more or less."""
    value = number.value * (10 + sign) / 10 if number.value else float(sign)
    return replace(number, value=float(f"{value:.6g}"))


def _in_memory(condition: p.Memory) -> Conditions:
    said = canonical(condition)
    changed: list[p.Memory] = []
    if condition.form == "delay":
        changed.append(replace(condition, initial=not condition.initial))
    if condition.duration is not None:
        changed.append(replace(condition, duration=replace(condition.duration, value=condition.duration.value * 2)))
        changed.append(replace(condition, duration=replace(condition.duration, value=condition.duration.value / 2)))
    if condition.form == "at-least":
        changed += [replace(condition, count=condition.count + n) for n in (1, -1) if condition.count + n > 0]
    for one in changed:
        yield Slip("number", condition.span, f"{said} became {canonical(one)}"), one


# --- whether it can be noticed ---


def equal(first: Ways, second: Ways) -> bool | None:
    """Whether two plans decide the same in every tick that can be; None where it is not decided."""
    try:
        found = differences(first, second)
    except ValueError:
        return False
    return False if found.found else None if found.undecided else True
