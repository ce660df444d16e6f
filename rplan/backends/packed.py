"""A circuit for many robots at once: 64 robots a word, numpy.

Takes: a circuit and how many robots. Gives: `PackedEngine`, `pack` and `unpack`. Leaves alone: what robots do.

A *plane* is one bit of every robot: ceil(robots / 64) words of uint64, robot n in bit n % 64 of word n // 64. A gate is
one numpy operation over a plane. Planes are worked through in blocks that stay in the cache, and scratch buffers are
used again as soon as nothing reads them any more; after the first tick nothing is allocated.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from rplan.circuit.cell import Op
from rplan.circuit.circuit import Circuit

Planes = NDArray[np.uint64]
"""shape (bits, words)."""

BLOCK = 16_384
"""Words of a block: smaller ones spend their time between operations, larger ones leave the cache."""
ALL = np.uint64(0xFFFF_FFFF_FFFF_FFFF)

Operation = Callable[..., object]
"""Takes the planes that it reads, then the one that it writes."""

GATES: dict[Op, Operation] = {Op.NOT: np.invert, Op.AND: np.bitwise_and, Op.OR: np.bitwise_or}


def pack(bits: NDArray[np.bool_]) -> Planes:
    """(bits, robots) of bool -> (bits, words)."""
    count, robots = bits.shape
    padded = np.zeros((count, words_of(robots) * 8), np.uint8)
    packed = np.packbits(bits, axis=1, bitorder="little")
    padded[:, : packed.shape[1]] = packed
    return padded.view("<u8").astype(np.uint64, copy=False)


def unpack(planes: Planes, robots: int) -> NDArray[np.bool_]:
    """(bits, words) -> (bits, robots) of bool."""
    as_bytes = np.ascontiguousarray(planes, dtype="<u8").view(np.uint8)
    return np.unpackbits(as_bytes, axis=1, count=robots, bitorder="little").view(np.bool_)


def words_of(robots: int) -> int:
    """Words of a plane."""
    return -(-robots // 64)


class PackedEngine:
    """Runs one circuit for many robots; `registers` is their memory as planes (registers, words)."""

    def __init__(self, circuit: Circuit, robots: int) -> None:
        self.robots = robots
        self._circuit = circuit
        self._words = words_of(robots)
        self._program = _Program(circuit)
        self._block = min(BLOCK, self._words)
        self.scratch = np.zeros((self._program.buffers, self._block), np.uint64)
        self._outputs = np.zeros((len(circuit.outputs), self._words), np.uint64)
        self._next = np.zeros((len(circuit.registers), self._words), np.uint64)
        self.registers: Planes = np.zeros_like(self._next)
        self.reset()

    def reset(self) -> None:
        """All robots back to before the first tick."""
        for plane, register in zip(self.registers, self._circuit.registers, strict=True):
            plane[:] = ALL if register.initial else 0

    def tick(self, planes: Planes) -> Planes:
        """One tick of every robot: (inputs, words) -> (outputs, words).

        The result is written over by the next tick; bits beyond the last robot mean nothing. `ValueError` for planes
        of another shape or type.
        """
        wanted = (len(self._circuit.inputs), self._words)
        if planes.shape != wanted or planes.dtype != np.uint64:
            raise ValueError(f"planes of shape {wanted} and type uint64 are wanted, not {planes.shape}, {planes.dtype}")
        for begin in range(0, self._words, self._block):
            self._run(planes, begin, min(begin + self._block, self._words))
        self.registers, self._next = self._next, self.registers
        return self._outputs

    def _run(self, planes: Planes, begin: int, end: int) -> None:
        """One block."""
        rows = [
            *(plane[begin:end] for bank in (planes, self.registers, self._outputs, self._next) for plane in bank),
            *(buffer[: end - begin] for buffer in self.scratch),
        ]
        for operation, operands, out in self._program.steps:
            operation(*[rows[row] for row in operands], rows[out])
        for source, row in self._program.copies:
            np.copyto(rows[row], rows[source])


class _Program:
    """Straight-line code over rows: inputs, registers, outputs, next registers, then scratch buffers.

    A gate that drives an output or register is computed in its row; the others share `buffers` scratch rows. copies:
    (from, to) of outputs and registers that an input, a register or another of them drives.
    """

    def __init__(self, circuit: Circuit) -> None:
        self.circuit = circuit
        self.steps: list[tuple[Operation, tuple[int, ...], int]] = []
        self.buffers = 0
        self._inputs = len(circuit.inputs)
        self._ends = self._inputs + len(circuit.registers)
        self._scratch = self._ends + len(circuit.outputs) + len(circuit.registers)
        self._rows: dict[int, int] = {}
        self._free: list[int] = []
        ends = [net for _, net in circuit.outputs] + [register.next for register in circuit.registers]
        homes = {net: self._ends + number for number, net in reversed([*enumerate(ends)])}
        self._write(homes)
        rows = [(self._rows[net], self._ends + number) for number, net in enumerate(ends)]
        self.copies = [(source, row) for source, row in rows if source != row]

    def _write(self, homes: dict[int, int]) -> None:
        last = self._last_reads(homes)
        for net, cell in enumerate(self.circuit.cells):
            match cell.op:
                case Op.INPUT:
                    self._rows[net] = cell.index
                case Op.REGISTER:
                    self._rows[net] = self._inputs + cell.index
                case _ if net in last:
                    operation = GATES.get(cell.op, _set if cell.index else _clear)
                    operands = tuple(self._rows[operand] for operand in cell.operands)
                    self._release(net, last)
                    self._rows[net] = homes[net] if net in homes else self._buffer()
                    self.steps.append((operation, operands, self._rows[net]))

    def _last_reads(self, homes: dict[int, int]) -> dict[int, int]:
        """Net -> the last net that reads it; what drives an end is read for ever, what nobody reads is left out."""
        last = dict.fromkeys(homes, len(self.circuit.cells))
        for net in range(len(self.circuit.cells) - 1, -1, -1):
            if net in last:
                for operand in self.circuit.cells[net].operands:
                    last.setdefault(operand, net)
        return last

    def _release(self, net: int, last: dict[int, int]) -> None:
        for operand in dict.fromkeys(self.circuit.cells[net].operands):
            row = self._rows[operand]
            if last[operand] == net and row >= self._scratch:
                self._free.append(row)

    def _buffer(self) -> int:
        if self._free:
            return self._free.pop()
        self.buffers += 1
        return self._scratch + self.buffers - 1


def _set(plane: NDArray[np.uint64]) -> None:
    plane.fill(ALL)


def _clear(plane: NDArray[np.uint64]) -> None:
    plane.fill(0)
