"""Tests of pytest on one mutant of a plan after the other, in one run of pytest.

Takes: test files, the plan's path, and mutants, compiled when they are asked for. Gives: for each the first test that
fails on it. Leaves alone: tests that do not open the plan by the fixture `plan`.
"""

from __future__ import annotations

import io
from collections.abc import Callable, Sequence
from contextlib import redirect_stderr, redirect_stdout
from importlib.metadata import entry_points
from pathlib import Path

import pytest
from _pytest.runner import runtestprotocol

from rplan.apps import pytest_plugin
from rplan.driver import Compiled

Later = Callable[[], Compiled]


def failing(tests: Sequence[Path], plan: Path, mutants: Sequence[Later]) -> list[str]:
    """For each mutant the node id of a test that fails on it, else nothing.

    Raises ValueError where tests cannot be collected, fail on the plan itself, or do not use it.
    """
    loop = _Loop(plan.resolve(), mutants)
    said = io.StringIO()
    installed = any(point.value == pytest_plugin.__name__ for point in entry_points(group="pytest11"))
    plugins: list[object] = [loop] if installed else [loop, pytest_plugin]
    with redirect_stdout(said), redirect_stderr(said):
        code = pytest.main([*map(str, tests), "-q", "-p", "no:cacheprovider"], plugins=plugins)
    if loop.wrong:
        raise ValueError(loop.wrong)
    if not loop.began:
        raise ValueError(f"pytest cannot run the tests (exit code {int(code)}):\n{said.getvalue().strip()}")
    return loop.found


class _Loop:
    """Takes the place of pytest's own loop over the tests."""

    def __init__(self, plan: Path, mutants: Sequence[Later]) -> None:
        self._plan, self._mutants = plan, mutants
        self.found: list[str] = []
        self.wrong = ""
        self.began = False

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtestloop(self, session: pytest.Session) -> bool | None:
        if session.testsfailed:
            return None
        self.began = True
        shelf = pytest_plugin.shelf_of(session.config)
        using = []
        for item in session.items:
            shelf.opened.clear()
            if _fails(item):
                self.wrong = f"{item.nodeid} fails on the plan as it stands: mend that first"
                return True
            using += [item] if self._plan in shelf.opened else []
        if not using:
            self.wrong = f"no test opens {self._plan.name} by the fixture `plan`"
        for mutant in self._mutants if using else ():
            shelf.substitutes = {self._plan: mutant()}
            self.found.append(next((item.nodeid for item in using if _fails(item)), ""))
        return True


def _fails(item: pytest.Item) -> bool:
    return any(report.failed for report in runtestprotocol(item, log=False, nextitem=None))
