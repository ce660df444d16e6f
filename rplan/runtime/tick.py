"""One tick of a plan alone: percept values in, the values of its outputs out.

Takes: a compiled plan's goals, atoms and engine. Gives: `Decision`s; holds what outputs with `:hold` keep. Leaves
alone: competences; see controller.py.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from rplan.circuit.build import HOLE
from rplan.circuit.circuit import Circuit
from rplan.circuit.engine import Engine
from rplan.circuit.evaluate import Bits
from rplan.goals.condition import Atom, Term
from rplan.goals.goal import Do, Goals, walk
from rplan.runtime.encode import PerceptValue, encoder

Setting = Mapping[str, Term | None]
"""Output -> value; None where the way leaves it open."""


@dataclass(frozen=True, slots=True)
class Decision:
    """inputs and registers as the circuit saw them; outputs as the way sets them; sent after idle and held values."""

    inputs: Bits
    registers: Bits
    hole: bool
    outputs: Setting
    sent: Setting


class Decider:
    """A plan that decides tick by tick."""

    def __init__(self, goals: Goals, atoms: Sequence[Atom], circuit: Circuit, engine: Engine) -> None:
        self.goals = goals
        self.engine = engine
        self.encode = encoder(goals, atoms)
        values = {(do.output, do.value.text): do.value for do in walk(goals.top) if isinstance(do, Do)}
        by_port = {f"{output}={text}": (output, term) for (output, text), term in values.items()}
        names = [port.name for port, _ in circuit.outputs]
        assert names[0] == HOLE
        self._ports = [by_port[name] for name in names[1:]]
        self._seen: dict[Bits, Setting] = {}
        self._held: dict[str, Term | None] = {}
        self.reset()

    def reset(self) -> None:
        """Back to before the first tick."""
        self.engine.reset()
        self._held = {output.name: output.initial for output in self.goals.outputs if output.hold}

    def tick(self, percepts: Mapping[str, PerceptValue]) -> Decision:
        """One tick; `PerceptError` if a percept is missing or has no proper value (the tick is not counted then)."""
        inputs = self.encode(percepts)
        registers = self.engine.registers
        bits = self.engine.tick(inputs)
        outputs = self._seen.get(bits)
        if outputs is None:
            outputs = self._seen[bits] = self._decode(bits)
        return Decision(inputs, registers, bits[0], outputs, self._sent(outputs))

    def values(self) -> Iterator[tuple[str, Term]]:
        """Every (output, value) that a tick can send."""
        yield from self._ports
        for output in self.goals.outputs:
            yield from ((output.name, term) for term in (output.idle, output.initial) if term is not None)

    def _decode(self, bits: Bits) -> Setting:
        setting: dict[str, Term | None] = dict.fromkeys(output.name for output in self.goals.outputs)
        for (output, term), bit in zip(self._ports, bits[1:], strict=True):
            if bit:
                setting[output] = term
        return setting

    def _sent(self, outputs: Setting) -> Setting:
        sent: dict[str, Term | None] = {}
        for output in self.goals.outputs:
            value = outputs[output.name]
            if output.hold:
                if value is None:
                    value = self._held[output.name]
                self._held[output.name] = value
            elif value is None:
                value = output.idle
            sent[output.name] = value
        return sent
