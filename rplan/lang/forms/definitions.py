"""What a plan defines: named conditions, rules, operators and its top goal.

Takes: a `Scope` and a form of the top level. Gives: the definition, its body read with the variables of its head.
Leaves alone: where it is put to use.
"""

from __future__ import annotations

from rplan.lang.forms.conditions import parse_argument, parse_condition, parse_expression, parse_fact
from rplan.lang.forms.goals import Kind, parse_goal, parse_subgoal_name
from rplan.lang.forms.parts import has_parts, parse_name, parse_new_name, parse_option, split_doc, split_options
from rplan.lang.forms.scope import Scope, head_of
from rplan.lang.plan import (
    Anything,
    Argument,
    Call,
    Expression,
    NamedCondition,
    Operator,
    Rule,
    TopGoal,
    Truth,
)
from rplan.lang.plan import Variable as Parameter
from rplan.lang.reader import Form, ListForm, Symbol, Text, Variable


def parse_named_condition(scope: Scope, form: ListForm) -> NamedCondition:
    head, doc, rest = _head_doc_body(form)
    if not has_parts(scope, "defcond", form, rest, 2):
        return NamedCondition("", (), doc, Truth(False, form.span), form.span)
    name, parameters = _signature(scope, head, "a condition")
    return NamedCondition(name, parameters, doc, parse_condition(scope.binding(parameters), rest[1]), form.span)


def _signature(scope: Scope, head: Form, owner: str) -> tuple[str, tuple[str, ...]]:
    """`(NAME ?ARG...)` or `NAME`: the name, and the variables without their question marks."""
    match head:
        case ListForm(items=(first, *rest)):
            variables = [one for one in rest if isinstance(one, Variable)]
            for one in rest:
                if not isinstance(one, Variable):
                    scope.unexpected(one, "a variable such as `?place`", "wrong-parts")
            scope.distinct("variable", [(f"?{one.name}", one.span) for one in variables])
            return parse_new_name(scope, first, owner), tuple(variable.name for variable in variables)
        case ListForm():
            scope.no_head(head, owner)
            return "", ()
        case _:
            return parse_new_name(scope, head, owner), ()


def parse_rule(scope: Scope, form: ListForm) -> Rule:
    head, doc, rest = _head_doc_body(form)
    if not has_parts(scope, "defgoalr", form, rest, 2):
        return Rule("ach", "", (), doc, Anything(form.span), head.span, form.span)
    kind, name, parameters = _rule_head(scope, head)
    variables = tuple(one.name for one in parameters if isinstance(one, Parameter))
    goal = parse_goal(scope.binding(variables), rest[1], 2)
    return Rule(kind, name, parameters, doc, goal, head.span, form.span)


def _head_doc_body(form: ListForm) -> tuple[Form, str, tuple[Form, ...]]:
    """What a definition defines, its text, and all parts without that text."""
    rest = form.items[1:]
    if len(rest) > 2 and isinstance(rest[1], Text):
        return rest[0], rest[1].value, (rest[0], *rest[2:])
    return rest[0] if rest else form, "", rest


def _rule_head(scope: Scope, form: Form) -> tuple[Kind, str, tuple[Argument, ...]]:
    """kind, name and parameters; a variable is a parameter, everything else is parsed without variables."""
    match form:
        case ListForm(items=(Symbol(name="ach" | "maint" as kind), *rest)):
            name, parts = parse_subgoal_name(scope, kind, form, rest)
            scope.distinct("variable", [(f"?{one.name}", one.span) for one in parts if isinstance(one, Variable)])
            parameters = tuple(
                Parameter(part.name, part.span) if isinstance(part, Variable) else parse_argument(scope, part)
                for part in parts
            )
            return "ach" if kind == "ach" else "maint", name, parameters
        case _:
            hint = "rules are for `(ach NAME)` or `(maint NAME)`"
            scope.unexpected(form, "`(ach NAME)` or `(maint NAME)`", "bad-head", hint)
            return "ach", "", ()


def parse_operator(scope: Scope, form: ListForm) -> Operator:
    rest, options = split_options(scope, form.items[1:], ("do", "pre", "add", "del"))
    doc, rest = split_doc(rest, 1)
    counted = has_parts(scope, "defop", form, rest, 1)
    name, parameters = _signature(scope, rest[0], "an operator") if counted else ("", ())
    if "do" not in options:
        scope.error("wrong-parts", "an operator says what it does: `:do (OUTPUT VALUE)`", form.span)
    inner = scope.binding(parameters)
    output, value = parse_option(inner, options, "do", _assignment) or ("", Truth(False, form.span))
    pre = parse_option(inner, options, "pre", parse_condition)
    adds = parse_option(inner, options, "add", _facts) or ()
    deletes = parse_option(inner, options, "del", _facts) or ()
    if "add" not in options and "del" not in options:
        scope.error("wrong-parts", "an operator says what it changes: `:add (FACT...)`, `:del (FACT...)`", form.span)
    head = rest[0].span if rest else form.span
    return Operator(name, parameters, doc, output, value, pre or Truth(True, form.span), adds, deletes, head, form.span)


def _assignment(scope: Scope, form: Form) -> tuple[str, Expression]:
    match form:
        case ListForm(items=(output, value)):
            return parse_name(scope, output, "an output"), parse_expression(scope, value)
        case _:
            scope.unexpected(form, "`(OUTPUT VALUE)`", "wrong-parts")
            return "", Truth(False, form.span)


def _facts(scope: Scope, form: Form) -> tuple[Call, ...]:
    if not isinstance(form, ListForm):
        scope.unexpected(form, "a list of facts `(FACT...)`", "wrong-parts")
        return ()
    return tuple(call for one in form.items if (call := parse_fact(scope, one)))


def parse_top_goal(scope: Scope, form: ListForm) -> TopGoal:
    head = head_of(form) or "goalem"
    rest = form.items[1:]
    goal = parse_goal(scope, rest[0], 2) if has_parts(scope, head, form, rest, 1) else Anything(form.span)
    return TopGoal(goal, form.span)
