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
    share,  # equal gates become one, constants disappear: cheap, so that the next has less to try out
    merge,  # nets that say the same in every situation become one: leaves constants and negations to be shared
    share,  # folds what merging has left
    sweep,  # last: takes away what nobody reads
)


def run(circuit: Circuit) -> Circuit:
    """The circuit after all passes, checked after each."""
    check(circuit)
    for one in PIPELINE:
        circuit = one(circuit)
        check(circuit)
    return circuit
