"""Does the plan do its job? Golden ticks of the plan alone, and runs in the parking lot."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path

import pytest

from rplan.apps.simulation import Run, load_world, simulate
from rplan.apps.testing import PlanUnderTest
from rplan.apps.wiring import compile_file
from rplan.driver import Compiled

HERE = Path(__file__).parent
Opened = Callable[[str], PlanUnderTest]
RUNAWAY, NAVIGATE = "(move-away-from-danger)", "(move-according-to-NaT-plan)"


@cache
def compiled() -> Compiled:
    return compile_file(HERE / "find_and_fetch.rplan")


@cache
def run(seed: int) -> Run:
    return simulate(compiled(), load_world(HERE / "parking_lot.yaml"), seed)


def test_the_golden_ticks_stand(plan: Opened) -> None:
    """`pytest --rplan --rplan-bless plans/find_and_fetch/find_and_fetch.ticks` writes them anew."""
    plan("find_and_fetch.rplan").golden("find_and_fetch.ticks")


def test_the_plan_has_nothing_to_complain_of() -> None:
    assert compiled().diagnostics == ()


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_the_object_is_fetched_without_driving_into_anything(seed: int) -> None:
    verdict = run(seed).verdict
    assert verdict.done, verdict.reason
    assert verdict.driven_into == 0
    assert verdict.smallest_clearance > 0.0


def test_the_search_takes_about_seven_minutes_as_in_the_paper() -> None:
    departure = run(0).verdict.times.departure
    assert departure is not None
    assert 5 * 60 < departure < 8 * 60


def test_the_trashcan_that_is_rolled_at_the_robot_provokes_a_runaway() -> None:
    assert run(0).shares[RUNAWAY].switches >= 1


def test_runaway_gives_way_to_navigation_once_danger_is_over() -> None:
    actions = [switch.after for switch in run(0).switches if switch.channel == "action"]
    after_runaway = {actions[n + 1] for n, action in enumerate(actions[:-1]) if action == RUNAWAY}
    assert after_runaway == {NAVIGATE}


def test_every_switch_has_a_reason() -> None:
    switches = run(0).switches
    assert switches
    assert all("became" in switch.because for switch in switches[1:])


def test_no_competence_fails_and_no_tick_is_a_hole() -> None:
    assert run(0).faults == ()
    assert run(0).holes == 0
