"""Every situation of a plan at once, where its atoms and registers are few.

Takes: `Ways`. Gives: in how many situations a guard holds, how many ways are taken; for plans with memory an
`Automaton`, which knows in which tick a state can first be. Leaves alone: plans with more; see reach.py.

A guard is evaluated once on integers that carry one bit a situation, so 4,096 situations cost as much as one.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce as fold
from itertools import product

import numpy as np
from numpy.typing import NDArray

from rplan.goals.condition import Percept
from rplan.ways.guards import Guards
from rplan.ways.reduce import Ways
from rplan.ways.situations import Question, Unrolling, cone, negated

MOST_ATOMS = 20
MOST_BITS = 16
"""Of atoms and registers together that an automaton has."""
MOST_COMPARISONS = 6
NEVER = 1 << 40
"""Costs more than any trace."""


def has_comparisons(ways: Ways) -> bool:
    """Whether atoms may imply one another, so that not every combination of them is a situation."""
    return not all(isinstance(atom, Percept) for atom in ways.atoms)


def exhaustible(ways: Ways) -> bool:
    """Whether every combination of atoms is a situation, and there are few enough."""
    return len(ways.atoms) <= MOST_ATOMS and not has_comparisons(ways) and not ways.registers


def count_situations(ways: Ways, guard: int) -> int:
    """In how many of the 2**atoms situations the guard holds."""
    return _every(ways)[guard].bit_count()


def count_ways(ways: Ways) -> int:
    """How many different ways are taken in some situation."""
    return len(classes(ways, _every(ways), (1 << (1 << len(ways.atoms))) - 1))


def classes(ways: Ways, values: Sequence[int], situations: int) -> list[int]:
    """The classes into which the ways' signatures part these situations, each given as bits."""
    parts = [part for part in [situations & ~values[ways.hole]] if part]
    for guard in dict.fromkeys(ways.signature()):
        split = (part for known in parts for part in (known & values[guard], known & ~values[guard]))
        parts = [part for part in split if part]
    return parts


def _every(ways: Ways) -> list[int]:
    """For each guard the situations in which it holds, as bits."""
    situations = 1 << len(ways.atoms)
    return evaluate_many(ways.guards, [_column(n, situations) for n in range(len(ways.atoms))], situations)


def evaluate_many(guards: Guards, atoms: Sequence[int], situations: int, registers: Sequence[int] = ()) -> list[int]:
    """The value of every node in many situations; bit s of an atom or register is its value in situation s."""
    every = (1 << situations) - 1
    values: list[int] = []
    for kind, a, b in guards.nodes:
        match kind:
            case "constant":
                values.append(every if a else 0)
            case "atom":
                values.append(atoms[a])
            case "register":
                values.append(registers[a])
            case "not":
                values.append(values[a] ^ every)
            case "and":
                values.append(values[a] & values[b])
            case "or":
                values.append(values[a] | values[b])
    return values


def _column(atom: int, situations: int) -> int:
    """Bit s is set where bit `atom` of s is."""
    half = 1 << atom
    block = ((1 << half) - 1) << half
    repeats = situations // (2 * half)
    return block * (((1 << (2 * half * repeats)) - 1) // ((1 << (2 * half)) - 1))


# --- plans with memory ---


class Automaton:
    """All states of some registers under all values of some atoms.

    Situation s is the atoms in the low bits of s and the registers above them.
    """

    def __init__(self, ways: Ways, registers: tuple[int, ...], atoms: tuple[int, ...], can_be: int) -> None:
        self._ways = ways
        self._size = 1 << len(registers) + len(atoms)
        self._shape = (1 << len(registers), 1 << len(atoms))
        columns = [_column(n, self._size) for n in range(len(atoms) + len(registers))]
        self._of_atom = dict(zip(atoms, columns, strict=False))
        self._of_register = dict(zip(registers, columns[len(atoms) :], strict=True))
        self._values: dict[int, int] = {}
        self._valid = can_be
        self._registers, self._atoms = registers, atoms
        for guard in ways.assumed:
            self._valid &= self._value(guard)
        self._following = self._transitions(registers)
        self._depth = self._breadth_first(registers)

    def first_tick(self, question: Question) -> int | None:
        """The first tick in which the question can be answered."""
        ticks = self._depth[self._answering(question).any(axis=1) & (self._depth >= 0)]
        return int(ticks.min()) if ticks.size else None

    def _answering(self, question: Question) -> NDArray[np.bool_]:
        answering = self._valid
        for guard, value in question:
            answering &= self._value(guard) if value else ~self._value(guard)
        return self._table(answering)

    def simplest(self, question: Question, tick: int, order: Sequence[int]) -> list[dict[int, bool]] | None:
        """The atoms, tick by tick, of the trace that answers the question in this tick with the fewest of them true.

        Of those the one whose atoms are false rather than true in the given order. None where atoms compare numbers.
        """
        if not all(isinstance(self._ways.atoms[number], Percept) for number in self._atoms):
            return None
        place = {number: 1 << n for n, number in enumerate(self._atoms)}
        ranked = [number for number in order if number in place]
        inputs = sorted(range(self._shape[1]), key=lambda chosen: [bool(chosen & place[n]) for n in ranked])
        trues = np.array([chosen.bit_count() for chosen in inputs], dtype=np.int64)
        costs = [np.where(self._answering(question)[:, inputs], trues, NEVER)]
        valid, following = self._table(self._valid)[:, inputs], self._following[:, inputs]
        for _ in range(tick):
            costs.append(np.where(valid, trues + costs[-1].min(axis=1)[following], NEVER))
        state, trace = self._first_state(self._registers), []
        for cost in reversed(costs):
            chosen = int(cost[state].argmin())
            trace.append({number: bool(inputs[chosen] & place[number]) for number in self._atoms})
            state = int(following[state, chosen])
        return trace

    def _table(self, bits: int) -> NDArray[np.bool_]:
        """By state and atoms."""
        data = np.frombuffer(bits.to_bytes((self._size + 7) // 8, "little"), dtype=np.uint8)
        return np.unpackbits(data, bitorder="little")[: self._size].reshape(self._shape).astype(bool)

    def _transitions(self, registers: tuple[int, ...]) -> NDArray[np.int64]:
        """The state that follows, by state and atoms."""
        following = np.zeros(self._shape, dtype=np.int64)
        for place, number in enumerate(registers):
            following |= self._table(self._value(self._ways.registers[number].next)).astype(np.int64) << place
        return following

    def _first_state(self, registers: tuple[int, ...]) -> int:
        return sum(self._ways.registers[n].initial << place for place, n in enumerate(registers))

    def _breadth_first(self, registers: tuple[int, ...]) -> NDArray[np.int64]:
        """For each state the first tick that can begin in it; -1: none."""
        valid = self._table(self._valid)
        depth = np.full(self._shape[0], -1, dtype=np.int64)
        here = np.array([self._first_state(registers)])
        tick = 0
        while here.size:
            depth[here] = tick
            after = np.unique(self._following[here][valid[here]])
            here = after[depth[after] < 0]
            tick += 1
        return depth

    def _value(self, guard: int) -> int:
        if guard not in self._values:
            for number in cone(self._ways, [guard]):
                if number not in self._values:
                    self._values[number] = self._evaluated(number)
        return self._values[guard]

    def _evaluated(self, number: int) -> int:
        kind, a, b = self._ways.guards.nodes[number]
        every = (1 << self._size) - 1
        match kind:
            case "constant":
                return every if a else 0
            case "atom":
                return self._of_atom[a]
            case "register":
                return self._of_register[a]
            case "not":
                return self._values[a] ^ every
            case "and":
                return self._values[a] & self._values[b]
            case "or":
                return self._values[a] | self._values[b]


def automaton(ways: Ways, registers: tuple[int, ...], atoms: tuple[int, ...]) -> Automaton | None:
    """The automaton of these registers and atoms; None where there are too many of them."""
    if len(registers) + len(atoms) > MOST_BITS:
        return None
    can_be = _can_be(ways, atoms, 1 << len(registers) + len(atoms))
    return None if can_be is None else Automaton(ways, registers, atoms, can_be)


def _can_be(ways: Ways, atoms: tuple[int, ...], situations: int) -> int | None:
    """The situations that numbers do not rule out, as bits; None where that is not decided."""
    places = [place for place, number in enumerate(atoms) if not isinstance(ways.atoms[number], Percept)]
    every = (1 << situations) - 1
    if len(places) > MOST_COMPARISONS:
        return None
    unrolling = Unrolling(ways, first=True)
    asked = [unrolling.comparison(0, atoms[place]) for place in places]
    can_be = 0
    for values in product((False, True), repeat=len(places)):
        answer = unrolling.check([one if value else negated(one) for one, value in zip(asked, values, strict=True)])
        if not isinstance(answer, bool):
            return None
        if answer:
            columns = [
                _column(place, situations) ^ (0 if value else every)
                for place, value in zip(places, values, strict=True)
            ]
            can_be |= fold(int.__and__, columns, every)
    return can_be
