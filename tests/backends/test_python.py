"""Generated Python: readable, complete, and not nested too deep for Python."""

from __future__ import annotations

import pytest
from properties.texts import compiled

from rplan.backends.interpreter import Interpreter
from rplan.backends.python import PythonEngine, emit
from rplan.circuit.cell import Cell, Op
from rplan.circuit.circuit import Circuit, Port, Register

A, MEMORY = Cell(Op.INPUT, (), 0), Cell(Op.REGISTER, (), 0)


def test_generated_code_names_inputs_registers_outputs_and_their_places() -> None:
    source = emit(compiled("(goalem (when (lost) (do lamp on)))").circuit)
    assert source == (
        "def tick(inputs, registers=()):\n"
        "    # i0: (lost)\n"
        "    (i0, ) = inputs\n"
        "    return (\n"
        "        False,  # hole at test.rplan:1:1\n"
        "        i0,  # lamp=(on) at test.rplan:1:22\n"
        "    ), ()\n"
    )


@pytest.mark.rule("L19")
def test_generated_code_evaluates_every_register_in_every_tick() -> None:
    latch = Circuit(
        "latch", (Port("set"),), (Register("on", False, 2),), (A, MEMORY, Cell(Op.OR, (0, 1))), ((Port("out"), 2),)
    )
    source = emit(latch)
    assert "# r0: on" in source
    assert source.endswith("    ), (n2, )\n")
    for engine in (PythonEngine(latch), Interpreter(latch)):
        assert [engine.tick((bit,)) for bit in (False, True, False)] == [(False,), (True,), (True,)]
        assert engine.registers == (True,)


def test_expressions_keep_their_parentheses() -> None:
    cells = (A, Cell(Op.INPUT, (), 1), Cell(Op.OR, (0, 1)), Cell(Op.NOT, (2,)), Cell(Op.AND, (0, 3)))
    circuit = Circuit("small", (Port("a"), Port("b")), (), cells, ((Port("out"), 4),))
    assert "i0 and not (i0 or i1),  # out" in emit(circuit)


@pytest.mark.parametrize("length", [39, 40, 41, 20_000])
def test_a_long_chain_of_gates_becomes_several_expressions(length: int) -> None:
    cells = [A, Cell(Op.INPUT, (), 1)]
    for number in range(length):
        cells.append(Cell((Op.AND, Op.OR)[number % 2], (len(cells) - 1, 0)))
        cells.append(Cell(Op.NOT, (len(cells) - 1,)))
    circuit = Circuit("chain", (Port("a"), Port("b")), (), tuple(cells), ((Port("out"), len(cells) - 1),))
    engine, reference = PythonEngine(circuit), Interpreter(circuit)
    for bits in ((False, False), (False, True), (True, False), (True, True)):
        assert engine.tick(bits) == reference.tick(bits)
