"""`rplan prove`: what holds in every tick is proven, what does not comes with a trace that replays (L8, L24, L26)."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner

from rplan.apps.cli import cli
from rplan.apps.wiring import compile_file, decider

FIGURE = Path(__file__).parents[2] / "plans" / "figure_1" / "text.rplan"
EXCLUSIVE = """
(defproperty never-both :always (not (and (= action (move-away-from-danger)) (= action (move-according-to-NaT-plan)))))
(defproperty runaway-iff-too-close
  :always (or (and (anything-is-too-close) (= action (move-away-from-danger)))
              (and (not (anything-is-too-close)) (not (= action (move-away-from-danger))))))
(defproperty no-way-to-nowhere :provided (and (anything-is-too-close) (not (anything-is-too-close))) :always false)
"""


def proven(plan: Path, *arguments: str) -> tuple[int, dict[str, str], list[list[dict[str, object]]]]:
    result = CliRunner().invoke(cli, ["prove", str(plan), "--json", *arguments])
    found = json.loads(result.stdout)["properties"]
    return result.exit_code, {one["name"]: one["verdict"] for one in found}, [one["trace"] for one in found]


def test_running_away_and_driving_by_template_exclude_each_other(tmp_path: Path) -> None:
    plan = tmp_path / "p.rplan"
    plan.write_text(FIGURE.read_text() + EXCLUSIVE)
    code, verdicts, _ = proven(plan)
    assert code == 0
    assert set(verdicts.values()) == {"proven"}
    assert [*verdicts][-1] == "(maint runaway)"
    said = CliRunner().invoke(cli, ["prove", str(plan), "no-way-to-nowhere"]).stdout
    assert "proven, but emptily" in said


def test_a_mutilated_plan_is_refuted_by_a_trace_that_replays(tmp_path: Path) -> None:
    plan = tmp_path / "p.rplan"
    text = FIGURE.read_text().replace(
        "(if (anything-is-too-close)\n      (do action", "(if (held-for 0.2s (anything-is-too-close))\n      (do action"
    )
    plan.write_text(text + EXCLUSIVE)
    trace = tmp_path / "trace.jsonl"
    code, verdicts, traces = proven(plan, "--trace", str(trace))
    assert code == 1
    assert verdicts["never-both"] == "proven"
    assert verdicts["runaway-iff-too-close"] == "refuted"
    assert [len(one) for one in traces] == [0, 1, 0, 0]
    ticks = CliRunner().invoke(cli, ["tick", str(plan), "--input", str(trace)])
    assert [json.loads(line)["outputs"]["action"] for line in ticks.stdout.splitlines()] == [None]


@pytest.mark.rule("L9")
@pytest.mark.parametrize(
    ("always", "verdict"),
    [
        ("(or (not (= x (a))) (once (p)))", "proven"),
        ("(or (not (= x (a))) (p))", "refuted"),
        ("(or (open x) (within 0.3s (p)))", "proven"),
        ("(or (open x) (within 0.2s (p)))", "refuted"),
    ],
)
def test_properties_speak_of_the_past(always: str, verdict: str, tmp_path: Path) -> None:
    plan = tmp_path / "p.rplan"
    plan.write_text(f"(defproperty it :always {always}) (goalem (when (within 0.3s (p)) (do x a)))")
    code, verdicts, _ = proven(plan)
    assert (code, verdicts) == (int(verdict == "refuted"), {"it": verdict})


def test_an_unknown_property_is_a_wrong_use(tmp_path: Path) -> None:
    result = CliRunner().invoke(cli, ["prove", str(FIGURE), "nothing"])
    assert result.exit_code == 2
    assert "there is no property nothing (there are: (maint runaway))" in result.stderr


def test_a_plan_that_promises_nothing_says_so(tmp_path: Path) -> None:
    plan = tmp_path / "p.rplan"
    plan.write_text("(goalem (do x a))")
    assert "promises nothing" in CliRunner().invoke(cli, ["prove", str(plan)]).stdout


def test_what_a_property_alone_asks_is_not_needed_to_drive(tmp_path: Path) -> None:
    plan = tmp_path / "aside.rplan"
    plan.write_text(
        "(declare (near) bool) (declare (lost) bool) (declare (go) command)\n"
        "(defproperty aside :always (or (near) (once (lost)) (= action (go))))\n"
        "(defoutput action command)\n(goalem (when (near) (do action (go))))\n"
    )
    compiled = compile_file(plan)
    assert [port.name for port in compiled.circuit.inputs] == ["(near)"]
    assert compiled.circuit.registers == ()
    assert decider(compiled).tick({"(near)": True}).outputs["action"] is not None
