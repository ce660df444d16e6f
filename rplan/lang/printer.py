"""A `Plan` and its parts as text; `parse` reads it back to the same plan, up to places.

Takes: syntax. Gives: canonical text of values and conditions (L21), goals on one line, plans laid out. Leaves alone:
places, comments, and how the text was first written (`when` and `cond` come out as `if`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rplan.lang.depth import deep_recursion
from rplan.lang.plan import (
    Achieve,
    AllOf,
    And,
    AnyOf,
    Anything,
    Argument,
    Arithmetic,
    Call,
    Compare,
    Condition,
    Declaration,
    Do,
    Goal,
    Header,
    If,
    Memory,
    NamedCondition,
    Not,
    Number,
    Operator,
    Or,
    OutputDeclaration,
    OutputIs,
    Plan,
    PlanTest,
    PrioAnd,
    Property,
    Rule,
    Setting,
    Step,
    Subgoal,
    TopGoal,
    Truth,
    Type,
    Use,
    Variable,
)
from rplan.lang.units import canonical_number

WIDTH = 100
NARROWEST = 40
"""Room that is left for a line however far it is indented."""

Sexp = str | tuple["Sexp", ...]
"""An S-expression yet to be laid out."""


def canonical(expression: Argument) -> str:
    """The canonical text (L21): `(name arg)` for a call, also without arguments; `true`; `7.62m`."""
    with deep_recursion():
        return _flat(_condition(expression))


def print_condition(condition: Condition) -> str:
    """The condition on one line."""
    return canonical(condition)


def print_goal(goal: Goal) -> str:
    """The goal on one line."""
    with deep_recursion():
        return _flat(_goal(goal))


def print_plan(plan: Plan) -> str:
    """The whole plan, forms in the order header, uses, declarations, outputs, conditions, rules, top goal."""
    with deep_recursion():
        return "".join(f"{_laid_out(form, 0)}\n" for form in _forms(plan))


def quoted(text: str) -> str:
    """The text as a string of a plan."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
    return f'"{escaped}"'


# --- syntax to S-expressions ----------------------------------------------------------------------


def _condition(condition: Argument) -> Sexp:
    match condition:
        case Number(value=value, unit=unit):
            return canonical_number(value, unit)
        case Truth(value=truth):
            return "true" if truth else "false"
        case Call(name=name, arguments=arguments):
            return (name, *[_condition(argument) for argument in arguments])
        case Not(condition=inner):
            return ("not", _condition(inner))
        case AllOf(conditions=members):
            return ("and", *[_condition(member) for member in members])
        case AnyOf(conditions=members):
            return ("or", *[_condition(member) for member in members])
        case Compare(operator=operator, left=left, right=right):
            return (operator, _condition(left), _condition(right))
        case Arithmetic(operator=operator, operands=operands):
            return (operator, *[_condition(operand) for operand in operands])
        case Memory():
            return _memory(condition)
        case OutputIs(output=output, value=value):
            return ("=", output, _condition(value)) if value else ("open", output)
        case Variable(name=name):
            return f"?{name}"


def _memory(memory: Memory) -> Sexp:
    parts: list[Sexp] = [memory.form]
    match memory.form:
        case "delay":
            parts.append("true" if memory.initial else "false")
        case "held-for" | "within" if memory.duration:
            parts.append(_condition(memory.duration))
        case "at-least":
            parts.append(str(memory.count))
    parts += [_condition(one) for one in memory.conditions]
    if memory.form == "at-least" and len(memory.conditions) == 2:
        parts.insert(-1, ":reset")
    return tuple(parts)


def _goal(goal: Goal) -> Sexp:
    match goal:
        case Do(output=output, value=value):
            return ("do", output, _condition(value))
        case Anything():
            return ("do", "anything")
        case If(condition=condition, then=then, otherwise=otherwise):
            return ("if", _condition(condition), _goal(then), _goal(otherwise))
        case And(goals=goals):
            return ("and", *[_goal(member) for member in goals])
        case Or(goals=goals):
            return ("or", *[_goal(member) for member in goals])
        case PrioAnd(goals=goals):
            return ("prio-and", *[_goal(member) for member in goals])
        case Subgoal(kind=kind, name=name, arguments=arguments, depth=depth):
            return (kind, name, *[_condition(argument) for argument in arguments], *_depth(depth))
        case Achieve(condition=condition, depth=depth):
            return ("ach", _condition(condition), *_depth(depth))


def _depth(depth: int | None) -> tuple[str, ...]:
    return () if depth is None else (":depth", str(depth))


def _forms(plan: Plan) -> Iterator[Sexp]:
    yield _header(plan.header)
    yield from map(_use, plan.uses)
    yield from map(_declaration, plan.declarations)
    yield from map(_output, plan.outputs)
    yield from map(_named_condition, plan.conditions)
    yield from map(_rule, plan.rules)
    yield from map(_operator, plan.operators)
    if plan.top:
        yield _top(plan.top)
    yield from map(_property, plan.properties)
    for assumption in plan.assumptions:
        yield ("assume", _condition(assumption.condition))
    yield from map(_test, plan.tests)


def _doc(doc: str) -> tuple[str, ...]:
    return (quoted(doc),) if doc else ()


def _header(header: Header) -> Sexp:
    return ("plan", header.name, *_doc(header.doc), ":period", canonical_number(header.period, "s"))


def _use(use: Use) -> Sexp:
    def pair(setting: Setting) -> tuple[Sexp, Sexp]:
        return f":{setting.name}", _condition(setting.value)

    return ("use", use.library, *[part for setting in use.settings for part in pair(setting)])


def _type(kind: Type) -> Sexp:
    return ("number", kind.unit) if kind.name == "number" and kind.unit else kind.name


def _declaration(declaration: Declaration) -> Sexp:
    parameters: list[Sexp] = [(name, _type(kind)) for name, kind in declaration.parameters]
    return ("declare", (declaration.name, *parameters), _type(declaration.type), *_doc(declaration.doc))


def _output(output: OutputDeclaration) -> Sexp:
    options: list[Sexp] = []
    if output.idle:
        options += [":idle", _condition(output.idle)]
    if output.hold:
        options.append(":hold")
    if output.initial:
        options += [":initial", _condition(output.initial)]
    if output.required:
        options.append(":required")
    return ("defoutput", output.name, _type(output.type), *options)


def _named_condition(named: NamedCondition) -> Sexp:
    return ("defcond", _signature(named.name, named.parameters), *_doc(named.doc), _condition(named.condition))


def _signature(name: str, parameters: Sequence[str]) -> Sexp:
    return (name, *[f"?{parameter}" for parameter in parameters])


def _rule(rule: Rule) -> Sexp:
    return ("defgoalr", _head(rule), *_doc(rule.doc), _goal(rule.goal))


def _head(rule: Rule) -> Sexp:
    return (rule.kind, rule.name, *[_condition(parameter) for parameter in rule.parameters])


def print_head(rule: Rule) -> str:
    """`(ach NAME ARG…)` as canonical text."""
    return _flat(_head(rule))


def _operator(operator: Operator) -> Sexp:
    parts: list[Sexp] = [
        ":do",
        (operator.output, _condition(operator.value)),
        ":pre",
        _condition(operator.precondition),
    ]
    parts += [":add", tuple(map(_condition, operator.adds)), ":del", tuple(map(_condition, operator.deletes))]
    return ("defop", _signature(operator.name, operator.parameters), *_doc(operator.doc), *parts)


def _property(one: Property) -> Sexp:
    provided: tuple[Sexp, ...] = (":provided", _condition(one.provided)) if one.provided else ()
    return ("defproperty", one.name, *_doc(one.doc), ":always", _condition(one.always), *provided)


def _test(test: PlanTest) -> Sexp:
    return ("deftest", test.name, *_doc(test.doc), *map(_step, test.steps))


def _step(step: Step) -> Sexp:
    parts: list[Sexp] = [":times", str(step.times)] if step.times != 1 else []
    if step.given:
        parts += [":given", tuple((_condition(one.percept), _condition(one.value)) for one in step.given)]
    if step.expected:
        expected = tuple((one.output, _condition(one.value) if one.value else "open") for one in step.expected)
        parts += [":expect", expected]
    return ("tick", *parts, *((":hole", "true") if step.hole else ()))


def _top(top: TopGoal) -> Sexp:
    return ("goalem", _goal(top.goal))


# --- S-expressions to text ------------------------------------------------------------------------


def _flat(sexp: Sexp) -> str:
    return sexp if isinstance(sexp, str) else f"({' '.join([_flat(part) for part in sexp])})"


def _fits(sexp: Sexp, room: int) -> int:
    """How much of the room is left beside the flat text; below 0 where it does not fit."""
    if isinstance(sexp, str):
        return room - len(sexp)
    room -= 1 + len(sexp)
    for part in sexp:
        if room < 0:
            return room
        room = _fits(part, room)
    return room


def _laid_out(sexp: Sexp, indent: int) -> str:
    """On one line where it fits; else the words before the first list stay, and the other parts get a line each."""
    if isinstance(sexp, str) or _fits(sexp, max(WIDTH - indent, NARROWEST)) >= 0:
        return _flat(sexp)
    lead = next((i for i, part in enumerate(sexp) if i and not isinstance(part, str)), len(sexp))
    lead += sexp[0] in ("defgoalr", "defcond", "declare")
    start = f"({' '.join([_flat(part) for part in sexp[:lead]])}"
    margin = "\n" + " " * (indent + 2)
    return start + "".join([margin + _laid_out(part, indent + 2) for part in sexp[lead:]]) + ")"
