"""Every engine equals the reference on every trace and in every situation, and passes keep the meaning of a circuit."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from properties.strategies import circuits, circuits_with_traces

from rplan.apps.files import plans_folder
from rplan.apps.wiring import compile_file
from rplan.backends.c import CEngine
from rplan.backends.interpreter import Interpreter
from rplan.backends.packed import PackedEngine, pack, unpack
from rplan.backends.python import PythonEngine
from rplan.circuit.cell import Cell, Op
from rplan.circuit.check import check
from rplan.circuit.circuit import Circuit, Port
from rplan.circuit.engine import Engine
from rplan.circuit.evaluate import Bits, evaluate, first_registers
from rplan.circuit.passes import PIPELINE, Pass, run
from rplan.circuit.passes.merge import values
from rplan.circuit.stats import stats


class OneOfMany:
    """The packed engine as one for a single robot: 100 robots are given the same, and must say the same."""

    ROBOTS = 100

    def __init__(self, circuit: Circuit) -> None:
        self.engine = PackedEngine(circuit, self.ROBOTS)

    @property
    def registers(self) -> Bits:
        return self.common(self.engine.registers)

    def reset(self) -> None:
        self.engine.reset()

    def tick(self, inputs: Sequence[bool]) -> Bits:
        bits = np.array([inputs] * self.ROBOTS, np.bool_).T.reshape(len(inputs), self.ROBOTS)
        return self.common(self.engine.tick(pack(bits)))

    def common(self, planes: np.ndarray[tuple[int, int], np.dtype[np.uint64]]) -> Bits:
        (bits,) = {tuple(map(bool, robot)) for robot in unpack(planes, self.ROBOTS).T}
        return bits


ENGINES: tuple[Callable[[Circuit], Engine], ...] = (Interpreter, PythonEngine, OneOfMany, CEngine)


@pytest.fixture(scope="module", autouse=True)
def _libraries(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Compiled libraries go where the tests leave their files."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(tmp_path_factory.mktemp("cache")))
        yield


Trace = list[Sequence[bool]]


def reference(circuit: Circuit, trace: Trace) -> list[Bits]:
    """The outputs of a circuit tick by tick."""
    registers, seen = first_registers(circuit), []
    for inputs in trace:
        outputs, registers = evaluate(circuit, registers, inputs)
        seen.append(outputs)
    return seen


def remembered(circuit: Circuit, trace: Trace) -> Bits:
    """The registers of a circuit after the last tick."""
    registers = first_registers(circuit)
    for inputs in trace:
        registers = evaluate(circuit, registers, inputs)[1]
    return registers


@pytest.mark.rule("L19")
@pytest.mark.parametrize("engine", ENGINES)
@settings(max_examples=70, deadline=None, derandomize=True)
@given(circuits_with_traces())
def test_an_engine_agrees_with_the_reference_on_every_trace(
    engine: Callable[[Circuit], Engine], pair: tuple[Circuit, Trace]
) -> None:
    circuit, trace = pair
    running = engine(circuit)
    assert running.registers == first_registers(circuit)
    assert [running.tick(inputs) for inputs in trace] == reference(circuit, trace)
    assert running.registers == remembered(circuit, trace)


@pytest.mark.parametrize("engine", ENGINES)
@settings(max_examples=20, deadline=None, derandomize=True)
@given(circuits_with_traces())
def test_after_a_reset_an_engine_is_as_before_its_first_tick(
    engine: Callable[[Circuit], Engine], pair: tuple[Circuit, Trace]
) -> None:
    circuit, trace = pair
    running = engine(circuit)
    before = running.registers
    first = [running.tick(inputs) for inputs in trace]
    running.reset()
    assert running.registers == before == first_registers(circuit)
    assert [running.tick(inputs) for inputs in trace] == first


def every_situation(inputs: int) -> np.ndarray[tuple[int, int], np.dtype[np.bool_]]:
    """(inputs, 2 ** inputs); the first input changes slowest, as `itertools.product` counts."""
    numbers = np.arange(1 << inputs)
    return np.array([numbers >> (inputs - 1 - n) & 1 for n in range(inputs)], np.bool_)


def figure(name: str) -> Circuit:
    return compile_file(plans_folder() / name, allow_holes=True).circuit


PLANS = ("figure_1/figure.rplan", "figure_1/text.rplan", "find_and_fetch/find_and_fetch.rplan")


@pytest.mark.rule("L19")
@pytest.mark.parametrize("engine", ENGINES[1:])
@pytest.mark.parametrize("name", PLANS)
def test_an_engine_agrees_with_the_reference_in_every_situation_of_a_plan(
    engine: Callable[[Circuit], Engine], name: str
) -> None:
    circuit = figure(name)
    running = engine(circuit)
    if isinstance(running, OneOfMany):
        wide = PackedEngine(circuit, 1 << len(circuit.inputs))
        seen = [tuple(row) for row in unpack(wide.tick(pack(every_situation(len(circuit.inputs)))), wide.robots).T]
    else:
        seen = [running.tick(bits) for bits in product((False, True), repeat=len(circuit.inputs))]
    assert seen == [evaluate(circuit, (), bits)[0] for bits in product((False, True), repeat=len(circuit.inputs))]


def synthetic(inputs: int, gates: int, seed: int) -> Circuit:
    """Random gates over the last few nets, so that the circuit gets deep and reads all inputs."""
    generator = np.random.default_rng(seed)
    cells = [Cell(Op.INPUT, (), n) for n in range(inputs)]
    for number in range(gates):
        op = (Op.AND, Op.OR, Op.NOT)[int(generator.integers(3))]
        near = int(generator.integers(max(0, len(cells) - 12), len(cells)))
        cells.append(Cell(op, (near, number % inputs)[: op.arity]))
    ports = tuple((Port(f"o{n}"), len(cells) - 1 - n) for n in range(12))
    return Circuit("synthetic", tuple(Port(f"i{n}") for n in range(inputs)), (), tuple(cells), ports)


def test_the_packed_engine_agrees_with_the_reference_in_each_of_a_million_situations() -> None:
    """20 inputs: all 1,048,576 situations against whole numbers as bits, and those against the reference at random."""
    circuit, count = synthetic(20, 120, 3), 1 << 20
    assert stats(run(circuit)).gates > 20
    situations = every_situation(20)
    planes = pack(situations)
    seen = PackedEngine(circuit, count).tick(planes)
    patterns = {(Op.INPUT, n): int.from_bytes(plane.tobytes(), "little") for n, plane in enumerate(planes)}
    nets = values(circuit, patterns, (1 << count) - 1)
    for plane, (_, net) in zip(seen, circuit.outputs, strict=True):
        assert int.from_bytes(plane.tobytes(), "little") == nets[net]
    bits = unpack(seen, count)
    for number in map(int, np.random.default_rng(1).integers(0, count, 500)):
        assert tuple(bits[:, number]) == evaluate(circuit, (), [bool(bit) for bit in situations[:, number]])[0]


@pytest.mark.parametrize("one", [*PIPELINE, run], ids=lambda one: one.__name__)
@settings(max_examples=150, deadline=None, derandomize=True)
@given(circuits_with_traces())
def test_a_pass_keeps_inputs_outputs_and_meaning(one: Pass, pair: tuple[Circuit, Trace]) -> None:
    circuit, trace = pair
    after = one(circuit)
    check(after)
    assert after.inputs == circuit.inputs
    assert [port for port, _ in after.outputs] == [port for port, _ in circuit.outputs]
    assert reference(after, trace) == reference(circuit, trace)


@settings(max_examples=100, deadline=None, derandomize=True)
@given(circuits())
def test_passes_never_make_a_circuit_dearer_and_have_nothing_left_to_do(circuit: Circuit) -> None:
    once = run(circuit)
    assert stats(once).gates <= stats(circuit).gates
    assert stats(once).registers <= stats(circuit).registers
    assert stats(run(once)) == stats(once)
