"""Registers and guards remember what the reference meaning says of the whole history."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from properties.strategies import ATOMS, do, remembering, whole

from rplan.backends.python import PythonEngine
from rplan.circuit import passes
from rplan.circuit.build import build
from rplan.goals.condition import Condition
from rplan.goals.goal import Anything, If
from rplan.lang.source import NOWHERE
from rplan.ways.meaning import Situation, holds
from rplan.ways.reduce import reduce

TICK = st.fixed_dictionaries({name: st.booleans() for name in ATOMS[:2]})


@pytest.mark.rule("L9")
@pytest.mark.rule("L11")
@settings(max_examples=500, deadline=None)
@given(remembering(), st.lists(TICK, min_size=1, max_size=14))
def test_a_condition_with_memory_is_what_the_history_says(condition: Condition, trace: list[dict[str, bool]]) -> None:
    goal = If(condition, do("x", "(p)"), Anything("(goalem)", NOWHERE), "(goalem)", NOWHERE)
    ways = reduce(whole(goal))
    engine = PythonEngine(passes.run(build(ways)))
    situation = None
    for tick in trace:
        situation = Situation(tick.__getitem__, situation)
        outputs = engine.tick([tick[atom.text] for atom in ways.atoms])
        assert outputs[1] == holds(condition, situation)
