"""Circuits: what is well formed, what passes take away, what a tick costs."""

from __future__ import annotations

import pytest

from rplan.circuit.cell import Cell, Op
from rplan.circuit.check import check
from rplan.circuit.circuit import Circuit, Port, Register, print_circuit
from rplan.circuit.evaluate import evaluate, first_registers
from rplan.circuit.passes import run
from rplan.circuit.passes.share import share
from rplan.circuit.passes.sweep import sweep
from rplan.circuit.stats import stats
from rplan.lang.diagnostic import InternalError

A, B = Cell(Op.INPUT, (), 0), Cell(Op.INPUT, (), 1)
TRUE, FALSE = Cell(Op.CONSTANT, (), 1), Cell(Op.CONSTANT, (), 0)


def circuit(*cells: Cell, out: int | None = None, registers: tuple[Register, ...] = ()) -> Circuit:
    net = len(cells) - 1 if out is None else out
    return Circuit("small", (Port("a"), Port("b")), registers, cells, ((Port("out"), net),))


def inner(op: Op, *operands: int) -> Cell:
    return Cell(op, operands)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        (circuit(A, inner(Op.AND, 0)), "and reads 1 nets"),
        (circuit(A, inner(Op.NOT, 0, 0)), "not reads 2 nets"),
        (circuit(A, inner(Op.NOT, 1)), "not smaller"),
        (circuit(inner(Op.NOT, -1)), "not smaller"),
        (circuit(Cell(Op.INPUT, (), 2)), "there is no input 2"),
        (circuit(Cell(Op.REGISTER, (), 0)), "there is no register 0"),
        (circuit(Cell(Op.CONSTANT, (), 2)), "there is no constant 2"),
        (circuit(A, out=1), "there is no net 1"),
        (circuit(A, registers=(Register("r", False, -1),)), "there is no net -1"),
    ],
)
def test_a_malformed_circuit_is_a_fault_of_rplan(wrong: Circuit, message: str) -> None:
    with pytest.raises(InternalError, match=message):
        check(wrong)
    with pytest.raises(InternalError):
        run(wrong)


@pytest.mark.parametrize("op", [Op.CONSTANT, Op.INPUT, Op.REGISTER])
def test_what_is_no_gate_has_no_meaning(op: Op) -> None:
    with pytest.raises(ValueError, match="is not a gate"):
        op.meaning(())


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ((A, inner(Op.NOT, 0), inner(Op.NOT, 1)), "(input a)"),
        ((A, inner(Op.AND, 0, 0)), "(input a)"),
        ((A, inner(Op.OR, 0, 0)), "(input a)"),
        ((A, TRUE, inner(Op.AND, 0, 1)), "(input a)"),
        ((A, TRUE, inner(Op.OR, 0, 1)), "true"),
        ((A, FALSE, inner(Op.AND, 1, 0)), "false"),
        ((A, FALSE, inner(Op.OR, 1, 0)), "(input a)"),
        ((A, inner(Op.NOT, 0), inner(Op.AND, 0, 1)), "false"),
        ((A, inner(Op.NOT, 0), inner(Op.OR, 1, 0)), "true"),
        ((TRUE, inner(Op.NOT, 0)), "false"),
    ],
)
def test_a_gate_that_says_nothing_is_folded_away(before: tuple[Cell, ...], after: str) -> None:
    assert print_circuit(run(circuit(*before))) == f"(circuit small\n  (net 0 {after})\n  (output out 0))\n"


def test_equal_gates_become_one_whatever_the_order_of_their_operands() -> None:
    twice = circuit(A, B, inner(Op.AND, 0, 1), inner(Op.AND, 1, 0), inner(Op.OR, 2, 3))
    assert stats(run(twice)).gates == 1


def test_share_leaves_to_sweep_what_nobody_reads() -> None:
    shared = share(circuit(A, B, inner(Op.AND, 0, 1), out=0))
    assert len(shared.cells) == 3
    assert [cell.op for cell in sweep(shared).cells] == [Op.INPUT]


def test_sweep_keeps_inputs_and_registers() -> None:
    registers = (Register("unread", False, 0), Register("toggle", True, 2))
    cells = (A, Cell(Op.REGISTER, (), 1), inner(Op.NOT, 1), Cell(Op.REGISTER, (), 0))
    swept = sweep(Circuit("memory", (Port("a"),), registers, cells, ((Port("out"), 1),)))
    assert swept.registers == registers
    assert len(swept.cells) == 3
    assert [port.name for port in swept.inputs] == ["a"]
    now, seen = first_registers(swept), []
    for _ in range(3):
        outputs, now = evaluate(swept, now, (False,))
        seen += outputs
    assert seen == [True, False, True]


def test_stats_count_gates_registers_and_the_longest_path_to_an_end() -> None:
    memory = Register("m", False, 3)
    cells = (A, Cell(Op.REGISTER, (), 0), inner(Op.OR, 0, 1), inner(Op.NOT, 2), inner(Op.NOT, 3))
    costs = stats(Circuit("memory", (Port("a"),), (memory,), cells, ((Port("out"), 2),)))
    assert (costs.inputs, costs.outputs, costs.registers, costs.gates) == (1, 1, 1, 3)
    assert (costs.depth, costs.operations) == (2, 4), "the last gate leads to no end"


def test_a_circuit_prints_one_cell_a_line() -> None:
    cells = (A, Cell(Op.REGISTER, (), 0), inner(Op.OR, 0, 1), TRUE)
    memory = Circuit("memory", (Port("a"),), (Register("m", False, 2),), cells, ((Port("out"), 2), (Port("on"), 3)))
    assert print_circuit(memory) == (
        "(circuit memory\n  (net 0 (input a))\n  (net 1 (register m))\n  (net 2 (or 0 1))\n  (net 3 true)\n"
        "  (register m false 2)\n  (output out 2)\n  (output on 3))\n"
    )
