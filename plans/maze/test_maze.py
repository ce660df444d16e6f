"""The maze: either hand on the wall leads to the goal."""

from __future__ import annotations

from pathlib import Path

import pytest

from rplan.apps.wiring import PlanBrain, compile_source
from rplan.lang.source import Source
from sim.episode import Episode
from sim.scenarios.format import load
from sim.scenarios.importers.choose import read
from sim.scenarios.importers.imported import Options

HERE = Path(__file__).parent


@pytest.mark.parametrize("follower", ["wall-by-ransac", "wall-by-hough"])
@pytest.mark.parametrize("side", ["right", "left"])
def test_either_hand_leads_to_the_goal_whoever_finds_the_wall(side: str, follower: str) -> None:
    text = (HERE / "maze.rplan").read_text(encoding="utf-8")
    used = "(use wall-by-ransac :preset modern :side right"
    assert text.count(used) == 1
    plan = compile_source(Source("maze.rplan", text.replace(used, f"(use {follower} :preset modern :side {side}")))
    verdict = Episode(load(HERE / "maze.yaml"), 0, plan.goals.period).run(PlanBrain(plan), 150)
    assert verdict.done and not verdict.contacts


def test_the_world_is_the_maze_eight_times_as_large() -> None:
    small, large = read(HERE / "maze.txt", Options()).document, load(HERE / "maze.yaml")
    assert large.bounds == pytest.approx([8 * side for side in small["bounds"]])
    assert large.goal is not None
    assert (large.goal.at[0], large.goal.at[1]) == pytest.approx([8 * side for side in small["goal"]["at"]])
