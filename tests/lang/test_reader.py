"""Text to forms: words, comments, strings, parentheses, places (L1, L2, L4)."""

from __future__ import annotations

from pathlib import Path

import pytest

from rplan.lang.diagnostic import Diagnostic, PlanError
from rplan.lang.reader import (
    MAX_ERRORS,
    Form,
    Keyword,
    ListForm,
    Numeral,
    Symbol,
    Text,
    Variable,
    read,
    read_with_errors,
    source_from_file,
)
from rplan.lang.source import Source, Span


def forms_of(text: str) -> tuple[Form, ...]:
    return read(Source("a.rplan", text))


def only(text: str) -> Form:
    (form,) = forms_of(text)
    return form


def errors_of(text: str) -> tuple[Diagnostic, ...]:
    with pytest.raises(PlanError) as caught:
        forms_of(text)
    return caught.value.diagnostics


def span(line: int, column: int, end_line: int, end_column: int) -> Span:
    return Span("a.rplan", line, column, end_line, end_column)


@pytest.mark.rule("L2")
@pytest.mark.parametrize(
    "name",
    [
        "fetch-widget&go-home",
        "rpt-ir-failure?",
        "move-according-to-NaT-plan",
        "<",
        "/=",
        "-",
        "+",
        "...",
        "->x",
        "a#|b",
        "é",
        "_1",
        "x|#",
        ":",
        "?",
    ],
)
def test_any_run_that_begins_like_no_number_is_a_symbol(name: str) -> None:
    assert only(name) == Symbol(name, span(1, 1, 1, len(name) + 1))


@pytest.mark.rule("L2")
def test_symbols_keep_their_case() -> None:
    assert [form.name for form in forms_of("NaT nat") if isinstance(form, Symbol)] == ["NaT", "nat"]


@pytest.mark.rule("L2")
def test_keywords_and_variables_lose_their_mark() -> None:
    assert forms_of(":idle ?x") == (Keyword("idle", span(1, 1, 1, 6)), Variable("x", span(1, 7, 1, 9)))


@pytest.mark.rule("L3")
def test_a_number_is_read_with_its_unit_and_keeps_its_text() -> None:
    assert only("25ft") == Numeral(7.62, "m", "25ft", span(1, 1, 1, 5))
    assert only("-.5") == Numeral(-0.5, "", "-.5", span(1, 1, 1, 4))


@pytest.mark.rule("L2")
@pytest.mark.parametrize("text", ["0.2meters", "+3x", "-.5q", "3d-map"])
def test_what_begins_like_a_number_and_is_none_is_an_error(text: str) -> None:
    (error,) = errors_of(f"(use lib :x {text})")
    assert (error.code, error.span) == ("bad-number", span(1, 13, 1, 13 + len(text)))


@pytest.mark.rule("L4")
def test_a_list_is_placed_from_parenthesis_to_parenthesis() -> None:
    form = only("\n  (do\n    action (stop))")
    assert isinstance(form, ListForm)
    assert form.span == span(2, 3, 3, 19)
    assert [item.span for item in form.items] == [span(2, 4, 2, 6), span(3, 5, 3, 11), span(3, 12, 3, 18)]


@pytest.mark.rule("L1")
def test_comments_to_the_end_of_the_line_are_skipped() -> None:
    assert [form.span for form in forms_of('a ; b ) " #| \nc')] == [span(1, 1, 1, 2), span(2, 1, 2, 2)]


@pytest.mark.rule("L1")
def test_comments_of_a_region_nest_and_keep_places() -> None:
    text = 'a #| ( " #| x |# \n ; |# b'
    assert [form.span for form in forms_of(text)] == [span(1, 1, 1, 2), span(2, 7, 2, 8)]


@pytest.mark.rule("L1")
def test_a_region_does_not_begin_in_a_string_or_in_a_comment() -> None:
    assert [type(form) for form in forms_of('"#|" ; #|\n x "|#"')] == [Text, Symbol, Text]


def test_a_region_that_is_never_closed_is_told_at_its_outermost_opening() -> None:
    (error,) = errors_of("(goalem (ach x))\n(defgoalr #| a #| b |# \n (ach x)")
    assert (error.code, error.span) == ("open-comment", span(2, 11, 2, 13))


@pytest.mark.rule("L1")
def test_strings_span_lines_and_know_three_escapes() -> None:
    assert only('"a\nb\\n\\"\\\\"') == Text('a\nb\n"\\', span(1, 1, 2, 9))


def test_another_escape_is_an_error_at_its_place() -> None:
    (error,) = errors_of('(plan x\n "ab\\tc")')
    assert (error.code, error.span) == ("bad-escape", span(2, 5, 2, 7))


def test_a_string_that_is_never_closed_is_told_at_its_opening_and_spoils_one_form() -> None:
    text = '(plan a "fine")\n(defgoalr (ach x) "open (do a 1))\n(defgoalr (ach y) "fine" (do a 1))\n(goalem (ach x))'
    forms, errors = read_with_errors(Source("a.rplan", text))
    assert [(error.code, error.span) for error in errors] == [("open-string", span(2, 19, 2, 20))]
    assert [form.span.line for form in forms] == [1, 3, 4]
    assert forms[2].span == span(4, 1, 4, 17)


def test_many_strings_that_are_never_closed_are_told_without_end() -> None:
    errors = errors_of('(defx "a\\")\n' * 2_000)
    assert {error.code for error in errors} == {"open-string"}
    assert [error.span.line for error in errors] == list(range(1, len(errors) + 1))


def test_a_missing_parenthesis_is_told_at_the_opener_and_the_next_form_is_still_read() -> None:
    text = "(defgoalr (ach x)\n  (if (a\n    (do b 1)\n    (do b 2)))\n(defgoalr (ach y) 3x)\n"
    missing, bad = errors_of(text)
    assert (missing.code, missing.span) == ("missing-parenthesis", span(1, 1, 1, 2))
    assert [related.span for related in missing.related] == [span(2, 7, 2, 8), span(5, 1, 5, 2)]
    assert (bad.code, bad.span.line) == ("bad-number", 5)


def test_several_missing_parentheses_are_counted() -> None:
    (error,) = errors_of("(goalem (and (ach x)")
    assert error.message == "2 `)` are missing: the form `(goalem` is not closed"


def test_a_parenthesis_too_many_spoils_one_form() -> None:
    text = "(defgoalr (ach x)\n  (if (a))\n    (do b 1)))\n(defgoalr (ach y) (do b 1))"
    forms, errors = read_with_errors(Source("a.rplan", text))
    assert [(error.code, error.span) for error in errors] == [("extra-parenthesis", span(3, 14, 3, 15))]
    assert [form.span.line for form in forms] == [4]


def test_a_list_may_go_on_in_the_first_column() -> None:
    form = only("(goalem\n(and\n(ach x)))")
    assert form.span == span(1, 1, 3, 10)


@pytest.mark.parametrize("tail", ["", ")" * 10_000])
def test_ten_thousand_levels_are_one_error(tail: str) -> None:
    (error,) = errors_of("(" * 10_000 + tail)
    assert (error.code, error.span) == ("too-deep", span(1, 1_001, 1, 1_002))


def test_a_thousand_levels_are_read() -> None:
    form = only("(" * 1_000 + ")" * 1_000)
    depth = 0
    while isinstance(form, ListForm) and form.items:
        depth, (form,) = depth + 1, form.items
    assert depth == 999


def test_after_fifty_errors_the_rest_is_counted() -> None:
    errors = errors_of("3x " * 1_000)
    assert len(errors) == MAX_ERRORS + 1
    assert (errors[-1].code, errors[-1].message) == ("too-many-errors", "and 950 more errors")


@pytest.mark.parametrize("character", ["\x00", "\x07", "\x1b", "\x7f", "\ud800"])
def test_control_characters_are_one_error(character: str) -> None:
    (error,) = errors_of(f"(plan x)\n ab{character}{character} )) 3x")
    assert (error.code, error.span) == ("not-text", span(2, 4, 2, 5))


def test_tabs_and_form_feeds_are_white_space() -> None:
    assert [form.span.column for form in forms_of("\ta\x0cb")] == [2, 4]


def test_an_empty_text_has_no_forms() -> None:
    assert forms_of("") == forms_of(" ; nothing\n#| |#") == ()


def test_a_file_is_read_as_utf_8_with_any_line_ends(tmp_path: Path) -> None:
    path = tmp_path / "a.rplan"
    path.write_bytes("\ufeff(plan é)\r\n(x)\r".encode())
    assert source_from_file(path) == Source(str(path), "(plan é)\n(x)\n")


def test_a_file_that_is_not_utf_8_is_one_error_at_the_byte(tmp_path: Path) -> None:
    path = tmp_path / "a.rplan"
    path.write_bytes("(plan x)\né ".encode() + b"\xff\xfe")
    with pytest.raises(PlanError) as caught:
        source_from_file(path)
    (error,) = caught.value.diagnostics
    assert (error.code, error.span) == ("not-text", Span(str(path), 2, 3, 2, 4))
    assert "0xff" in error.message


def test_a_file_that_is_not_there_is_the_business_of_the_caller(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        source_from_file(tmp_path / "none.rplan")


def test_ten_thousand_rules_are_read() -> None:
    text = "(defgoalr (ach abc)\n  (if (bumped) (do anything) (do action (move))))\n" * 10_000
    assert len(forms_of(text)) == 10_000
