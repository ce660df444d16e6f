"""The operators of a plan, checked in general and made ready for regression (L20).

Takes: the operators of a `Plan` and its scope. Gives: the same with the text of named conditions in their place;
findings where names or types are wrong. Leaves alone: what the operators can reach.
"""

from __future__ import annotations

from dataclasses import replace

from rplan.goals.resolve import resolve_condition, resolve_value
from rplan.goals.scope import Scope
from rplan.goals.substitute import unfold
from rplan.lang import plan as p
from rplan.lang.diagnostic import Related


def checked_operators(plan: p.Plan, scope: Scope) -> tuple[p.Operator, ...]:
    """The operators in textual order; their variables stand for anything."""
    return tuple(_checked(operator, scope) for operator in plan.operators)


def _checked(operator: p.Operator, scope: Scope) -> p.Operator:
    declared = scope.output(operator.output, operator.span)
    resolve_value(operator.value, declared.type if declared else None, scope)
    resolve_condition(operator.precondition, scope)
    for fact in (*operator.adds, *operator.deletes):
        _check_fact(fact, scope)
    return replace(operator, precondition=unfold(operator.precondition, scope.conditions, scope.findings))


def _check_fact(fact: p.Call, scope: Scope) -> None:
    if fact.name in scope.conditions:
        scope.findings.add(
            "error", "not-a-fact", f"`{fact.name}` is a named condition; operators change percepts", fact.span,
            related=[Related("defined here", scope.conditions[fact.name].span)],
        )  # fmt: skip
    else:
        resolve_condition(fact, scope)
