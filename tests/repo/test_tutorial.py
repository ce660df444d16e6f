"""The tutorial, followed from its first page to its last, prints what it says. `RPLAN_BLESS=1` writes that again."""

from __future__ import annotations

import os
import re
from itertools import pairwise
from pathlib import Path

import pytest
from repo.following import PageError, Reader

from rplan.apps.commands.new import project

BLESS = os.environ.get("RPLAN_BLESS") == "1"
OWN = {"README.md", "run.mcap", "run.html", "plan.html", "__pycache__"}


@pytest.fixture(scope="module")
def steps(root: Path) -> list[Path]:
    """The pages in their order."""
    return sorted((root / "docs" / "tutorial").glob("[0-9]_*.md"))


def test_every_step_does_what_it_says_where_the_last_one_ended(
    steps: list[Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    wanted = project("shy")
    reader = Reader(wanted)
    for page in steps:
        shown = page.read_text(encoding="utf-8")
        new = reader.follow(shown)
        if BLESS:
            page.write_text(new, encoding="utf-8")
        else:
            assert new == shown, page.name
    ended = {path.name: path.read_text(encoding="utf-8") for path in Path().iterdir() if path.name not in OWN}
    assert ended == {name: text for name, text in wanted.items() if name not in OWN}


def test_there_are_six_steps_and_each_leads_to_the_next(steps: list[Path]) -> None:
    assert len(steps) == 6
    for page, following in pairwise(steps):
        last = page.read_text(encoding="utf-8").rstrip().rpartition("\n\n")[2]
        assert f"]({following.name})" in last, page.name


def test_what_is_marked_in_a_file_is_what_has_changed(steps: list[Path]) -> None:
    """`hl_lines` has the lines that the same file had not when it was shown last."""
    shown: dict[str, list[str]] = {}
    pattern = re.compile(
        r'^```\w+ title="([^",]+)[^"]*"(?: hl_lines="([\d ]+)")?\n(.*?)^```$', re.MULTILINE | re.DOTALL
    )
    for page in steps:
        for name, marked, body in pattern.findall(page.read_text(encoding="utf-8")):
            lines = body.splitlines()
            if marked:
                new = [number for number, line in enumerate(lines, start=1) if line and line not in shown[name]]
                assert list(map(int, marked.split())) == new, f"{page.name}: {name}"
            shown[name] = lines


@pytest.mark.parametrize(
    "block", ["```sh\nrplan\n```", "```text\nno command\n```", "```text\n$ rm -r x\n```", "```\n```"]
)
def test_a_block_that_nobody_runs_is_refused(block: str) -> None:
    with pytest.raises(PageError):
        Reader({}).follow(f"# A page\n\n{block}\n")


def test_a_page_that_shows_something_else_differs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    page = (
        'So:\n\n```text title="x.rplan"\n(goalem (do a (b)))\n```\n\n```text\n$ rplan fmt --check x.rplan\nfine\n```\n'
    )
    assert Reader({}).follow(page) == page.replace("fine\n", "")
