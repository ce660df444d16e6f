"""Does every donor's object come home?"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import pytest

from rplan.apps.simulation import Run, World, load_world, simulate
from rplan.apps.wiring import compile_file
from rplan.driver import Compiled
from sim.scenarios.format import loads

HERE = Path(__file__).parent
LOT = HERE / "three_donors.yaml"
NEAR_TWICE = """
name: two donors, two trips each
bounds: [-10, -10, 10, 10]
time_limit: 60 min
robot: {start: [0, 0]}
donors:
  - {id: ann, at: [5, 1], trips: 2}
  - {id: bob, at: [-4, 4], trips: 2}
home: {unload: 5 s}
"""


@cache
def plan() -> Compiled:
    return compile_file(HERE / "fetch_all.rplan")


@cache
def run(seed: int) -> Run:
    return simulate(plan(), load_world(LOT), seed)


def test_the_plan_has_nothing_to_complain_of() -> None:
    assert plan().diagnostics == ()


@pytest.mark.parametrize("seed", range(2))
def test_three_objects_come_home_one_after_the_other(seed: int) -> None:
    verdict = run(seed).verdict
    assert verdict.done, verdict.reason
    assert len(verdict.deliveries) == 3
    assert verdict.driven_into == 0


def test_once_all_is_fetched_the_robot_rests_at_home() -> None:
    """The plan knows how many donors there are; it does not set out for a fourth."""
    last = [switch.after for switch in run(0).switches if switch.channel == "action"][-1]
    assert last == "(stop)"


def test_each_donor_may_hold_several_objects(tmp_path: Path) -> None:
    text = (HERE / "fetch_all.rplan").read_text(encoding="utf-8").replace(":donors 3", ":donors 2 :trips 2")
    (tmp_path / "lib").mkdir()
    rules = HERE.parent / "lib" / "fetch_by_roaming.rplan"
    (tmp_path / "lib" / rules.name).write_text(rules.read_text(encoding="utf-8"), encoding="utf-8")
    (tmp_path / "twice").mkdir()
    file = tmp_path / "twice" / "twice.rplan"
    file.write_text(text, encoding="utf-8")
    verdict = simulate(compile_file(file), World(loads(NEAR_TWICE, "twice"), NEAR_TWICE), 0).verdict
    assert verdict.done, verdict.reason
    assert len(verdict.deliveries) == 4


def test_no_competence_fails_and_no_tick_is_a_hole() -> None:
    assert run(0).faults == ()
    assert run(0).holes == 0
