"""Do the rules as printed do what the paper says of them?"""

from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from rplan.apps.cli import cli

HERE = Path(__file__).parent


def prove(path: Path, *options: str) -> Result:
    return CliRunner().invoke(cli, ["prove", str(path), *options])


@pytest.mark.parametrize("name", ["text", "figure"])
def test_the_plans_compile_as_printed(name: str) -> None:
    assert CliRunner().invoke(cli, ["check", str(HERE / f"{name}.rplan")]).exit_code == 0


def test_runaway_and_navigation_exclude_each_other_and_runaway_comes_first() -> None:
    result = prove(HERE / "exclusive.rplan")
    assert result.exit_code == 0
    assert result.stdout.endswith("4 proven\n")


def test_a_plan_edited_so_that_this_breaks_is_refuted_with_a_trace_that_replays(tmp_path: Path) -> None:
    printed = (HERE / "figure.rplan").read_text(encoding="utf-8")
    (tmp_path / "figure.rplan").write_text(printed.replace("(if (or (anything-is-too-close)", "(if (or false"))
    plan = tmp_path / "broken.rplan"
    whole = (HERE / "exclusive.rplan").read_text(encoding="utf-8")
    plan.write_text(whole.replace("(prio-and (maint runaway)", "(prio-and (ach move-to-goal) (maint runaway)"))
    trace = tmp_path / "trace.jsonl"
    result = prove(plan, "--trace", str(trace))
    assert result.exit_code == 1
    assert "runaway-takes-precedence: refuted" in result.stdout
    replayed = CliRunner().invoke(cli, ["tick", str(plan), "--input", str(trace)])
    assert '"action": "(move-according-to-NaT-plan)"' in replayed.stdout.splitlines()[-1]
