"""What `rplan compile` does.

Takes: a plan. Gives: a report of what a tick of it costs, or its circuit in some form. Leaves alone: options and
their help; see rplan/apps/commands/compile.py, which imports this only when there is something to do.
"""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path

import click

from rplan.apps import talk
from rplan.apps.drawing.dot import dot
from rplan.apps.drawing.svg import svg
from rplan.apps.files import InputError, plan_file, unreadable
from rplan.backends.c import emit_c
from rplan.backends.python import emit, generate
from rplan.circuit.circuit import Circuit, print_circuit
from rplan.circuit.stats import stats
from rplan.driver import Compiled
from rplan.ways.exhaust import count_ways, exhaustible, has_comparisons
from rplan.ways.listing import taken_ways
from rplan.ways.sample import Samples

MOST_WAYS = 64
"""Ways of a plan that compares numbers are counted up to here."""


def run(plan: str, form: str | None, output: str | None, strict: bool, allow_holes: bool, as_json: bool) -> None:
    """Do what was asked; leaves with the exit code of the command."""
    compiled = talk.compiled(
        plan_file(plan), strict=strict, allow_holes=allow_holes, as_json=as_json, notes=talk.MOST_NOTES
    )
    if form is not None:
        _write(_emitted(compiled.circuit, form), output)
        return
    ways, exact = _count(compiled)
    if as_json:
        costs = {**asdict(stats(compiled.circuit)), "longest_path_in_python": generate(compiled.circuit).longest}
        talk.result({"plan": compiled.goals.name, "ways": ways, "ways_exact": exact, **costs})
        return
    _write(_report(compiled, ways, exact), output)


def _count(compiled: Compiled) -> tuple[int, bool]:
    """How many ways can be taken, and whether that is all of them or a least number."""
    ways = compiled.ways
    if exhaustible(ways):
        return count_ways(ways), True
    if not has_comparisons(ways):
        return Samples(ways).count_ways(), False
    found = sum(1 for _ in taken_ways(ways, MOST_WAYS))
    return found, found < MOST_WAYS and not ways.driving


def _report(compiled: Compiled, ways: int, exact: bool) -> str:
    costs = stats(compiled.circuit)
    rows = [
        ("ways that can be taken", f"{ways:,}" if exact else f"≥ {ways:,}"),
        ("inputs", f"{costs.inputs:,}"),
        ("outputs", f"{costs.outputs:,}"),
        ("registers", f"{costs.registers:,}"),
        ("gates", f"{costs.gates:,}"),
        ("depth", f"{costs.depth:,}"),
        ("operations a tick", f"{costs.operations:,}"),
        ("longest path in Python", f"{generate(compiled.circuit).longest:,}"),
    ]
    lines = [f"{compiled.goals.name}: a tick every {compiled.goals.period:g} s"]
    return "\n".join(lines + [f"  {name:<24}{value:>10}" for name, value in rows]) + "\n"


def _emitted(circuit: Circuit, form: str) -> str:
    match form:
        case "sexp":
            return print_circuit(circuit)
        case "python":
            return emit(circuit)
        case "dot":
            return dot(circuit)
        case "svg":
            return _drawn(circuit)
        case "c":
            return emit_c(circuit)
        case _:
            return _json(circuit)


def _drawn(circuit: Circuit) -> str:
    try:
        return svg(circuit)
    except ValueError as error:
        raise InputError(str(error)) from error


def _json(circuit: Circuit) -> str:
    import json

    value = {
        "name": circuit.name,
        "inputs": [{"name": p.name, "places": [str(s) for s in p.places]} for p in circuit.inputs],
        "registers": [asdict(register) for register in circuit.registers],
        "cells": [{"op": c.op.value, "operands": list(c.operands), "index": c.index} for c in circuit.cells],
        "outputs": [{"name": p.name, "net": net, "places": [str(s) for s in p.places]} for p, net in circuit.outputs],
    }
    return json.dumps(value, indent=2, ensure_ascii=False) + "\n"


def _write(text: str, output: str | None) -> None:
    if output is None:
        click.echo(text, nl=False)
        return
    try:
        Path(output).write_text(text, encoding="utf-8")
    except OSError as error:
        unreadable(Path(output), error)
