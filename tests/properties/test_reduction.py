"""The compiler agrees with the reference meaning in every situation."""

from __future__ import annotations

from itertools import product

import pytest
from hypothesis import given, settings
from properties.strategies import ATOMS, goals, whole

from rplan.goals.goal import Goal
from rplan.ways.meaning import taken
from rplan.ways.reduce import Ways, reduce
from rplan.ways.way import taken_way

SITUATIONS = [dict(zip(ATOMS, bits, strict=True)) for bits in product((False, True), repeat=len(ATOMS))]


def agree(goal: Goal) -> None:
    ways = reduce(whole(goal))
    for situation in SITUATIONS:
        expected = taken(goal, situation.__getitem__)
        atoms = [situation[atom.text] for atom in ways.atoms]
        values = ways.guards.evaluate(atoms)
        assert values[ways.hole] == (expected is None)
        acts = {(o, v) for o, vs in ways.sets.items() for v, guard in vs.items() if values[guard]}
        assert acts == (set(expected.acts) if expected else set())
        if expected:
            same_places(ways, values, expected.given_up, expected.leaves)
            explained = taken_way(ways, atoms)
            assert {(act.output, act.value) for act in explained.acts} == acts
            assert len(explained.given_up) == len(expected.given_up)


def same_places(ways: Ways, values: list[bool], given_up: tuple, leaves: tuple) -> None:
    places: dict[int, tuple[int, ...]] = {0: ()}
    for node in ways.layout.nodes:
        for n, child in enumerate(ways.layout.inside[node.number]):
            places[child] = (*places[node.number], n)
    lost = {places[m.node] for m in ways.layout.members[1:] if values[ways.given_up[m.number]]}
    assert lost == set(given_up)
    served = {places[n.number] for n in ways.layout.nodes if values[ways.reached[n.number]]}
    assert set(leaves) <= served


@pytest.mark.rule("L19")
@settings(max_examples=400, deadline=None, derandomize=True)
@given(goals(impossible=True, alternatives=False, max_leaves=16))
def test_without_alternatives_the_greedy_form_is_the_way_of_the_reference(goal: Goal) -> None:
    agree(goal)


@pytest.mark.rule("L18")
@settings(max_examples=600, deadline=None, derandomize=True)
@given(goals(impossible=True, max_leaves=9))
def test_with_alternatives_the_way_taken_is_the_one_of_the_reference(goal: Goal) -> None:
    agree(goal)
