"""Does the plan do by operators what find_and_fetch does by rules?"""

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
LOT = HERE.parent / "find_and_fetch" / "parking_lot.yaml"


@cache
def compiled() -> Compiled:
    return compile_file(HERE / "fetch_by_operators.rplan")


@cache
def run() -> Run:
    return simulate(compiled(), load_world(LOT), 0)


@pytest.mark.rule("L20")
def test_the_compiler_finds_the_order_of_the_steps() -> None:
    actions = [switch.after for switch in run().switches if switch.channel == "action"]
    steps = [action for action in actions if action != "(move-away-from-danger)"]
    assert list(dict.fromkeys(steps)) == [
        "(start-ir-search)",
        "(continue-ir-search)",
        "(start-stereo-ranging)",
        "(continue-stereo-search)",
        "(move-according-to-NaT-plan)",
        "(stop)",
    ]


@pytest.mark.rule("L20")
def test_the_object_is_fetched() -> None:
    verdict = run().verdict
    assert verdict.done, verdict.reason
    assert verdict.driven_into == 0


def test_the_golden_ticks_stand(plan: Callable[[str], PlanUnderTest]) -> None:
    plan("fetch_by_operators.rplan").golden("fetch_by_operators.ticks")


def test_nothing_is_wrong_with_the_plan() -> None:
    assert compiled().diagnostics == ()
