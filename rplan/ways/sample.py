"""Many runs of a plan at once, by chance.

Takes: `Ways`. Gives: `Samples`, which show what is possible and never what is not. Leaves alone: proofs; see reach.py.

A guard is evaluated on integers that carry one bit a run: each percept alone true, alone false, and by chance. Numbers
are drawn from those that they are compared with and those between and beyond; they are exact, as in the proofs.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise
from typing import cast

import numpy as np

from rplan.goals.condition import Comparison, Percept, Term, compare, operate, percept_terms
from rplan.ways.exhaust import classes, evaluate_many
from rplan.ways.reduce import Ways
from rplan.ways.simplest import bounds
from rplan.ways.situations import Question, exact, number_percepts

RUNS = 1_024
TICKS = 24


class Samples:
    """Runs of a plan from its first tick on; those that break an assumption end there."""

    def __init__(self, ways: Ways) -> None:
        self._ways = ways
        self._chance = np.random.default_rng(0)
        self._alone = sum(isinstance(atom, Percept) for atom in ways.atoms)
        self.runs = 2 * self._alone + RUNS
        self._every = (1 << self.runs) - 1
        self._numbers = {text: _numbers(ways, text) for text in number_percepts(ways)}
        self._truths: list[int] = []
        self._seen: list[tuple[list[int], int]] = []
        self._run()

    def show(self, question: Question) -> bool:
        """Whether some run answers the question in some tick."""
        return any(self._answering(values, valid, question) for values, valid in self._seen)

    def count_ways(self) -> int:
        """How many different ways the runs take: at least so many there are."""
        values = [0] * len(self._ways.guards.nodes)
        for guard in dict.fromkeys((self._ways.hole, *self._ways.signature())):
            values[guard] = sum(seen[guard] << tick * self.runs for tick, (seen, _) in enumerate(self._seen))
        valid = sum(possible << tick * self.runs for tick, (_, possible) in enumerate(self._seen))
        return len(classes(self._ways, values, valid))

    def _answering(self, values: list[int], valid: int, question: Question) -> int:
        for guard, value in question:
            valid &= values[guard] if value else ~values[guard]
        return valid

    def _run(self) -> None:
        registers = [self._every if one.initial else 0 for one in self._ways.registers]
        valid = self._every
        for tick in range(TICKS if registers else 1):
            values = evaluate_many(self._ways.guards, self._atoms(tick), self.runs, registers)
            for guard in self._ways.assumed:
                valid &= values[guard]
            self._seen.append((values, valid))
            registers = [values[one.next] for one in self._ways.registers]

    def _atoms(self, tick: int) -> list[int]:
        """What each atom is in each run."""
        drawn = {text: self._chance.integers(len(values), size=self.runs) for text, values in self._numbers.items()}
        truths = [self._changed(before) for before in self._truths] if tick else self._first()
        self._truths = truths
        left = iter(truths)
        return [next(left) if isinstance(atom, Percept) else self._compared(atom, drawn) for atom in self._ways.atoms]

    def _first(self) -> list[int]:
        """Each percept alone true, alone false, and by chance."""
        alone, others = (1 << self._alone) - 1, 2 * self._alone
        return [
            1 << place | (alone ^ 1 << place) << self._alone | self._bits() >> others << others
            for place in range(self._alone)
        ]

    def _changed(self, before: int) -> int:
        """What lasts shows more than what flickers: one in eight changes."""
        return before ^ (self._bits() & self._bits() & self._bits())

    def _bits(self) -> int:
        return int.from_bytes(self._chance.bytes((self.runs + 7) // 8), "little") & self._every

    def _compared(self, atom: Comparison, drawn: dict[str, np.ndarray]) -> int:
        texts = [*dict.fromkeys(term.text for term in percept_terms(atom))]
        known: dict[tuple[int, ...], bool] = {}
        bits = np.zeros(self.runs, dtype=bool)
        for run, chosen in enumerate(zip(*(drawn[text].tolist() for text in texts), strict=True)):
            if chosen not in known:
                values = {text: self._numbers[text][n] for text, n in zip(texts, chosen, strict=True)}
                known[chosen] = _compare(atom, values)
            bits[run] = known[chosen]
        if not texts and _compare(atom, {}):
            return self._every
        return int.from_bytes(np.packbits(bits, bitorder="little").tobytes(), "little")


def _numbers(ways: Ways, text: str) -> list[Fraction]:
    ordered = sorted({Fraction(0), *bounds(ways, text)})
    return [*ordered, *((a + b) / 2 for a, b in pairwise(ordered)), ordered[0] - 1, ordered[-1] + 1]


def _compare(atom: Comparison, values: dict[str, Fraction]) -> bool:
    """As when the plan runs, with exact numbers."""
    left, right = _quantity(atom.left, values), _quantity(atom.right, values)
    return compare(atom.operator, cast(float, left), cast(float, right))


def _quantity(term: Term, values: dict[str, Fraction]) -> Fraction:
    match term.kind:
        case "call":
            return values[term.text]
        case "arithmetic":
            operands = [_quantity(operand, values) for operand in term.arguments]
            return cast(Fraction, operate(term.name, cast(list[float], operands)))
        case _:
            assert isinstance(term.value, float)
            return exact(term.value)
