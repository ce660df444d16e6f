"""What runs a circuit.

Takes: nothing. Gives: the protocol `Engine`. Leaves alone: how; each engine is a file of rplan/backends and equals
`evaluate` on every trace.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from rplan.circuit.evaluate import Bits


class Engine(Protocol):
    """A circuit brought to life."""

    @property
    def registers(self) -> Bits:
        """The registers as they are now."""
        ...

    def reset(self) -> None:
        """Back to before the first tick."""
        ...

    def tick(self, inputs: Sequence[bool]) -> Bits:
        """One tick: inputs in the order of the circuit's, outputs likewise."""
        ...
