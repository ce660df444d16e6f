"""Drawings of circuits: whole, well-formed, readable and small."""

from __future__ import annotations

import re
from xml.etree import ElementTree

import numpy as np
import pytest

from rplan.apps.drawing.dot import dot
from rplan.apps.drawing.svg import MOST_GATES, svg
from rplan.apps.files import plans_folder
from rplan.apps.wiring import compile_file
from rplan.circuit.cell import Cell, Op
from rplan.circuit.circuit import Circuit, Port, Register
from rplan.lang.source import Span

SVG = "{http://www.w3.org/2000/svg}"


def drawn(circuit: Circuit) -> ElementTree.Element:
    return ElementTree.fromstring(svg(circuit))


def texts(drawing: ElementTree.Element) -> list[str]:
    return [text.text or "" for text in drawing.iter(f"{SVG}text")]


def fetch() -> Circuit:
    return compile_file(plans_folder() / "find_and_fetch" / "find_and_fetch.rplan").circuit


def test_every_input_gate_and_output_is_drawn_once() -> None:
    circuit = fetch()
    drawing = drawn(circuit)
    names = texts(drawing)
    assert names[0] == "find-and-fetch"
    assert sorted(names[1:]) == sorted(
        [port.name for port in circuit.inputs] + [port.name for port, _ in circuit.outputs] + ["false"]
    )
    shapes = [path.get("class", "") for path in drawing.iter(f"{SVG}path")]
    for op in (Op.NOT, Op.AND, Op.OR):
        assert shapes.count(f"gate {op.value}") == sum(1 for cell in circuit.cells if cell.op is op)


def test_nothing_stands_upon_anything_else_and_all_is_inside_the_picture() -> None:
    drawing = drawn(fetch())
    places = []
    for text in drawing.iter(f"{SVG}text"):
        x, y = float(text.get("x", "")), float(text.get("y", ""))
        places.append((x, y))
        assert 0 <= x <= float(drawing.get("width", "")) and 0 <= y <= float(drawing.get("height", ""))
    for path in drawing.iter(f"{SVG}path"):
        if path.get("class", "").startswith("gate"):
            x, y = map(float, re.findall(r"^M(\S+) ([\d.]+)", path.get("d", ""))[0])
            places.append((x, y))
    columns: dict[float, list[float]] = {}
    for x, y in places:
        columns.setdefault(x, []).append(y)
    gaps = [b - a for ys in columns.values() for a, b in zip(sorted(ys), sorted(ys)[1:], strict=False)]
    assert min(gaps) > 14


def test_tooltips_name_the_places_and_any_name_is_escaped() -> None:
    span = Span("a<b>.rplan", 3, 4, 3, 9)
    cells = (Cell(Op.INPUT, (), 0), Cell(Op.REGISTER, (), 0), Cell(Op.AND, (0, 1)))
    circuit = Circuit(
        "<&>", (Port('"<x>\n', (span,)),), (Register("r&d", False, 2),), cells, ((Port("y" * 180, (span,)), 2),)
    )
    drawing = drawn(circuit)
    assert texts(drawing) == ["<&>", '"<x>?', "r&d", "y" * 159 + "…", "next r&d"]
    titles = [title.text or "" for title in drawing.iter(f"{SVG}title")]
    assert f"{'y' * 180} at a<b>.rplan:3:4" in titles


def test_a_circuit_without_gates_or_outputs_is_drawn_too() -> None:
    assert texts(drawn(Circuit("empty", (), (), (), ()))) == ["empty"]


def large(gates: int) -> Circuit:
    generator = np.random.default_rng(0)
    cells = [Cell(Op.INPUT, (), n) for n in range(100)]
    for _ in range(gates):
        near = int(generator.integers(max(0, len(cells) - 150), len(cells)))
        cells.append(Cell(Op.AND, (near, int(generator.integers(len(cells))))))
    ports = tuple((Port(f"output-{n}"), len(cells) - 1 - n) for n in range(40))
    return Circuit("large", tuple(Port(f"i{n}") for n in range(100)), (), tuple(cells), ports)


def test_the_largest_drawing_is_less_than_a_megabyte_and_a_larger_one_is_refused() -> None:
    assert len(svg(large(MOST_GATES)).encode()) < 1_000_000
    with pytest.raises(ValueError, match=r"a circuit of 1,001 gates is too large to be drawn \(at most 1,000\)"):
        svg(large(MOST_GATES + 1))


def test_a_drawing_is_the_same_every_time() -> None:
    assert svg(fetch()) == svg(fetch())


def test_dot_has_a_line_for_each_cell_and_each_wire() -> None:
    circuit = fetch()
    text = dot(circuit)
    assert len(re.findall(r"^  n\d+ \[", text, re.MULTILINE)) == len(circuit.cells)
    wires = sum(len(cell.operands) for cell in circuit.cells) + len(circuit.outputs)
    assert text.count(" -> ") == wires
