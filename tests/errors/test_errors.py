"""What is said of wrong plans, word for word: one golden file a diagnostic code.

A golden file is a plan text, whose first line is a comment with the command, then a line `----`, then the diagnostics.
`rplan check` compiles the plan, `rplan simulate` also brings it to life.
Adding a test is adding a file; `RPLAN_BLESS=1` in the environment rewrites what is expected.
"""

from __future__ import annotations

import ast
import os
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import pytest

import rplan
from rplan.apps.wiring import PlanBrain, compile_source
from rplan.lang.diagnostic import Diagnostic, PlanError, render
from rplan.lang.source import Source
from rplan.ways.coverage import review

HERE = Path(__file__).parent
GOLDEN = sorted(HERE.glob("*.txt"))
SEPARATOR = "----\n"


NOT_BY_TEXT = ("not-decided",)
"""Codes that no plan text of a reasonable size brings about; tests/ways/test_coverage.py has them."""


def findings(source: Source) -> tuple[Diagnostic, ...]:
    command = source.text.partition("\n")[0].split()
    checks = partial(review, notes="--verbose" in command)
    try:
        compiled = compile_source(
            source, strict="--strict" in command, allow_holes="--allow-holes" in command, checks=checks
        )
        if "simulate" in command:
            PlanBrain(compiled)
        return compiled.diagnostics
    except PlanError as error:
        return error.diagnostics


def said_of(source: Source) -> str:
    return "".join(f"{render(found, {source.name: source.text})}\n" for found in findings(source))


@pytest.mark.parametrize("path", GOLDEN, ids=lambda path: path.stem)
def test_every_word_is_as_expected(path: Path) -> None:
    text, separator, expected = path.read_text(encoding="utf-8").partition(SEPARATOR)
    assert text.startswith(("; rplan check", "; rplan simulate"))
    said = said_of(Source(f"{path.stem}.rplan", text))
    if os.environ.get("RPLAN_BLESS") == "1":
        path.write_text(text + SEPARATOR + said, encoding="utf-8")
    else:
        assert separator
        assert said == expected


def codes_of(path: Path) -> Iterator[str]:
    """Every code that a file of rplan gives to a diagnostic."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Call):
            called = ast.unparse(node.func).split(".")[-1]
            position = {"Diagnostic": 0, "error": 0, "shown": 2, "_unexpected": 2, "add": 1}.get(called, len(node.args))
            for code in ast.walk(node.args[position]) if position < len(node.args) else ():
                if isinstance(code, ast.Constant) and isinstance(code.value, str):
                    yield code.value


def test_every_code_has_a_golden_file_and_shows_in_it() -> None:
    here = Path(rplan.__path__[0])
    stages = [*here.glob("lang/*.py"), *here.glob("goals/*.py"), *here.glob("ways/**/*.py"), here / "apps/wiring.py"]
    codes = sorted({code for path in stages for code in codes_of(path)} - {*NOT_BY_TEXT})
    assert len(codes) > 40
    files = {path.stem: path.read_text(encoding="utf-8") for path in GOLDEN}
    assert [code for code in codes if f"[{code}]: " not in files.get(code, "")] == []


def test_five_mistakes_are_five_errors_with_their_places() -> None:
    text = (HERE / "five-mistakes.txt").read_text(encoding="utf-8").partition(SEPARATOR)[0]
    found = findings(Source("five.rplan", text))
    assert [(one.code, one.span.line) for one in found] == [
        ("unit-mismatch", 2),
        ("unknown-form", 4),
        ("wrong-parts", 7),
        ("bad-number", 9),
        ("missing-parenthesis", 10),
    ]


def test_mistakes_of_text_of_form_and_of_name_are_told_together() -> None:
    text = """(plan many :period 0.1m)
(use runaway :safety-radius 2s)
(defgoalr (maint a) (if (anything-is-too-closs) (do action (move-away-from-danger))))
(defgoalr (ach b) (do action (move-away-from-danger))
(goalem (and (maint a) (ach b) (ach c)))
"""
    codes = [(d.code, d.span.line) for d in findings(Source("many.rplan", text)) if d.severity == "error"]
    assert codes == [
        ("unit-mismatch", 1),
        ("unit-mismatch", 2),
        ("wrong-parts", 3),
        ("misspelt", 3),
        ("missing-parenthesis", 4),
        ("no-rule", 5),
    ]
