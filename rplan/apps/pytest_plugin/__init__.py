"""Plans under pytest: `*.rplan` files and golden ticks as items, the fixture `plan`, coverage of plans.

Takes: what pytest asks. Gives: items only where a project asks for them (`--rplan`, or the setting `rplan_files`), the
fixture `plan`, and with `--rplan-coverage` a table and pages of what the tests reached. Leaves alone: everything else;
a project without plans notices nothing. This module is loaded with every pytest, so that it imports nothing of rplan.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from rplan.apps.pytest_plugin.shelf import Shelf
    from rplan.apps.testing import PlanUnderTest

PLAN = ".rplan"
TICKS = (".ticks", ".ticks.jsonl")
HTML = "html:"
SHELF = pytest.StashKey["Shelf"]()


def pytest_addoption(parser: pytest.Parser) -> None:
    group = parser.getgroup("rplan", "plans for robots")
    group.addoption(
        "--rplan", action="store_true", help="collect *.rplan files and golden ticks (setting: rplan_files)"
    )
    group.addoption("--rplan-bless", action="store_true", help="write golden ticks anew as the plans decide now")
    group.addoption(
        "--rplan-coverage",
        nargs="?",
        const="table",
        metavar="html:FOLDER",
        help="say what of each plan the tests reached; html:FOLDER also writes a page for each plan",
    )
    parser.addini("rplan_files", "patterns of plans to collect, such as *.rplan", type="args", default=[])
    parser.addini("rplan_libraries", "Python files with libraries of behaviours", type="paths", default=[])


def pytest_configure(config: pytest.Config) -> None:
    asked = config.getoption("--rplan-coverage")
    if asked is not None and asked != "table" and not (asked.startswith(HTML) and asked != HTML):
        raise pytest.UsageError(f"--rplan-coverage={asked}: `=html:FOLDER` or `=table` is wanted")


def shelf_of(config: pytest.Config) -> Shelf:
    """The plans of this run; rplan is imported when the first is asked for."""
    if SHELF not in config.stash:
        from rplan.apps.pytest_plugin.shelf import Shelf

        config.stash[SHELF] = Shelf(tuple(config.getini("rplan_libraries")))
    return config.stash[SHELF]


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> pytest.Collector | None:
    config = parent.config
    patterns = config.getini("rplan_files") or (["*.rplan"] if config.getoption("--rplan") else [])
    if not patterns or not file_path.name.endswith((PLAN, *TICKS)):
        return None
    from rplan.apps.pytest_plugin import items

    if file_path.suffix == PLAN:
        return items.PlanFile.from_parent(parent, path=file_path) if _matches(file_path, patterns) else None
    from rplan.apps.trying import plan_of

    plan = plan_of(file_path)
    if plan is None or not _matches(plan, patterns):
        return None
    return items.TicksFile.from_parent(parent, path=file_path, plan=plan)


def _matches(path: Path, patterns: list[str]) -> bool:
    return any(path.match(pattern) for pattern in patterns)


@pytest.fixture
def plan(request: pytest.FixtureRequest) -> Callable[[str | Path], PlanUnderTest]:
    """`plan("patrol.rplan")`: a plan under test; a path that is not found as it stands is one beside the test."""
    from rplan.apps.files import InputError, plan_file
    from rplan.apps.libraries import LibraryError
    from rplan.lang.diagnostic import PlanError

    def opened(path: str | Path) -> PlanUnderTest:
        __tracebackhide__ = True
        beside = request.path.parent / path
        try:
            return shelf_of(request.config).under_test(plan_file(str(beside if beside.exists() else path)))
        except InputError as error:
            said = error.format_message()
        except LibraryError as error:
            said = str(error)
        except PlanError as error:
            from rplan.apps.pytest_plugin.shelf import rendered

            said = rendered(error)
        pytest.fail(said, pytrace=False)

    return opened


def pytest_sessionfinish(session: pytest.Session) -> None:
    """A worker of pytest-xdist hands over what its tests reached."""
    output = getattr(session.config, "workeroutput", None)
    if output is not None and SHELF in session.config.stash:
        output["rplan"] = session.config.stash[SHELF].handed_over()


@pytest.hookimpl(optionalhook=True)
def pytest_testnodedown(node: Any) -> None:
    for path, ticks in getattr(node, "workeroutput", {}).get("rplan", {}).items():
        shelf_of(node.config).taken_over(Path(path), ticks)


def pytest_terminal_summary(terminalreporter: Any, config: pytest.Config) -> None:
    asked = config.getoption("--rplan-coverage")
    if asked is None:
        return
    from rplan.apps.pytest_plugin.coverage import show

    folder = Path(asked.removeprefix(HTML)) if asked.startswith(HTML) else None
    show(shelf_of(config), terminalreporter, folder)
