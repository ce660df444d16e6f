"""The bar that counts, on a terminal and elsewhere."""

from __future__ import annotations

from io import StringIO

import pytest
from rich.console import Console

from rplan.apps import progress


def test_a_bar_shows_how_far_it_is_on_a_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    shown = StringIO()
    monkeypatch.setattr(progress, "Console", lambda **_: Console(force_terminal=True, width=100, file=shown))
    with progress.counting(5, done=2, said="2 of them known") as count:
        count("the third")
    assert "3/5" in shown.getvalue() and "the third" in shown.getvalue()


def test_where_nobody_looks_there_is_no_bar(capsys: pytest.CaptureFixture[str]) -> None:
    with progress.counting(2) as count:
        count("the first")
    assert capsys.readouterr() == ("", "")
