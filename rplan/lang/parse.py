"""Forms to a `Plan` (the table of the top level, L8, L9, L12-L17, L20).

Takes: forms and the source they come from. Gives: a `Plan` and warnings, or every error at once. Leaves alone: whether
names exist and types fit.

An error leaves a placeholder in its place, so that the rest is still checked and one mistake is told once; a plan with
an error is thrown away at the end. How each form is parsed: rplan/lang/forms/.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from pathlib import PurePath

from rplan.lang.depth import deep_recursion
from rplan.lang.diagnostic import Diagnostic, PlanError
from rplan.lang.forms.claims import parse_assumption, parse_property, parse_test
from rplan.lang.forms.declarations import DEFAULT_PERIOD, parse_declaration, parse_header, parse_output, parse_use
from rplan.lang.forms.definitions import parse_named_condition, parse_operator, parse_rule, parse_top_goal
from rplan.lang.forms.parts import Parsed
from rplan.lang.forms.scope import Scope, first_is_here, head_of, known_names
from rplan.lang.forms.words import GOAL_FORMS
from rplan.lang.include import Gathered
from rplan.lang.plan import Header, Plan, Use
from rplan.lang.printer import canonical
from rplan.lang.reader import TOP_FORMS, Broken, Form, ListForm, capped, read_with_errors
from rplan.lang.source import Source, Span


def parse(forms: Sequence[Form], source: Source) -> tuple[Plan, tuple[Diagnostic, ...]]:
    """The plan that the forms make up, and warnings. Raises PlanError with every error and warning."""
    scope = Scope()
    with deep_recursion():
        plan = _plan(scope, forms, source.name)
    return _plan_or_error(plan, sorted(scope.found, key=lambda diagnostic: diagnostic.span))


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
    scope = Scope()
    with deep_recursion():
        plan = _plan(scope, gathered.forms, gathered.sources[0].name)
    order = {source.name: number for number, source in enumerate(gathered.sources)}
    found = [*gathered.errors, *scope.found]
    return plan, tuple(sorted(found, key=lambda one: (order.get(one.span.file, 0), one.span)))


def _plan_or_error(plan: Plan, found: Iterable[Diagnostic]) -> tuple[Plan, tuple[Diagnostic, ...]]:
    inorder = tuple(found)
    if any(diagnostic.severity == "error" for diagnostic in inorder):
        raise PlanError(capped(inorder))
    return plan, inorder


def _plan(scope: Scope, forms: Sequence[Form], file: str) -> Plan:
    if not forms:
        hint = "a plan has rules `(defgoalr (ach NAME) GOAL)` and a top goal `(goalem GOAL)`"
        scope.error("empty-plan", "the plan is empty", Span(file, 1, 1, 1, 1), hint)
    start = forms[0].span if forms else Span(file, 1, 1, 1, 1)
    heads = [(head_of(form), form) for form in forms]
    _strays(scope, heads)

    def every(parse_one: Callable[[Scope, ListForm], Parsed], *names: str) -> tuple[Parsed, ...]:
        return tuple(parse_one(scope, form) for head, form in heads if head in names and isinstance(form, ListForm))

    headers = every(parse_header, "plan")
    tops = every(parse_top_goal, "goalem", "goallem")
    _only_one(scope, "plan", "a plan has one header", [header.span for header in headers])
    _only_one(scope, "goalem", "a plan has one top goal", [top.span for top in tops])
    plan = Plan(
        headers[0] if headers else Header(_name_of_file(file), "", DEFAULT_PERIOD, start),
        _once(every(parse_use, "use")),
        every(parse_declaration, "declare"),
        every(parse_output, "defoutput"),
        every(parse_named_condition, "defcond"),
        every(parse_rule, "defgoalr"),
        tops[0] if tops else None,
        start,
        every(parse_operator, "defop"),
        every(parse_property, "defproperty"),
        every(parse_assumption, "assume"),
        every(parse_test, "deftest"),
    )
    _distinct_names(scope, plan)
    return plan


def _distinct_names(scope: Scope, plan: Plan) -> None:
    scope.distinct("library", [(use.library, use.span) for use in plan.uses])
    scope.distinct("function", [(one.name, one.span) for one in plan.declarations])
    scope.distinct("output", [(one.name, one.span) for one in plan.outputs])
    scope.distinct("condition", [(one.name, one.span) for one in plan.conditions])
    scope.distinct("operator", [(one.name, one.span) for one in plan.operators])
    scope.distinct("property", [(one.name, one.span) for one in plan.properties])
    scope.distinct("test", [(one.name, one.span) for one in plan.tests])


def _strays(scope: Scope, heads: Sequence[tuple[str | None, Form]]) -> None:
    """Report what is no form of the top level; words in a row count as one."""
    words: list[Form] = []
    for head, form in heads:
        if not isinstance(form, ListForm):
            words.append(form)
            continue
        _stray_words(scope, words)
        words = []
        if head is None:
            scope.no_head(form, "a form", TOP_FORMS)
        elif head in GOAL_FORMS:
            hint = "a rule begins with `defgoalr`, the top goal with `goalem`"
            scope.error("misplaced-form", f"a goal `({head} ...)` stands outside of a rule", form.span, hint)
        elif head not in TOP_FORMS:
            scope.unknown(head, form, "form", TOP_FORMS)
    _stray_words(scope, words)


def _stray_words(scope: Scope, words: Sequence[Form]) -> None:
    said = [word for word in words if not isinstance(word, Broken)]
    if said:
        span = said[0].span.to(said[-1].span)
        what = "a word stands" if len(said) == 1 else f"{len(said)} words stand"
        scope.error("stray-word", f"{what} outside of every form", span, known_names("form", TOP_FORMS))


def _only_one(scope: Scope, code_word: str, message: str, spans: Sequence[Span]) -> None:
    for span in spans[1:]:
        scope.error("duplicate", f"{message}: this is another `{code_word}`", span, "", first_is_here(spans[0]))


def _once(uses: Sequence[Use]) -> tuple[Use, ...]:
    """Without what another file has said in the same words: several files may use one library."""
    said: dict[tuple[str, str], str] = {}
    kept: list[Use] = []
    for use in uses:
        words = " ".join([f":{one.name} {canonical(one.value)}" for one in use.settings])
        if said.setdefault((use.library, words), use.span.file) == use.span.file:
            kept.append(use)
    return tuple(kept)


_NO_SYMBOL = re.compile(r'[\s()";]+')
_NO_START = re.compile(r"[+-]?\.?[0-9]|[:?]|\|#|#\|")


def _name_of_file(file: str) -> str:
    """The name of a plan without a header: its file's, made a symbol."""
    name = _NO_SYMBOL.sub("-", PurePath(file).stem) or "plan"
    return f"plan-{name}" if _NO_START.match(name) else name
