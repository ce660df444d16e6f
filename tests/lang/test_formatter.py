"""Texts laid out anew: nothing is lost, nothing changes its meaning, and once is enough."""

from __future__ import annotations

import re
from itertools import cycle

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rplan.lang.diagnostic import PlanError
from rplan.lang.formatter import WIDTH, comments, formatted
from rplan.lang.parse import parse_text
from rplan.lang.reader import words_of
from rplan.lang.source import Source
from tests.properties.strategies_lang import plan_texts, without_places

LAW = settings(derandomize=True, max_examples=80, deadline=None)
GAPS = (
    "",
    " ",
    "  ",
    "\n",
    "\n\n",
    "\n\n\n   ",
    " ; said\n",
    "\n;; on its own  \n\n",
    " #| in between |# ",
    " #| two\n  lines |#\n",
)


@st.composite
def untidy_texts(draw: st.DrawFn) -> str:
    """A plan whose words are set apart by anything that may stand between them."""
    gaps = cycle(draw(st.lists(st.sampled_from(GAPS), min_size=1, max_size=12)))
    text = next(gaps)
    for word in words_of(draw(plan_texts())):
        glued = not text or text[-1].isspace() or text[-1] in "()" or word in "()"
        text += ("" if glued else " ") + word + next(gaps)
    return text


def laid_out(text: str) -> str:
    return formatted(Source("a.rplan", text))


@LAW
@given(untidy_texts())
def test_the_plan_and_its_comments_stay_and_once_is_enough(text: str) -> None:
    once = laid_out(text)
    assert words_of(once) == words_of(text)
    assert comments(once) == comments(text)
    assert without_places(parse_text(Source("a", once))[0]) == without_places(parse_text(Source("a", text))[0])
    assert laid_out(once) == once
    assert once.endswith("\n")
    assert "\n\n\n" not in re.sub(r"#\|.*?\|#", "", once, flags=re.DOTALL)


@LAW
@given(plan_texts())
def test_what_is_on_one_line_is_broken_where_it_does_not_fit(text: str) -> None:
    flat = "\n".join(" ".join(form.split()) for form in re.split(r"\n(?=\()", text))
    lines = laid_out(flat).split("\n")
    assert all(len(line) <= WIDTH or line.count("(") <= 1 + line.count("do ") + 40 for line in lines)
    assert laid_out(text) == laid_out(laid_out(text))


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("(goalem   (do anything) )", "(goalem (do anything))\n"),
        ("(goalem (if (x)\n(do o a)\n(do o b)))", "(goalem (if (x)\n            (do o a)\n            (do o b)))\n"),
        ("(goalem\n(do anything))", "(goalem\n  (do anything))\n"),
        ("(goalem (when (x)\n(do o a)))", "(goalem (when (x)\n          (do o a)))\n"),
        (
            "(goalem (cond ((x)\n(do o a))\n(else\n(do o b))))",
            "(goalem (cond ((x)\n               (do o a))\n              (else\n               (do o b))))\n",
        ),
        ("(plan p) (goalem (do anything))", "(plan p)\n(goalem (do anything))\n"),
        ("\n\n(plan p)\n\n\n\n(goalem (do anything))\n\n", "(plan p)\n\n(goalem (do anything))\n"),
        ("(plan p) ; why\n(goalem (do anything))", "(plan p)  ; why\n(goalem (do anything))\n"),
        (
            "(goalem (and (x)   ; first\n(y)\n; last\n))",
            "(goalem (and (x)  ; first\n             (y)\n             ; last\n        ))\n",
        ),
        ("", ""),
        ("; alone", "; alone\n"),
        ('(plan p "two\n   lines")', '(plan p "two\n   lines")\n'),
    ],
)
def test_how_a_text_is_laid_out(text: str, expected: str) -> None:
    assert laid_out(text) == expected


def test_a_long_definition_has_a_line_for_each_part_and_values_stay_with_their_keywords() -> None:
    step = "(tick :given ((bumped true)) :expect ((action stop)))"
    text = f'(deftest bumps "It stops where it bumps." {step} {step})'
    assert laid_out(text) == f'(deftest bumps\n  "It stops where it bumps."\n  {step}\n  {step})\n'
    text = "(defop (take ?what ?where) :do (action (take ?what)) :pre (and (at ?where) (lies ?what ?where)) :add (has))"
    assert laid_out(text).split("\n") == [
        "(defop (take ?what ?where)",
        "  :do (action (take ?what))",
        "  :pre (and (at ?where) (lies ?what ?where))",
        "  :add (has))",
        "",
    ]


def test_a_text_that_cannot_be_read_is_refused() -> None:
    with pytest.raises(PlanError):
        laid_out("(goalem (do anything)")
