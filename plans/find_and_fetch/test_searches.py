"""What the paper says of the two searches, in the worlds of this folder."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import pytest

from rplan.apps.simulation import Run, load_world, simulate
from rplan.apps.wiring import compile_source
from rplan.driver import Compiled
from rplan.lang.source import Source

HERE = Path(__file__).parent
PLAN = HERE / "find_and_fetch.rplan"
IR, STEREO, NAVIGATE = "(start-ir-search)", "(start-stereo-ranging)", "(move-according-to-NaT-plan)"


@cache
def plan(stereo: str = "(use stereo-search)") -> Compiled:
    return compile_source(Source(str(PLAN), PLAN.read_text(encoding="utf-8").replace("(use stereo-search)", stereo)))


def run(world: str, seed: int = 0, until: float | None = None, compiled: Compiled | None = None) -> Run:
    return simulate(compiled or plan(), load_world(HERE / "worlds" / f"{world}.yaml"), seed, until=until)


def moments(run: Run, action: str) -> list[float]:
    return [switch.time for switch in run.switches if switch.channel == "action" and switch.after == action]


@pytest.mark.parametrize(("world", "found"), [("ir_24ft", 1), ("ir_28ft", 0), ("ir_sun", 0), ("ir_sun_blocked", 1)])
def test_one_sweep_finds_the_beacon_only_where_it_can_be_heard(world: str, found: int) -> None:
    for seed in range(3):
        assert len(moments(run(world, seed, until=115), STEREO)) == found


def test_in_the_wind_the_direction_is_found_with_few_retries() -> None:
    sweeps = [len(moments(run("ir_wind", seed, until=420), IR)) for seed in range(3)]
    assert sum(sweeps) / len(sweeps) <= 3


def test_runaway_suspends_a_sweep_and_it_starts_from_scratch() -> None:
    shown = run("ir_runaway")
    away = moments(shown, "(move-away-from-danger)")
    starts = moments(shown, IR)
    assert len(away) >= 1 and len(starts) >= 2
    assert starts[0] == 0.0 and starts[1] > away[0]
    assert moments(shown, STEREO)[0] - starts[1] > 90, "a whole sweep"
    assert shown.verdict.done, shown.verdict.reason


def test_a_donor_beyond_the_cut_off_is_never_driven_to() -> None:
    for seed in range(2):
        assert moments(run("donor_26ft", seed), NAVIGATE) == []


def test_what_stands_between_is_taken_for_the_donor() -> None:
    assert run("donor_behind_box", until=600).verdict.times.arrival is None, "the limit that the paper states"


def test_a_search_from_the_horizon_finds_the_donor_behind_it() -> None:
    verdict = run("donor_behind_box", compiled=plan("(use stereo-search :preset modern)")).verdict
    assert verdict.done, verdict.reason


def test_a_donor_that_moves_has_both_searches_start_again() -> None:
    shown = run("donor_moves")
    left = moments(shown, NAVIGATE)[0]
    assert [at for at in moments(shown, IR) if at > left]
    assert [at for at in moments(shown, STEREO) if at > left]
    assert shown.verdict.done, shown.verdict.reason


def test_trips_alternate_between_the_donor_and_home() -> None:
    verdict = run("three_trips").verdict
    assert verdict.done, verdict.reason
    assert len(verdict.deliveries) == 3
    gaps = [b - a for a, b in zip(verdict.deliveries, verdict.deliveries[1:], strict=False)]
    assert all(60 < gap < 200 for gap in gaps), "no search in between"


def test_a_head_that_sticks_frees_itself_within_the_search() -> None:
    shown = run("head_jams")
    assert shown.verdict.done, shown.verdict.reason
    assert len(moments(shown, STEREO)) == 1


def test_a_head_that_needs_help_is_reported_until_help_comes() -> None:
    shown = run("head_needs_help")
    reported = [
        switch for switch in shown.switches if switch.channel == "rpt-prism-failure?" and switch.after == "true"
    ]
    assert reported and shown.verdict.done, shown.verdict.reason
