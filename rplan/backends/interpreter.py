"""The reference interpreter as an engine.

Takes: a circuit. Gives: an `Engine` that follows `evaluate` step by step. Leaves alone: speed.
"""

from __future__ import annotations

from collections.abc import Sequence

from rplan.circuit.circuit import Circuit
from rplan.circuit.evaluate import Bits, evaluate, first_registers


class Interpreter:
    """Runs a circuit cell by cell."""

    def __init__(self, circuit: Circuit) -> None:
        self._circuit = circuit
        self._registers = first_registers(circuit)

    @property
    def registers(self) -> Bits:
        return self._registers

    def reset(self) -> None:
        self._registers = first_registers(self._circuit)

    def tick(self, inputs: Sequence[bool]) -> Bits:
        outputs, self._registers = evaluate(self._circuit, self._registers, inputs)
        return outputs
