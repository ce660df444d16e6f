"""How-to pages do what they say, each in a fresh folder beside the plans. `RPLAN_BLESS=1` writes what they show."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path
from shlex import quote
from shutil import copytree, ignore_patterns, which

import numpy as np
import pytest
from repo.following import BLOCK, ROOT, PageError, Reader, run, works

from rplan.apps.wiring import signatures
from rplan.driver import compile_plan
from rplan.lang.reader import source_from_file
from sim.scenarios.format import loads

BLESS = os.environ.get("RPLAN_BLESS") == "1"
PAGES = sorted(path.name for path in (ROOT / "docs" / "how-to").glob("*.md"))
WITH_PLANS_BY_NAME = ("order_steps_by_operators.md", "prove_a_property.md")
"""Their plans go by any name in the commands; test_generated_pages.py follows them."""


@pytest.mark.parametrize("name", [name for name in PAGES if name not in WITH_PLANS_BY_NAME])
def test_the_page_does_what_it_says(name: str, root: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    copytree(root / "plans", tmp_path / "plans", ignore=ignore_patterns("__pycache__"))
    page = root / "docs" / "how-to" / name
    shown = page.read_text(encoding="utf-8")
    new = Reader().follow(shown)
    if BLESS:
        page.write_text(new, encoding="utf-8")
    else:
        assert new == shown


def blocks(page: Path, kind: str) -> list[str]:
    """The texts of the blocks of a kind."""
    return [block["body"] for block in BLOCK.finditer(page.read_text(encoding="utf-8")) if block["kind"] == kind]


def test_what_the_reference_says_to_type_works(root: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    lines = [line for text in blocks(root / "docs/reference/commands.md", "sh") for line in text.splitlines()]
    assert len(lines) >= 3
    for line in lines:
        works(line)


def test_the_scenarios_of_the_reference_are_scenarios(root: Path) -> None:
    (robot,) = blocks(root / "docs/reference/scenarios.md", "yaml")
    assert loads(f"name: it\nbounds: [-5, -5, 5, 5]\n{robot}").robot.sensors


def test_the_program_of_the_page_of_engines_runs_a_thousand_robots(root: Path) -> None:
    (program,) = blocks(root / "docs/reference/engines.md", "python")
    circuit = compile_plan(source_from_file(root / "plans/make_room/make_room.rplan"), signatures()).circuit
    names = {"circuit": circuit, "bits": np.ones((len(circuit.inputs), 1_000), dtype=np.bool_)}
    exec(program, names)
    assert names["outputs"].shape == (len(circuit.outputs), 1_000)


def test_the_c_of_the_page_of_engines_goes_with_the_c_of_the_plan(root: Path, tmp_path: Path) -> None:
    (shown,) = blocks(root / "docs/reference/engines.md", "c")
    code = run(f"rplan compile {quote(str(root / 'plans' / 'find_and_fetch'))} --emit c")
    source = tmp_path / "page.c"
    source.write_text(f"{code}\nint main(void)\n{{\n{shown}\nreturn 0;\n}}\n", encoding="utf-8")
    compiler = which("cc") or which("gcc") or which("clang")
    assert compiler is not None
    command = [compiler, "-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-fsyntax-only", str(source)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize(
    "block",
    [
        "```sh\nrplan check nowhere.rplan\n```",
        "```sh\nrplan check --no-such-option plans\n```",
        "```sh\nmake\n```",
        "```toml\na = \n```",
        "```lisp\n(goalem (and (do a (b)) (do a (c))))\n```",
        "```lisp wrong\n(goalem (do a (b)))\n```",
        "```text\nsaid by nobody\n```",
        "<!-- $ rplan list robot -->\n```text\nno such line\n```",
        "<!-- $ rplan list robot -->\n```text\n (stop)\n (speed)\n```",
    ],
)
def test_what_does_not_work_or_is_not_so_is_refused(
    block: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises((PageError, ValueError)):
        Reader().follow(f"# A page\n\n{block}\n")


def test_a_program_is_followed_by_what_it_prints() -> None:
    page = "```python\nprint(2 + 2)\n```\n\n```text\nfive\n```\n"
    assert Reader().follow(page) == page.replace("five", "4")
