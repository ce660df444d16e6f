"""What is said of wrong plans, word for word: one golden file a diagnostic code.

A golden file is a plan text, whose first line is a comment with the command, then a line `----`, then the diagnostics.
Adding a test is adding a file; `RPLAN_BLESS=1` in the environment rewrites what is expected.
"""

from __future__ import annotations

import ast
import os
from collections.abc import Iterator
from pathlib import Path

import pytest

import rplan.lang
from rplan.lang.diagnostic import Diagnostic, PlanError, render
from rplan.lang.parse import parse_text
from rplan.lang.source import Source

HERE = Path(__file__).parent
GOLDEN = sorted(HERE.glob("*.txt"))
SEPARATOR = "----\n"


def findings(source: Source) -> tuple[Diagnostic, ...]:
    try:
        return parse_text(source)[1]
    except PlanError as error:
        return error.diagnostics


def said_of(source: Source) -> str:
    return "".join(f"{render(found, {source.name: source.text})}\n" for found in findings(source))


@pytest.mark.parametrize("path", GOLDEN, ids=lambda path: path.stem)
def test_every_word_is_as_expected(path: Path) -> None:
    text, separator, expected = path.read_text(encoding="utf-8").partition(SEPARATOR)
    assert text.startswith("; rplan check\n")
    said = said_of(Source(f"{path.stem}.rplan", text))
    if os.environ.get("RPLAN_BLESS") == "1":
        path.write_text(text + SEPARATOR + said, encoding="utf-8")
    else:
        assert separator
        assert said == expected


def codes_of(path: Path) -> Iterator[str]:
    """Every code that a file of rplan.lang gives to a diagnostic."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Call):
            called = ast.unparse(node.func).split(".")[-1]
            position = {"Diagnostic": 0, "error": 0, "_unexpected": 2}.get(called)
            if position is not None and isinstance(code := node.args[position], ast.Constant):
                yield str(code.value)


def test_every_code_has_a_golden_file_and_shows_in_it() -> None:
    here = Path(rplan.lang.__file__).parent
    codes = sorted({code for name in ("reader.py", "parse.py") for code in codes_of(here / name)})
    assert len(codes) > 20
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
