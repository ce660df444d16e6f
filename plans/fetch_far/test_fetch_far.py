"""Is a donor beyond hearing found and its object fetched?"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import pytest

from rplan.apps.simulation import Run, World, load_world, simulate
from rplan.apps.wiring import compile_file
from rplan.driver import Compiled
from sim.scenarios.format import loads

HERE = Path(__file__).parent
LOT = HERE / "far_lot.yaml"
PAPER = HERE.parent / "find_and_fetch" / "find_and_fetch.rplan"


@cache
def plan() -> Compiled:
    return compile_file(HERE / "fetch_far.rplan")


@cache
def run(seed: int) -> Run:
    return simulate(plan(), load_world(LOT), seed)


def actions(run: Run) -> list[str]:
    return [switch.after for switch in run.switches if switch.channel == "action"]


def test_the_plan_has_nothing_to_complain_of() -> None:
    assert plan().diagnostics == ()


@pytest.mark.parametrize("seed", range(3))
def test_a_donor_45_feet_away_is_found_and_its_object_fetched(seed: int) -> None:
    verdict = run(seed).verdict
    assert verdict.done, verdict.reason
    assert verdict.driven_into == 0


@pytest.mark.parametrize(("at", "seed"), [("[-17, 6]", 5), ("[3, -11]", 6), ("[-9, -9]", 7)])
def test_it_is_found_in_any_direction_up_to_60_feet(at: str, seed: int) -> None:
    text = LOT.read_text(encoding="utf-8").replace("at: [45 ft, 0]", f"at: {at}")
    verdict = simulate(plan(), World(loads(text, "elsewhere"), text), seed).verdict
    assert verdict.done, verdict.reason


def test_it_listens_at_home_drives_on_and_listens_again() -> None:
    wanted = iter(actions(run(0)))
    steps = (
        "(start-ir-search)",
        "(move-according-to-NaT-plan)",
        "(start-ir-search)",
        "(start-stereo-ranging)",
        "(move-according-to-NaT-plan)",
    )
    assert all(step in wanted for step in steps), "in this order"


def test_the_plan_of_the_paper_does_not_find_it() -> None:
    lost = simulate(compile_file(PAPER), load_world(LOT), 0, until=900)
    assert not lost.verdict.done and "(start-stereo-ranging)" not in actions(lost)


def test_no_competence_fails_and_no_tick_is_a_hole() -> None:
    assert run(0).faults == ()
    assert run(0).holes == 0
