"""The rules of find and fetch on another robot: only what it uses is said anew."""

from __future__ import annotations

from pathlib import Path

import pytest

from rplan.apps.wiring import PlanBrain, compile_file
from sim.episode import run
from sim.scenarios.format import load

HERE = Path(__file__).parent
PLAN = HERE / "fetch_with_lidar.rplan"


def rules(plan: Path) -> str:
    """Everything from the first output on."""
    text = plan.read_text(encoding="utf-8")
    return text[text.index("(defoutput") :]


def test_nothing_but_the_use_lines_differs_from_find_and_fetch():
    assert rules(PLAN) == rules(HERE.parent / "find_and_fetch" / "find_and_fetch.rplan")


def test_the_robot_has_a_lidar_and_no_sonar():
    kinds = [sensor.name for sensor in load(HERE / "parking_lot.yaml").robot.sensors]
    assert "lidar" in kinds and "sonar" not in kinds


@pytest.mark.parametrize("seed", [0])
def test_it_fetches_and_drives_into_nothing(seed):
    verdict = run(load(HERE / "parking_lot.yaml"), seed, PlanBrain(compile_file(PLAN)))
    assert verdict.done and verdict.driven_into == 0
