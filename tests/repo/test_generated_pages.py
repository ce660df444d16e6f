"""Pages that are made from the code are as the code is. `RPLAN_BLESS=1` in the environment writes them again."""

from __future__ import annotations

import ast
import os
import re
import shlex
from collections.abc import Iterator
from pathlib import Path

import pytest
from click.testing import CliRunner

from behaviours.catalogue import LIBRARIES
from behaviours.interface import Library
from rplan.apps.cli import cli
from rplan.apps.wiring import PlanBrain, signatures
from rplan.driver import compile_plan
from rplan.lang.diagnostic import Diagnostic, PlanError, render
from rplan.lang.source import Source
from rplan.ways.coverage import review

BLESS = os.environ.get("RPLAN_BLESS") == "1"
SECTION = re.compile(r"^## ([\w-]+)\n(.*?)(?=^## |\Z)", re.MULTILINE | re.DOTALL)
EXAMPLE = re.compile(r"^```lisp wrong\n(.*?)^```\n\n```text\n(.*?)^```$", re.MULTILINE | re.DOTALL)
WHERE_THE_CODE_IS = {"Diagnostic": 0, "error": 0, "_error": 0, "shown": 2, "unexpected": 2, "add": 1}
WITHOUT_EXAMPLE = ("not-decided", "not-text", "too-deep", "too-large", "too-many-errors")
"""Codes whose examples are too long or no text; tests/errors has most of them."""


def same(page: Path, expected: str) -> bool:
    if BLESS:
        page.write_text(expected, encoding="utf-8")
    return page.read_text(encoding="utf-8") == expected


# --- libraries ----------------------------------------------------------------------------------------


def cell(text: str) -> str:
    return text.replace("|", "\\|")


def library_section(library: Library) -> str:
    lines = [f"## {library.name}", "", library.doc, "", "| function | type | says |", "| --- | --- | --- |"]
    lines += [f"| `({f.name})` | {f'{f.type} {f.unit}'.strip()} | {cell(f.doc)} |" for f in library.functions]
    if library.parameters:
        lines += ["", "| parameter | default | says |", "| --- | --- | --- |"]
        for p in library.parameters:
            default = f"{p.default:g} {p.unit}".strip() if isinstance(p.default, float) else str(p.default)
            lines.append(f"| `:{p.name}` | {default} | {cell(p.doc)} |")
    return "\n".join(lines) + "\n"


def test_the_page_of_the_libraries_is_as_the_catalogue(root: Path) -> None:
    page = root / "docs" / "reference" / "libraries.md"
    head = page.read_text(encoding="utf-8").partition("\n## ")[0].rstrip("\n") + "\n"
    assert same(page, "\n".join([head, *map(library_section, LIBRARIES.values())]))


# --- diagnostics --------------------------------------------------------------------------------------


def codes_in(path: Path) -> Iterator[str]:
    """Every code that a file gives to a diagnostic."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Call):
            position = WHERE_THE_CODE_IS.get(ast.unparse(node.func).split(".")[-1], len(node.args))
            for part in ast.walk(node.args[position]) if position < len(node.args) else ():
                if isinstance(part, ast.Constant) and isinstance(part.value, str):
                    yield part.value


def test_every_code_in_the_sources_has_a_section_and_every_section_a_code(root: Path) -> None:
    codes = {code for path in sorted((root / "rplan").rglob("*.py")) for code in codes_in(path)}
    page = (root / "docs" / "reference" / "diagnostics.md").read_text(encoding="utf-8")
    assert [code for code, _ in SECTION.findall(page)] == sorted(codes)


def findings(text: str) -> tuple[Diagnostic, ...]:
    """What is said of a plan that is compiled and brought to life."""
    said: tuple[Diagnostic, ...] = ()
    try:
        compiled = compile_plan(Source("plan.rplan", text), signatures(), checks=review)
        said = compiled.diagnostics
        PlanBrain(compiled)
    except PlanError as error:
        return (*said, *error.diagnostics)
    return said


def test_every_example_of_a_diagnostic_says_what_the_page_says(root: Path) -> None:
    page = root / "docs" / "reference" / "diagnostics.md"
    text = page.read_text(encoding="utf-8")
    without = []
    expected = text.partition("## ")[0]
    for code, body in SECTION.findall(text):
        example = EXAMPLE.search(body)
        if example is None:
            without.append(code)
            expected += f"## {code}\n{body}"
            continue
        plan = example[1]
        said = [render(found, {"plan.rplan": plan}) for found in findings(plan) if found.code == code]
        assert said, f"the example of {code} does not show it"
        shown = f"```lisp wrong\n{plan}```\n\n```text\n{said[0]}\n```"
        expected += f"## {code}\n" + body.replace(example[0], shown)
    assert tuple(without) == WITHOUT_EXAMPLE
    assert same(page, expected)


# --- what commands print --------------------------------------------------------------------------------

BLOCK = re.compile(r"^```(lisp wrong|lisp|text)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
PRINTING = (
    "reference/commands.md",
    "explanation/order_of_ways.md",
    "how-to/prove_a_property.md",
    "how-to/order_steps_by_operators.md",
)
SECONDS = re.compile(r"\(\d+\.\d\d s\)")
"""How long a proof took, which no page can promise."""


def printed(command: str, plan: str) -> str:
    """What a shell line `rplan …` or `echo '…' | rplan …` prints; a plan file that is not there is the given plan."""
    given, _, called = command.rpartition(" | ")
    arguments = shlex.split(called)[1:]
    for name in arguments:
        if name.endswith(".rplan") and "/" not in name:
            Path(name).write_text(plan, encoding="utf-8")
    text = shlex.split(given)[1] + "\n" if given else None
    return SECONDS.sub("(0.01 s)", CliRunner().invoke(cli, arguments, input=text).output)


def session(text: str, plan: str) -> str:
    """The block with every command run again; simulations are left as they are, for they print how fast they were."""
    parts = re.split(r"^\$ (.*)\n", text, flags=re.MULTILINE)[1:]
    return "".join(
        f"$ {command}\n" + (said if "simulate" in command else printed(command, plan).strip("\n") + "\n")
        for command, said in zip(parts[::2], parts[1::2], strict=True)
    )


@pytest.mark.parametrize("name", PRINTING)
def test_commands_print_what_the_page_shows(
    name: str, root: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "plans").symlink_to(root / "plans")
    page = root / "docs" / name
    plan = ""
    expected = page.read_text(encoding="utf-8")
    for kind, text in BLOCK.findall(expected):
        if kind != "text":
            plan = text
        elif text.startswith("$ "):
            expected = expected.replace(f"```text\n{text}```", f"```text\n{session(text, plan)}```", 1)
    assert same(page, expected)
