"""`rplan inspect`: the table agrees with the circuit, the goal tree with the plan, and pages need no network."""

from __future__ import annotations

import json
import re
from html.parser import HTMLParser
from itertools import product
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest
from click.testing import CliRunner, Result

from rplan.apps.cli import cli
from rplan.apps.drawing.inspect import Table, inspect
from rplan.apps.drawing.inspect_page import page
from rplan.apps.drawing.inspect_svg import draw
from rplan.apps.drawing.inspect_text import WIDTH, text
from rplan.apps.drawing.inspect_words import register_words
from rplan.apps.wiring import compile_file
from rplan.circuit.evaluate import evaluate
from rplan.driver import Compiled, compile_plan
from rplan.lang.source import Source

PLANS = Path(__file__).parents[2] / "plans"
FIND = str(PLANS / "find_and_fetch")
SMALL = """(plan small "Two <rules> & more" :period 0.1s)
(defoutput action command :idle (stop))
(defoutput light bool)
(defgoalr (maint safe) (if (near) (do action (flee)) (do anything)))
(defgoalr (ach go) (if (held-for 0.2s (far)) (and (do action (drive)) (do light true)) (do action (wait))))
(goalem (prio-and (maint safe) (ach go)))
"""


def compiled(source: str) -> Compiled:
    return compile_plan(Source("small.rplan", source), allow_holes=True)


def many(rules: int) -> str:
    """A plan of so many rules whose tests are tangled."""
    heads = [f"(ach r{k})" for k in range(rules)]
    bodies = [
        f"(defgoalr {h} (if (and (p{k}) (q{k % 17})) (do action (a{k})) (do anything)))" for k, h in enumerate(heads)
    ]
    opening = "(plan many)\n(defoutput action command :idle (stop))\n"
    return opening + "\n".join(bodies) + f"\n(goalem (prio-and {' '.join(heads)}))\n"


def rplan_inspect(*arguments: str) -> Result:
    result = CliRunner().invoke(cli, ["inspect", *arguments], catch_exceptions=False)
    assert "Traceback" not in result.output
    return result


def holding(table: Table, situation: dict[str, bool]) -> list[int]:
    return [n for n, row in enumerate(table.rows) if all(situation[name] is value for name, value in row.when)]


# --- the decision table ----------------------------------------------------------------------------


TANGLED = """(plan tangled)
(defoutput a bool)
(defoutput b bool)
(goalem (and (if (x) (do a false) (if (y) (do a true) (do a false)))
             (if (z) (do b true) (if (y) (do b false) (do anything)))))
"""


SIMPLE = "(plan p)\n(defoutput a bool)\n(goalem (if (x) (do a false) (if (y) (do a true) (do a false))))\n"


@pytest.mark.parametrize(
    "source", [SMALL, TANGLED, SIMPLE, (PLANS / "make_room" / "make_room.rplan").read_text(encoding="utf-8")]
)
def test_in_every_situation_one_row_holds_and_sets_what_the_circuit_sets(source: str) -> None:
    from rplan.apps.wiring import signatures

    plan = compile_plan(Source("small.rplan", source), signatures(), allow_holes=True)
    table, circuit = inspect(plan).table, plan.circuit
    names = [
        *(port.name for port in circuit.inputs),
        *(f"register {register_words(one.name)}" for one in circuit.registers),
    ]
    for bits in product((False, True), repeat=len(names)):
        inputs, registers = bits[: len(circuit.inputs)], bits[len(circuit.inputs) :]
        (row,) = holding(table, dict(zip(names, bits, strict=True)))
        outputs, _ = evaluate(circuit, registers, inputs)
        on = {port.name for (port, _), bit in zip(circuit.outputs, outputs, strict=True) if bit}
        assert set(table.rows[row].sets) == on - {"hole"}
        assert table.rows[row].hole == ("hole" in on)


def test_rows_that_set_the_same_and_differ_in_one_condition_alone_are_one_row() -> None:
    whens = "(if (y) (do a (p)) (do a (q)))", "(if (y) (do a (p)) (do a (r)))"
    source = f"(plan p)\n(defoutput a command :idle (q))\n(goalem (if (x) {' '.join(whens)}))\n"
    rows = inspect(compiled(source)).table.rows
    assert sorted((sorted(row.when), row.sets) for row in rows) == [
        ([("(x)", False), ("(y)", False)], ("a=(r)",)),
        ([("(x)", True), ("(y)", False)], ("a=(q)",)),
        ([("(y)", True)], ("a=(p)",)),
    ]


def test_rows_say_who_sets_and_what_is_given_up() -> None:
    row = inspect(compiled(SMALL)).table.rows[0]
    assert (row.when[0], row.sets, row.rules) == (("(near)", True), ("action=(flee)",), ("(maint safe)",))
    assert row.given_up == ("(ach go)",)


def test_a_hole_has_a_row() -> None:
    source = "(plan p)\n(defoutput a bool)\n(goalem (if (x) (and (do a true) (do a false)) (do a true)))\n"
    table = inspect(compiled(source)).table
    assert [(dict(row.when), row.hole) for row in table.rows if row.hole] == [({"(x)": True}, True)]
    assert "HOLE" in text(inspect(compiled(source)), ["table"])


def test_a_plan_of_many_rules_has_a_row_for_each_act_in_their_order() -> None:
    table = inspect(compiled(many(200))).table
    assert not table.exclusive
    assert [row.sets for row in table.rows] == [(f"action=(a{k})",) for k in range(200)]
    assert table.rows[150].when == (("(and (p150) (q14))", True),)
    said = text(inspect(compiled(many(30))), ["table"])
    assert "several rows may hold" in said and "by (ach r29)" in said


def test_a_goal_with_alternatives_and_memory_inside_other_conditions_is_laid_open() -> None:
    asks = "(and (not (held-for 0.2s (far))) (or (near) (held-for 0.3s (near))))"
    source = (
        f"(plan p :period 0.1s)\n(defoutput a bool)\n(goalem (or (if {asks} (do a true) (do a false)) (do a true)))\n"
    )
    found = inspect(compiled(source))
    assert (found.goals.kind, found.goals.says, len(found.goals.inside)) == ("or", "one of", 2)
    assert found.percepts[0].memory == ("(held-for 0.2s (far))", "(held-for 0.3s (near))")


# --- text, drawings, page --------------------------------------------------------------------------


def test_the_goal_tree_says_ranks_rules_conditions_and_acts_with_their_lines() -> None:
    assert text(inspect(compiled(SMALL)), ["goals"]).splitlines() == [
        "by priority",
        "├─ 1: (maint safe)  :6",
        "│  └─ if (near)",
        "│     ├─ then: do action := (flee)  :4",
        "│     └─ else: anything",
        "└─ 2: (ach go)  :6",
        "   └─ if (held-for 0.2s (far))",
        "      ├─ then: all of",
        "      │  ├─ do action := (drive)  :5",
        "      │  └─ do light := true  :5",
        "      └─ else: do action := (wait)  :5",
    ]


def test_the_circuit_says_what_every_tick_costs() -> None:
    said = text(inspect(compiled(SMALL)), ["circuit"])
    assert re.search(r"^registers +1$", said, re.MULTILINE)
    assert re.search(r"^every tick +\d+ operations, the same whatever happens, every 0.1 s$", said, re.MULTILINE)


def test_what_stands_in_an_included_text_is_said_with_its_file(tmp_path: Path) -> None:
    (tmp_path / "rules.rplan").write_text("; a rule\n(defgoalr (ach one)\n  (when (a) (do x on)))", encoding="utf-8")
    plan = tmp_path / "plan.rplan"
    plan.write_text('(include "rules.rplan")\n(goalem (ach one))', encoding="utf-8")
    said = rplan_inspect(str(plan)).stdout
    assert "(ach one)  :2\n" in said
    assert "then: do x := (on)  rules.rplan:3\n" in said
    assert "(ach one)  rules.rplan:2\n    (a)\n" in said
    one = json.loads(rplan_inspect(str(plan), "--percepts", "--json").stdout)["percepts"][0]
    assert one["line"] is None and one["place"].endswith("rules.rplan:2:1")
    shown = page(inspect(compile_file(plan)))
    assert "(ach one) <i>rules.rplan:2</i>" in shown and "</span> <i>rules.rplan:3</i>" in shown


def test_a_plan_that_asks_nothing_says_so() -> None:
    said = text(inspect(compiled("(goalem (do x on))")), ["table", "circuit", "percepts"])
    assert said.startswith("Decision table\n\n  always  x=(on)\n          by (goalem)\n\nCircuit\n")
    assert "depth       0 gates one" in said
    assert said.endswith("Percepts\n\nno percept is asked")
    one = text(inspect(compiled("(goalem (when (not (a)) (do x on)))")), ["circuit", "percepts"])
    assert "depth       1 gate one after another" in one and "every tick  1 operation, the same" in one
    assert one.endswith("1 percept, by the number of rules that ask them:\n     1  (a)")


def test_each_rule_says_which_percepts_it_reads() -> None:
    reads = {one.rule: (one.percepts, one.memory) for one in inspect(compiled(SMALL)).percepts}
    assert reads == {"(maint safe)": (("(near)",), ()), "(ach go)": (("(far)",), ("(held-for 0.2s (far))",))}


@pytest.mark.parametrize("part", ["table", "goals", "circuit", "percepts"])
def test_every_part_is_drawn_as_svg_that_parses(part: str) -> None:
    root = ElementTree.fromstring(draw(inspect(compiled(SMALL)), part))
    assert root.tag.endswith("svg") and len(root) > 3


def test_what_is_too_large_to_be_drawn_is_refused() -> None:
    deep = " ".join(f"(do a{k} true)" for k in range(5001))
    outputs = "\n".join(f"(defoutput a{k} bool)" for k in range(5001))
    with pytest.raises(ValueError, match="too many to be drawn"):
        draw(inspect(compiled(f"(plan p)\n{outputs}\n(goalem (and {deep}))\n")), "goals")


class Tags(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.seen: list[tuple[str, dict[str, str | None]]] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.seen.append((tag, dict(attrs)))


def test_the_page_stands_alone_and_no_text_of_the_plan_breaks_out_of_it() -> None:
    hostile = SMALL + "; </script><img src=x onerror=alert(1)> {{table}}\n"
    made = page(inspect(compiled(hostile)))
    tags = Tags()
    tags.feed(made)
    assert not [tag for tag, _ in tags.seen if tag in ("link", "img", "iframe", "object", "embed", "base")]
    assert not [given for _, given in tags.seen if "src" in given]
    assert not re.search(r"https?://(?!www.w3.org/2000/svg)|\bfetch\(|XMLHttpRequest", made)
    assert "Two &lt;rules&gt; &amp; more" in made and "&lt;img src=x onerror=alert(1)&gt; {{table}}" in made


def test_the_page_links_places_to_lines_and_folds_the_rules_of_a_large_plan() -> None:
    small, large = page(inspect(compiled(SMALL))), page(inspect(compiled(many(60))))
    assert 'href="#line-4"' in small and 'id="line-4"' in small
    assert '<details><summary class="place"><span class="rule">' in large
    assert '<details><summary class="place"><span class="rule">' not in small


# --- the command -----------------------------------------------------------------------------------


def test_the_command_shows_all_parts_or_the_one_asked_for() -> None:
    whole, one = rplan_inspect(FIND), rplan_inspect(FIND, "--percepts")
    assert [whole.exit_code, one.exit_code] == [0, 0]
    assert all(f"{title}\n" in whole.stdout for title in ("Decision table", "Goals", "Circuit", "Percepts"))
    assert "Goals" not in one.stdout and "12 percepts" in one.stdout


def test_json_has_the_parts_asked_for() -> None:
    value: dict[str, Any] = json.loads(rplan_inspect(FIND, "--table", "--circuit", "--json").stdout)
    assert sorted(value) == ["circuit", "plan", "table"]
    assert (value["circuit"]["gates"], value["circuit"]["operations"], value["table"]["exclusive"]) == (38, 38, True)
    assert len(value["table"]["conditions"]) == 12


def test_svg_and_page_are_written_to_files(tmp_path: Path) -> None:
    svg, html = tmp_path / "a.svg", tmp_path / "a.html"
    result = rplan_inspect(FIND, "--circuit", "--svg", str(svg), "--html", str(html))
    assert (result.exit_code, result.stdout) == (0, "")
    assert svg.read_text(encoding="utf-8").startswith("<svg")
    assert html.read_text(encoding="utf-8").startswith("<!doctype html>")


def test_what_cannot_be_written_or_drawn_is_said(tmp_path: Path) -> None:
    two = rplan_inspect(FIND, "--table", "--goals", "--svg", str(tmp_path / "a.svg"))
    assert (two.exit_code, two.stderr) == (
        2,
        "error: --svg draws one part: give one of --table, --goals, --circuit, --percepts\n",
    )
    nowhere = rplan_inspect(FIND, "--html", str(tmp_path / "no" / "a.html"))
    assert nowhere.exit_code == 2 and "No such file" in nowhere.stderr
    drawing = str(tmp_path / "a.svg")
    unknown = rplan_inspect(FIND, "--circuit", "--svg", drawing, "--of", "actoin")
    assert unknown.exit_code == 2
    assert "nothing in the circuit is called actoin" in unknown.stderr and "near it: action" in unknown.stderr
    for more in (["--circuit"], ["--table", "--svg", drawing], ["--svg", drawing]):
        alone = rplan_inspect(FIND, "--of", "action", *more)
        assert (alone.exit_code, alone.stderr) == (2, "error: --of goes with --circuit --svg\n")
    assert not Path(drawing).exists()


# --- what is large ---------------------------------------------------------------------------------


def loud(outputs: int) -> str:
    """A plan that sets so many outputs at once."""
    names = [f"light-{k}" for k in range(outputs)]
    declared = "\n".join(f"(defoutput {name} bool)" for name in names)
    rules = "\n".join(f"(defgoalr (ach {name}) (do {name} true))" for name in names)
    return f"(plan p)\n{declared}\n{rules}\n(goalem (and {' '.join(f'(ach {name})' for name in names)}))\n"


def test_a_row_that_sets_much_takes_lines_of_bounded_width_with_everything_in_them() -> None:
    said = text(inspect(compiled(loud(60))), ["table"])
    assert max(map(len, said.splitlines())) <= WIDTH
    assert all(f"light-{k}=true" in said and f"(ach light-{k})" in said for k in range(60))


def test_of_what_a_row_sets_the_page_folds_all_but_the_first() -> None:
    assert "<summary>54 more</summary>" in page(inspect(compiled(loud(60))))
    assert "more</summary>" not in page(inspect(compiled(loud(8))))


@pytest.mark.parametrize("part", ["table", "percepts"])
def test_a_drawing_of_more_conditions_than_columns_lists_them(part: str) -> None:
    drawn = draw(inspect(compiled(many(200))), part)
    width = int(ElementTree.fromstring(drawn).attrib["width"])
    assert "rotate" not in drawn and "(ach r199)" in drawn and width < 900
