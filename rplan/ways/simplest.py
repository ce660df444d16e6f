"""The simplest trace that shows something (L26).

Takes: `Ways`, a question, and the tick in which it can first be. Gives: the trace with the fewest true percepts, of
those the one whose percepts are false rather than true in textual order, tick by tick, with the simplest numbers
that fit. Leaves alone: which tick that is; see reach.py.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from itertools import pairwise

import z3

from rplan.goals.condition import Comparison, Term, percept_terms
from rplan.ways.reduce import Ways
from rplan.ways.situations import Question, Trace, Undecided, Unrolling, exact, nothing


def simplest(ways: Ways, question: Question, tick: int) -> Trace | Undecided:
    """The simplest trace whose last tick, number `tick`, answers the question; there has to be one."""
    unrolling = Unrolling(ways, first=True)
    wanted = [*unrolling.ask(tick, question), *unrolling.assumed(tick + 1)]
    unrolling.solver.add(*wanted)
    return _Search(ways, unrolling).trace(tick + 1)


SIMPLE = 400_000
"""For one step towards the simplest trace [z3's resource units]; where it does not suffice the trace stays as it is."""


class _Search:
    """Settles one percept after the other."""

    def __init__(self, ways: Ways, unrolling: Unrolling) -> None:
        self.ways = ways
        self.unrolling = unrolling
        self.solver = unrolling.solver
        order = {text: number for number, text in enumerate(nothing(ways))}
        asked = sorted(unrolling.symbols().items(), key=lambda one: (one[0][0], order[one[0][1]]))
        self.truths = [(key, symbol) for key, symbol in asked if z3.is_bool(symbol)]
        self.numbers = [(key, symbol) for key, symbol in asked if not z3.is_bool(symbol)]

    def trace(self, ticks: int) -> Trace | Undecided:
        if self.solver.check() != z3.sat:
            return Undecided()
        model = self.solver.model()
        found = [nothing(self.ways) for _ in range(ticks)]
        self.solver.set("rlimit", SIMPLE)
        try:
            self._fewest_true(model)
            self._first_false()
        except TooHardError:
            return _as_it_is(found, self.unrolling, model)
        self.solver.check()
        model = self.solver.model()
        for (tick, text), symbol in self.truths:
            found[tick][text] = z3.is_true(model.eval(symbol, model_completion=True))
        for (tick, text), symbol in self.numbers:
            found[tick][text] = self._simplest_number(text, symbol)
        return tuple(found)

    def _true(self, model: z3.ModelRef) -> int:
        return sum(z3.is_true(model.eval(symbol, model_completion=True)) for _, symbol in self.truths)

    def _fewest_true(self, model: z3.ModelRef) -> None:
        flags = [(symbol, 1) for _, symbol in self.truths]
        low, high = 0, self._true(model)
        while low < high:
            most = low if low == 0 else (low + high) // 2
            better = self._possible(z3.PbLe(flags, most))
            if better is not None:
                high = self._true(better)
            else:
                low = most + 1
        if flags:
            self.solver.add(z3.PbLe(flags, high))

    def _first_false(self) -> None:
        """The longest run of false percepts, then a true one, and so on; all in textual order."""
        rest = [symbol for _, symbol in self.truths]
        while rest:
            run = self._run_of_false(rest)
            self.solver.add(*map(z3.Not, rest[:run]), *rest[run : run + 1])
            rest = rest[run + 1 :]

    def _run_of_false(self, rest: list[z3.BoolRef]) -> int:
        return _longest(len(rest), lambda n: self._possible(*map(z3.Not, rest[:n])) is not None)

    def _possible(self, *wanted: z3.BoolRef) -> z3.ModelRef | None:
        """A model of this as well; None where there is none."""
        self.solver.push()
        self.solver.add(*wanted)
        answer = self.solver.check()
        model = self.solver.model() if answer == z3.sat else None
        self.solver.pop()
        if answer == z3.unknown:
            raise TooHardError
        return model

    def _simplest_number(self, text: str, symbol: z3.ArithRef) -> float:
        for value in self._candidates(text):
            number = z3.RealVal(str(value), self.unrolling.context)
            if self.solver.check(symbol == number) == z3.sat:
                self.solver.add(symbol == number)
                return float(value)
        self.solver.check()
        value = self.solver.model().eval(symbol, model_completion=True)
        self.solver.add(symbol == value)
        return value_of(value)

    def _candidates(self, text: str) -> list[Fraction]:
        """Zero, what it is compared with, and values between and beyond, the nearest to zero first."""
        ordered = sorted({Fraction(0), *bounds(self.ways, text)})
        between = [(a + b) / 2 for a, b in pairwise(ordered)]
        return sorted({*ordered, *between, ordered[0] - 1, ordered[-1] + 1}, key=lambda value: (abs(value), -value))


class TooHardError(Exception):
    """A step took too long."""


def _as_it_is(found: list[dict[str, bool | float]], unrolling: Unrolling, model: z3.ModelRef) -> Trace:
    for (tick, text), symbol in unrolling.symbols().items():
        found[tick][text] = value_of(model.eval(symbol, model_completion=True))
    return tuple(found)


def value_of(value: z3.ExprRef) -> bool | float:
    """What z3 found, as the language has it."""
    if z3.is_bool(value):
        return bool(z3.is_true(value))
    fraction = value.approx(12).as_fraction() if z3.is_algebraic_value(value) else value.as_fraction()
    return float(fraction)


def bounds(ways: Ways, text: str) -> list[Fraction]:
    """The numbers that stand in comparisons with a percept."""
    found: dict[Fraction, None] = {}
    for atom in ways.atoms:
        if isinstance(atom, Comparison) and any(term.text == text for term in percept_terms(atom)):
            found |= dict.fromkeys(number for side in (atom.left, atom.right) for number in _literals(side))
    return [*found]


def _literals(term: Term) -> list[Fraction]:
    if term.kind == "arithmetic":
        return [number for operand in term.arguments for number in _literals(operand)]
    return [exact(term.value)] if isinstance(term.value, float) else []


def _longest(most: int, possible: Callable[[int], bool]) -> int:
    """The greatest n up to `most` that is possible; what is possible for n is so for less."""
    if possible(most):
        return most
    low, high = 0, most
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if possible(middle) else (low, middle)
    return low
