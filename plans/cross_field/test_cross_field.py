"""Fields of posts are crossed without touching one, by both presets."""

from pathlib import Path

import pytest

from rplan.apps.simulation import load_world, simulate
from rplan.apps.wiring import compile_source
from rplan.lang.source import Source

HERE = Path(__file__).parent
TEXT = (HERE / "cross_field.rplan").read_text(encoding="utf-8")
FIELD = load_world(HERE / "field.yaml")


@pytest.mark.parametrize("preset", ["paper", "modern"])
@pytest.mark.parametrize("seed", [0, 1])
def test_the_field_is_crossed_without_a_contact(preset, seed):
    plan = compile_source(Source("cross_field.rplan", TEXT.replace(":preset paper", f":preset {preset}")))
    verdict = simulate(plan, FIELD, seed).verdict
    assert verdict.done
    assert not verdict.contacts
