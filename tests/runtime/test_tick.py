"""A plan alone: percepts to bits, bits to values, and how a tick is written down (L22)."""

from __future__ import annotations

import json

import pytest
from hypothesis import given, settings
from properties.strategies import goals
from properties.texts import as_text, compiled, decider, situations

from rplan.driver import Compiled
from rplan.goals.goal import Goal
from rplan.runtime.encode import PerceptError, encoder
from rplan.runtime.trace import Trace

PLAN = "(goalem (if (and (lost) (< (near) 2m) (> (near) (far))) (do lamp on) (do lamp off)))"
GOOD: dict[str, bool | float] = {"(lost)": True, "(near)": 1.5, "(far)": 1}


@pytest.fixture(scope="module")
def plan() -> Compiled:
    return compiled(PLAN)


def test_percepts_become_the_atoms_that_the_circuit_asks(plan: Compiled) -> None:
    encode = encoder(plan.goals, plan.ways.atoms)
    assert [atom.text for atom in plan.ways.atoms] == ["(lost)", "(< (near) 2m)", "(> (near) (far))"]
    assert encode(GOOD) == (True, True, True)
    assert encode(GOOD | {"(near)": 2}) == (True, False, True)
    assert encode(GOOD | {"(far)": 1.5}) == (True, True, False)


@pytest.mark.rule("L22")
@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"(lost)": 1}, "(lost): true or false is wanted, not 1"),
        ({"(lost)": "yes"}, '(lost): true or false is wanted, not "yes"'),
        ({"(lost)": None}, "(lost): true or false is wanted, not null"),
        ({"(near)": True}, "(near): a finite number is wanted, not true"),
        ({"(near)": float("nan")}, "(near): a finite number is wanted, not NaN"),
        ({"(near)": float("-inf")}, "(near): a finite number is wanted, not -Infinity"),
        ({"(near)": 10**400}, "(near): a finite number is wanted, not 1000000000000000000000000000000000000000…"),
        ({"(far)": [1]}, "(far): a finite number is wanted, not [1]"),
        ({"(far)": object}, "(far): a finite number is wanted, not \"<class 'object'>\""),
    ],
)
def test_a_value_of_the_wrong_type_is_refused_by_name(plan: Compiled, wrong: dict[str, object], message: str) -> None:
    with pytest.raises(PerceptError) as caught:
        decider(plan).tick({**GOOD, **wrong})
    assert str(caught.value) == message
    assert caught.value.key == next(iter(wrong))


@pytest.mark.rule("L22")
def test_a_missing_percept_is_refused_and_the_tick_not_counted() -> None:
    decide = decider(compiled("(defoutput lamp symbol :hold :initial off) (goalem (when (lost) (do lamp on)))"))
    with pytest.raises(PerceptError, match="there is no value"):
        decide.tick({})
    sent = decide.tick({"(lost)": False, "(more)": True}).sent["lamp"]
    assert sent is not None
    assert sent.text == "off"


def test_a_reset_forgets_what_is_held() -> None:
    decide = decider(compiled("(defoutput lamp symbol :hold) (goalem (when (lost) (do lamp on)))"))
    shown = []
    for lost in (False, True, False):
        shown.append(decide.tick({"(lost)": lost}).sent["lamp"])
    decide.reset()
    shown.append(decide.tick({"(lost)": False}).sent["lamp"])
    assert [None if term is None else term.text for term in shown] == [None, "on", "on", None]


@pytest.mark.rule("L22")
def test_a_line_of_a_tick_is_as_the_language_says() -> None:
    plan = compiled(
        "(defoutput goal pose) (defoutput action symbol :idle stop) (defoutput lamp symbol)\n"
        "(defgoalr (ach home) (if (far) (do goal home) (do lamp on)))\n"
        "(goalem (prio-and (ach home) (do lamp off)))"
    )
    decision = decider(plan).tick({"(far)": False})
    assert Trace(plan.ways).line(7, decision) == (
        '{"tick": 7, "hole": false, "outputs": {"goal": null, "action": null, "lamp": "on"}, '
        '"sent": {"goal": null, "action": "stop", "lamp": "on"}, '
        '"way": {"rules": ["(ach home)"], '
        '"branches": [{"condition": "(far)", "value": false, "rule": "(ach home)", "line": 2}], '
        '"acts": [{"output": "lamp", "value": "on", "rule": "(ach home)", "line": 2}], '
        '"given_up": [{"member": "(do lamp off)", '
        '"because": "lamp would be off, and (ach home) sets it to on", "line": 3}]}}'
    )


def test_a_way_is_put_into_words_once_for_equal_inputs(plan: Compiled) -> None:
    trace, decide = Trace(plan.ways), decider(plan)
    first, second = decide.tick(GOOD), decide.tick(GOOD)
    assert trace.way(first) is trace.way(second)


@settings(max_examples=40, deadline=None, derandomize=True)
@given(goals(numbers=True, max_leaves=7))
def test_every_line_is_json_that_agrees_with_the_decision(goal: Goal) -> None:
    plan = compiled(f"(goalem {as_text(goal, lambda: False, [])})", allow_holes=True)
    decide, trace = decider(plan), Trace(plan.ways)
    for number, values in enumerate(situations(goal, (0.0, 1.0, 3.0))):
        decision = decide.tick(values)
        line = json.loads(trace.line(number, decision))
        assert [*line] == ["tick", "hole", "outputs", "sent", "way"]
        acts = {act["output"]: act["value"] for act in line["way"]["acts"]}
        assert acts == {output: text for output, text in line["outputs"].items() if text is not None}
        assert line["hole"] is decision.hole
