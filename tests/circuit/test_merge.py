"""Merging: what is equal in every situation is one net, and only that."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from rplan.apps.files import packaged_plans
from rplan.apps.wiring import compile_file
from rplan.circuit.build import build
from rplan.circuit.cell import Cell, Op
from rplan.circuit.check import check
from rplan.circuit.circuit import Circuit, Port, Register, print_circuit
from rplan.circuit.passes import run
from rplan.circuit.passes.merge import CHUNK, MOST_VARIABLES, merge, tables, variables
from rplan.circuit.passes.share import share
from rplan.circuit.passes.sweep import sweep
from rplan.circuit.stats import stats

A, B, C = (Cell(Op.INPUT, (), n) for n in range(3))


def inner(op: Op, *operands: int) -> Cell:
    return Cell(op, operands)


def circuit(*cells: Cell) -> Circuit:
    return Circuit("small", (Port("a"), Port("b"), Port("c")), (), cells, ((Port("out"), len(cells) - 1),))


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ((A, B, inner(Op.NOT, 0), inner(Op.AND, 1, 2), inner(Op.AND, 0, 3)), "(net 0 false)"),
        ((A, B, inner(Op.NOT, 0), inner(Op.OR, 1, 2), inner(Op.OR, 0, 3)), "(net 0 true)"),
        ((A, B, inner(Op.OR, 0, 1), inner(Op.AND, 0, 2)), "(net 0 (input a))"),
        ((A, B, inner(Op.NOT, 1), inner(Op.AND, 0, 1), inner(Op.AND, 0, 2), inner(Op.OR, 3, 4)), "(net 0 (input a))"),
    ],
)
def test_a_net_that_is_constant_or_an_input_in_every_situation_becomes_that(
    before: tuple[Cell, ...], after: str
) -> None:
    assert print_circuit(run(circuit(*before))) == f"(circuit small\n  {after}\n  (output out 0))\n"


def test_a_net_that_is_the_opposite_of_another_becomes_its_negation() -> None:
    nor = (A, B, inner(Op.OR, 0, 1), inner(Op.NOT, 0), inner(Op.NOT, 1), inner(Op.AND, 3, 4), inner(Op.OR, 2, 5))
    assert "(net 0 true)" in print_circuit(run(circuit(*nor)))
    both = Circuit("two", (Port("a"), Port("b")), (), nor[:6], ((Port("or"), 2), (Port("nor"), 5)))
    assert stats(run(both)).gates == 2


def test_registers_are_free_and_all_stay() -> None:
    """The register never becomes true, but a circuit does not know that of itself."""
    cells = (A, Cell(Op.REGISTER, (), 0), inner(Op.AND, 0, 1), inner(Op.NOT, 0), inner(Op.AND, 1, 2))
    never = Circuit("never", (Port("a"),), (Register("r", False, 4),), cells, ((Port("out"), 2),))
    after = run(never)
    assert after.registers == (Register("r", False, 2),)
    assert stats(after).gates == 1


@pytest.mark.parametrize("wide", [CHUNK, CHUNK + 1, MOST_VARIABLES])
def test_nets_that_differ_in_one_of_all_situations_stay_apart(wide: int) -> None:
    """all and (all or nothing-but-the-last): a chunk after the first tells them apart."""
    cells = [Cell(Op.INPUT, (), n) for n in range(wide)]
    total = 0
    for number in range(1, wide):
        cells.append(inner(Op.AND, total, number))
        total = len(cells) - 1
    cells += [Cell(Op.CONSTANT, (), 0), inner(Op.OR, total, total), inner(Op.AND, total, wide - 1)]
    ports = tuple(Port(f"i{n}") for n in range(wide))
    conjunction = Circuit("all", ports, (), tuple(cells), tuple((Port(f"o{n}"), len(cells) - n) for n in range(1, 4)))
    after = sweep(share(merge(conjunction)))
    check(after)
    assert [net for _, net in after.outputs][:2] == [after.outputs[0][1]] * 2
    assert after.cells[after.outputs[2][1]].op is Op.CONSTANT
    assert stats(after).gates == wide - 1


def test_a_circuit_of_many_inputs_is_left_as_it_is() -> None:
    cells = [Cell(Op.INPUT, (), n) for n in range(MOST_VARIABLES + 1)]
    cells += [inner(Op.OR, 0, 1), inner(Op.AND, 0, len(cells))]
    wide = Circuit("wide", tuple(Port(f"i{n}") for n in range(MOST_VARIABLES + 1)), (), tuple(cells), ())
    assert merge(wide) is wide


@pytest.mark.parametrize("path", packaged_plans(), ids=lambda path: path.stem)
def test_plans_do_not_grow_and_mean_the_same_in_every_situation(path: Path) -> None:
    compiled = compile_file(path, allow_holes=True)
    before = build(compiled.ways)
    names = sorted(variables(before), key=lambda name: (name[0].value, name[1]))
    for (_, old), (_, new) in zip(tables(before, names), tables(compiled.circuit, names), strict=True):
        assert [old[net] for _, net in before.outputs] == [new[net] for _, net in compiled.circuit.outputs]
        assert [old[r.next] for r in before.registers] == [new[r.next] for r in compiled.circuit.registers]
    assert stats(compiled.circuit).gates <= stats(sweep(share(before))).gates


def test_find_and_fetch_gets_smaller() -> None:
    compiled = compile_file(next(path for path in packaged_plans() if path.stem == "find_and_fetch"))
    assert stats(compiled.circuit).gates < stats(sweep(share(build(compiled.ways)))).gates


def test_random_tables_are_those_of_the_reference() -> None:
    """The patterns of a chunk count upwards, the first name fastest."""
    three = circuit(A, B, C)
    ((mask, nets),) = tables(three, variables(three))
    assert mask == 255
    rows = [[number >> bit & 1 for number in range(8)] for bit in range(3)]
    assert nets == [int(np.packbits(row, bitorder="little")[0]) for row in rows]
