"""Where plans and behaviours meet: signatures, crews, brains, drawings."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path

import pytest
from properties.texts import said

from behaviours.catalogue import LIBRARIES
from behaviours.interface import STOP, Odometry, Pose, Reading
from rplan.apps.drawing.dot import dot
from rplan.apps.wiring import PlanBrain, compile_file, compile_source, crew, decider, plan_header, signatures
from rplan.circuit.cell import Cell, Op
from rplan.circuit.circuit import Circuit, Port, Register
from rplan.lang.diagnostic import PlanError
from rplan.lang.source import Source
from rplan.runtime.trace import Trace

PLAN = """(use robot)
(defoutput goal pose)
(defoutput action command)
(defgoalr (maint still)
  (do action (stop)))
(goalem (if (> (time-since-start) 1s) (maint still) (do anything)))
"""


def reading(stamp: float, tick: int) -> Reading:
    return Reading(stamp, tick, Odometry(Pose(0.0, 0.0), 0.0, 0.0))


def test_a_library_offers_the_compiler_what_it_brings_to_life() -> None:
    offered = signatures()
    assert [*offered] == [*LIBRARIES]
    stop = next(function for function in offered["robot"].functions if function.name == "stop")
    assert (stop.type is not None and stop.type.name, stop.actuators, stop.origin) == ("command", ("drive",), "robot")


def test_every_function_of_every_library_is_brought_to_life_by_its_crew() -> None:
    for library in LIBRARIES.values():
        made = crew(compile_source(Source("one.rplan", f"(use {library.name}) (goalem (do anything))")))
        for function in library.functions:
            sensed = {**made.percepts, **made.values}  # a value may be of any type
            home = {"command": made.competences, "pose": made.values}.get(function.type, sensed)
            assert function.name in home
        assert made.safe == STOP


def test_a_parameter_that_a_library_refuses_makes_the_plan_wrong() -> None:
    with pytest.raises(PlanError) as caught:
        compile_source(
            Source(
                "x.rplan", "(use runaway :safety-radius -1m)\n(use natigation :max-speed -1m/s) (goalem (do anything))"
            )
        )
    assert said(caught.value.diagnostics, "error") == ["bad-parameter", "bad-parameter"]


def test_a_brain_steps_notes_and_forgets_with_a_reset() -> None:
    brain = PlanBrain(compile_source(Source("still.rplan", PLAN)))
    assert brain.note() == "null"
    assert brain.step(reading(0.0, 0)) == STOP
    assert brain.step(reading(2.0, 1)) == STOP
    assert '"started":["stop"]' in brain.note()
    brain.close()
    brain.reset()
    assert brain.note() == "null"
    brain.step(reading(2.0, 0))
    assert brain.tick is not None
    assert (brain.tick.number, brain.tick.started) == (0, ("stop",))


@pytest.mark.parametrize("looked_at", [True, False])
def test_views_are_asked_where_somebody_looks_at_them(looked_at: bool) -> None:
    plan = compile_source(Source("placed.rplan", PLAN.replace("(use robot)", "(use robot) (use localisation)")))
    brain = PlanBrain(plan, looked_at=looked_at)
    assert brain.step(reading(0.0, 0)) == STOP
    assert brain.tick is not None
    assert ("believed-pose" in brain.tick.shown) is looked_at
    assert ("believed-pose" in brain.note()) is looked_at


def test_a_recording_says_of_its_plan_what_a_reader_needs() -> None:
    header = plan_header(compile_source(Source("some/where/still.rplan", PLAN)))
    assert header == {
        "name": "still",
        "file": "still.rplan",
        "text": PLAN,
        "included": [],
        "sha256": hashlib.sha256(PLAN.encode()).hexdigest(),
        "inputs": ["(> (time-since-start) 1s)"],
        "outputs": ["goal", "action"],
        "rules": [{"rule": "(maint still)", "line": 4, "end_line": 5}],
    }


def test_a_circuit_is_drawn_with_inputs_gates_registers_and_outputs() -> None:
    cells = (Cell(Op.INPUT, (), 0), Cell(Op.REGISTER, (), 0), Cell(Op.OR, (0, 1)), Cell(Op.CONSTANT, (), 1))
    latch = Circuit(
        'a "latch"', (Port("(set)"),), (Register("on", False, 2),), cells, ((Port("x\\y"), 2), (Port("t"), 3))
    )
    assert dot(latch).splitlines() == [
        'digraph "a \\"latch\\"" {',
        "  rankdir=LR;",
        '  node [fontname="Helvetica", fontsize=10];',
        '  n0 [label="(set)", shape=cds];',
        '  n1 [label="on", shape=box];',
        '  n2 [label="or", shape=invhouse];',
        "  n0 -> n2;",
        "  n1 -> n2;",
        '  n3 [label="true", shape=plaintext];',
        '  o0 [label="x\\\\y", shape=cds, style=bold];',
        "  n2 -> o0;",
        '  o1 [label="t", shape=cds, style=bold];',
        "  n3 -> o1;",
        "  n2 -> n1 [style=dashed, constraint=false];",
        "}",
    ]


def test_a_recording_knows_the_texts_that_a_plan_includes_and_lights_no_line_of_them(tmp_path: Path) -> None:
    (tmp_path / "rules.rplan").write_text("; rules\n\n(defgoalr (ach rest) (do action (stop)))\n")
    plan = tmp_path / "plan.rplan"
    plan.write_text('(include "rules.rplan")\n(use robot)\n(defoutput action command)\n(goalem (ach rest))\n')
    compiled = compile_file(plan)
    header = plan_header(compiled)
    assert header["included"] == [{"file": "rules.rplan", "text": (tmp_path / "rules.rplan").read_text()}]
    assert header["rules"] == []
    way = json.loads(Trace(compiled.ways).line(0, decider(compiled).tick({})))["way"]
    assert [(act["line"], Path(act["at"]).name) for act in way["acts"]] == [(None, "rules.rplan:3:22")]
