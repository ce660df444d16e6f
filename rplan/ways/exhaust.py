"""Every situation of a plan at once, where its atoms are few and independent.

Takes: `Ways`. Gives: in how many situations a guard holds, how many ways are taken. Leaves alone: plans that
compare numbers, whose atoms imply one another; coverage.py decides those.

A guard is evaluated once on integers that carry one bit a situation, so 4,096 situations cost as much as one.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rplan.goals.condition import Percept
from rplan.ways.guards import Guards
from rplan.ways.reduce import Ways

MOST_ATOMS = 20
SAMPLES = 1_024


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
    return _classes(ways, _every(ways), 1 << len(ways.atoms))


def count_sampled_ways(ways: Ways) -> int:
    """How many different ways are taken in some samples: at least so many there are."""
    return _classes(ways, *samples(ways))


def _classes(ways: Ways, values: list[int], situations: int) -> int:
    """Into how many classes the ways' signatures part the situations."""
    classes = [((1 << situations) - 1) ^ values[ways.hole]]
    for guard in dict.fromkeys(ways.signature()):
        split = (part for known in classes for part in (known & values[guard], known & ~values[guard]))
        classes = [part for part in split if part]
    return len(classes)


def samples(ways: Ways) -> tuple[list[int], int]:
    """Every guard in some situations as bits, and their number: each percept alone true, alone false, and by chance."""
    count = len(ways.atoms)
    chance = np.random.default_rng(0)
    alone, others = (1 << count) - 1, 2 * count
    columns = [
        1 << n | (alone ^ 1 << n) << count | int.from_bytes(chance.bytes(SAMPLES // 8), "little") << others
        for n in range(count)
    ]
    return evaluate_many(ways.guards, columns, others + SAMPLES), others + SAMPLES


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
