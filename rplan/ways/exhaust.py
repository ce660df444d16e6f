"""Every situation of a plan at once, where its atoms are few and independent.

Takes: `Ways`. Gives: in how many situations a guard holds. Leaves alone: plans that compare numbers, whose atoms imply
one another; coverage.py decides those.

A guard is evaluated once on integers that carry one bit a situation, so 4,096 situations cost as much as one.
"""

from __future__ import annotations

from rplan.goals.condition import Percept
from rplan.ways.reduce import Ways

MOST_ATOMS = 20


def exhaustible(ways: Ways) -> bool:
    """Whether every combination of atoms is a situation, and there are few enough."""
    return len(ways.atoms) <= MOST_ATOMS and all(isinstance(atom, Percept) for atom in ways.atoms)


def count_situations(ways: Ways, guard: int) -> int:
    """In how many of the 2**atoms situations the guard holds."""
    situations = 1 << len(ways.atoms)
    every = (1 << situations) - 1
    values: list[int] = []
    for kind, a, b in ways.guards.nodes:
        match kind:
            case "constant":
                values.append(every if a else 0)
            case "atom":
                values.append(_column(a, situations))
            case "not":
                values.append(values[a] ^ every)
            case "and":
                values.append(values[a] & values[b])
            case "or":
                values.append(values[a] | values[b])
    return values[guard].bit_count()


def _column(atom: int, situations: int) -> int:
    """Bit s is set where bit `atom` of s is."""
    half = 1 << atom
    block = ((1 << half) - 1) << half
    repeats = situations // (2 * half)
    return block * (((1 << (2 * half * repeats)) - 1) // ((1 << (2 * half)) - 1))
