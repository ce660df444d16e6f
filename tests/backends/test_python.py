"""Generated Python: a tree of tests where that is small, readable, complete, and never nested too deep."""

from __future__ import annotations

from itertools import product

import pytest
from properties.texts import compiled

from rplan.backends.interpreter import Interpreter
from rplan.backends.python import PythonEngine, Tick, emit, generate
from rplan.circuit.cell import Cell, Op
from rplan.circuit.circuit import Circuit, Port, Register
from rplan.circuit.decisions import MOST_GATES, MOST_VARIABLES, decisions, nodes_of

A, MEMORY = Cell(Op.INPUT, (), 0), Cell(Op.REGISTER, (), 0)


def parity(inputs: int) -> Circuit:
    """Whether an odd number of inputs is true: its tree has a path for every situation."""
    cells = [Cell(Op.INPUT, (), n) for n in range(inputs)]
    total = 0
    for number in range(1, inputs):
        here = len(cells)
        cells += [Cell(Op.OR, (total, number)), Cell(Op.AND, (total, number)), Cell(Op.NOT, (here + 1,))]
        cells.append(Cell(Op.AND, (here, here + 2)))
        total = here + 3
    ports = tuple(Port(f"i{n}") for n in range(inputs))
    return Circuit("parity", ports, (), tuple(cells), ((Port("odd"), total),))


def test_generated_code_names_inputs_outputs_and_their_places() -> None:
    source = emit(compiled("(goalem (when (lost) (do lamp on)))").circuit)
    assert source == (
        "# Longest path: 1 tests, and 0 gates for registers; 2 paths.\n"
        "# Output 0: hole at test.rplan:1:1\n"
        "# Output 1: lamp=(on) at test.rplan:1:22\n"
        "\n"
        "#   lamp=(on) at test.rplan:1:22\n"
        "OUT_0 = ((False, True, ), ())\n"
        "\n"
        "#   nothing is set\n"
        "OUT_1 = ((False, False, ), ())\n"
        "\n\n"
        "def tick(inputs, registers=()):\n"
        "    if inputs[0]:  # (lost)\n"
        "        return OUT_0\n"
        "    return OUT_1\n"
    )


@pytest.mark.rule("L19")
def test_generated_code_evaluates_every_register_in_every_tick() -> None:
    latch = Circuit(
        "latch", (Port("set"),), (Register("on", False, 2),), (A, MEMORY, Cell(Op.OR, (0, 1))), ((Port("out"), 2),)
    )
    generated = generate(latch)
    assert generated.form == "tree"
    assert (generated.tests, generated.gates, generated.longest, generated.ends) == (2, 1, 3, 3)
    assert generated.source.endswith(
        "def tick(inputs, registers=()):\n"
        "    i0 = inputs[0]  # set\n"
        "    r0 = registers[0]  # on\n"
        "    after = (i0 or r0, )\n"
        "    if i0:  # set\n"
        "        return OUT_0, after\n"
        "    if r0:  # on\n"
        "        return OUT_0, after\n"
        "    return OUT_1, after\n"
    )
    for engine in (PythonEngine(latch), Interpreter(latch)):
        assert [engine.tick((bit,)) for bit in (False, True, False)] == [(False,), (True,), (True,)]
        assert engine.registers == (True,)


def test_what_is_returned_was_made_beforehand() -> None:
    engine = PythonEngine(parity(3))
    assert engine.tick((True, False, False)) is engine.tick((False, True, False))


@pytest.mark.rule("L19")
def test_the_longest_path_is_reported_whatever_the_form() -> None:
    tree, expressions = generate(parity(5)), generate(parity(5), most=10)
    assert (tree.form, tree.tests, tree.ends, tree.longest) == ("tree", 5, 32, 5)
    assert (expressions.form, expressions.gates, expressions.longest) == ("expressions", 16, 16)
    assert tree.source.startswith("# Longest path: 5 tests, and 0 gates for registers; 32 paths.\n")
    assert expressions.source.startswith("# Longest path: 16 gates.\n")


@pytest.mark.parametrize(("inputs", "form"), [(10, "tree"), (11, "tree"), (12, "expressions"), (18, "expressions")])
def test_a_tree_that_would_be_too_large_is_not_written_out(inputs: int, form: str) -> None:
    generated = generate(parity(inputs))
    assert generated.form == form
    assert len(generated.source) < 400_000


def test_a_tree_asks_in_the_order_that_makes_it_smaller() -> None:
    """(a and d) or (b and e) or (c and f): in the order of the plan 2⁴ ends, in that of the cells 7 tests suffice."""
    pairs = [Cell(Op.INPUT, (), n) for pair in ((0, 3), (1, 4), (2, 5)) for n in pair]
    cells = [*pairs, *(Cell(Op.AND, (n, n + 1)) for n in (0, 2, 4)), Cell(Op.OR, (6, 7)), Cell(Op.OR, (8, 9))]
    circuit = Circuit("pairs", tuple(Port(f"i{n}") for n in range(6)), (), tuple(cells), ((Port("out"), 10),))
    tree = decisions(circuit)
    assert tree is not None
    assert nodes_of(tree) == 2 * 14 + 1


def test_code_nests_no_deeper_than_the_logarithm_of_its_size() -> None:
    """A chain of 200 conditions is 200 tests, one under the other."""
    cells = [Cell(Op.INPUT, (), n) for n in range(200)]
    total = 0
    for number in range(1, 200):
        cells.append(Cell((Op.AND, Op.OR)[number % 2], (total, number)))
        total = len(cells) - 1
    ports = tuple(Port(f"i{n}") for n in range(200))
    chain = Circuit("chain", ports, (), tuple(cells), ((Port("out"), total),))
    engine, reference = PythonEngine(chain), Interpreter(chain)
    assert engine.generated.tests == 200
    assert max(len(line) - len(line.lstrip()) for line in engine.generated.source.splitlines()) <= 8
    for first in range(0, 200, 7):
        bits = tuple(number >= first for number in range(200))
        assert engine.tick(bits) == reference.tick(bits)


def test_expressions_keep_their_parentheses() -> None:
    cells = (A, *(Cell(Op.INPUT, (), n) for n in (1, 2)), Cell(Op.OR, (1, 2)), Cell(Op.NOT, (3,)), Cell(Op.AND, (0, 4)))
    circuit = Circuit("small", (Port("a"), Port("b"), Port("c")), (), cells, ((Port("out"), 5),))
    assert "i0 and not (i1 or i2),  # out" in generate(circuit, most=0).source


@pytest.mark.parametrize("length", [39, 40, 41, MOST_GATES // 2, 20_000])
@pytest.mark.parametrize("most", [0, 100])
def test_a_long_chain_of_gates_becomes_several_expressions(length: int, most: int) -> None:
    cells = [A, Cell(Op.INPUT, (), 1)]
    for number in range(length):
        cells.append(Cell((Op.AND, Op.OR)[number % 2], (len(cells) - 1, 0)))
        cells.append(Cell(Op.NOT, (len(cells) - 1,)))
    circuit = Circuit("chain", (Port("a"), Port("b")), (), tuple(cells), ((Port("out"), len(cells) - 1),))
    names: dict[str, Tick] = {}
    exec(generate(circuit, most).source, names)
    reference = Interpreter(circuit)
    for bits in product((False, True), repeat=2):
        assert names["tick"](bits, ()) == (reference.tick(bits), ())


def test_a_circuit_of_very_many_inputs_has_no_tree() -> None:
    cells = tuple(Cell(Op.INPUT, (), n) for n in range(MOST_VARIABLES + 1))
    ports = tuple(Port(f"i{n}") for n in range(MOST_VARIABLES + 1))
    wide = Circuit("wide", ports, (), cells, ((Port("out"), MOST_VARIABLES),))
    assert decisions(wide) is None
    assert PythonEngine(wide).tick((False,) * MOST_VARIABLES + (True,)) == (True,)


def test_names_that_break_lines_stay_in_their_comment() -> None:
    wicked = Circuit("a\nb", (Port("x\nraise SystemExit"),), (), (A,), ((Port("y\rimport this\u2028\udcff"), 0),))
    assert PythonEngine(wicked).tick((True,)) == (True,)
