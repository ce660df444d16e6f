"""What can be in some tick: found exactly where some trace shows it, by every way of deciding (L10, L18, L26)."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

import pytest
import z3
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from properties.strategies import ATOMS, do, remembering, whole
from properties.texts import compiled, decider, findings

from rplan.goals.condition import Condition
from rplan.goals.goal import And, Anything, Goal, If
from rplan.lang.source import NOWHERE
from rplan.ways import reach as reach_module
from rplan.ways.guards import FALSE
from rplan.ways.meaning import Situation, taken
from rplan.ways.reach import Reach, spacer
from rplan.ways.reduce import Ways, reduce
from rplan.ways.sample import Samples
from rplan.ways.situations import Question, Trace, Undecided, lines, registers_in, replay

TICKS = [dict(zip(ATOMS[:2], bits, strict=True)) for bits in product((False, True), repeat=2)]
MOST = 5
"""Ticks of the longest trace that is tried; no plan here needs more."""


def clash(condition: Condition) -> Goal:
    """A goal that has a hole exactly where a condition holds."""
    other = If(condition, do("x", "(q)"), Anything("(goalem)", NOWHERE), "(goalem)", NOWHERE)
    return And((do("x", "(p)"), other), NOWHERE)


def few_states(ways: Ways) -> bool:
    """So few registers that every state is reached within `MOST` ticks or never."""
    return len(ways.registers) <= 2


def first_hole(goal: Goal) -> list[list[dict[str, bool]]]:
    """The shortest traces that end in a hole, by the reference meaning; none if there is none."""
    for length in range(1, MOST + 1):
        found = [list(trace) for trace in product(TICKS, repeat=length) if ends_in_hole(goal, trace)]
        if found:
            return found
    return []


def ends_in_hole(goal: Goal, trace: tuple[dict[str, bool], ...]) -> bool:
    here = None
    for tick in trace:
        here = Situation(tick.__getitem__, here)
    assert here is not None
    return taken(goal, here) is None


def cost(trace: list[dict[str, bool]] | Trace, names: list[str]) -> tuple[int, list[bool]]:
    values = [bool(tick[name]) for tick in trace for name in names]
    return sum(values), values


@pytest.mark.rule("L26")
@settings(max_examples=120, deadline=None, derandomize=True)
@given(remembering())
def test_a_hole_is_found_where_some_trace_shows_it_and_its_witness_is_the_simplest(condition: Condition) -> None:
    goal = clash(condition)
    ways = reduce(whole(goal))
    assume(few_states(ways))
    shortest = first_hole(goal)
    trace = Reach(ways).trace((ways.hole, True))
    assert not isinstance(trace, Undecided)
    assert (trace is not None) == bool(shortest)
    if trace is not None:
        names = [term.text for term in ways.goals.percepts()]
        assert len(trace) == len(shortest[0])
        assert cost(trace, names) == min(cost(one, names) for one in shortest)


@pytest.mark.parametrize("engine", ["automaton", "unrolling", "spacer"])
@settings(max_examples=60, deadline=None, derandomize=True)
@given(condition=remembering())
def test_every_way_of_deciding_comes_to_the_same(engine: str, condition: Condition) -> None:
    ways = reduce(whole(clash(condition)))
    assume(ways.registers and len(ways.registers) <= 3)
    question = ((ways.hole, True),)
    expected = Reach(ways).first_tick(*question)
    if engine == "spacer":
        assert spacer(ways, question, registers_in(ways, [ways.hole])) == (expected is not None)
        return
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(reach_module, "automaton", lambda *_: None)
        assert Reach(ways).first_tick(*question) == expected


@settings(max_examples=60, deadline=None, derandomize=True)
@given(remembering())
def test_what_a_sample_shows_can_be(condition: Condition) -> None:
    ways = reduce(whole(clash(condition)))
    question: Question = ((ways.hole, True),)
    if Samples(ways).show(question):
        assert isinstance(Reach(ways).first_tick(*question), int)


def holes(text: str) -> Iterator[Trace]:
    ways = compiled(text, allow_holes=True).ways
    trace = Reach(ways).trace((ways.hole, True))
    if isinstance(trace, tuple):
        yield trace


@pytest.mark.rule("L10")
@pytest.mark.parametrize(
    ("condition", "ticks"),
    [
        ("(delay true (p))", 1),
        ("(delay false (p))", 2),
        ("(held-for 0.3s (p))", 3),
        ("(at-least 4 (p))", 4),
        ("(and (once (p)) (historically (not (p))))", 0),
        ("(rose (p))", 2),
        ("(held-for 30s (p))", 300),
        ("(and (held-for 2s (p)) (at-least 60 (q)))", 60),
        ("(held-for 2s (< (d) 1m))", 20),
        ("(and (held-for 2s (< (d) 1m)) (> (d) 2m))", 0),
        ("(held-for 0.2s (< (* (d) (d)) -1))", 0),
    ],
)
def test_a_hole_in_the_future_has_its_shortest_trace_from_the_first_tick(condition: str, ticks: int) -> None:
    text = f"(goalem (and (do x a) (when {condition} (do x b))))"
    assert [len(trace) for trace in holes(text)] == ([ticks] if ticks else [])


@pytest.mark.rule("L26")
def test_a_witness_with_memory_replays_tick_by_tick() -> None:
    plan = compiled(
        "(goalem (and (do x a) (when (and (held-for 0.3s (p)) (once (< (d) 1m)) (> (d) 2m)) (do x b))))",
        allow_holes=True,
    )
    (found,) = [d for d in plan.diagnostics if d.code == "hole"]
    assert found.when == "ticks 0 to 1: (p) and (d) = 0; tick 2: (p) and (d) = 3"
    decide = decider(plan)
    trace = Reach(plan.ways).trace((plan.ways.hole, True))
    assert isinstance(trace, tuple)
    assert [decide.tick(tick).hole for tick in trace] == [False, False, True]
    assert found.trace == lines(trace)
    assert found.trace[-1] == '{"p": true, "d": 3.0}'


@pytest.mark.rule("L8")
@pytest.mark.parametrize(
    ("condition", "witness"),
    [
        ("(> (+ (d) (e)) 3m)", {"(d)": 0.0, "(e)": 4.0}),
        ("(> (* 2 (d)) 3m)", {"(d)": 2.0}),
        ("(< (/ (d) 2) -1m)", {"(d)": -3.0}),
        ("(> (min (d) (e)) 1m)", {"(d)": 2.0, "(e)": 2.0}),
        ("(< (max (d) 2m) 2m)", None),
        ("(< (abs (d)) 0m)", None),
        ("(and (> (abs (d)) 1m) (< (d) 0m))", {"(d)": -2.0}),
        ("(< (- (d)) -1m)", {"(d)": 2.0}),
        ("(= (- (d) (e) 1m) 1m)", {"(d)": 0.0, "(e)": -2.0}),
    ],
)
def test_arithmetic_is_exact(condition: str, witness: dict[str, float] | None) -> None:
    text = f"""(declare (d) (number m) "") (declare (e) (number m) "")
               (goalem (and (do x a) (when {condition} (do x b))))"""
    found = [*holes(text)]
    assert found == ([] if witness is None else [(witness,)])
    if found:
        ways = compiled(text, allow_holes=True).ways
        assert replay(ways, found[0]).guards[ways.hole]


def test_what_a_plan_takes_for_granted_keeps_holes_away() -> None:
    text = "{} (goalem (and (when (p) (do x a)) (when (once (q)) (do x b))))"
    assert "hole" in [d.code for d in findings(text.format(""))]
    assert "hole" not in [d.code for d in findings(text.format("(assume (not (and (p) (once (q)))))"))]


def test_nothing_is_possible_that_is_false() -> None:
    assert Reach(compiled("(goalem (do anything))").ways).possible((FALSE, True)) is False


@pytest.mark.rule("L9")
@given(st.integers(1, 40))
@settings(max_examples=8, deadline=None, derandomize=True)
def test_counting_takes_as_long_as_it_counts(count: int) -> None:
    ways = compiled(f"(goalem (and (do x a) (when (at-least {count} (p)) (do x b))))", allow_holes=True).ways
    assert Reach(ways).first_tick((ways.hole, True)) == count - 1


def test_where_spacer_stops_by_an_exception_nothing_is_decided(monkeypatch: pytest.MonkeyPatch) -> None:
    def spent(*_: object) -> None:
        raise z3.Z3Exception(b"max. resource limit exceeded")

    ways = compiled("(goalem (when (held-for 1s (p)) (do x a)))").ways
    question = ((ways.sets["x"]["(a)"], True),)
    monkeypatch.setattr(z3.Fixedpoint, "query", spent)
    monkeypatch.setattr(reach_module, "automaton", lambda *_: None)
    monkeypatch.setattr(reach_module, "MOST_TICKS", 5)
    monkeypatch.setattr(Samples, "show", lambda *_: False)
    assert Reach(ways).possible(*question) == Undecided()
