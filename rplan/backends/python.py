"""A circuit as generated Python.

Takes: a circuit. Gives: its source text (`emit`) and an `Engine` that runs it (`PythonEngine`). Leaves alone: what the
bits mean.

A gate that is read once stands inside the expression that reads it, so that `and` and `or` stop early; the others get a
name. Every register is evaluated in every tick. Comments carry the places in the plan.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from rplan.circuit.cell import Op
from rplan.circuit.circuit import Circuit, Port
from rplan.circuit.evaluate import Bits, first_registers

LONGEST = 40
"""Gates in one expression, at most: keeps the parser of Python from nesting too deep."""


def emit(circuit: Circuit) -> str:
    """Python source of `tick(inputs, registers) -> (outputs, registers)`."""
    body = _Writer(circuit)
    ends = [net for _, net in circuit.outputs] + [register.next for register in circuit.registers]
    for net in range(len(circuit.cells)):
        body.place(net)
    lines = ["def tick(inputs, registers=()):"]
    lines += _unpack("i", circuit.inputs, "inputs")
    lines += _unpack("r", tuple(Port(register.name) for register in circuit.registers), "registers")
    lines += body.lines
    values = [body.text(net, 0) for net in ends]
    count = len(circuit.outputs)
    lines.append("    return (")
    for (port, _), value in zip(circuit.outputs, values, strict=False):
        places = ", ".join(dict.fromkeys(map(str, port.places)))
        lines.append(f"        {value},  # {port.name}" + (f" at {places}" if places else ""))
    lines.append(f"    ), ({''.join(f'{value}, ' for value in values[count:])})")
    return "\n".join(lines) + "\n"


def _unpack(letter: str, ports: tuple[Port, ...], source: str) -> list[str]:
    if not ports:
        return []
    comments = [f"    # {letter}{n}: {port.name}" for n, port in enumerate(ports)]
    return [*comments, f"    ({''.join(f'{letter}{n}, ' for n in range(len(ports)))}) = {source}"]


class _Writer:
    """Turns nets into expressions and names."""

    def __init__(self, circuit: Circuit) -> None:
        self.circuit = circuit
        self.lines: list[str] = []
        self.expressions: list[tuple[str, int, int]] = []
        self.readers = [0] * len(circuit.cells)
        for cell in circuit.cells:
            for operand in cell.operands:
                self.readers[operand] += 1
        for net in [net for _, net in circuit.outputs] + [register.next for register in circuit.registers]:
            self.readers[net] += 1

    def place(self, net: int) -> None:
        """Write one net; nets come in order."""
        text, strength, size = self._expression(net)
        if self.circuit.cells[net].operands and (self.readers[net] > 1 or size > LONGEST):
            self.lines.append(f"    n{net} = {text}")
            text, strength, size = f"n{net}", _ATOM, 0
        self.expressions.append((text, strength, size))

    def text(self, net: int, strength: int) -> str:
        """The expression of a net, in parentheses where it binds weaker than its surroundings."""
        text, own, _ = self.expressions[net]
        return f"({text})" if own < strength else text

    def _expression(self, net: int) -> tuple[str, int, int]:
        cell = self.circuit.cells[net]
        size = 1 + sum(self.expressions[operand][2] for operand in cell.operands)
        match cell.op:
            case Op.CONSTANT:
                return str(bool(cell.index)), _ATOM, 0
            case Op.INPUT:
                return f"i{cell.index}", _ATOM, 0
            case Op.REGISTER:
                return f"r{cell.index}", _ATOM, 0
            case Op.NOT:
                return f"not {self.text(cell.operands[0], _NOT)}", _NOT, size
            case Op.AND:
                return " and ".join(self.text(operand, _AND) for operand in cell.operands), _AND, size
            case Op.OR:
                return " or ".join(self.text(operand, _OR) for operand in cell.operands), _OR, size


_OR, _AND, _NOT, _ATOM = 1, 2, 3, 4

Tick = Callable[[Sequence[bool], Bits], tuple[Bits, Bits]]


class PythonEngine:
    """Runs the generated source of a circuit."""

    def __init__(self, circuit: Circuit) -> None:
        names: dict[str, Tick] = {}
        exec(compile(emit(circuit), f"<circuit {circuit.name}>", "exec"), names)
        self._tick = names["tick"]
        self._first = first_registers(circuit)
        self._registers = self._first

    @property
    def registers(self) -> Bits:
        return self._registers

    def reset(self) -> None:
        self._registers = self._first

    def tick(self, inputs: Sequence[bool]) -> Bits:
        outputs, self._registers = self._tick(inputs, self._registers)
        return outputs
