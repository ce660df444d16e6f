"""Find and fetch with two lines more, which get it out of where it is held and round that."""

from __future__ import annotations

import difflib
from pathlib import Path

from rplan.apps.simulation import World, simulate
from rplan.apps.sweep.work import Change, changed
from rplan.apps.wiring import compile_file
from sim.scenarios.format import loads

HERE = Path(__file__).parent
PLAN = HERE / "fetch_steering_clear.rplan"
PLAIN = HERE.parent / "find_and_fetch" / "find_and_fetch.rplan"
MODERN = tuple(
    Change(name, "preset", "modern") for name in ("natigation", "ir-search", "stereo-search", "find-and-fetch")
)


def lines(path):
    return path.read_text(encoding="utf-8").splitlines()


def run(path, seed):
    text = (HERE / "wheel_stops.yaml").read_text(encoding="utf-8")
    return simulate(changed(compile_file(path), MODERN), World(loads(text, "wheel_stops.yaml"), text), seed)


def test_it_is_find_and_fetch_with_two_lines_more():
    differences = [line for line in difflib.ndiff(lines(PLAIN), lines(PLAN)) if not line.startswith("  ")]
    assert differences == ['+ (include "../lib/steering_clear.rplan")', "+                   (maint freedom)"]


def test_held_by_what_no_sonar_sees_it_gets_out_and_round_it():
    run_of_it = run(PLAN, 1)
    assert run_of_it.verdict.done
    assert run_of_it.shares["(escape-from-stasis)"].ticks > 0
    assert run_of_it.shares["(steer-clear-of-obstacles)"].ticks > 0
