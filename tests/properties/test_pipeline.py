"""From text to ticks: a whole plan does in every situation what the reference meaning says."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from properties.strategies import EVERY_ORDER, goals, whole
from properties.texts import Values, as_text, compiled, decider, holds, said, situation, situations

from rplan.goals.goal import Do, Goal, walk
from rplan.ways.checks.branches import NEVER_DONE
from rplan.ways.coverage import review
from rplan.ways.exhaust import count_situations, exhaustible
from rplan.ways.meaning import taken
from rplan.ways.reach import Reach
from rplan.ways.reduce import reduce
from rplan.ways.situations import Undecided


def text_of(goal: Goal, data: st.DataObject) -> str:
    rules: list[str] = []
    top = as_text(goal, lambda: data.draw(st.integers(0, 3)) == 0, rules)
    return "\n".join([*rules, f"(goalem {top})"])


@pytest.mark.rule("L18")
@settings(max_examples=120, deadline=None, derandomize=True)
@given(goals(numbers=True, max_leaves=8), st.data())
def test_a_plan_as_text_decides_as_the_reference_meaning_of_its_goal(goal: Goal, data: st.DataObject) -> None:
    plan = compiled(text_of(goal, data), allow_holes=True)
    decide = decider(plan)
    for values in situations(goal, EVERY_ORDER[::2]):
        expected = taken(goal, situation(goal, values))
        decision = decide.tick(values)
        assert decision.hole == (expected is None)
        set_now = {(output, term.text) for output, term in decision.outputs.items() if term is not None}
        assert set_now == (set(expected.acts) if expected else set())


def true_percepts(values: Values) -> int:
    return sum(value is True for value in values.values())


@pytest.mark.rule("L26")
@settings(max_examples=120, deadline=None, derandomize=True)
@given(goals(max_leaves=8) | goals(numbers=True, max_leaves=7))
def test_a_hole_is_found_where_there_is_one_with_a_witness_of_fewest_true_percepts(goal: Goal) -> None:
    plan = compiled(f"(goalem {as_text(goal, lambda: False, [])})", allow_holes=True)
    holes = [values for values in situations(goal, EVERY_ORDER) if taken(goal, situation(goal, values)) is None]
    assert ("hole" in said(plan.diagnostics)) == bool(holes)
    trace = Reach(plan.ways).trace((plan.ways.hole, True))
    assert not isinstance(trace, Undecided)
    assert (trace is not None) == bool(holes)
    if trace is not None:
        (witness,) = trace
        assert taken(goal, situation(goal, witness)) is None
        assert true_percepts(witness) == min(map(true_percepts, holes))
        assert [*witness] == [*holes[0]], "in textual order"


@settings(max_examples=80, deadline=None, derandomize=True)
@given(goals(numbers=True, max_leaves=7))
def test_an_act_is_said_never_to_be_done_exactly_where_no_situation_does_it(goal: Goal) -> None:
    plan = compiled(f"(goalem {as_text(goal, lambda: False, [])})", allow_holes=True)
    done = set()
    for values in situations(goal, EVERY_ORDER):
        seen = plan.ways.guards.evaluate([holds(atom, values) for atom in plan.ways.atoms])
        done |= {node.goal.span for node in plan.ways.layout.nodes if seen[plan.ways.reached[node.number]]}
    every = {node.span for node in walk(plan.goals.top) if isinstance(node, Do)}
    if all(code != "hole" for code in said(plan.diagnostics)):
        never = {r.span for d in review(plan.ways) for r in d.related if r.message == NEVER_DONE}
        assert never == every - done


@settings(max_examples=150, deadline=None, derandomize=True)
@given(goals(max_leaves=8))
def test_situations_are_counted_as_if_each_were_tried(goal: Goal) -> None:
    ways = reduce(whole(goal))
    assert exhaustible(ways)
    guards = [ways.hole, *ways.reached, *(guard for values in ways.sets.values() for guard in values.values())]
    tried = [0] * len(guards)
    for number in range(1 << len(ways.atoms)):
        seen = ways.guards.evaluate([bool(number >> atom & 1) for atom in range(len(ways.atoms))])
        tried = [count + seen[guard] for count, guard in zip(tried, guards, strict=True)]
    assert [count_situations(ways, guard) for guard in guards] == tried
