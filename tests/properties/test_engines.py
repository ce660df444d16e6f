"""Every engine equals the reference on every trace, and passes keep the meaning of a circuit."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import pytest
from hypothesis import given, settings
from properties.strategies import circuits, circuits_with_traces

from rplan.backends.interpreter import Interpreter
from rplan.backends.python import PythonEngine
from rplan.circuit.check import check
from rplan.circuit.circuit import Circuit
from rplan.circuit.engine import Engine
from rplan.circuit.evaluate import Bits, evaluate, first_registers
from rplan.circuit.passes import PIPELINE, Pass, run
from rplan.circuit.stats import stats

ENGINES = (Interpreter, PythonEngine)
Trace = list[Sequence[bool]]


def reference(circuit: Circuit, trace: Trace) -> list[Bits]:
    """The outputs of a circuit tick by tick."""
    registers, seen = first_registers(circuit), []
    for inputs in trace:
        outputs, registers = evaluate(circuit, registers, inputs)
        seen.append(outputs)
    return seen


@pytest.mark.rule("L19")
@pytest.mark.parametrize("engine", ENGINES)
@settings(max_examples=150, deadline=None, derandomize=True)
@given(circuits_with_traces())
def test_an_engine_agrees_with_the_reference_on_every_trace(
    engine: Callable[[Circuit], Engine], pair: tuple[Circuit, Trace]
) -> None:
    circuit, trace = pair
    running = engine(circuit)
    assert [running.tick(inputs) for inputs in trace] == reference(circuit, trace)


@pytest.mark.parametrize("engine", ENGINES)
@settings(max_examples=60, deadline=None, derandomize=True)
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
