"""Registers and guards remember what the reference meaning says of the whole history."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from properties.strategies import ATOMS, do, percept, remember, remembering, whole

from rplan.backends.python import PythonEngine
from rplan.circuit import passes
from rplan.circuit.build import build
from rplan.goals.condition import Condition
from rplan.goals.goal import Anything, If
from rplan.lang.source import NOWHERE
from rplan.ways.meaning import Situation, holds
from rplan.ways.reduce import reduce

Tick = dict[str, bool]
TICK = st.fixed_dictionaries({name: st.booleans() for name in ATOMS[:2]})


def agrees(condition: Condition, traces: Sequence[Sequence[Tick]]) -> None:
    goal = If(condition, do("x", "(p)"), Anything("(goalem)", NOWHERE), "(goalem)", NOWHERE)
    ways = reduce(whole(goal))
    engine = PythonEngine(passes.run(build(ways)))
    for trace in traces:
        engine.reset()
        situation = None
        for tick in trace:
            situation = Situation(tick.__getitem__, situation)
            outputs = engine.tick([tick[atom.text] for atom in ways.atoms])
            assert outputs[1] == holds(condition, situation), (trace, condition)


@pytest.mark.rule("L9")
@pytest.mark.parametrize("form", ["delay", "once", "historically", "rose", "fell", "held-for", "within", "at-least"])
@pytest.mark.parametrize("ticks", [1, 2, 3, 4, 5, 6])
def test_a_form_of_one_condition_is_right_on_every_trace_of_eight_ticks(form: str, ticks: int) -> None:
    traces = [[{"(a)": bit} for bit in bits] for bits in product((False, True), repeat=8)]
    agrees(remember(form, [percept("(a)")], initial=ticks % 2 == 0, ticks=ticks), traces)


@pytest.mark.rule("L9")
@pytest.mark.parametrize("form", ["since", "latch", "at-least"])
def test_a_form_of_two_conditions_is_right_on_every_trace_of_five_ticks(form: str) -> None:
    ticks = [dict(zip(ATOMS[:2], bits, strict=True)) for bits in product((False, True), repeat=2)]
    traces = [list(trace) for trace in product(ticks, repeat=5)]
    agrees(remember(form, [percept("(a)"), percept("(b)")], initial=True, ticks=2), traces)


@pytest.mark.rule("L11")
@settings(max_examples=300, deadline=None)
@given(remembering(), st.lists(st.lists(TICK, min_size=1, max_size=14), min_size=1, max_size=6))
def test_memories_of_memories_are_what_the_history_says(condition: Condition, traces: list[list[Tick]]) -> None:
    agrees(condition, traces)
