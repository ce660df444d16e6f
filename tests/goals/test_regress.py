"""Goals regressed over operators take the shortest way there is, and say where there is none (L20)."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import product

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rplan.goals.regress import RegressionError, regress
from rplan.lang import plan as p
from rplan.lang.printer import canonical
from rplan.lang.source import NOWHERE

FACTS = ("f", "g", "h")
State = Mapping[str, bool]
STATES = [dict(zip(FACTS, bits, strict=True)) for bits in product((False, True), repeat=len(FACTS))]


def call(name: str, *arguments: p.Argument) -> p.Call:
    return p.Call(name, arguments, NOWHERE)


def operator(number: int, pre: p.Condition, adds: tuple[str, ...], deletes: tuple[str, ...]) -> p.Operator:
    facts = [tuple(call(name) for name in names) for names in (adds, deletes)]
    return p.Operator(f"op{number}", (), "", "act", call(f"a{number}"), pre, facts[0], facts[1], NOWHERE, NOWHERE)


def holds(condition: p.Condition, state: State) -> bool:
    match condition:
        case p.Truth(value):
            return value
        case p.Call(name):
            return state[name]
        case p.Not(inner):
            return not holds(inner, state)
        case p.AllOf(parts):
            return all(holds(part, state) for part in parts)
        case p.AnyOf(parts):
            return any(holds(part, state) for part in parts)
    raise AssertionError(condition)


def after(one: p.Operator, state: State) -> dict[str, bool]:
    deleted = dict.fromkeys((fact.name for fact in one.deletes), False)
    return {**state, **deleted, **dict.fromkeys((fact.name for fact in one.adds), True)}


def distance(goal: p.Condition, operators: list[p.Operator], state: State) -> int | None:
    """The fewest operators that lead to the goal, by search."""
    seen, ring = [dict(state)], [dict(state)]
    for steps in range(len(STATES) + 1):
        if any(holds(goal, here) for here in ring):
            return steps
        ring = [after(one, here) for here in ring for one in operators if holds(one.precondition, here)]
        ring = [here for n, here in enumerate(ring) if here not in seen and here not in ring[:n]]
        seen += ring
    return None


conditions = st.recursive(
    st.sampled_from(FACTS).map(call) | st.just(p.Truth(True, NOWHERE)),
    lambda inner: st.one_of(
        inner.map(lambda one: p.Not(one, NOWHERE)),
        st.lists(inner, min_size=1, max_size=3).map(lambda parts: p.AllOf(tuple(parts), NOWHERE)),
        st.lists(inner, min_size=1, max_size=3).map(lambda parts: p.AnyOf(tuple(parts), NOWHERE)),
    ),
    max_leaves=4,
)
facts = st.lists(st.sampled_from(FACTS), max_size=2, unique=True).map(tuple)


@pytest.mark.rule("L20")
@settings(max_examples=300)
@given(conditions, st.lists(st.tuples(conditions, facts, facts), max_size=4))
def test_every_clause_takes_one_step_of_a_shortest_way(
    goal: p.Condition, kinds: list[tuple[p.Condition, tuple[str, ...], tuple[str, ...]]]
) -> None:
    operators = [operator(number, *kind) for number, kind in enumerate(kinds)]
    acts = {canonical(one.value): one for one in operators}
    clauses = regress(goal, operators, (), 8, NOWHERE)
    for state in STATES:
        clause = next((clause for clause in clauses if holds(clause.condition, state)), None)
        steps = distance(goal, operators, state)
        assert (clause is None) == (steps is None)
        if clause is not None and steps == 0:
            assert clause.act is None
        elif clause is not None and steps is not None:
            assert clause.act is not None
            one = acts[canonical(clause.act.value)]
            assert holds(one.precondition, state)
            assert distance(goal, operators, after(one, state)) == steps - 1


@pytest.mark.rule("L20")
def test_depth_limits_the_steps() -> None:
    chain = [
        operator(0, call("g"), ("f",), ()),
        operator(1, call("h"), ("g",), ()),
        operator(2, p.Truth(True, NOWHERE), ("h",), ()),
    ]
    assert [len(regress(call("f"), chain, (), depth, NOWHERE)) for depth in (0, 1, 2, 3, 8)] == [1, 2, 3, 4, 4]


@pytest.mark.rule("L20")
def test_a_conjunction_is_regressed_as_one_so_that_no_operator_undoes_what_another_did() -> None:
    undoing = [operator(0, p.Truth(True, NOWHERE), ("f",), ("g",)), operator(1, p.Truth(True, NOWHERE), ("g",), ())]
    clauses = regress(p.AllOf((call("f"), call("g")), NOWHERE), undoing, (), 8, NOWHERE)
    state = {"f": False, "g": False, "h": False}
    first = next(clause for clause in clauses if holds(clause.condition, state))
    assert first.act is not None
    assert canonical(first.act.value) == "(a0)"


@pytest.mark.rule("L20")
def test_variables_range_over_the_symbols_in_the_order_of_the_plan() -> None:
    here = p.Variable("place", NOWHERE)
    go = p.Operator(
        "go", ("place",), "", "act", call("go", here), p.Truth(True, NOWHERE), (call("at", here),), (), NOWHERE, NOWHERE
    )
    clauses = regress(call("at", call("dock")), [go], ("home", "dock"), 8, NOWHERE)
    assert [canonical(clause.act.value) for clause in clauses if clause.act] == ["(go (dock))"]


@pytest.mark.rule("L20")
def test_what_asks_the_past_of_a_fact_that_changes_cannot_be_regressed() -> None:
    remembered = p.Memory("once", (call("f"),), NOWHERE)
    with pytest.raises(RegressionError, match="asks the past"):
        regress(remembered, [operator(0, p.Truth(True, NOWHERE), ("f",), ())], (), 8, NOWHERE)
