"""Many robots at once: packing, blocks, and what a tick gives back."""

from __future__ import annotations

import numpy as np
import pytest

from rplan.backends import packed
from rplan.backends.packed import PackedEngine, pack, unpack, words_of
from rplan.circuit.cell import Cell, Op
from rplan.circuit.circuit import Circuit, Port, Register
from rplan.circuit.evaluate import Bits, evaluate, first_registers

A, B, MEMORY = Cell(Op.INPUT, (), 0), Cell(Op.INPUT, (), 1), Cell(Op.REGISTER, (), 0)
LATCH = Circuit(
    "latch",
    (Port("set"), Port("reset")),
    (Register("on", True, 5), Register("was", False, 2)),
    (A, B, MEMORY, Cell(Op.NOT, (1,)), Cell(Op.OR, (0, 2)), Cell(Op.AND, (3, 4)), Cell(Op.CONSTANT, (), 1)),
    (
        (Port("on"), 5),
        (Port("again"), 5),
        (Port("before"), 2),
        (Port("true"), 6),
        (Port("reset"), 1),
    ),
)


@pytest.mark.parametrize("robots", [1, 63, 64, 65, 130, 1000])
def test_unpack_undoes_pack(robots: int) -> None:
    bits = np.random.default_rng(robots).random((3, robots)) < 0.5
    planes = pack(bits)
    assert planes.shape == (3, words_of(robots)) and planes.dtype == np.uint64
    assert np.array_equal(unpack(planes, robots), bits)


def test_robot_n_is_bit_n_modulo_64_of_word_n_over_64() -> None:
    bits = np.zeros((1, 130), np.bool_)
    bits[0, [1, 64, 129]] = True
    assert [*pack(bits)[0]] == [2, 1, 2]


def test_no_inputs_and_no_robots_are_planes_too() -> None:
    assert pack(np.zeros((0, 65), np.bool_)).shape == (0, 2)
    assert unpack(np.zeros((2, 0), np.uint64), 0).shape == (2, 0)


@pytest.mark.parametrize("block", [1, 3, 8192])
def test_every_robot_has_its_own_memory_whatever_the_blocks(block: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(packed, "BLOCK", block)
    robots, generator = 500, np.random.default_rng(4)
    engine = PackedEngine(LATCH, robots)
    memories: list[Bits] = [first_registers(LATCH)] * robots
    for _ in range(6):
        bits = generator.random((2, robots)) < 0.4
        seen = unpack(engine.tick(pack(bits)), robots)
        for robot in range(robots):
            outputs, memories[robot] = evaluate(LATCH, memories[robot], [bool(bit) for bit in bits[:, robot]])
            assert tuple(seen[:, robot]) == outputs
        assert [tuple(row) for row in unpack(engine.registers, robots).T] == memories
    engine.reset()
    assert {tuple(row) for row in unpack(engine.registers, robots).T} == {first_registers(LATCH)}


def test_a_tick_leaves_its_inputs_alone_and_writes_into_the_same_planes() -> None:
    engine = PackedEngine(LATCH, 64)
    planes = np.array([[5], [3]], np.uint64)
    first = engine.tick(planes)
    assert engine.tick(planes) is first
    assert [*planes[:, 0]] == [5, 3]


@pytest.mark.parametrize(
    "wrong", [np.zeros((1, 2), np.uint64), np.zeros((2, 1), np.uint64), np.zeros((2, 2), np.int64)]
)
def test_planes_of_another_shape_or_type_are_refused(wrong: packed.Planes) -> None:
    with pytest.raises(ValueError, match=r"planes of shape \(2, 2\) and type uint64 are wanted"):
        PackedEngine(LATCH, 65).tick(wrong)


def test_scratch_planes_are_used_again() -> None:
    """A chain of 50 conjunctions and negations needs no more than two."""
    cells = [A, B]
    for _ in range(25):
        cells += [Cell(Op.AND, (len(cells) - 1, 0)), Cell(Op.NOT, (len(cells),))]
    chain = Circuit("chain", (Port("a"), Port("b")), (), tuple(cells), ((Port("out"), len(cells) - 1),))
    engine = PackedEngine(chain, 64)
    assert engine.scratch.shape[0] <= 2
    assert len(cells) == 52
