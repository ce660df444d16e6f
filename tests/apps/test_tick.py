"""`rplan tick`: JSON lines in, JSON lines out, and what is said of lines that are wrong (L22)."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from rplan.apps.cli import cli

PLAN = """(use robot)
(declare (lost) bool "")
(declare (gap) (number m) "")
(declare (sees (what symbol)) bool "")
(declare (spare) bool "")
(defoutput goal pose)
(defoutput action command :idle (stop))
(goalem (when (or (lost) (sees car) (< (gap) 2m)) (do action (stop))))
"""
GOOD = {"lost": False, "gap": 3, "(sees car)": False}


@pytest.fixture
def plan(tmp_path: Path) -> str:
    path = tmp_path / "plan.rplan"
    path.write_text(PLAN, encoding="utf-8")
    return str(path)


def tick(plan: str, *lines: str | bytes | dict[str, object], options: tuple[str, ...] = ()) -> Result:
    raw = [json.dumps(line) if isinstance(line, dict) else line for line in lines]
    stdin = b"".join((line if isinstance(line, bytes) else line.encode()) + b"\n" for line in raw)
    result = CliRunner().invoke(cli, ["tick", plan, *options], input=stdin, catch_exceptions=False)
    assert "Traceback" not in result.output
    return result


@pytest.mark.rule("L22")
def test_every_line_becomes_a_line_with_the_fields_of_the_language(plan: str) -> None:
    result = tick(plan, GOOD, "", GOOD | {"lost": True}, GOOD | {"gap": 1.5})
    assert result.exit_code == 0
    lines = [json.loads(line) for line in result.stdout.splitlines()]
    assert [[*line] for line in lines] == [["tick", "hole", "outputs", "sent", "way"]] * 3
    assert [line["tick"] for line in lines] == [0, 1, 2]
    assert [line["outputs"] for line in lines] == [
        {"goal": None, "action": None},
        {"goal": None, "action": "(stop)"},
        {"goal": None, "action": "(stop)"},
    ]
    assert [line["sent"] for line in lines] == [{"goal": None, "action": "(stop)"}] * 3
    assert result.stdout.startswith(
        '{"tick": 0, "hole": false, "outputs": {"goal": null, "action": null}, "sent": {"goal": null, '
    )


@pytest.mark.rule("L22")
@pytest.mark.parametrize(
    "line",
    [
        {"(lost)": False, "(gap)": 3, "(sees car)": False},
        GOOD | {"spare": True, "speed": 0.1, "time-since-start": 3},
        "\ufeff" + json.dumps(GOOD),
        json.dumps(GOOD) + "\r",
    ],
)
def test_canonical_keys_percepts_that_are_only_declared_and_odd_line_ends_are_accepted(
    plan: str, line: str | dict[str, object]
) -> None:
    assert tick(plan, line).exit_code == 0


@pytest.mark.rule("L22")
@pytest.mark.parametrize(
    ("line", "said"),
    [
        (GOOD | {"weather": True}, "`weather` is a percept that the plan neither declares nor reads"),
        (GOOD | {"spear": True}, "`spear` is a percept"),
        (GOOD | {"spar": True}, "`spar` is a percept"),
        (GOOD | {"speeed": 1}, "(did you mean `speed`?)"),
        (GOOD | {"stop": True}, "`stop` is a percept that the plan neither declares nor reads"),
        (GOOD | {"sees": True}, "`sees` is a percept that the plan neither declares nor reads"),
        ({"lost": False, "gap": 3}, "`(sees car)`: the plan reads it, and there is no value"),
        ({"lost": False, "(sees car)": True}, "`gap`: the plan reads it, and there is no value"),
        (GOOD | {"lost": 1}, "`lost`: true or false is wanted, not 1"),
        (GOOD | {"lost": None}, "`lost`: true or false is wanted, not null"),
        (GOOD | {"gap": "2m"}, '`gap`: a finite number is wanted, not "2m"'),
        (GOOD | {"gap": True}, "`gap`: a finite number is wanted, not true"),
        (GOOD | {"gap": float("nan")}, "`gap`: a finite number is wanted, not NaN"),
        (GOOD | {"gap": float("inf")}, "`gap`: a finite number is wanted, not Infinity"),
        (GOOD | {"gap": 10**400}, "`gap`: a finite number is wanted, not 1000"),
        (GOOD | {"spare": "no"}, '`spare`: true or false is wanted, not "no"'),
        (GOOD | {"speed": float("nan")}, "`speed`: a finite number is wanted, not NaN"),
        (GOOD | {"(lost)": True}, "`lost` is there twice, also as `(lost)`"),
        ('{"lost": true, "lost": true}', "`lost` is there twice"),
        ('{"lost": tru', "not JSON: Expecting value at column 10"),
        ('{"lost": true', "not JSON: "),
        ("lost", "not JSON: Expecting value at column 1"),
        ("[1, 2]", "an object percept → value is wanted, not [1, 2]"),
        ("null", "an object percept → value is wanted, not null"),
        ("[" * 100_000, "nested too deep"),
        ('{"gap": ' + "1" * 5_000 + "}", "a number has too many digits"),
        (b'{"lost": "\xff"}', "not text in UTF-8"),
    ],
)
def test_a_wrong_line_ends_it_with_line_and_key_after_the_lines_before_it(
    plan: str, line: str | bytes | dict[str, object], said: str
) -> None:
    result = tick(plan, GOOD, "", line, GOOD)
    assert result.exit_code == 2
    assert len(result.stdout.splitlines()) == 1
    last = result.stderr.splitlines()[-1]
    assert last.startswith("error: line 3: ")
    assert said in last


@pytest.mark.rule("L22")
def test_an_empty_input_gives_nothing(plan: str) -> None:
    result = tick(plan)
    assert (result.exit_code, result.stdout) == (0, "")


def test_lines_may_come_from_a_file(plan: str, tmp_path: Path) -> None:
    lines = tmp_path / "lines"
    lines.write_text(json.dumps(GOOD), encoding="utf-8")
    assert len(tick(plan, options=("--input", str(lines))).stdout.splitlines()) == 1
    assert tick(plan, options=("--input", str(tmp_path / "nowhere"))).exit_code == 2


@pytest.mark.rule("L18")
def test_a_tick_in_a_hole_says_so_and_sends_idle_values(tmp_path: Path) -> None:
    path = tmp_path / "hole.rplan"
    path.write_text(
        "(defoutput a symbol :idle rest) (defoutput b symbol :hold :initial low)"
        "(goalem (and (when (lost) (and (do a one) (do b high))) (when (found) (do a two))))"
    )
    result = tick(
        str(path), *({"lost": x, "found": y} for x, y in ((True, False), (True, True))), options=("--allow-holes",)
    )
    hole = json.loads(result.stdout.splitlines()[1])
    assert hole["hole"] is True
    assert hole["outputs"] == {"a": None, "b": None}
    assert hole["sent"] == {"a": "rest", "b": "high"}
    assert hole["way"] == {"rules": [], "branches": [], "acts": [], "given_up": []}


def test_a_plan_that_reads_its_own_failures_takes_them_as_percepts(tmp_path: Path) -> None:
    path = tmp_path / "plan.rplan"
    path.write_text(
        "(use robot) (defoutput action command)(goalem (when (not (competence-failed stop)) (do action (stop))))"
    )
    result = tick(str(path), {"(competence-failed stop)": True}, {"(competence-failed stop)": False})
    assert [json.loads(line)["outputs"]["action"] for line in result.stdout.splitlines()] == [None, "(stop)"]
