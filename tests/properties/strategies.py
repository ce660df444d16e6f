"""Hypothesis strategies: resolved goals, circuits and traces.

Takes: nothing. Gives: strategies that the property tests share. Leaves alone: texts; see strategies_lang.py.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import cast

from hypothesis import strategies as st

from rplan.circuit.cell import Cell, Op
from rplan.circuit.circuit import Circuit, Port, Register
from rplan.goals.condition import (
    AllOf,
    AnyOf,
    Comparison,
    Condition,
    Constant,
    Memory,
    Not,
    Percept,
    Term,
    print_condition,
)
from rplan.goals.goal import And, Anything, Do, Goal, Goals, If, Impossible, Or, Output, PrioAnd, walk
from rplan.goals.signature import BOOL
from rplan.lang.plan import Comparator, Past, Type
from rplan.lang.source import NOWHERE

ATOMS = ("(a)", "(b)", "(c)", "(d)")
OUTPUTS = ("x", "y", "z")
VALUES = ("(p)", "(q)")
NUMBERS = ("(near)", "(far)")
BOUNDS = (1.0, 2.5)
EVERY_ORDER = (0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5)
"""Numbers that stand in every order to one another and to the bounds."""


def percept(text: str) -> Percept:
    return Percept(text, Term("call", text[1:-1], (), None, BOOL, NOWHERE))


def do(output: str, value: str) -> Do:
    return Do(output, Term("call", value[1:-1], (), None, None, NOWHERE), "(goalem)", NOWHERE)


def number(side: str | float) -> Term:
    if isinstance(side, str):
        return Term("call", side[1:-1], (), None, None, NOWHERE)
    return Term("number", "", (), side, Type("number"), NOWHERE)


def compare(operator: Comparator, left: str | float, right: str | float) -> Comparison:
    sides = number(left), number(right)
    return Comparison(f"({operator} {sides[0].text} {sides[1].text})", operator, *sides)


def comparisons() -> st.SearchStrategy[Comparison]:
    side = st.sampled_from((*NUMBERS, *BOUNDS))
    operators: list[Comparator] = ["<", "<=", ">", ">=", "=", "/="]
    return st.builds(compare, st.sampled_from(operators), side, side)


def conditions(*, numbers: bool = False) -> st.SearchStrategy[Condition]:
    """Mostly atoms, seldom constants."""
    atoms: list[Condition] = [percept(text) for text in (ATOMS[:2] if numbers else ATOMS)]
    leaves: st.SearchStrategy[Condition] = st.sampled_from([*atoms, *atoms, *atoms, Constant(True), Constant(False)])
    if numbers:
        leaves = comparisons() | leaves
    return st.recursive(
        leaves,
        lambda inner: st.one_of(
            inner.map(Not),
            st.lists(inner, min_size=1, max_size=3).map(lambda parts: AllOf(tuple(parts))),
            st.lists(inner, min_size=1, max_size=3).map(lambda parts: AnyOf(tuple(parts))),
        ),
        max_leaves=3,
    )


@st.composite
def goals(
    draw: st.DrawFn,
    *,
    alternatives: bool = True,
    numbers: bool = False,
    impossible: bool = False,
    max_leaves: int = 12,
) -> Goal:
    """Goals that often conflict: a few outputs of two values, every kind of joint.

    impossible: with places that no way leads through; texts cannot say so, regression can.
    """
    kinds: list[type[Goal]] = [If, If, And, And, PrioAnd, PrioAnd, *([Or] if alternatives else [])]

    def grow(leaves: int) -> Goal:
        if leaves == 1:
            chance = draw(st.integers(0, 15))
            if chance >= 14:
                return Anything("(goalem)", NOWHERE)
            if chance == 13 and impossible:
                return Impossible(NOWHERE)
            return do(draw(st.sampled_from(("x", *OUTPUTS))), draw(st.sampled_from(VALUES)))
        kind = draw(st.sampled_from(kinds))
        if kind is If:
            first = draw(st.integers(1, leaves - 1))
            return If(draw(conditions(numbers=numbers)), grow(first), grow(leaves - first), "(goalem)", NOWHERE)
        parts = []
        while leaves:
            parts.append(grow(draw(st.integers(1, max(1, leaves - (not parts))))))
            leaves -= size(parts[-1])
        assert kind in (And, Or, PrioAnd)
        return kind(tuple(parts), NOWHERE)

    return grow(draw(st.integers(max_leaves // 2, max_leaves)))


def size(goal: Goal) -> int:
    """How many leaves a goal has."""
    return sum(isinstance(node, Do | Anything | Impossible) for node in walk(goal))


def whole(top: Goal) -> Goals:
    """A plan around a goal."""
    outputs = dict.fromkeys(node.output for node in walk(top) if isinstance(node, Do))
    return Goals(
        "random", "", 0.1, top,
        tuple(Output(name, None, None, False, None, NOWHERE) for name in outputs), (), (), {}, NOWHERE,
    )  # fmt: skip


@st.composite
def circuits(draw: st.DrawFn) -> Circuit:
    """Random well-formed circuits with registers."""
    inputs = draw(st.integers(0, 4))
    registers = draw(st.integers(0, 3))
    cells = [Cell(Op.INPUT, (), n) for n in range(inputs)] + [Cell(Op.REGISTER, (), n) for n in range(registers)]
    cells += [Cell(Op.CONSTANT, (), draw(st.integers(0, 1)))]
    for _ in range(draw(st.integers(0, 25))):
        op = draw(st.sampled_from((Op.NOT, Op.AND, Op.OR)))
        cells.append(Cell(op, tuple(draw(st.integers(0, len(cells) - 1)) for _ in range(op.arity))))
    nets = st.integers(0, len(cells) - 1)
    return Circuit(
        "random",
        tuple(Port(f"i{n}") for n in range(inputs)),
        tuple(Register(f"r{n}", draw(st.booleans()), draw(nets)) for n in range(registers)),
        tuple(cells),
        tuple((Port(f"o{n}"), draw(nets)) for n in range(draw(st.integers(1, 4)))),
    )


@st.composite
def circuits_with_traces(draw: st.DrawFn) -> tuple[Circuit, list[Sequence[bool]]]:
    circuit = draw(circuits())
    tick = st.lists(st.booleans(), min_size=len(circuit.inputs), max_size=len(circuit.inputs))
    return circuit, draw(st.lists(tick.map(tuple), max_size=8))


def remember(form: str, parts: list[Condition], *, initial: bool, ticks: int) -> Condition:
    """A condition with memory; initial also says whether `at-least` has a reset."""
    two = form in ("since", "latch") or (form == "at-least" and initial and len(parts) > 1)
    used = tuple(parts[: 2 if two else 1])
    head = {"delay": ["true" if initial else "false"], "held-for": [f"{ticks / 10:g}s"], "within": [f"{ticks / 10:g}s"]}
    words = [form, *head.get(form, [str(ticks)] if form == "at-least" else []), *map(print_condition, used)]
    if form == "at-least" and two:
        words.insert(-1, ":reset")
    counted = ticks if form in ("held-for", "within", "at-least") else 0
    return Memory(f"({' '.join(words)})", cast(Past, form), used, initial, counted)


MEMORY_FORMS = ("delay", "once", "historically", "since", "latch", "rose", "fell", "held-for", "within", "at-least")


def memories(inner: st.SearchStrategy[Condition]) -> st.SearchStrategy[Condition]:
    """Conditions that ask the past."""
    return st.builds(
        lambda form, parts, initial, ticks: remember(form, parts, initial=initial, ticks=ticks),
        st.sampled_from(MEMORY_FORMS),
        st.lists(inner, min_size=2, max_size=2),
        st.booleans(),
        st.integers(1, 6),
    )


def remembering() -> st.SearchStrategy[Condition]:
    """Conditions with memory anywhere inside."""
    leaves = st.sampled_from(ATOMS[:2]).map(percept)
    return st.recursive(leaves, lambda inner: memories(inner) | inner.map(Not) | memories(inner), max_leaves=4)
