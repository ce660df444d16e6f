"""Passes over circuits, one file each; every pass gives a circuit that computes the same outputs.

Takes: a circuit. Gives: `PIPELINE` in order, `run`. Leaves alone: meaning.
"""

from __future__ import annotations

from collections.abc import Callable

from rplan.circuit.check import check
from rplan.circuit.circuit import Circuit
from rplan.circuit.passes.merge import merge
from rplan.circuit.passes.share import share
from rplan.circuit.passes.sweep import sweep

Pass = Callable[[Circuit], Circuit]

PIPELINE: tuple[Pass, ...] = (
    sweep,  # first: building leaves much that nobody reads
    share,  # equal gates become one, constants disappear: leaves nets that nobody reads
    merge,  # what equals something else in every situation becomes that: dear, so the others go before
    sweep,  # last: takes away what nobody reads
)


def run(circuit: Circuit) -> Circuit:
    """The circuit after all passes, checked after each that changes it."""
    check(circuit)
    for one in PIPELINE:
        after = one(circuit)
        if after is not circuit:
            check(after)
        circuit = after
    return circuit
