"""Percepts of branches that are not taken are sampled and evaluated like all others."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from rplan.apps.cli import cli

BRANCHES = "(goalem (if (near) (do x a) (if (late) (do x b) (do x c))))"


def tick(plan: Path, percepts: dict[str, bool]) -> Result:
    return CliRunner().invoke(cli, ["tick", str(plan)], input=json.dumps(percepts))


@pytest.mark.rule("L11")
def test_a_condition_of_a_branch_that_is_not_taken_is_evaluated_all_the_same(tmp_path: Path) -> None:
    plan = tmp_path / "branches.rplan"
    plan.write_text(BRANCHES, encoding="utf-8")
    taken = tick(plan, {"near": True, "late": False})
    assert taken.exit_code == 0
    assert '"x": "(a)"' in taken.output
    missing = tick(plan, {"near": True})
    assert missing.exit_code == 2
    assert "`late`" in missing.output
