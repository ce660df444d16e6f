"""Programs on pages run and print what stands below them. `RPLAN_BLESS=1` in the environment writes that again."""

from __future__ import annotations

import io
import os
import re
from contextlib import redirect_stdout
from pathlib import Path

BLESS = os.environ.get("RPLAN_BLESS") == "1"
PROGRAM = re.compile(r"^```python\n(.*?)^```\n\n```text\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def printed(program: str, page: Path) -> str:
    stdout = io.StringIO()
    with redirect_stdout(stdout):
        exec(compile(program, page.name, "exec"), {"__name__": "__page__"})
    return stdout.getvalue()


def test_programs_on_pages_print_what_stands_below_them(pages: dict[Path, str], tmp_path: Path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    programs = 0
    for page, text in pages.items():
        new = PROGRAM.sub(lambda found, page=page: found[0].replace(found[2], printed(found[1], page)), text)
        programs += len(PROGRAM.findall(text))
        if BLESS:
            page.write_text(new, encoding="utf-8")
        assert new == page.read_text(encoding="utf-8")
    assert programs >= 1
