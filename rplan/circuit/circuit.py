"""`Circuit`: inputs, registers, gates, outputs.

Takes: nothing. Gives: the frozen value that engines run, and its text. Leaves alone: where it comes from (build.py) and
how it is run (evaluate.py, rplan/backends).

A gate reads only nets with smaller numbers, so one pass over the cells evaluates a tick; every register has a first
value and takes the value of its `next` net after the tick.
"""

from __future__ import annotations

from dataclasses import dataclass

from rplan.circuit.cell import Cell, Op
from rplan.lang.source import Span


@dataclass(frozen=True, slots=True)
class Port:
    """An input or output by name, with the places in the plan that it comes from."""

    name: str
    places: tuple[Span, ...] = ()


@dataclass(frozen=True, slots=True)
class Register:
    """One bit of memory."""

    name: str
    initial: bool
    next: int


@dataclass(frozen=True, slots=True)
class Circuit:
    """cells by net number; outputs: port and the net that drives it."""

    name: str
    inputs: tuple[Port, ...]
    registers: tuple[Register, ...]
    cells: tuple[Cell, ...]
    outputs: tuple[tuple[Port, int], ...]


def print_circuit(circuit: Circuit) -> str:
    """The circuit as an S-expression, one cell a line; read back by no one, compared by tests."""
    lines = [f"(circuit {circuit.name}"]
    for number, cell in enumerate(circuit.cells):
        lines.append(f"  (net {number} {_print_cell(cell, circuit)})")
    lines += [f"  (register {r.name} {'true' if r.initial else 'false'} {r.next})" for r in circuit.registers]
    lines += [f"  (output {port.name} {net})" for port, net in circuit.outputs]
    return "\n".join(lines) + ")\n"


def _print_cell(cell: Cell, circuit: Circuit) -> str:
    match cell.op:
        case Op.CONSTANT:
            return "true" if cell.index else "false"
        case Op.INPUT:
            return f"(input {circuit.inputs[cell.index].name})"
        case Op.REGISTER:
            return f"(register {circuit.registers[cell.index].name})"
        case _:
            return f"({cell.op.value} {' '.join(map(str, cell.operands))})"
