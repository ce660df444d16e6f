"""Guards as boolean algebra, ways counted exactly and by samples, and ways as the paper counts them (L23)."""

from __future__ import annotations

from itertools import product

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from properties.strategies import goals, whole
from properties.texts import compiled

from rplan.goals.goal import Goal
from rplan.ways.count import count
from rplan.ways.exhaust import count_ways, exhaustible
from rplan.ways.guards import FALSE, TRUE, Guards
from rplan.ways.reduce import reduce
from rplan.ways.sample import Samples

ATOMS = 3


@settings(max_examples=150, deadline=None, derandomize=True)
@given(st.lists(st.tuples(st.integers(0, 2), st.integers(0, 99), st.integers(0, 99)), max_size=30))
def test_whatever_guards_simplify_they_mean_what_was_said(steps: list[tuple[int, int, int]]) -> None:
    guards = Guards()
    built = [FALSE, TRUE, *(guards.atom(n) for n in range(ATOMS))]
    situations = [*product((False, True), repeat=ATOMS)]
    columns = [[False] * 8, [True] * 8, *([bits[n] for bits in situations] for n in range(ATOMS))]
    for kind, x, y in steps:
        a, b = x % len(built), y % len(built)
        both = list(zip(columns[a], columns[b], strict=True))
        match kind:
            case 0:
                built.append(guards.negation(built[a]))
                columns.append([not p for p in columns[a]])
            case 1:
                built.append(guards.both(built[a], built[b]))
                columns.append([p and q for p, q in both])
            case _:
                built.append(guards.either(built[a], built[b]))
                columns.append([p or q for p, q in both])
    for number, bits in enumerate(situations):
        values = guards.evaluate(bits)
        assert [values[guard] for guard in built] == [column[number] for column in columns]


def test_a_guard_and_its_opposite_fold_at_any_depth() -> None:
    guards = Guards()
    a, b, c = (guards.atom(n) for n in range(3))
    not_a = guards.negation(a)
    assert guards.both(guards.either(a, b), not_a) == guards.both(b, not_a)
    assert guards.both(guards.either(b, a), not_a) == guards.both(b, not_a)
    assert guards.either(guards.both(a, b), not_a) == guards.either(b, not_a)
    assert guards.both(guards.both(a, b), not_a) == FALSE
    assert guards.either(guards.either(a, c), not_a) == TRUE
    assert guards.both(a, guards.either(a, c)) == a
    assert guards.either(a, guards.both(a, c)) == a
    assert guards.all_of([]) == TRUE
    assert guards.any_of([]) == FALSE


@settings(max_examples=100, deadline=None, derandomize=True)
@given(goals(max_leaves=8))
def test_ways_are_counted_as_if_each_situation_were_tried_and_samples_show_no_more(goal: Goal) -> None:
    ways = reduce(whole(goal))
    taken = set()
    for bits in product((False, True), repeat=len(ways.atoms)):
        values = ways.guards.evaluate(bits)
        if not values[ways.hole]:
            taken.add(tuple(values[guard] for guard in (*ways.reached, *ways.given_up)))
    assert count_ways(ways) == len(taken)
    assert Samples(ways).count_ways() <= len(taken)


def test_a_plan_of_many_percepts_is_counted_by_samples() -> None:
    text = "(goalem (and " + " ".join(f"(when (p{n}) (do x{n} on))" for n in range(25)) + "))"
    ways = compiled(text).ways
    assert not exhaustible(ways)
    assert 1_000 < Samples(ways).count_ways() < 2**25


def test_a_plan_that_compares_numbers_is_not_counted_by_its_atoms() -> None:
    assert not exhaustible(compiled("(goalem (when (< (d) 2) (do x on)))").ways)


# --- as the paper counts ----------------------------------------------------------------------------


@pytest.mark.rule("L23")
@pytest.mark.parametrize(
    ("goal", "total", "distinct", "taken"),
    [
        ("(do x one)", 1, 1, 1),
        ("(do anything)", 1, 1, 1),
        ("(if (a) (do x one) (do x two))", 2, 2, 2),
        ("(if (or (a) (b)) (do x one) (do anything))", 3, 3, 3),
        ("(if (not (and (a) (b))) (do x one) (do anything))", 3, 3, 3),
        ("(if (and (a) (not (a))) (do x one) (do x two))", 2, 2, 2),
        ("(if true (do x one) (do x two))", 1, 1, 1),
        ("(if (< (d) 2) (do x one) (do x two))", 2, 2, 2),
        ("(or (do x one) (do x two) (do x one))", 3, 2, 2),
        ("(and (do x one) (do x two))", 0, 0, 0),
        ("(and (if (a) (do x one) (do x two)) (if (a) (do y one) (do y two)))", 2, 2, 2),
        ("(and (or (do x one) (do x two)) (or (do x one) (do x two)))", 2, 2, 2),
        ("(prio-and (if (a) (do x one) (do x two)) (if (a) (do y one) (do y two)))", 4, 4, 2),
    ],
)
def test_ways_are_counted_one_a_disjunct(goal: str, total: int, distinct: int, taken: int) -> None:
    counted = count(compiled(f"(goalem {goal})", allow_holes=True).goals.top)
    assert (counted.total, counted.distinct, counted.taken) == (total, distinct, taken)
