"""Tests of a plan alone, with their names looked up and their types checked.

Takes: a `Plan`, its scope and its outputs. Gives: `Trial`s: percepts and outputs by canonical text. Leaves alone:
running them; see rplan/apps/doing/test.py.
"""

from __future__ import annotations

from rplan.goals import goal as g
from rplan.goals.condition import print_condition
from rplan.goals.resolve import resolve_condition, resolve_value
from rplan.goals.scope import Scope
from rplan.lang import plan as p
from rplan.lang.diagnostic import Related
from rplan.lang.plan import Type
from rplan.lang.source import Span
from rplan.lang.suggest import close


def resolve_trials(plan: p.Plan, scope: Scope, outputs: tuple[g.Output, ...]) -> tuple[g.Trial, ...]:
    """The tests in textual order."""
    types = {output.name: output.type for output in outputs}

    def step(one: p.Step) -> g.TrialStep:
        given = tuple(_given(pair, scope) for pair in one.given)
        expected = tuple(_expected(pair, types, scope) for pair in one.expected)
        _distinct([(text, pair.span) for (text, _), pair in zip(given, one.given, strict=True)], scope)
        _distinct([(pair.output, pair.span) for pair in one.expected], scope)
        return g.TrialStep(one.times, given, expected, one.hole, one.span)

    return tuple(g.Trial(test.name, test.doc, tuple(map(step, test.steps)), test.span) for test in plan.tests)


def _distinct(named: list[tuple[str, Span]], scope: Scope) -> None:
    seen: dict[str, Span] = {}
    for name, span in named:
        if name in seen:
            related = [Related("the first is here", seen[name])]
            scope.findings.add("error", "duplicate", f"`{name}` is there twice", span, related=related)
        seen.setdefault(name, span)


def _given(pair: p.Given, scope: Scope) -> tuple[str, bool | float]:
    percept, value = pair.percept, pair.value
    if percept.name in scope.conditions:
        scope.findings.add(
            "error", "not-a-percept", f"`{percept.name}` is a named condition; a test gives percepts", percept.span,
            related=[Related("defined here", scope.conditions[percept.name].span)],
        )  # fmt: skip
        return percept.name, False
    if isinstance(value, p.Truth):
        return print_condition(resolve_condition(percept, scope)), value.value
    term = resolve_value(percept, Type("number", value.unit), scope)
    wanted = term.type if term.type is not None and term.type.name == "number" else None
    number = resolve_value(value, wanted, scope)
    return term.text, number.value if number.value is not None else 0.0


def _expected(pair: p.Expected, types: dict[str, Type | None], scope: Scope) -> tuple[str, str | None]:
    if pair.output not in types:
        meant = close(pair.output, types)
        known = " ".join(f"`{name}`" for name in types) or "none"
        hint = f"did you mean `{meant}`?" if meant else f"there are: {known}"
        scope.findings.add("error", "no-output", f"no output is called `{pair.output}`", pair.span, hint=hint)
        return pair.output, None
    if pair.value is None:
        return pair.output, None
    return pair.output, resolve_value(pair.value, types[pair.output], scope).text
