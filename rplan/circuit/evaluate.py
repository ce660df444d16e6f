"""The reference interpreter: one pass over the cells a tick.

Takes: a circuit, the registers and the inputs of a tick. Gives: the outputs and the registers of the next tick.
Leaves alone: speed; rplan/backends has engines that are fast and must agree with this one.
"""

from __future__ import annotations

from collections.abc import Sequence

from rplan.circuit.cell import Op
from rplan.circuit.circuit import Circuit

Bits = tuple[bool, ...]


def evaluate(circuit: Circuit, registers: Bits, inputs: Sequence[bool]) -> tuple[Bits, Bits]:
    """(outputs, next registers) of one tick; inputs in the order of `circuit.inputs`."""
    nets: list[bool] = []
    for cell in circuit.cells:
        match cell.op:
            case Op.CONSTANT:
                nets.append(bool(cell.index))
            case Op.INPUT:
                nets.append(inputs[cell.index])
            case Op.REGISTER:
                nets.append(registers[cell.index])
            case _:
                nets.append(cell.op.meaning(tuple(nets[operand] for operand in cell.operands)))
    return tuple(nets[net] for _, net in circuit.outputs), tuple(nets[register.next] for register in circuit.registers)


def first_registers(circuit: Circuit) -> Bits:
    """The registers before the first tick."""
    return tuple(register.initial for register in circuit.registers)
