"""Arguments put in the place of variables, on syntax (L17).

Takes: syntax with variables, and their arguments by name. Gives: syntax without them; where an argument does not fit
its place, a harmless stand-in and a finding. Leaves alone: variables that have no argument, and what names mean.

What is put in keeps the place at which it is written, so that messages point to the argument.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from rplan.goals.scope import Findings
from rplan.lang import plan as p
from rplan.lang.diagnostic import Related
from rplan.lang.printer import canonical
from rplan.lang.source import Span


@dataclass(frozen=True, slots=True)
class Substitution:
    """Variable name -> argument, and where to tell what does not fit."""

    arguments: Mapping[str, p.Argument]
    findings: Findings

    def goal(self, goal: p.Goal) -> p.Goal:
        """The goal with arguments in the place of variables."""
        match goal:
            case p.Do(output, value, span):
                return p.Do(output, self.value(value), span)
            case p.Anything():
                return goal
            case p.If(condition, then, otherwise, span):
                return p.If(self.condition(condition), self.goal(then), self.goal(otherwise), span)
            case p.And(goals, span):
                return p.And(tuple(map(self.goal, goals)), span)
            case p.Or(goals, span):
                return p.Or(tuple(map(self.goal, goals)), span)
            case p.PrioAnd(goals, span):
                return p.PrioAnd(tuple(map(self.goal, goals)), span)
            case p.Subgoal(kind, name, arguments, span, depth):
                return p.Subgoal(kind, name, tuple(map(self.argument, arguments)), span, depth)
            case p.Achieve(condition, span, depth):
                return p.Achieve(self.condition(condition), span, depth)

    def condition(self, condition: p.Condition) -> p.Condition:
        """The condition with arguments in the place of variables."""
        match condition:
            case p.Variable(name, span):
                return self._condition_of(self.arguments.get(name, condition), span)
            case p.Truth():
                return condition
            case p.Call():
                return self.call(condition)
            case p.Not(inner, span):
                return p.Not(self.condition(inner), span)
            case p.AllOf(parts, span):
                return p.AllOf(tuple(map(self.condition, parts)), span)
            case p.AnyOf(parts, span):
                return p.AnyOf(tuple(map(self.condition, parts)), span)
            case p.Compare(operator, left, right, span):
                return p.Compare(operator, self.quantity(left), self.quantity(right), span)
            case p.Memory(form, parts, span, initial, duration, count):
                return p.Memory(form, tuple(map(self.condition, parts)), span, initial, duration, count)
            case p.OutputIs(output, value, span):
                return p.OutputIs(output, None if value is None else self.value(value), span)

    def call(self, call: p.Call) -> p.Call:
        """The call with arguments in the place of variables."""
        return p.Call(call.name, tuple(map(self.argument, call.arguments)), call.span)

    def value(self, value: p.Expression) -> p.Expression:
        """The value with arguments in the place of variables."""
        match value:
            case p.Variable(name, span):
                return self._value_of(self.arguments.get(name, value), span)
            case p.Call():
                return self.call(value)
            case _:
                return value

    def quantity(self, quantity: p.Quantity) -> p.Quantity:
        """The number with arguments in the place of variables."""
        match quantity:
            case p.Variable(name, span):
                return self._quantity_of(self.arguments.get(name, quantity), span)
            case p.Call():
                return self.call(quantity)
            case p.Arithmetic(operator, operands, span):
                return p.Arithmetic(operator, tuple(map(self.quantity, operands)), span)
            case p.Number():
                return quantity

    def argument(self, argument: p.Argument) -> p.Argument:
        """The argument of a goal or a call, with arguments in the place of variables."""
        match argument:
            case p.Variable(name):
                return self.arguments.get(name, argument)
            case p.Number() | p.Arithmetic():
                return self.quantity(argument)
            case _:
                return self.condition(argument)

    def _condition_of(self, argument: p.Argument, place: Span) -> p.Condition:
        match argument:
            case p.Number() | p.Arithmetic():
                self._unfit(argument, "not-a-condition", "a condition", place)
                return p.Truth(False, place)
            case _:
                return argument

    def _value_of(self, argument: p.Argument, place: Span) -> p.Expression:
        match argument:
            case p.Number() | p.Truth() | p.Call() | p.Variable():
                return argument
            case _:
                self._unfit(argument, "not-a-value", "a value", place)
                return p.Truth(False, place)

    def _quantity_of(self, argument: p.Argument, place: Span) -> p.Quantity:
        match argument:
            case p.Number() | p.Call() | p.Variable() | p.Arithmetic():
                return argument
            case _:
                self._unfit(argument, "not-a-number", "a number", place)
                return p.Number(0.0, "", place)

    def _unfit(self, argument: p.Argument, code: str, wanted: str, place: Span) -> None:
        self.findings.add(
            "error", code, f"the argument `{canonical(argument)}` is put where {wanted} is expected", argument.span,
            related=[Related("it is put here", place)],
        )  # fmt: skip


def unfold(
    condition: p.Condition,
    definitions: Mapping[str, p.NamedCondition],
    findings: Findings,
    inside: tuple[str, ...] = (),
) -> p.Condition:
    """The condition with the text of named conditions in their place, but for memory, and for circles."""
    match condition:
        case p.Not(inner, span):
            return p.Not(unfold(inner, definitions, findings, inside), span)
        case p.AllOf(parts, span):
            return p.AllOf(tuple(unfold(part, definitions, findings, inside) for part in parts), span)
        case p.AnyOf(parts, span):
            return p.AnyOf(tuple(unfold(part, definitions, findings, inside) for part in parts), span)
        case p.Call(name, arguments) if name in definitions and name not in inside:
            named = definitions[name]
            if len(named.parameters) != len(arguments):
                return condition
            bound = dict(zip(named.parameters, arguments, strict=True))
            body = Substitution(bound, findings).condition(named.condition)
            return unfold(body, definitions, findings, (*inside, name))
        case _:
            return condition


def has_variables(argument: p.Argument) -> bool:
    """Whether a variable stands anywhere in it."""
    match argument:
        case p.Variable():
            return True
        case p.Call(arguments=parts) | p.Arithmetic(operands=parts):
            return any(map(has_variables, parts))
        case p.Not(inner):
            return has_variables(inner)
        case p.AllOf(conditions) | p.AnyOf(conditions) | p.Memory(conditions=conditions):
            return any(map(has_variables, conditions))
        case p.Compare(left=left, right=right):
            return has_variables(left) or has_variables(right)
        case p.OutputIs(value=value):
            return value is not None and has_variables(value)
        case p.Number() | p.Truth():
            return False
