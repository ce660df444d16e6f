"""Forms to a `Plan` (the table of the top level, L8, L9, L12-L17, L20).

Takes: forms and the source they come from. Gives: a `Plan` and warnings, or every error at once. Leaves alone: whether
names exist and types fit.

An error leaves a placeholder in its place, so that the rest is still checked and one mistake is told once; a plan with
an error is thrown away at the end.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import PurePath
from typing import Literal, TypeVar

from rplan.lang.depth import MAX_LEVELS, deep_recursion
from rplan.lang.diagnostic import Diagnostic, PlanError, Related
from rplan.lang.include import Gathered
from rplan.lang.plan import (
    Achieve,
    AllOf,
    And,
    AnyOf,
    Anything,
    Argument,
    Arithmetic,
    ArithmeticOperator,
    Assumption,
    Call,
    Comparator,
    Compare,
    Condition,
    Declaration,
    Do,
    Expected,
    Expression,
    Given,
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
    Past,
    Plan,
    PlanTest,
    PrioAnd,
    Property,
    Quantity,
    Rule,
    Setting,
    Step,
    Subgoal,
    TopGoal,
    Truth,
    Type,
    Use,
)
from rplan.lang.plan import Variable as Parameter
from rplan.lang.printer import canonical
from rplan.lang.reader import (
    TOP_FORMS,
    Broken,
    Form,
    Keyword,
    ListForm,
    Numeral,
    Symbol,
    Text,
    Variable,
    capped,
    read_with_errors,
)
from rplan.lang.source import Source, Span
from rplan.lang.suggest import close
from rplan.lang.units import SI_UNITS, UNITS, dimension

GOAL_FORMS = ("do", "if", "when", "cond", "and", "or", "prio-and", "ach", "maint")
COMPARATORS: tuple[Comparator, ...] = ("<", "<=", ">", ">=", "=", "/=")
MEMORY_FORMS: tuple[Past, ...] = (
    "delay", "once", "historically", "since", "latch", "rose", "fell", "held-for", "within", "at-least",
)  # fmt: skip
OPERATORS: tuple[ArithmeticOperator, ...] = ("+", "-", "*", "/", "min", "max", "abs")
CONDITION_FORMS = ("not", "and", "or", *COMPARATORS, *MEMORY_FORMS)
TYPES = ("bool", "number", "pose", "command", "symbol")
DEFAULT_PERIOD = 0.1
"""The length of a tick [s] where the plan tells none."""

_TRUTHS = ("true", "false")
_RESERVED = (*_TRUTHS, "anything", "else", *TOP_FORMS, *GOAL_FORMS, *CONDITION_FORMS, *OPERATORS)

_TAKES = {
    "plan": "a name",
    "use": "the name of a library and its parameters",
    "declare": "`(NAME (ARGUMENT TYPE)...)`, a type and perhaps a text",
    "defoutput": "a name and a type",
    "defcond": "`(NAME ?ARG...)`, perhaps a text, and a condition",
    "defgoalr": "`(ach NAME ARG...)` or `(maint NAME ARG...)`, perhaps a text, and a goal",
    "defop": "`(NAME ?ARG...)`, perhaps a text, and `:do`, `:pre`, `:add`, `:del`",
    "defproperty": "a name, perhaps a text, `:always CONDITION` and perhaps `:provided CONDITION`",
    "assume": "a condition",
    "deftest": "a name, perhaps a text, and one or more steps `(tick ...)`",
    "tick": "`:times`, `:given`, `:expect` and `:hole`, and nothing else",
    "goalem": "a goal",
    "goallem": "a goal",
    "do": "an output and a value, or is `(do anything)`",
    "if": "a condition, a goal and an else goal",
    "when": "a condition and a goal",
    "cond": "one or more clauses `(CONDITION GOAL)`, at last perhaps `(else GOAL)`",
    "ach": "the name of a goal and its arguments, or a condition",
    "maint": "the name of a goal and its arguments",
    "not": "a condition",
    "delay": "a first value (`true` or `false`) and a condition",
    "once": "a condition",
    "historically": "a condition",
    "since": "a condition, and the condition since which it holds",
    "latch": "a condition that sets and one that resets",
    "rose": "a condition",
    "fell": "a condition",
    "held-for": "a time and a condition",
    "within": "a time and a condition",
    "at-least": "a number of ticks and a condition, and perhaps `:reset CONDITION`",
}
_HINTS = {
    ("if", 2): "use `when` for an if without else",
    ("when", 3): "use `if` for a when with an else goal",
    ("defgoalr", 3): "join goals with `and`, `or` or `prio-and`",
    ("goalem", 2): "join goals with `and`, `or` or `prio-and`",
    ("goallem", 2): "join goals with `and`, `or` or `prio-and`",
    ("not", 2): "join conditions with `and` or `or`",
}

Kind = Literal["ach", "maint"]
Parsed = TypeVar("Parsed")
Named = TypeVar("Named", Use, Declaration, OutputDeclaration, NamedCondition, Operator, Property, PlanTest)


def parse(forms: Sequence[Form], source: Source) -> tuple[Plan, tuple[Diagnostic, ...]]:
    """The plan that the forms make up, and warnings. Raises PlanError with every error and warning."""
    parser = _Parser(source)
    with deep_recursion():
        plan = parser.plan(forms)
    return _plan_or_error(plan, sorted(parser.found, key=lambda diagnostic: diagnostic.span))


def parse_text(source: Source) -> tuple[Plan, tuple[Diagnostic, ...]]:
    """`read` and `parse` in one, so that errors of the text and errors of the forms are told together.

    What the text includes is left alone; see `parse_gathered`.
    """
    forms, errors = read_with_errors(source)
    plan, found = parse_gathered(Gathered([*forms], [source], [*errors]))
    return _plan_or_error(plan, found)


def parse_gathered(gathered: Gathered) -> tuple[Plan, tuple[Diagnostic, ...]]:
    """The plan of a text and of all that it includes, and everything found, in the order of the files.

    What is wrong has a placeholder in the plan, so that the rest can be looked at. Raises PlanError where nothing could
    be read.
    """
    if gathered.errors and not gathered.forms:
        raise PlanError(capped(gathered.errors))
    parser = _Parser(gathered.sources[0])
    with deep_recursion():
        plan = parser.plan(gathered.forms)
    order = {source.name: number for number, source in enumerate(gathered.sources)}
    found = [*gathered.errors, *parser.found]
    return plan, tuple(sorted(found, key=lambda one: (order.get(one.span.file, 0), one.span)))


def _plan_or_error(plan: Plan, found: Iterable[Diagnostic]) -> tuple[Plan, tuple[Diagnostic, ...]]:
    inorder = tuple(found)
    if any(diagnostic.severity == "error" for diagnostic in inorder):
        raise PlanError(capped(inorder))
    return plan, inorder


@dataclass(frozen=True, slots=True)
class _Option:
    """`:name value`; value is None for a keyword that takes none."""

    keyword: Keyword
    value: Form | None


class _Parser:
    """Each method takes a form, notes what is wrong with it in `found`, and gives what it says or a placeholder.

    level: how many parentheses are open around the printed text of what is parsed. bound: the variables of the head
    whose body is parsed. of_outputs: whether conditions may ask outputs here.
    """

    def __init__(self, source: Source) -> None:
        self.source = source
        self.found: list[Diagnostic] = []
        self.bound: tuple[str, ...] = ()
        self.of_outputs = False

    def error(self, code: str, message: str, span: Span, hint: str = "", related: tuple[Related, ...] = ()) -> None:
        self.found.append(Diagnostic(code, "error", message, span, related, hint))

    # --- the whole ---

    def plan(self, forms: Sequence[Form]) -> Plan:
        if not forms:
            hint = "a plan has rules `(defgoalr (ach NAME) GOAL)` and a top goal `(goalem GOAL)`"
            self.error("empty-plan", "the plan is empty", Span(self.source.name, 1, 1, 1, 1), hint)
        start = forms[0].span if forms else Span(self.source.name, 1, 1, 1, 1)
        heads = [(_head(form), form) for form in forms]
        self._strays(heads)

        def every(parse_one: Callable[[ListForm], Parsed], *names: str) -> tuple[Parsed, ...]:
            return tuple(parse_one(form) for head, form in heads if head in names and isinstance(form, ListForm))

        headers = every(self.header, "plan")
        tops = every(self.top_goal, "goalem", "goallem")
        self._only_one("plan", "a plan has one header", [header.span for header in headers])
        self._only_one("goalem", "a plan has one top goal", [top.span for top in tops])
        return Plan(
            headers[0] if headers else Header(_name_of_file(self.source.name), "", DEFAULT_PERIOD, start),
            self._distinct("library", _once([(use.library, use) for use in every(self.use, "use")])),
            self._distinct("function", [(one.name, one) for one in every(self.declaration, "declare")]),
            self._distinct("output", [(one.name, one) for one in every(self.output, "defoutput")]),
            self._distinct("condition", [(one.name, one) for one in every(self.named_condition, "defcond")]),
            every(self.rule, "defgoalr"),
            tops[0] if tops else None,
            start,
            self._distinct("operator", [(one.name, one) for one in every(self.operator, "defop")]),
            self._distinct("property", [(one.name, one) for one in every(self.property, "defproperty")]),
            every(self.assumption, "assume"),
            self._distinct("test", [(one.name, one) for one in every(self.test, "deftest")]),
        )

    def _strays(self, heads: Sequence[tuple[str | None, Form]]) -> None:
        """Report what is no form of the top level; words in a row count as one."""
        words: list[Form] = []
        for head, form in heads:
            if not isinstance(form, ListForm):
                words.append(form)
                continue
            self._stray_words(words)
            words = []
            if head is None:
                self._no_head(form, "a form", TOP_FORMS)
            elif head in GOAL_FORMS:
                hint = "a rule begins with `defgoalr`, the top goal with `goalem`"
                self.error("misplaced-form", f"a goal `({head} ...)` stands outside of a rule", form.span, hint)
            elif head not in TOP_FORMS:
                self._unknown(head, form, "form", TOP_FORMS)
        self._stray_words(words)

    def _stray_words(self, words: Sequence[Form]) -> None:
        said = [word for word in words if not isinstance(word, Broken)]
        if said:
            first, last = said[0].span, said[-1].span
            span = Span(first.file, first.line, first.column, last.end_line, last.end_column)
            what = "a word stands" if len(said) == 1 else f"{len(said)} words stand"
            self.error("stray-word", f"{what} outside of every form", span, _known("form", TOP_FORMS))

    def _only_one(self, code_word: str, message: str, spans: Sequence[Span]) -> None:
        for span in spans[1:]:
            self.error("duplicate", f"{message}: this is another `{code_word}`", span, "", _first(spans[0]))

    def _distinct(self, what: str, named: Sequence[tuple[str, Named]]) -> tuple[Named, ...]:
        seen: dict[str, Span] = {}
        for name, one in named:
            if name in seen and name:
                self.error("duplicate", f"the {what} `{name}` is there twice", one.span, "", _first(seen[name]))
            seen.setdefault(name, one.span)
        return tuple(one for _, one in named)

    # --- the top level ---

    def header(self, form: ListForm) -> Header:
        rest, options = self._split(form.items[1:], ("period",))
        doc, rest = self._without_doc(rest, 1)
        name = self._name(rest[0], "a plan") if self._count("plan", form, rest, 1) else ""
        option = options.get("period")
        period = self._period(option.value) if option and option.value else DEFAULT_PERIOD
        return Header(name, doc, period, form.span)

    def _period(self, form: Form) -> float:
        if not isinstance(form, Numeral):
            self._unexpected(form, "a time such as `0.1s`", "bad-value")
        elif form.unit not in ("s", ""):
            message = f"`:period` is a time, `{form.text}` is a {dimension(form.unit)}"
            self.error("unit-mismatch", message, form.span, "times have the units `s`, `ms` or `min`")
        elif form.value <= 0:
            self.error("bad-value", "`:period` is a time longer than nothing", form.span)
        else:
            if not form.unit:
                self._bare_seconds(form)
            return form.value
        return DEFAULT_PERIOD

    def use(self, form: ListForm) -> Use:
        rest, options = self._split(form.items[1:], None)
        library = self._name(rest[0], "a library") if self._count("use", form, rest, 1) else ""
        settings = tuple(
            Setting(name, self.expression(option.value), _join(option.keyword.span, option.value.span))
            for name, option in options.items()
            if option.value
        )
        return Use(library, settings, form.span)

    def declaration(self, form: ListForm) -> Declaration:
        doc, rest = self._without_doc(form.items[1:], 2)
        if not self._count("declare", form, rest, 2):
            return Declaration("", (), Type("bool"), doc, form.span)
        signature = rest[0].items if isinstance(rest[0], ListForm) else (rest[0],)
        if not signature:
            self._no_head(rest[0], "a function")
        name = self._new_name(signature[0], "a function") if signature else ""
        parameters = tuple(self._parameter(one) for one in signature[1:])
        self._distinct_parameters(signature[1:], parameters)
        return Declaration(name, parameters, self._type(rest[1]), doc, form.span)

    def _parameter(self, form: Form) -> tuple[str, Type]:
        if isinstance(form, ListForm) and len(form.items) == 2:
            return self._name(form.items[0], "an argument"), self._type(form.items[1])
        self._unexpected(form, "an argument `(NAME TYPE)`", "wrong-parts")
        return "", Type("bool")

    def _distinct_parameters(self, forms: Sequence[Form], parameters: Sequence[tuple[str, Type]]) -> None:
        seen: dict[str, Span] = {}
        for form, (name, _) in zip(forms, parameters, strict=True):
            if name and name in seen:
                self.error("duplicate", f"the argument `{name}` is there twice", form.span, "", _first(seen[name]))
            seen.setdefault(name, form.span)

    def _type(self, form: Form) -> Type:
        match form:
            case Symbol(name=name) if name in TYPES:
                return Type(name)
            case Symbol(name=name, span=span):
                self._unknown_type(name, span)
            case ListForm(items=(Symbol(name="number"), Symbol(name=unit, span=span))):
                return self._number_type(unit, span)
            case _:
                self._unexpected(form, "a type", "unknown-type", _TYPES_HINT)
        return Type("bool")

    def _unknown_type(self, name: str, span: Span) -> None:
        if name in UNITS:
            self.error("unknown-type", f"`{name}` is a unit, not a type", span, f"write `(number {UNITS[name].si})`")
        else:
            meant = close(name, TYPES, shortest=3)
            hint = f"did you mean `{meant}`? {_TYPES_HINT}" if meant else _TYPES_HINT
            self.error("unknown-type", f"`{name}` is not a type", span, hint)

    def _number_type(self, unit: str, span: Span) -> Type:
        if unit in SI_UNITS:
            return Type("number", unit)
        hint = f"the units of types: {' '.join(SI_UNITS)}"
        if unit in UNITS:
            hint = f"numbers are kept in SI: write `(number {UNITS[unit].si})`"
        self.error("unknown-unit", f"`{unit}` is not a unit of a type", span, hint)
        return Type("number")

    def output(self, form: ListForm) -> OutputDeclaration:
        rest, options = self._split(form.items[1:], ("idle", "hold", "initial", "required"), flags=("hold", "required"))
        name, kind = "", Type("bool")
        if self._count("defoutput", form, rest, 2):
            name, kind = self._new_name(rest[0], "an output"), self._type(rest[1])
        hold, idle, initial = options.get("hold"), options.get("idle"), options.get("initial")
        self._outdone(options.get("required"), idle or hold)
        if hold and idle:
            message = "`:idle` and `:hold` exclude each other"
            related = (Related("`:hold` is here", hold.keyword.span),)
            self.error(
                "bad-option", message, idle.keyword.span, "for a first value of `:hold` write `:initial`", related
            )
        if initial and not hold and not idle:
            self.error("bad-option", "`:initial` goes with `:hold`", initial.keyword.span)
        elif initial and not hold:
            self.error("bad-option", "`:initial` goes with `:hold`, not with `:idle`", initial.keyword.span)
        required = "required" in options
        idle_value, initial_value = self._value_of(idle), self._value_of(initial)
        return OutputDeclaration(name, kind, idle_value, hold is not None, initial_value, form.span, required)

    def _outdone(self, required: _Option | None, other: _Option | None) -> None:
        if required and other:
            word = f"`:{other.keyword.name}`"
            message = f"`:required` lets no tick leave it open, so that {word} says nothing"
            related = (Related(f"{word} is here", other.keyword.span),)
            self.error("bad-option", message, required.keyword.span, "leave one of them out", related)

    def _value_of(self, option: _Option | None) -> Expression | None:
        return self.expression(option.value) if option and option.value else None

    def named_condition(self, form: ListForm) -> NamedCondition:
        head, doc, rest = self._head_doc_body(form)
        if not self._count("defcond", form, rest, 2):
            return NamedCondition("", (), doc, Truth(False, form.span), form.span)
        name, parameters = self._signature(head, "a condition")
        return NamedCondition(name, parameters, doc, self._body(rest[1], parameters, self.condition), form.span)

    def _signature(self, head: Form, owner: str) -> tuple[str, tuple[str, ...]]:
        """`(NAME ?ARG...)` or `NAME`: the name, and the variables without their question marks."""
        match head:
            case ListForm(items=(first, *rest)):
                variables = [one for one in rest if isinstance(one, Variable)]
                for one in rest:
                    if not isinstance(one, Variable):
                        self._unexpected(one, "a variable such as `?place`", "wrong-parts")
                self._distinct_variables(variables)
                return self._new_name(first, owner), tuple(variable.name for variable in variables)
            case ListForm():
                self._no_head(head, owner)
                return "", ()
            case _:
                return self._new_name(head, owner), ()

    def _distinct_variables(self, variables: Sequence[Variable]) -> None:
        seen: dict[str, Span] = {}
        for variable in variables:
            if variable.name in seen:
                first = _first(seen[variable.name])
                self.error("duplicate", f"the variable `?{variable.name}` is there twice", variable.span, "", first)
            seen.setdefault(variable.name, variable.span)

    def _body(self, form: Form, parameters: tuple[str, ...], parse_one: Callable[[Form], Parsed]) -> Parsed:
        """What a definition with these variables says."""
        self.bound = parameters
        try:
            return parse_one(form)
        finally:
            self.bound = ()

    def rule(self, form: ListForm) -> Rule:
        head, doc, rest = self._head_doc_body(form)
        if not self._count("defgoalr", form, rest, 2):
            return Rule("ach", "", (), doc, Anything(form.span), head.span, form.span)
        kind, name, parameters = self._rule_head(head)
        variables = tuple(one.name for one in parameters if isinstance(one, Parameter))
        goal = self._body(rest[1], variables, lambda body: self.goal(body, 2))
        return Rule(kind, name, parameters, doc, goal, head.span, form.span)

    def _head_doc_body(self, form: ListForm) -> tuple[Form, str, tuple[Form, ...]]:
        """What a definition defines, its text, and all parts without that text."""
        rest = form.items[1:]
        if len(rest) > 2 and isinstance(rest[1], Text):
            return rest[0], rest[1].value, (rest[0], *rest[2:])
        return rest[0] if rest else form, "", rest

    def _rule_head(self, form: Form) -> tuple[Kind, str, tuple[Argument, ...]]:
        """kind, name and parameters; a variable is a parameter, everything else is parsed without variables."""
        match form:
            case ListForm(items=(Symbol(name="ach" | "maint" as kind), *rest)):
                name, parts = self._named_parts(kind, form, rest)
                self._distinct_variables([part for part in parts if isinstance(part, Variable)])
                parameters = tuple(
                    Parameter(part.name, part.span) if isinstance(part, Variable) else self.argument(part)
                    for part in parts
                )
                return "ach" if kind == "ach" else "maint", name, parameters
            case _:
                hint = "rules are for `(ach NAME)` or `(maint NAME)`"
                self._unexpected(form, "`(ach NAME)` or `(maint NAME)`", "bad-head", hint)
                return "ach", "", ()

    def _named_parts(self, kind: str, form: ListForm, rest: Sequence[Form]) -> tuple[str, Sequence[Form]]:
        """Name and arguments of `(ach NAME ARG...)` and `(ach (NAME ARG...))`."""
        match rest:
            case (ListForm(items=(Symbol(name=name, span=span), *arguments)),):
                if name in _RESERVED:
                    self.error("misplaced-form", f"`{name}` is {_what_is(name)}; here a goal is named", span)
                    return "", ()
                return name, arguments
            case (name_form, *arguments):
                return self._goal_name(name_form), arguments
            case _:
                self._count(kind, form, rest, 1)
                return "", ()

    def _goal_name(self, form: Form) -> str:
        """A goal without arguments may be called as a form of the language; `(ach and x)` is a slip."""
        if isinstance(form, Symbol) and form.name in CONDITION_FORMS:
            hint = f"a condition stands in parentheses: `(ach ({form.name} …))`"
            self.error("reserved-name", f"`{form.name}` makes a condition and cannot name a goal", form.span, hint)
            return ""
        return self._name(form, "a goal")

    def operator(self, form: ListForm) -> Operator:
        rest, options = self._split(form.items[1:], ("do", "pre", "add", "del"))
        doc, rest = self._without_doc(rest, 1)
        counted = self._count("defop", form, rest, 1)
        name, parameters = self._signature(rest[0], "an operator") if counted else ("", ())
        if "do" not in options:
            self.error("wrong-parts", "an operator says what it does: `:do (OUTPUT VALUE)`", form.span)
        output, value = self._part(options, "do", parameters, self._assignment) or ("", Truth(False, form.span))
        pre = self._part(options, "pre", parameters, self.condition)
        adds = self._part(options, "add", parameters, self._facts) or ()
        deletes = self._part(options, "del", parameters, self._facts) or ()
        if "add" not in options and "del" not in options:
            self.error("wrong-parts", "an operator says what it changes: `:add (FACT...)`, `:del (FACT...)`", form.span)
        head = rest[0].span if rest else form.span
        return Operator(
            name, parameters, doc, output, value, pre or Truth(True, form.span), adds, deletes, head, form.span
        )

    def _part(
        self, options: Mapping[str, _Option], name: str, bound: tuple[str, ...], parse_one: Callable[[Form], Parsed]
    ) -> Parsed | None:
        """The value of an option, None where there is none."""
        option = options.get(name)
        return self._body(option.value, bound, parse_one) if option and option.value else None

    def _assignment(self, form: Form) -> tuple[str, Expression]:
        match form:
            case ListForm(items=(output, value)):
                return self._name(output, "an output"), self.expression(value)
            case _:
                self._unexpected(form, "`(OUTPUT VALUE)`", "wrong-parts")
                return "", Truth(False, form.span)

    def _facts(self, form: Form) -> tuple[Call, ...]:
        if not isinstance(form, ListForm):
            self._unexpected(form, "a list of facts `(FACT...)`", "wrong-parts")
            return ()
        return tuple(call for one in form.items if (call := self._fact(one)))

    def _fact(self, form: Form) -> Call | None:
        match form:
            case Symbol(name=name) | ListForm(items=(Symbol(name=name), *_)):
                return self._call(form, name, "fact")
            case _:
                self._unexpected(form, "a fact", "not-a-condition")
                return None

    def property(self, form: ListForm) -> Property:
        rest, options = self._split(form.items[1:], ("always", "provided"))
        doc, rest = self._without_doc(rest, 1)
        name = self._name(rest[0], "a property") if self._count("defproperty", form, rest, 1) else ""
        if "always" not in options:
            self.error("wrong-parts", "a property says what must hold: `:always CONDITION`", form.span)
        always = self._part(options, "always", (), self._claim)
        provided = self._part(options, "provided", (), self._claim)
        return Property(name, doc, always or Truth(True, form.span), provided, form.span)

    def assumption(self, form: ListForm) -> Assumption:
        rest = form.items[1:]
        condition = self._claim(rest[0]) if self._count("assume", form, rest, 1) else Truth(True, form.span)
        return Assumption(condition, form.span)

    def _claim(self, form: Form) -> Condition:
        """A condition that may ask outputs."""
        self.of_outputs = True
        try:
            return self.condition(form)
        finally:
            self.of_outputs = False

    def test(self, form: ListForm) -> PlanTest:
        doc, rest = self._without_doc(form.items[1:], 1)
        name = self._name(rest[0], "a test") if self._count("deftest", form, rest, 2, None) else ""
        return PlanTest(name, doc, tuple(step for one in rest[1:] if (step := self._step(one))), form.span)

    def _step(self, form: Form) -> Step | None:
        match form:
            case ListForm(items=(Symbol(name="tick"), *items)):
                rest, options = self._split(items, ("times", "given", "expect", "hole"))
                self._count("tick", form, rest, 0)
            case _:
                self._unexpected(form, "a step `(tick ...)`", "wrong-parts")
                return None
        times = self._part(options, "times", (), lambda value: self._whole(value, "`:times` counts ticks"))
        given = self._part(options, "given", (), lambda value: self._pairs(value, self._given)) or ()
        expected = self._part(options, "expect", (), lambda value: self._pairs(value, self._expected)) or ()
        hole = self._part(options, "hole", (), self._truth)
        return Step(times or 1, given, expected, bool(hole), form.span)

    def _pairs(self, form: Form, parse_one: Callable[[ListForm], Parsed | None]) -> tuple[Parsed, ...]:
        if not isinstance(form, ListForm):
            self._unexpected(form, "a list of pairs", "wrong-parts")
            return ()
        found: list[Parsed] = []
        for one in form.items:
            if not isinstance(one, ListForm) or len(one.items) != 2:
                self._unexpected(one, "a pair of a name and a value", "wrong-parts")
            elif (parsed := parse_one(one)) is not None:
                found.append(parsed)
        return tuple(found)

    def _given(self, form: ListForm) -> Given | None:
        percept, value = form.items
        called = self._fact(percept)
        match value:
            case Symbol(name="true" | "false" as truth):
                given: Number | Truth = Truth(truth == "true", value.span)
            case Numeral(value=number, unit=unit):
                given = Number(number, unit, value.span)
            case _:
                self._unexpected(value, "`true`, `false` or a number", "bad-value")
                return None
        return Given(called, given, form.span) if called else None

    def _expected(self, form: ListForm) -> Expected:
        output, value = form.items
        match value:
            case Symbol(name="open"):
                return Expected(self._name(output, "an output"), None, form.span)
            case _:
                return Expected(self._name(output, "an output"), self.expression(value), form.span)

    def top_goal(self, form: ListForm) -> TopGoal:
        head = _head(form) or "goalem"
        rest = form.items[1:]
        goal = self.goal(rest[0], 2) if self._count(head, form, rest, 1) else Anything(form.span)
        return TopGoal(goal, form.span)

    # --- goals ---

    def goal(self, form: Form, level: int) -> Goal:
        if level > MAX_LEVELS:
            self.error("too-deep", f"goals nest more than {MAX_LEVELS:,} deep here", form.span)
            return Anything(form.span)
        if not isinstance(form, ListForm):
            return self._no_goal(form)
        match _head(form):
            case "do":
                return self._do(form)
            case "if":
                return self._if(form, level)
            case "when":
                return self._when(form, level)
            case "cond":
                return self._cond(form, level)
            case "and" | "or" | "prio-and" as joint:
                return self._joint(form, joint, level)
            case "ach":
                return self._subgoal(form, "ach")
            case "maint":
                return self._subgoal(form, "maint")
            case None:
                self._no_head(form, "a goal", GOAL_FORMS)
            case str() as head:
                self._unknown_goal(head, form)
        return Anything(form.span)

    def _no_goal(self, form: Form) -> Goal:
        match form:
            case Symbol(name="anything"):
                hint = "write `(do anything)`"
            case Symbol(name=name):
                hint = f"write `(ach {name})`, `(maint {name})` or `(do OUTPUT {name})`"
            case _:
                hint = ""
        self._unexpected(form, "a goal", "not-a-goal", hint)
        return Anything(form.span)

    def _unknown_goal(self, head: str, form: ListForm) -> None:
        if head in TOP_FORMS:
            message = f"`({head} ...)` stands inside of a goal; it belongs to the top level"
            self.error("misplaced-form", message, form.span)
        elif head in CONDITION_FORMS:
            message = f"`({head} ...)` is a condition; here a goal is expected"
            self.error("misplaced-form", message, form.span, "conditions are asked with `if`, `when` and `cond`")
        else:
            self._unknown(head, form, "goal", GOAL_FORMS)

    def _do(self, form: ListForm) -> Goal:
        match form.items[1:]:
            case (Symbol(name="anything"),):
                return Anything(form.span)
            case (Symbol(name="anything"), *_):
                self.error("wrong-parts", "`(do anything)` takes no value", form.span)
            case (output, value):
                return Do(self._name(output, "an output"), self.expression(value), form.span)
            case rest:
                self._count("do", form, rest, 2)
        return Anything(form.span)

    def _if(self, form: ListForm, level: int) -> Goal:
        rest = form.items[1:]
        if not self._count("if", form, rest, 3):
            return self._when_like(rest, form.span, level)
        condition = self.condition(rest[0])
        return If(condition, self.goal(rest[1], level + 1), self.goal(rest[2], level + 1), form.span)

    def _when(self, form: ListForm, level: int) -> Goal:
        rest = form.items[1:]
        self._count("when", form, rest, 2)
        return self._when_like(rest, form.span, level)

    def _when_like(self, rest: Sequence[Form], span: Span, level: int) -> Goal:
        """A condition and a goal, as far as they are there."""
        if len(rest) < 2:
            return Anything(span)
        return If(self.condition(rest[0]), self.goal(rest[1], level + 1), Anything(span), span)

    def _cond(self, form: ListForm, level: int) -> Goal:
        """Nested ifs, each with the place of its clause."""
        clauses = form.items[1:]
        if not self._count("cond", form, clauses, 1, None):
            return Anything(form.span)
        if level + len(clauses) > MAX_LEVELS:
            message = f"with the branches of this `cond`, goals nest more than {MAX_LEVELS:,} deep"
            self.error("too-deep", message, form.span)
            return Anything(form.span)
        branches = [self._clause(clause, level + i) for i, clause in enumerate(clauses)]
        goal: Goal = Anything(form.span)
        for i, branch in reversed(list(enumerate(branches))):
            if branch.condition is not None:
                goal = If(branch.condition, branch.goal, goal, clauses[i].span)
            elif i == len(branches) - 1:
                goal = branch.goal
            else:
                self.error("misplaced-else", "`else` is not the last clause of its `cond`", clauses[i].span)
        return goal

    def _clause(self, form: Form, level: int) -> _Branch:
        match form:
            case ListForm(items=(Symbol(name="else"), body)):
                return _Branch(None, self.goal(body, level))
            case ListForm(items=(condition, body)):
                return _Branch(self.condition(condition), self.goal(body, level + 1))
            case ListForm(items=items):
                self._wrong_parts("a clause of `cond` takes a condition and a goal", form, items)
            case _:
                self._unexpected(form, "a clause `(CONDITION GOAL)`", "wrong-parts")
        return _Branch(Truth(False, form.span), Anything(form.span))

    def _joint(self, form: ListForm, head: str, level: int) -> Goal:
        if len(form.items) == 1:
            self.error("wrong-parts", f"`{head}` joins one or more goals; here are none", form.span)
        goals = tuple(self.goal(one, level + 1) for one in form.items[1:])
        if head == "and":
            return And(goals, form.span)
        return Or(goals, form.span) if head == "or" else PrioAnd(goals, form.span)

    def _subgoal(self, form: ListForm, kind: Kind) -> Goal:
        rest, options = self._split(form.items[1:], ("depth",) if kind == "ach" else ())
        depth = self._part(options, "depth", self.bound, lambda value: self._whole(value, "`:depth` counts steps"))
        match rest:
            case (ListForm(items=(Symbol(name=head), *_)),) if head in CONDITION_FORMS and kind == "ach":
                return Achieve(self.condition(rest[0]), form.span, depth)
        name, parts = self._named_parts(kind, form, rest)
        return Subgoal(kind, name, tuple(self.argument(part) for part in parts), form.span, depth)

    # --- conditions and values ---

    def condition(self, form: Form) -> Condition:
        match form:
            case Symbol(name="true" | "false" as name):
                return Truth(name == "true", form.span)
            case Variable():
                return self._parameter_here(form)
            case Symbol(name=name) | ListForm(items=(Symbol(name=name), *_)):
                pass
            case ListForm():
                self._no_head(form, "a condition")
                return Truth(False, form.span)
            case _:
                self._unexpected(form, "a condition", "not-a-condition")
                return Truth(False, form.span)
        if self.of_outputs and isinstance(form, ListForm) and (asked := self._of_output(form)):
            return asked
        if isinstance(form, ListForm) and name in CONDITION_FORMS:
            return self._compound(form, name)
        called = self._call(form, name, "condition")
        return called if called else Truth(False, form.span)

    def _of_output(self, form: ListForm) -> Condition | None:
        """`(= OUTPUT VALUE)`, `(/= OUTPUT VALUE)` or `(open OUTPUT)`, by the look of it."""
        match form.items:
            case (Symbol(name="open"), Symbol(name=output)):
                return OutputIs(output, None, form.span)
            case (Symbol(name="=" | "/=" as comparator), Symbol(name=output), value) if output not in _RESERVED:
                if isinstance(value, ListForm) and _head(value) in OPERATORS:
                    return None
                asked = OutputIs(output, self.expression(value), form.span)
                return asked if comparator == "=" else Not(asked, form.span)
            case _:
                return None

    def _compound(self, form: ListForm, head: str) -> Condition:
        rest = form.items[1:]
        for comparator in COMPARATORS:
            if head == comparator:
                return self._compare(form, comparator)
        for form_of_memory in MEMORY_FORMS:
            if head == form_of_memory:
                return self._memory(form, form_of_memory)
        if head == "not":
            return (
                Not(self.condition(rest[0]), form.span)
                if self._count("not", form, rest, 1)
                else Truth(False, form.span)
            )
        if not rest:
            self.error("wrong-parts", f"`{head}` joins one or more conditions; here are none", form.span)
        conditions = tuple(self.condition(one) for one in rest)
        return AllOf(conditions, form.span) if head == "and" else AnyOf(conditions, form.span)

    def _memory(self, form: ListForm, head: Past) -> Condition:
        rest, options = self._split(form.items[1:], ("reset",) if head == "at-least" else ())
        wanted = 1 if head in ("once", "historically", "rose", "fell") else 2
        if not self._count(head, form, rest, wanted):
            return Truth(False, form.span)
        match head:
            case "delay":
                return Memory(head, (self.condition(rest[1]),), form.span, initial=self._truth(rest[0]))
            case "held-for" | "within":
                return Memory(head, (self.condition(rest[1]),), form.span, duration=self._duration(rest[0], head))
            case "at-least":
                reset = options.get("reset")
                conditions = [self.condition(rest[1])]
                conditions += [self.condition(reset.value)] if reset and reset.value else []
                return Memory(head, tuple(conditions), form.span, count=self._whole(rest[0], "`at-least` counts ticks"))
            case _:
                return Memory(head, tuple(self.condition(one) for one in rest), form.span)

    def _truth(self, form: Form) -> bool:
        match form:
            case Symbol(name="true" | "false" as name):
                return name == "true"
            case _:
                self._unexpected(form, "`true` or `false`", "bad-value")
        return False

    def _duration(self, form: Form, head: str) -> Number:
        """A time longer than nothing; a bare number is seconds, with a warning."""
        if not isinstance(form, Numeral):
            self._unexpected(form, "a time such as `2s`", "bad-value")
        elif form.unit not in ("s", ""):
            message = f"`{head}` wants a time, `{form.text}` is a {dimension(form.unit)}"
            self.error("unit-mismatch", message, form.span, "times have the units `s`, `ms` or `min`")
        elif form.value <= 0:
            self.error("bad-value", f"`{head}` wants a time longer than nothing", form.span)
        else:
            if not form.unit:
                self._bare_seconds(form)
            return Number(form.value, "s", form.span)
        return Number(1.0, "s", form.span)

    def _bare_seconds(self, form: Numeral) -> None:
        message = f"`{form.text}` has no unit; it is taken as seconds"
        self.found.append(Diagnostic("bare-number", "warning", message, form.span, hint=f"write `{form.text}s`"))

    def _whole(self, form: Form, counts: str) -> int:
        if isinstance(form, Numeral) and not form.unit and form.value >= 1 and form.value == int(form.value):
            return int(form.value)
        if isinstance(form, Numeral):
            self.error("bad-value", f"{counts}: a whole number from 1 up, not `{form.text}`", form.span)
        else:
            self._unexpected(form, "a whole number from 1 up", "bad-value")
        return 1

    def _compare(self, form: ListForm, comparator: Comparator) -> Condition:
        rest = form.items[1:]
        if len(rest) != 2:
            self._wrong_parts(f"`{comparator}` compares two numbers", form, rest)
            return Truth(False, form.span)
        return Compare(comparator, self._operand(rest[0]), self._operand(rest[1]), form.span)

    def _operand(self, form: Form) -> Quantity:
        match form:
            case ListForm(items=(Symbol(name=name), *rest)) if name in OPERATORS:
                return self._arithmetic(form, name, rest)
            case Symbol(name="true" | "false"):
                hint = "a condition is itself true or false; `(not C)` turns it round"
                self._unexpected(form, "a number", "not-a-number", hint)
            case Numeral() | Symbol() | ListForm() | Variable():
                value = self.expression(form)
                if not isinstance(value, Truth):
                    return value
            case _:
                self._unexpected(form, "a number", "not-a-number")
        return Number(0.0, "", form.span)

    def _arithmetic(self, form: ListForm, name: str, rest: Sequence[Form]) -> Quantity:
        operator = next(one for one in OPERATORS if one == name)
        if operator == "abs" and len(rest) != 1:
            self._wrong_parts("`abs` takes one number", form, rest)
        elif operator == "/" and len(rest) != 2:
            self._wrong_parts("`/` takes a number and a divisor", form, rest)
        elif not rest:
            self._wrong_parts(f"`{operator}` takes one or more numbers", form, rest)
        else:
            return Arithmetic(operator, tuple(self._operand(one) for one in rest), form.span)
        return Number(0.0, "", form.span)

    def argument(self, form: Form) -> Argument:
        """What is put in the place of a variable: a value, a condition, or a number that is worked out."""
        match form:
            case ListForm(items=(Symbol(name=name), *rest)) if name in OPERATORS:
                return self._arithmetic(form, name, rest)
            case ListForm(items=(Symbol(name=name), *_)) if name in CONDITION_FORMS:
                return self.condition(form)
            case Symbol(name=name) | ListForm(items=(Symbol(name=name), *_)) if name not in _RESERVED:
                return self._called(form, name, self.argument)
            case _:
                return self.expression(form)

    def expression(self, form: Form) -> Expression:
        match form:
            case Variable():
                return self._parameter_here(form)
            case Numeral(value=value, unit=unit):
                return Number(value, unit, form.span)
            case Symbol(name="true" | "false" as name):
                return Truth(name == "true", form.span)
            case Symbol(name=name) | ListForm(items=(Symbol(name=name), *_)):
                called = self._call(form, name, "value")
                return called if called else Truth(False, form.span)
            case ListForm():
                self._no_head(form, "a value")
            case _:
                self._unexpected(form, "a value", "not-a-value")
        return Truth(False, form.span)

    def _call(self, form: Form, name: str, wanted: str) -> Call | None:
        """A call of `name`, None where the name is a word of the language."""
        if name not in _RESERVED:
            return self._called(form, name, self.argument if wanted == "condition" else self.expression)
        if name in OPERATORS:
            hint = "compare numbers with `<`, `<=`, `>`, `>=`, `=` or `/=`"
            self.error("misplaced-form", f"`{name}` makes a number; here a {wanted} is expected", form.span, hint)
        elif name in _TRUTHS:
            self.error("misplaced-form", f"`{name}` takes no parentheses", form.span, f"write `{name}`")
        else:
            what = _what_is(name)
            self.error("misplaced-form", f"`{name}` is {what}; here a {wanted} is expected", form.span)
        return None

    def _called(self, form: Form, name: str, parse_one: Callable[[Form], Argument]) -> Call:
        parts = form.items[1:] if isinstance(form, ListForm) else ()
        return Call(name, tuple(parse_one(part) for part in parts), form.span)

    # --- parts ---

    def _split(
        self, items: Sequence[Form], known: tuple[str, ...] | None, flags: tuple[str, ...] = ()
    ) -> tuple[tuple[Form, ...], dict[str, _Option]]:
        """Plain parts and options; known: the keywords that may be (None: any), flags: those without a value."""
        plain: list[Form] = []
        options: dict[str, _Option] = {}
        position = 0
        while position < len(items):
            item = items[position]
            position += 1
            if not isinstance(item, Keyword):
                plain.append(item)
                continue
            follows = items[position] if position < len(items) else None
            value = None if item.name in flags or isinstance(follows, Keyword) else follows
            position += value is not None
            self._option(_Option(item, value), options, known, flags)
        return tuple(plain), options

    def _option(
        self, option: _Option, options: dict[str, _Option], known: tuple[str, ...] | None, flags: tuple[str, ...]
    ) -> None:
        keyword = option.keyword
        if known is not None and keyword.name not in known:
            meant = close(keyword.name, known, shortest=3)
            hint = f"did you mean `:{meant}`? " if meant else ""
            hint += "known here: " + " ".join(f"`:{name}`" for name in known)
            self.error("unknown-keyword", f"`:{keyword.name}` is not known here", keyword.span, hint)
        elif keyword.name in options:
            first = options[keyword.name].keyword.span
            self.error("duplicate", f"`:{keyword.name}` is there twice", keyword.span, "", _first(first))
        else:
            if option.value is None and keyword.name not in flags:
                self.error("wrong-parts", f"`:{keyword.name}` takes a value; here is none", keyword.span)
            options[keyword.name] = option

    def _without_doc(self, items: Sequence[Form], at: int) -> tuple[str, tuple[Form, ...]]:
        """The text that stands after `at` parts, if any, and the rest."""
        if len(items) > at and isinstance(doc := items[at], Text):
            return doc.value, (*items[:at], *items[at + 1 :])
        return "", tuple(items)

    def _count(self, head: str, form: ListForm, rest: Sequence[Form], least: int, most: int | None = -1) -> bool:
        """Whether there are as many parts as there must be; most: -1 for as many as least, None for any number."""
        limit = least if most == -1 else most
        if len(rest) >= least and (limit is None or len(rest) <= limit):
            return True
        self._wrong_parts(f"`{head}` takes {_TAKES[head]}", form, rest, _HINTS.get((head, len(rest)), ""))
        return False

    def _name(self, form: Form, owner: str) -> str:
        if isinstance(form, Symbol):
            return form.name
        self._unexpected(form, f"the name of {owner}", "not-a-name")
        return ""

    def _new_name(self, form: Form, owner: str) -> str:
        name = self._name(form, owner)
        if name in _RESERVED:
            self.error("reserved-name", f"`{name}` is a word of the language and cannot name {owner}", form.span)
            return ""
        return name

    # --- what went wrong ---

    def _wrong_parts(self, takes: str, form: Form, parts: Sequence[Form], hint: str = "") -> None:
        if not any(isinstance(part, Broken) for part in parts):
            hint = _spaced_unit(parts) or hint
            self.error("wrong-parts", f"{takes}; here {_parts(len(parts))}", form.span, hint)

    def _unexpected(self, form: Form, wanted: str, code: str, hint: str = "") -> None:
        """One error that something else was wanted here; none where it has been reported already."""
        match form:
            case Broken():
                pass
            case Variable():
                self._variable(form)
            case _:
                self.error(code, f"here stands {_describe(form)}, expected is {wanted}", form.span, hint)

    def _variable(self, variable: Variable) -> None:
        message = f"`?{variable.name}`: no variable may stand here"
        hint = "variables stand in the place of values and conditions"
        self.error("no-variables", message, variable.span, hint)

    def _parameter_here(self, variable: Variable) -> Parameter:
        """A variable in the place of a value or a condition; the head must have it."""
        if variable.name not in self.bound:
            meant = close(variable.name, self.bound, shortest=3)
            there_are = " ".join(f"`?{name}`" for name in self.bound) or "none"
            hint = f"did you mean `?{meant}`?" if meant else f"variables of the head: {there_are}"
            self.error("unbound-variable", f"`?{variable.name}` is not in the head", variable.span, hint)
        return Parameter(variable.name, variable.span)

    def _no_head(self, form: Form, what: str, known: Sequence[str] = ()) -> None:
        items = form.items if isinstance(form, ListForm) else ()
        if items and isinstance(items[0], Broken):
            return
        if items and isinstance(items[0], Variable):
            self._variable(items[0])
            return
        hint = _known(what.split()[-1], known) if known else ""
        message = (
            f"{what} begins with a name; these parentheses are empty" if not items else f"{what} begins with a name"
        )
        self.error("no-head", message, items[0].span if items else form.span, hint)

    def _unknown(self, head: str, form: ListForm, what: str, known: Sequence[str]) -> None:
        meant = close(head, known, shortest=2)
        hint = (f"did you mean `{meant}`? " if meant else "") + _known(what, known)
        self.error("unknown-form", f"`{head}` is not a known {what}", form.items[0].span, hint)


@dataclass(frozen=True, slots=True)
class _Branch:
    """A clause of `cond`; condition is None for `else`."""

    condition: Condition | None
    goal: Goal


def _once(uses: Sequence[tuple[str, Use]]) -> list[tuple[str, Use]]:
    """Without what another file has said in the same words: several files may use one library."""
    said: dict[tuple[str, str], str] = {}
    kept: list[tuple[str, Use]] = []
    for name, use in uses:
        words = " ".join([f":{one.name} {canonical(one.value)}" for one in use.settings])
        if said.setdefault((name, words), use.span.file) == use.span.file:
            kept.append((name, use))
    return kept


_TYPES_HINT = "the types: bool, (number UNIT), pose, command, symbol"


def _head(form: Form) -> str | None:
    match form:
        case ListForm(items=(Symbol(name=name), *_)):
            return name
        case _:
            return None


def _known(what: str, names: Sequence[str]) -> str:
    return f"known {what}s: {' '.join(names)}"


def _parts(number: int) -> str:
    return "are none" if number == 0 else "is 1 part" if number == 1 else f"are {number} parts"


def _spaced_unit(parts: Sequence[Form]) -> str:
    """A hint where a number and its unit stand apart."""
    for number, unit in pairwise(parts):
        if isinstance(number, Numeral) and isinstance(unit, Symbol) and not number.unit and unit.name in UNITS:
            return f"a unit follows its number without a space: `{number.text}{unit.name}`"
    return ""


def _first(span: Span) -> tuple[Related, ...]:
    return (Related("the first is here", span),)


def _join(first: Span, last: Span) -> Span:
    return Span(first.file, first.line, first.column, last.end_line, last.end_column)


def _what_is(name: str) -> str:
    if name in TOP_FORMS:
        return "a form of the top level"
    if name in CONDITION_FORMS:
        return "a condition"
    return "a goal" if name in GOAL_FORMS else "a word of the language"


def _describe(form: Form) -> str:
    match form:
        case Symbol(name=name):
            return f"the name `{name}`"
        case Keyword(name=name):
            return f"the keyword `:{name}`"
        case Numeral(text=text):
            return f"the number `{text}`"
        case Text():
            return "a text"
        case ListForm(items=(Symbol(name=name), *_)):
            return f"`({name} ...)`"
        case _:
            return "a list"


_NO_SYMBOL = re.compile(r'[\s()";]+')
_NO_START = re.compile(r"[+-]?\.?[0-9]|[:?]|\|#|#\|")


def _name_of_file(file: str) -> str:
    """The name of a plan without a header: its file's, made a symbol."""
    name = _NO_SYMBOL.sub("-", PurePath(file).stem) or "plan"
    return f"plan-{name}" if _NO_START.match(name) else name
