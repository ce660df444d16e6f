"""The corridor is followed from end to end and back by either wall follower; the `use` line alone is another."""

from __future__ import annotations

import math
from functools import cache
from pathlib import Path

import pytest

from rplan.apps.wiring import PlanBrain, compile_source
from rplan.driver import Compiled
from rplan.lang.source import Source
from sim.episode import Episode
from sim.judge import Verdict
from sim.scenarios.format import load

HERE = Path(__file__).parent
WORLD = load(HERE / "corridor.yaml")
USED = "wall-by-ransac"


@cache
def compiled(used: str) -> Compiled:
    """The plan with a library in its `use` line."""
    text = (HERE / "corridor.rplan").read_text(encoding="utf-8")
    line = f"(use {USED} "
    assert text.count(line) == 1
    return compile_source(Source("corridor.rplan", text.replace(line, f"(use {used} ")))


class Ends:
    """When the robot was in the dead end in the north, in the one in the west, and back at the start."""

    PLACES = ((14.0, 12.0), (9.3, 9.0), (0.5, 0.0))

    def __init__(self) -> None:
        self.reached: list[float] = []

    def observe(self, episode: Episode) -> None:
        pose, count = episode.world.robot.pose, len(self.reached)
        if count < len(self.PLACES) and math.dist((pose.x, pose.y), self.PLACES[count]) < 1.2:
            self.reached.append(episode.time)


@cache
def run(used: str, seconds: float) -> tuple[Verdict, list[float]]:
    """The verdict of a run by a follower, and when it was where."""
    plan = compiled(used)
    ends = Ends()
    return Episode(WORLD, 0, plan.goals.period).run(PlanBrain(plan), seconds, ends), ends.reached


def test_it_goes_to_both_dead_ends_and_back_without_a_touch() -> None:
    verdict, reached = run(USED, 215)
    assert not verdict.contacts and len(reached) == 3
    assert verdict.smallest_clearance > 0.15


def test_the_other_follower_goes_the_same_way_at_the_same_pace() -> None:
    verdict, reached = run("wall-by-hough", 170)
    _, by_ransac = run(USED, 215)
    assert not verdict.contacts and len(reached) == 3
    assert reached == pytest.approx(by_ransac, rel=0.2)
    assert verdict.smallest_clearance > 0.15


def test_plan_and_swapped_plan_decide_alike() -> None:
    one, other = compiled(USED), compiled("wall-by-hough")
    assert one.diagnostics == other.diagnostics == ()
    assert [term.name for term in one.goals.percepts()] == [term.name for term in other.goals.percepts()]
