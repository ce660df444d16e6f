"""Laws of reading that hold for every text."""

from __future__ import annotations

from collections.abc import Iterator

from hypothesis import given, settings
from hypothesis import strategies as st

from rplan.lang.diagnostic import PlanError, render
from rplan.lang.parse import parse, parse_text
from rplan.lang.plan import Plan
from rplan.lang.printer import print_goal, print_plan
from rplan.lang.reader import Form, ListForm, Numeral, Symbol, Text, read
from rplan.lang.source import Source, Span
from tests.properties.strategies_lang import mutated_texts, plan_texts, plans, without_places

LAW = settings(max_examples=80)

MANY = settings(LAW, max_examples=250)


def cut(text: str, span: Span) -> str:
    """The part of the text that a span names."""
    lines = text.split("\n")[span.line - 1 : span.end_line]
    lines[-1] = lines[-1][: span.end_column - 1]
    lines[0] = lines[0][span.column - 1 :]
    return "\n".join(lines)


def every(forms: tuple[Form, ...]) -> Iterator[Form]:
    for form in forms:
        yield form
        if isinstance(form, ListForm):
            yield from every(form.items)


def errors_of(text: str) -> list[str]:
    try:
        parse_text(Source("a.rplan", text))
    except PlanError as error:
        assert any(d.severity == "error" for d in error.diagnostics)
        for diagnostic in error.diagnostics:
            assert render(diagnostic, {"a.rplan": text})
        return [d.code for d in error.diagnostics if d.severity == "error"]
    return []


@LAW
@given(plans())
def test_a_printed_plan_reads_back_as_the_same_plan(plan: Plan) -> None:
    text = print_plan(plan)
    source = Source("a.rplan", text)
    read_back, _ = parse(read(source), source)
    assert without_places(read_back) == plan
    assert print_plan(read_back) == text


@LAW
@given(plans())
def test_a_goal_on_one_line_has_the_words_of_the_laid_out_goal(plan: Plan) -> None:
    laid_out = " ".join(print_plan(plan).split())
    for rule in plan.rules:
        words = " ".join(print_goal(rule.goal).split())
        assert words.replace(" ", "") in laid_out.replace(" ", "")


@LAW
@given(plan_texts())
def test_every_form_knows_the_place_of_its_text(text: str) -> None:
    for form in every(read(Source("a.rplan", text))):
        said = cut(text, form.span)
        match form:
            case Symbol(name=name):
                assert said == name
            case Numeral(text=number):
                assert said == number
            case Text():
                assert said[0] == said[-1] == '"'
            case ListForm():
                assert said[0] + said[-1] == "()"
            case _:
                assert said


@MANY
@given(st.one_of(st.text(), st.text(alphabet='()";|#\\?:a0.m \n'), mutated_texts()))
def test_any_text_is_a_plan_or_a_plan_error(text: str) -> None:
    errors_of(text)


def parentheses(text: str) -> list[int]:
    """The offsets of all closing parentheses outside of strings."""
    starts = [0]
    for line in text.split("\n"):
        starts.append(starts[-1] + len(line) + 1)
    ends = [form.span for form in every(read(Source("a.rplan", text))) if isinstance(form, ListForm)]
    return sorted(starts[span.end_line - 1] + span.end_column - 2 for span in ends)


@LAW
@given(plan_texts(), st.data())
def test_one_parenthesis_too_few_is_one_error(text: str, data: st.DataObject) -> None:
    at = data.draw(st.sampled_from(parentheses(text)))
    assert errors_of(text[:at] + text[at + 1 :]) == ["missing-parenthesis"]


@LAW
@given(plan_texts(), st.data())
def test_one_parenthesis_too_many_is_one_error(text: str, data: st.DataObject) -> None:
    at = data.draw(st.sampled_from(parentheses(text)))
    assert errors_of(text[:at] + ")" + text[at:]) == ["extra-parenthesis"]
