"""Does `make_room` do its job: away from both trashcans, and at rest when nobody is near?"""

from __future__ import annotations

from pathlib import Path

import pytest

from rplan.apps.simulation import load_world, simulate
from rplan.apps.wiring import compile_file

HERE = Path(__file__).parent


@pytest.mark.parametrize("seed", [0, 1])
def test_it_makes_room_twice_and_then_rests(seed: int) -> None:
    run = simulate(compile_file(HERE / "make_room.rplan"), load_world(HERE / "visit.yaml"), seed)
    doing = [switch.after for switch in run.switches]
    assert doing == ["(stop)", *["(move-away-from-danger)", "(stop)"] * 2]
    assert run.verdict.contacts == ()
    assert run.verdict.distance > 0.4
    assert run.holes == 0
    assert run.faults == ()
