"""Conditions, values, outputs and settings with their names looked up and their types checked (L5-L8, L21).

Takes: syntax of rplan/lang/plan.py and a `Scope`. Gives: the resolved forms of condition.py and goal.py; what is wrong
goes to the scope's findings and a harmless stand-in comes back, so that one run finds every error. Leaves alone: goals.
"""

from __future__ import annotations

import math
from dataclasses import replace
from fractions import Fraction

from rplan.goals import condition as c
from rplan.goals import goal as g
from rplan.goals.dimension import product, quotient
from rplan.goals.scope import DEEPEST, LONGEST, Scope
from rplan.goals.signature import BOOL, COMPETENCE_FAILED, ParameterSignature
from rplan.goals.substitute import Substitution, has_variables
from rplan.lang import plan as p
from rplan.lang.diagnostic import Related
from rplan.lang.plan import Type
from rplan.lang.printer import canonical
from rplan.lang.source import Span
from rplan.lang.suggest import close

_DELAY = "(delay)"
"""Stands among the names on the way to a condition where a `delay` was passed."""


def resolve_condition(condition: p.Condition, scope: Scope, inside: tuple[str, ...] = ()) -> c.Condition:
    """A condition with named conditions put in place; inside: the names on the way here, for circles (L10)."""
    match condition:
        case p.Truth(value):
            return c.Constant(value)
        case p.Not(inner):
            return c.Not(resolve_condition(inner, scope, inside))
        case p.AllOf(parts):
            return c.AllOf(tuple(resolve_condition(part, scope, inside) for part in parts))
        case p.AnyOf(parts):
            return c.AnyOf(tuple(resolve_condition(part, scope, inside) for part in parts))
        case p.Compare():
            return _comparison(condition, scope)
        case p.Memory():
            return _memory(condition, scope, inside)
        case p.Call(name) if name in scope.conditions:
            return _named(condition, scope, inside)
        case p.Call():
            term = _call(condition, scope, BOOL, "condition")
            return c.Percept(term.text, term)
        case p.OutputIs():
            return _output_is(condition, scope, inside)
        case p.Variable():
            return c.Constant(False)


def _named(call: p.Call, scope: Scope, inside: tuple[str, ...]) -> c.Condition:
    name, span = call.name, call.span
    scope.used[("condition", name)] = None
    definition = scope.conditions[name]
    if len(call.arguments) != len(definition.parameters):
        takes, given = arguments_said(len(definition.parameters)), len(call.arguments)
        scope.findings.add(
            "error", "wrong-arity", f"the condition `{name}` takes {takes}, here {_are(given)}", span,
            related=[Related("defined here", definition.span)],
        )  # fmt: skip
        return c.Constant(False)
    key = " ".join((name, *map(canonical, call.arguments)))
    if key in inside and _DELAY in inside[inside.index(key) :]:
        scope.recursive[key] = call
        return c.Named(key)
    if key in inside:
        _circle(inside[inside.index(key) :], span, scope)
        return c.Constant(False)
    if scope.endless or len(inside) > DEEPEST or len(key) > LONGEST:
        _too_deep(name, span, scope)
        return c.Constant(False)
    return resolve_condition(_definition(call, scope), scope, (*inside, key))


def _definition(call: p.Call, scope: Scope) -> p.Condition:
    """What a named condition says of these arguments."""
    definition = scope.conditions[call.name]
    if not definition.parameters:
        return definition.condition
    arguments = dict(zip(definition.parameters, call.arguments, strict=True))
    return Substitution(arguments, scope.findings).condition(definition.condition)


def _too_deep(name: str, span: Span, scope: Scope) -> None:
    if not scope.endless:
        message = f"the condition `{name}` is nested deeper than {DEEPEST} conditions"
        scope.findings.add("error", "too-deep", message, span, hint="its arguments grow each time")
    scope.endless = True


def _circle(keys: tuple[str, ...], span: Span, scope: Scope) -> None:
    """Report a circle once, as it looks from the condition of it that is defined first."""
    names = [key.split(" ", 1)[0] for key in keys]
    if names[0] == next(name for name in scope.conditions if name in names):
        path = " → ".join((*keys, keys[0]))
        related = [Related(f"`{name}` is defined here", scope.conditions[name].span) for name in names]
        scope.findings.add(
            "error", "condition-circle", f"`{keys[0]}` depends on itself within one tick: {path}", span,
            related=related,
        )  # fmt: skip


def _output_is(asked: p.OutputIs, scope: Scope, inside: tuple[str, ...]) -> c.Condition:
    """A question for an output, or what it turns out to be where there is no such output."""
    if asked.output in scope.channels:
        return _asked_output(asked, scope)
    called = p.Call(asked.output, (), asked.span)
    if asked.value is None and "open" in (*scope.functions, *scope.conditions):
        return resolve_condition(p.Call("open", (called,), asked.span), scope, inside)
    if asked.value is None or isinstance(asked.value, p.Truth) or close(asked.output, scope.channels):
        meant = close(asked.output, scope.channels)
        known = " ".join(f"`{name}`" for name in scope.channels) or "none"
        hint = f"did you mean `{meant}`?" if meant else f"there are: {known}"
        scope.findings.add("error", "no-output", f"no output is called `{asked.output}`", asked.span, hint=hint)
        return c.Constant(False)
    return resolve_condition(p.Compare("=", called, asked.value, asked.span), scope, inside)


def _asked_output(asked: p.OutputIs, scope: Scope) -> c.Condition:
    if scope.asks == "percepts":
        scope.findings.add(
            "error", "asks-output", f"an assumption asks percepts alone; `{asked.output}` is an output", asked.span,
            hint="what outputs must be is said by `defproperty`",
        )  # fmt: skip
    if asked.value is None:
        return c.OutputIs(asked.output, None)
    return c.OutputIs(asked.output, resolve_value(asked.value, scope.channels[asked.output], scope).text)


def _memory(memory: p.Memory, scope: Scope, inside: tuple[str, ...]) -> c.Memory:
    """`delay` breaks circles: what is inside it is of the tick before (L10)."""
    here = (*inside, _DELAY) if memory.form == "delay" else inside
    conditions = tuple(resolve_condition(part, scope, here) for part in memory.conditions)
    head: list[str] = [memory.form]
    ticks = memory.count
    match memory.form:
        case "delay":
            head.append("true" if memory.initial else "false")
        case "held-for" | "within" if memory.duration is not None:
            head.append(_literal(memory.duration).text)
            ticks = ticks_of(memory.duration.value, scope.period)
        case "at-least":
            head.append(str(memory.count))
    parts = [*head, *map(c.print_condition, conditions)]
    if memory.form == "at-least" and len(conditions) == 2:
        parts.insert(-1, ":reset")
    return c.Memory(f"({' '.join(parts)})", memory.form, conditions, memory.initial, ticks)


def ticks_of(duration: float, period: float) -> int:
    """How many ticks a time [s] takes, rounded up; exact on the decimals of the text: 70 ms at 10 ms is 7."""
    return math.ceil(Fraction(repr(duration)) / Fraction(repr(period)))


def _comparison(compare: p.Compare, scope: Scope) -> c.Comparison:
    left = _number(compare.left, scope)
    right = _number(compare.right, scope)
    for term, other in ((left, right), (right, left)):
        if term.type is None and term.kind == "call":
            scope.take_for(term.name, Type("number", _unit(other)), term.span)
    left, right = _same_unit(left, right, compare.span, scope)
    return c.Comparison(f"({compare.operator} {left.text} {right.text})", compare.operator, left, right)


def _number(expression: p.Quantity, scope: Scope) -> c.Term:
    if isinstance(expression, p.Number):
        return _literal(expression)
    if isinstance(expression, p.Arithmetic):
        return _arithmetic(expression, scope)
    if isinstance(expression, p.Variable):
        return _stand_in(expression, None)
    term = _call(expression, scope, None, "number")
    if term.type is not None and term.type.name != "number":
        scope.findings.add(
            "error", "type-mismatch", f"`{term.text}` is of type {term.type}; a number is wanted", expression.span
        )
    return term


def _stand_in(variable: p.Variable, wanted: Type | None) -> c.Term:
    """For a variable of a rule or condition that nothing asks for, whose body is checked all the same."""
    return c.Term("symbol", f"?{variable.name}", (), None, wanted, variable.span)


def _unit(term: c.Term) -> str:
    return term.type.unit if term.type is not None else ""


def _arithmetic(arithmetic: p.Arithmetic, scope: Scope) -> c.Term:
    operands = [_number(operand, scope) for operand in arithmetic.operands]
    match arithmetic.operator:
        case "*" | "/":
            if arithmetic.operator == "/" and not operands[1].value:
                scope.findings.add(
                    "error", "bad-divisor", "a divisor is a number other than zero, so that no tick divides by nothing",
                    operands[1].span, hint="multiply the other side instead",
                )  # fmt: skip
            unit = _unit(operands[0])
            for operand in operands[1:]:
                unit = (product if arithmetic.operator == "*" else quotient)(unit, _unit(operand))
        case _:
            for number in range(1, len(operands)):
                operands[0], operands[number] = _same_unit(operands[0], operands[number], arithmetic.span, scope)
            unit = _unit(operands[0])
    kind = Type("number", unit)
    return c.Term("arithmetic", arithmetic.operator, tuple(operands), None, kind, arithmetic.span)


def _same_unit(left: c.Term, right: c.Term, span: Span, scope: Scope) -> tuple[c.Term, c.Term]:
    units = [term.type.unit if term.type is not None and term.type.name == "number" else None for term in (left, right)]
    if None in units or units[0] == units[1]:
        return left, right
    if "" not in units:
        scope.findings.add(
            "error", "unit-mismatch", f"`{left.text}` [{units[0]}] and `{right.text}` [{units[1]}] cannot be compared",
            span,
        )  # fmt: skip
        return left, right
    unit = units[0] or units[1] or ""
    bare = left if units[0] == "" else right
    scope.findings.add("warning", "bare-number", f"`{bare.text}` has no unit; it is read in [{unit}]", bare.span)
    if bare.kind != "number":
        return left, right
    dressed = replace(bare, type=Type("number", unit))
    return (dressed, right) if bare is left else (left, dressed)


def _literal(number: p.Number) -> c.Term:
    return c.Term("number", "", (), number.value, Type("number", number.unit), number.span)


def resolve_definitions(scope: Scope) -> dict[str, c.Condition]:
    """What the named conditions stand for that were found to ask their own past."""
    found: dict[str, c.Condition] = {}
    while missing := [key for key in scope.recursive if key not in found]:
        for key in missing:
            found[key] = resolve_condition(_definition(scope.recursive[key], scope), scope, (key,))
    general = [key for key, call in scope.recursive.items() if has_variables(call)]
    return {key: condition for key, condition in found.items() if key not in general}


def resolve_value(value: p.Expression, wanted: Type | None, scope: Scope) -> c.Term:
    """A value that has to be of type `wanted` (None: nothing tells it)."""
    match value:
        case p.Number():
            term = _literal(value)
        case p.Truth(truth, span):
            term = c.Term("truth", "", (), truth, BOOL, span)
        case p.Call(name, (), span) if wanted is not None and wanted.name == "symbol":
            return c.Term("symbol", name, (), None, wanted, span)
        case p.Call():
            term = _call(value, scope, wanted, "value")
        case p.Variable():
            return _stand_in(value, wanted)
    return _fitting(term, wanted, scope)


def _argument(argument: p.Argument, wanted: Type | None, scope: Scope) -> c.Term:
    """An argument of a function: a value."""
    match argument:
        case p.Number() | p.Truth() | p.Call() | p.Variable():
            return resolve_value(argument, wanted, scope)
        case _:
            scope.findings.add(
                "error", "misplaced-form", f"`{canonical(argument)}` is no value; a function takes values",
                argument.span, hint="goals and named conditions with variables may take conditions",
            )  # fmt: skip
            return c.Term("truth", "", (), False, wanted, argument.span)


def _fitting(term: c.Term, wanted: Type | None, scope: Scope) -> c.Term:
    if wanted is None or term.type is None or term.type == wanted:
        return term
    if term.type.name == wanted.name == "number":
        if "" not in (term.type.unit, wanted.unit):
            scope.findings.add(
                "error",
                "unit-mismatch",
                f"`{term.text}` is in [{term.type.unit}]; wanted is [{wanted.unit}]",
                term.span,
            )
            return term
        if term.type.unit == "" and term.kind == "number":
            scope.findings.add(
                "warning", "bare-number", f"`{term.text}` has no unit; it is read in [{wanted.unit}]", term.span
            )
            return replace(term, type=wanted)
        return term
    scope.findings.add("error", "type-mismatch", f"`{term.text}` is of type {term.type}; wanted is {wanted}", term.span)
    return term


def _call(call: p.Call, scope: Scope, wanted: Type | None, what: str) -> c.Term:
    function = scope.function(call.name, call.span, what)
    parameters: tuple[Type | None, ...] = (None,) * len(call.arguments)
    kind = wanted
    if function is None and wanted is not None:
        scope.take_for(call.name, wanted, call.span)
    if function is not None:
        kind = function.type
        if len(function.parameters) != len(call.arguments):
            scope.findings.add(
                "error", "wrong-arity",
                f"`{call.name}` takes {arguments_said(len(function.parameters))}, here {_are(len(call.arguments))}",
                call.span,
            )  # fmt: skip
        else:
            parameters = function.parameters
        if what == "condition" and kind is not None and kind != BOOL:
            scope.findings.add(
                "error", "type-mismatch", f"`{call.name}` is of type {kind}; a condition is a bool", call.span
            )
    arguments = tuple(
        _argument(argument, parameter, scope) for argument, parameter in zip(call.arguments, parameters, strict=True)
    )
    if call.name == COMPETENCE_FAILED.name and len(arguments) == 1:
        _known_competence(arguments[0], scope)
    return c.Term("call", call.name, arguments, None, kind, call.span)


def arguments_said(number: int) -> str:
    """How many arguments, as messages say it."""
    return "no arguments" if number == 0 else "1 argument" if number == 1 else f"{number} arguments"


def _are(number: int) -> str:
    return "is 1" if number == 1 else f"are {number}"


def _known_competence(argument: c.Term, scope: Scope) -> None:
    commands = [f.name for f in scope.functions.values() if f.type is not None and f.type.name == "command"]
    if argument.name not in commands and commands:
        meant = close(argument.name, commands)
        scope.findings.add(
            "error" if meant else "note", "misspelt" if meant else "undeclared",
            f"no competence is called `{argument.name}`", argument.span,
            hint=f"did you mean `{meant}`?" if meant else "",
        )  # fmt: skip


def resolve_outputs(plan: p.Plan, scope: Scope, top: g.Goal | None) -> tuple[g.Output, ...]:
    """The channels in the order in which they are filled: declared ones first, others as they appear (L25)."""
    outputs = {
        d.name: g.Output(
            d.name, d.type,
            None if d.idle is None else resolve_value(d.idle, d.type, scope), d.hold,
            None if d.initial is None else resolve_value(d.initial, d.type, scope), d.span, d.required,
        )
        for d in plan.outputs
    }  # fmt: skip
    for node in () if top is None else g.walk(top):
        if isinstance(node, g.Do) and node.output not in outputs:
            outputs[node.output] = g.Output(node.output, node.value.type, None, False, None, node.span)
    return tuple(outputs.values())


def resolve_settings(plan: p.Plan, scope: Scope) -> tuple[g.BoundLibrary, ...]:
    """Every library in use with the values of its parameters, defaults where the plan is silent."""
    bound = []
    for use in plan.uses:
        if use.library not in scope.libraries:
            continue
        known = {parameter.name: parameter for parameter in scope.libraries[use.library].parameters}
        values: dict[str, float | bool | str] = {name: parameter.default for name, parameter in known.items()}
        for setting in use.settings:
            if setting.name not in known:
                meant = close(setting.name, list(known))
                hint = f"did you mean `:{meant}`?" if meant else f"it has: {', '.join(known) or 'none'}"
                scope.findings.add(
                    "error", "unknown-parameter", f"`{use.library}` has no parameter `:{setting.name}`", setting.span,
                    hint=hint,
                )  # fmt: skip
                continue
            value = _setting(setting, known[setting.name], scope)
            if value is not None:
                values[setting.name] = value
        bound.append(g.BoundLibrary(use.library, values, use.span))
    return tuple(bound)


def _setting(setting: p.Setting, parameter: ParameterSignature, scope: Scope) -> float | bool | str | None:
    match setting.value:
        case p.Number() | p.Truth():
            term = _fitting(resolve_value(setting.value, None, scope), parameter.type, scope)
            return term.value
        case p.Call(name, ()) if parameter.type.name == "symbol":
            return name
        case p.Call(span=span) | p.Variable(span=span):
            scope.findings.add("error", "type-mismatch", f"`:{setting.name}` wants {parameter.type}", span)
            return None
