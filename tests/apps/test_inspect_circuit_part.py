"""Parts of a circuit: the gates nearest to what is asked for, with whatever they read, and no wire that ends in air."""

from __future__ import annotations

import json
import re
from pathlib import Path
from xml.etree import ElementTree

import pytest
from click.testing import CliRunner

from rplan.apps.cli import cli
from rplan.apps.drawing.inspect import inspect
from rplan.apps.drawing.inspect_circuit_part import MOST_SHOWN, Part, choice, compact, part
from rplan.apps.drawing.inspect_page import page
from rplan.apps.drawing.inspect_words import register_words
from rplan.apps.drawing.svg import MOST_GATES, svg
from rplan.apps.viewer import telling
from rplan.circuit.cell import Op
from rplan.circuit.circuit import Circuit
from rplan.circuit.evaluate import evaluate
from rplan.driver import Compiled, compile_plan
from rplan.lang.source import Source
from rplan.ways.why import Reasons


def many(rules: int) -> str:
    """A plan of so many rules that ask each other's conditions, some of them about the past."""
    heads = [f"(ach r{k})" for k in range(rules)]
    asks = [f"(and (p{k % 60}) (or (q{k % 17}) (held-for 0.4s (p{k * 7 % 60}))))" for k in range(rules)]
    bodies = [
        f"(defgoalr {h} (if {a} (do go (a{k % 20})) (do anything)))"
        for k, (h, a) in enumerate(zip(heads, asks, strict=True))
    ]
    opening = "(plan many :period 0.1s)\n(defoutput go command :idle (stop))\n"
    return opening + "\n".join(bodies) + f"\n(goalem (prio-and {' '.join(heads)}))\n"


LARGE = compile_plan(Source("many.rplan", many(200)), allow_holes=True)
SMALL = """(plan small :period 0.1s)
(defoutput light bool)
(defoutput horn bool)
(goalem (and (if (or (near) (far)) (do light true) (do light false))
             (if (and (not (near)) (held-for 0.2s (far))) (do horn true) (do horn false))))
"""


def small() -> Circuit:
    return compile_plan(Source("small.rplan", SMALL)).circuit


def gates(circuit: Circuit) -> int:
    return sum(1 for cell in circuit.cells if cell.operands)


def distances(circuit: Circuit, begin: int) -> dict[int, int]:
    """How many gates lie between each gate that makes a net and this net."""
    found, level = {begin: 0}, [begin]
    while level:
        beyond = dict.fromkeys(one for net in level for one in circuit.cells[net].operands if one not in found)
        level = [net for net in beyond if circuit.cells[net].operands]
        found |= dict.fromkeys(level, 1 + max(found.values()))
    return found


def shown(found: Part) -> set[int]:
    return {net for net, cell in zip(found.numbers, found.circuit.cells, strict=True) if cell.operands}


def test_the_plan_of_these_tests_is_too_large_to_be_drawn_whole() -> None:
    assert gates(LARGE.circuit) > MOST_GATES


def test_no_gate_that_is_left_out_is_nearer_than_one_that_is_shown() -> None:
    wanted = choice(LARGE.circuit, "go=(a7)")
    far, found = distances(LARGE.circuit, wanted.nets[0]), part(LARGE.circuit, wanted, 60)
    assert found.shown == len(shown(found)) == 60
    assert max(far[net] for net in shown(found)) <= min(far[net] for net in far if net not in shown(found))


def test_what_is_shown_is_wired_as_in_the_whole_and_ends_in_the_gates_that_are_not() -> None:
    whole, found = LARGE.circuit, part(LARGE.circuit, choice(LARGE.circuit, "go=(a7)"), 60)
    ends = []
    for net, cell in zip(found.numbers, found.circuit.cells, strict=True):
        if cell.operands:
            assert cell.op is whole.cells[net].op
            assert tuple(found.numbers[one] for one in cell.operands) == whole.cells[net].operands
        elif whole.cells[net].operands:
            ends.append(found.circuit.inputs[cell.index].name)
            assert ends[-1] == f"… gate {net}"
    assert len(ends) > 5


def test_a_part_that_has_all_of_an_output_computes_it() -> None:
    whole = small()
    found = part(whole, choice(whole, "horn=true"))
    ((port, _),) = found.circuit.outputs
    assert port.name == "horn=true"
    names = [one.name for one in found.circuit.inputs]
    assert sorted(names) == ["(far)", "(held-for 0.2s (far)), bit 0", "(near)"]
    for near in (False, True):
        for far in (False, True):
            given = {"(near)": near, "(far)": far}
            inputs = [given[one.name] for one in whole.inputs]
            outputs, _ = evaluate(whole, (True,), inputs)
            ours, _ = evaluate(found.circuit, (), [given.get(name, True) for name in names])
            assert ours[0] == dict(zip([p.name for p, _ in whole.outputs], outputs, strict=True))["horn=true"]


def test_a_percept_shows_what_reads_it_and_where_that_leads() -> None:
    whole = small()
    found = part(whole, choice(whole, "near"))
    reading = {net for net, cell in enumerate(whole.cells) if net in shown(found) for _ in cell.operands}
    assert reading and {port.name for port, _ in found.circuit.outputs} == {
        "light=true", "light=false", "horn=true", "horn=false"
    }  # fmt: skip
    cut = part(LARGE.circuit, choice(LARGE.circuit, "(p3)"), 2)
    assert cut.shown == 2 and any("more read" in port.name for port, _ in cut.circuit.outputs)


@pytest.mark.parametrize(
    ("of", "says", "forwards"),
    [("light", "light", False), ("light=true", "light=true", False), ("(near)", "(near)", True), ("far", "(far)", True),
     ("(held-for 0.2s (far))#0", "(held-for 0.2s (far))#0", True),
     ("(held-for 0.2s (far)), bit 0", "(held-for 0.2s (far)), bit 0", True), ("", "light=true", False)],
)  # fmt: skip
def test_outputs_percepts_and_registers_are_found_by_name(of: str, says: str, forwards: bool) -> None:
    found = choice(small(), of)
    assert (found.says, found.forwards) == (says, forwards)


def test_a_gate_is_found_by_its_number_and_shows_what_makes_it_and_who_reads_it() -> None:
    whole = small()
    gate = max(net for net, cell in enumerate(whole.cells) if cell.operands)
    for of in (f"gate {gate}", str(gate), f"net {gate}"):
        found = choice(whole, of)
        assert (found.nets, found.forwards) == ((gate,), False)
        assert part(whole, found).circuit.outputs
    with pytest.raises(ValueError, match="nothing in the circuit is called gate 9999"):
        choice(whole, "gate 9999")


def test_a_circuit_without_gates_has_a_part_too() -> None:
    bare = compile_plan(Source("p.rplan", "(plan p)\n(defoutput a bool)\n(goalem (do a true))\n")).circuit
    assert svg(part(bare, choice(bare)).circuit).count("<svg") == 1


def test_a_bit_of_a_counter_is_called_so_and_a_latch_by_its_name() -> None:
    assert register_words("(held-for 0.2s (near))#1") == "(held-for 0.2s (near)), bit 1"
    assert register_words("(latch (near) (far))") == "(latch (near) (far))"
    assert register_words("odd#name") == "odd#name"


# --- drawings and pages ----------------------------------------------------------------------------


def rplan(*arguments: str) -> str:
    result = CliRunner().invoke(cli, ["inspect", *arguments], catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return result.output


def test_a_large_circuit_is_drawn_in_part_and_says_so(tmp_path: Path) -> None:
    plan, drawing = tmp_path / "many.rplan", tmp_path / "part.svg"
    plan.write_text(many(200), encoding="utf-8")
    rplan(str(plan), "--circuit", "--svg", str(drawing))
    first = drawing.read_text(encoding="utf-8")
    texts = [one.text or "" for one in ElementTree.fromstring(first).iter("{http://www.w3.org/2000/svg}text")]
    assert texts[0] == f"many: {MOST_SHOWN} of {gates(LARGE.circuit):,} gates: what makes go=(a0)"
    assert sum(1 for text in texts if text.startswith("… gate ")) > 3
    rplan(str(plan), "--circuit", "--svg", str(drawing), "--of", "p3")
    assert "what reads (p3)" in drawing.read_text(encoding="utf-8")
    rplan(str(plan), "--circuit", "--svg", str(drawing))
    assert drawing.read_text(encoding="utf-8") == first


def test_the_tooltips_of_a_part_have_the_numbers_of_the_whole() -> None:
    found = part(LARGE.circuit, choice(LARGE.circuit, "go=(a7)"), 60)
    told = re.findall(r"<title>(and|or|not), net (\d+)</title>", svg(found.circuit, found.numbers))
    assert len(told) == 60
    assert all(LARGE.circuit.cells[int(net)].op.value == op for op, net in told)


def rebuilt(values: dict[str, object]) -> list[tuple[str, tuple[int, ...]]]:
    ops, a, b = values["ops"], values["a"], values["b"]
    assert isinstance(ops, str) and isinstance(a, list) and isinstance(b, list)
    return [(op, (x,) if y < 0 else (x, y)) for op, x, y in zip(ops, a, b, strict=True)]


def test_in_few_letters_the_circuit_is_the_same() -> None:
    values = compact(LARGE.circuit)
    kinds = {"c": Op.CONSTANT, "i": Op.INPUT, "r": Op.REGISTER, "n": Op.NOT, "a": Op.AND, "o": Op.OR}
    for cell, (letter, numbers) in zip(LARGE.circuit.cells, rebuilt(values), strict=True):
        assert cell.op is kinds[letter] and numbers == (cell.operands or (cell.index,))
    assert values["outputs"] == [[port.name, net, port.places[0].line] for port, net in LARGE.circuit.outputs]
    assert len(json.dumps(values)) < 15 * len(LARGE.circuit.cells) + 20_000


def embedded(compiled: Compiled) -> object:
    found = re.search(r'<script type="application/json" id="made">(.*?)</script>', page(inspect(compiled)), re.DOTALL)
    assert found
    return json.loads(found[1])


def test_the_page_of_a_large_plan_has_its_circuit_and_what_draws_parts_of_it() -> None:
    text = page(inspect(LARGE))
    assert embedded(LARGE) == json.loads(json.dumps(compact(LARGE.circuit)))
    assert "window.circuitPart = " in text and "too large" not in text


def test_the_page_of_a_small_plan_has_its_circuit_whole_and_nothing_else() -> None:
    text = page(inspect(compile_plan(Source("small.rplan", SMALL))))
    assert 'data-net="' in text and "window.circuitPart = " not in text and 'id="made"' not in text


def test_a_run_of_a_large_plan_is_told_the_circuit_to_draw_parts_of() -> None:
    told = telling.circuit(LARGE)
    assert (told["svg"], told["cells"], told["part"]) == ("", [], compact(LARGE.circuit))
    assert "part" not in telling.circuit(compile_plan(Source("small.rplan", SMALL)))


def test_a_page_is_told_the_conditions_that_why_gives() -> None:
    plan = compile_plan(Source("small.rplan", SMALL))
    loser, reasons = telling.Loser(plan), Reasons(plan.ways)
    for inputs, kept in (("00", "0"), ("01", "1"), ("10", "1"), ("11", "0")):
        bits = [bit == "1" for bit in inputs]
        wanted = reasons.why(bits, [kept == "1"]).literals
        assert loser.enough(inputs, kept) == [{"condition": one.text, "value": one.value} for one in wanted]
