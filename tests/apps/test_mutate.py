"""`rplan mutate`: slips in a plan that its tests do not notice are shown, each with a situation that would show it."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from time import process_time

import pytest
from click.testing import CliRunner, Result

import rplan.apps.pytest_plugin.mutants
from rplan.apps.cli import cli
from rplan.apps.doing import mutate
from rplan.lang.parse import parse_text
from rplan.lang.printer import print_plan
from rplan.lang.source import Source
from rplan.ways.mutate import KINDS, mutants

ROOT = Path(__file__).parents[2]
HEAD = """\
(declare (near) bool "")
(declare (lost) bool "")
(declare (distance) (number m) "")
(declare (flee) command "")
(declare (rest) command "")
(defoutput action command)
"""
RULE = "(defgoalr (maint distance) (if (near) (do action (flee)) (do action (rest))))\n(goalem (maint distance))\n"
FLEES = "(deftest flees (tick :given ((near true)) :expect ((action (flee)))))\n"
RESTS = "(deftest rests (tick :expect ((action (rest)))))\n"


def run(folder: Path, text: str, *arguments: str) -> Result:
    path = folder / "guard.rplan"
    path.write_text(HEAD + text, encoding="utf-8")
    result = CliRunner().invoke(cli, ["mutate", str(path), *arguments], catch_exceptions=False)
    assert "Traceback" not in result.output
    return result


def values(folder: Path, text: str, *arguments: str) -> dict:
    result = run(folder, text, "--json", *arguments)
    assert result.exit_code == 0, result.output
    return json.loads(result.stdout)


def changes(text: str) -> list[str]:
    plan, _ = parse_text(Source("p.rplan", text))
    return [mutant.change for mutant in mutants(plan)]


# --- the slips --------------------------------------------------------------------------------------


def goal(text: str) -> list[str]:
    return changes(f"(goalem {text})")


def test_branches_are_swapped_and_dropped() -> None:
    assert goal("(if (a) (do x (b)) (do anything))") == [
        "the branches after (a) are swapped",
        "what is done where (a) is dropped: (do x (b))",
    ]
    assert "what is done where not (a) is dropped: (ach c)" in goal("(if (a) (do x (b)) (ach c))")


def test_parts_of_conditions_are_negated_and_connectives_exchanged() -> None:
    found = goal("(when (and (a) (not (b)) (or (c) true)) (ach x))")[2:]
    assert found == [
        "`and` became `or` in (and (a) (not (b)) (or (c) true))",
        "(a) became (not (a))",
        "(not (b)) became (b)",
        "(or (c) true) became (not (or (c) true))",
        "`or` became `and` in (or (c) true)",
        "(c) became (not (c))",
    ]


def test_numbers_and_comparisons_are_shifted() -> None:
    assert goal("(when (> (+ (d) 1m) 0) (ach x))")[2:] == [
        "(> (+ (d) 1m) 0) became (>= (+ (d) 1m) 0)",
        "1m became 1.1m",
        "1m became 0.9m",
        "0 became 1",
        "0 became -1",
    ]
    assert goal("(when (= (d) 1m) (ach x))")[2:] == ["1m became 1.1m", "1m became 0.9m"]


def test_memory_is_shifted() -> None:
    assert goal("(when (held-for 2s (a)) (ach x))")[2:] == [
        "(held-for 2s (a)) became (held-for 4s (a))",
        "(held-for 2s (a)) became (held-for 1s (a))",
        "(a) became (not (a))",
    ]
    assert "(at-least 1 (a)) became (at-least 2 (a))" in goal("(when (at-least 1 (a)) (ach x))")
    assert "(delay false (a)) became (delay true (a))" in goal("(when (delay false (a)) (ach x))")


def test_members_are_dropped_and_their_order_exchanged() -> None:
    assert goal("(prio-and (ach a) (ach b))") == [
        "the member (ach a) is dropped",
        "the member (ach b) is dropped",
        "(ach b) comes before (ach a)",
    ]
    assert goal("(and (ach a) (ach b))")[0] == "`and` of goals became `or`"
    assert "(ach b) comes before (ach a)" in goal("(or (ach a) (ach b))")


def test_a_value_is_exchanged_with_the_next_of_its_output() -> None:
    text = (
        "(goalem (and (do x (a)) (if (p) (do x (b)) (do y true))))(defgoalr (ach r ?v) (and (do x (f ?v)) (do y ?v)))"
    )
    found = [one for one in changes(text) if "is set to" in one]
    assert found == [
        "`x` is set to (a) instead of (f ?v)",
        "`y` is set to true instead of ?v",
        "`x` is set to (b) instead of (a)",
        "`x` is set to (a) instead of (b)",
        "`y` is set to false instead of true",
    ]


def test_conditions_operators_and_achieved_conditions_have_slips_too() -> None:
    text = """(defcond (c) (not (a)))
    (defop (go ?x) :do (x (drive ?x)) :pre (at ?x) :add ((there ?x)))
    (goalem (ach (and (there home) (c))))"""
    plan, _ = parse_text(Source("p.rplan", text))
    assert [(one.where, one.change) for one in mutants(plan)] == [
        ("(c)", "(not (a)) became (a)"),
        ("(defop go)", "(at ?x) became (not (at ?x))"),
        ("(goalem)", "(and (there (home)) (c)) became (not (and (there (home)) (c)))"),
        ("(goalem)", "`and` became `or` in (and (there (home)) (c))"),
        ("(goalem)", "(there (home)) became (not (there (home)))"),
        ("(goalem)", "(c) became (not (c))"),
    ]


def test_every_slip_is_another_plan_and_only_one_file_is_changed() -> None:
    text = (ROOT / "plans" / "find_and_fetch" / "find_and_fetch.rplan").read_text(encoding="utf-8")
    plan, _ = parse_text(Source("p.rplan", text))
    every = list(mutants(plan, "p.rplan"))
    assert len({print_plan(one.plan) for one in every}) == len(every) > 50
    assert {one.kind for one in every} <= set(KINDS)
    assert not list(mutants(plan, "other.rplan"))


# --- which are noticed ------------------------------------------------------------------------------


def test_tests_that_say_everything_notice_everything(tmp_path: Path) -> None:
    found = values(tmp_path, RULE + FLEES + RESTS)
    assert (found["share"], found["counts"]["survived"]) == (1.0, 0)
    assert {one["by"] for one in found["mutants"] if one["verdict"] == "killed"} == {"test flees", "test rests"}
    assert run(tmp_path, RULE + FLEES + RESTS).stdout.splitlines()[1:] == ["  5 of 5 noticed (100 %): 5 by deftest"]


def test_what_survives_is_shown_with_its_place_and_a_situation(tmp_path: Path) -> None:
    result = run(tmp_path, RULE + FLEES)
    assert result.exit_code == 0
    assert result.stdout.splitlines()[1:] == [
        "  3 of 5 noticed (60 %): 3 by deftest",
        "  2 survived",
        f"{tmp_path}/guard.rplan:7:58: (maint distance): what is done where not (near) is dropped: (do action (rest))",
        "  given nothing: action is (rest), with the slip open",
        f"{tmp_path}/guard.rplan:7:58: (maint distance): `action` is set to (flee) instead of (rest)",
        "  given nothing: action is (rest), with the slip (flee)",
    ]


def test_every_test_begins_on_a_plan_that_remembers_nothing(tmp_path: Path) -> None:
    text = "(goalem (if (once (near)) (do action (flee)) (do action (rest))))\n" + FLEES + RESTS
    (tmp_path / "guard.ticks").write_text('{}\n{"outputs": {"action": "(rest)"}}\n', encoding="utf-8")
    assert values(tmp_path, text)["share"] == 1.0


def test_golden_ticks_beside_the_plan_count(tmp_path: Path) -> None:
    (tmp_path / "any.ticks").write_text('; guard.rplan\n[]\n{"outputs": {"action": "(rest)"}}\n', encoding="utf-8")
    (tmp_path / "other.ticks").write_text("; other.rplan\n[3\n", encoding="utf-8")
    found = values(tmp_path, RULE + FLEES)
    assert found["share"] == 1.0
    assert "any.ticks" in {one["by"] for one in found["mutants"]}
    assert "5 of 5 noticed (100 %): 3 by deftest, 2 by golden ticks" in run(tmp_path, RULE + FLEES).stdout


def test_properties_count(tmp_path: Path) -> None:
    text = RULE + "(defproperty p :always (= action (rest)) :provided (not (near)))"
    found = values(tmp_path, text + FLEES)
    assert (found["share"], found["mutants"][2]["by"]) == (1.0, "property p")


def test_a_slip_that_makes_a_hole_is_noticed_by_the_check(tmp_path: Path) -> None:
    text = "(goalem (or (do action (flee)) (and (when (near) (do action (flee))) (do action (rest)))))"
    found = values(tmp_path, text)
    assert "check" in {one["by"] for one in found["mutants"]}


def test_slips_that_make_no_difference_are_left_out(tmp_path: Path) -> None:
    inner = "(if (and (< (distance) 2m) (near)) (do action (rest)) (do action (rest)))"
    text = f"(goalem (if (> (distance) 1m) (do action (flee)) {inner}))"
    found = values(tmp_path, text)
    equal = [one["change"] for one in found["mutants"] if one["verdict"] == "equal"]
    assert "(near) became (not (near))" in equal
    assert found["counts"]["equal"] == len(equal)


def test_assumptions_hold_for_slips_too(tmp_path: Path) -> None:
    text = "(assume (not (and (near) (lost))))(goalem (if (and (near) (lost)) (do action (flee)) (do action (rest))))"
    verdicts = {one["change"]: one["verdict"] for one in values(tmp_path, text)["mutants"]}
    assert verdicts["what is done where (and (near) (lost)) is dropped: (do action (flee))"] == "equal"
    assert verdicts["(near) became (not (near))"] == "survived"


def test_what_shows_only_in_time_is_told_apart(tmp_path: Path) -> None:
    text = "(goalem (if (held-for 0.4s (near)) (do action (flee)) (do action (rest))))"
    survivors = {one["change"]: one["shown"] for one in values(tmp_path, text)["mutants"]}
    assert survivors["(held-for 0.4s (near)) became (held-for 0.8s (near))"].startswith("after ")


def test_what_is_not_decided_survives(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mutate, "equal", lambda first, second: None)
    text = "(assume (near))" + RULE
    assert values(tmp_path, text)["counts"]["undecided"] > 0
    assert "survived and may make no difference" in run(tmp_path, text).stdout


def test_a_share_that_is_too_small_exits_with_1(tmp_path: Path) -> None:
    assert run(tmp_path, RULE + FLEES, "--at-least", "60").exit_code == 0
    assert run(tmp_path, RULE + FLEES, "--at-least", "61").exit_code == 1


def test_of_many_changes_some_are_tried_spread_over_the_plan(tmp_path: Path) -> None:
    found = values(tmp_path, RULE + FLEES, "--most", "2")
    assert (found["possible"], [one["kind"] for one in found["mutants"]]) == (5, ["swap", "drop"])
    assert run(tmp_path, RULE + FLEES, "--most", "2").stdout.startswith("guard: 2 of 5 changes (")


def test_a_plan_in_which_nothing_can_be_changed_is_all_noticed(tmp_path: Path) -> None:
    assert values(tmp_path, "(goalem (do action (rest)))")["share"] == 1.0


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("(deftest wrong (tick :expect ((action (flee)))))", "test wrong fails on the plan as it stands"),
        ("(defproperty wrong :always (near))", "property wrong fails on the plan as it stands"),
    ],
)
def test_tests_that_fail_on_the_plan_itself_are_an_error(text: str, says: str, tmp_path: Path) -> None:
    result = run(tmp_path, RULE + text)
    assert result.exit_code == 2
    assert says in result.stderr


@pytest.mark.parametrize("line", ["{near", '{"near": 3}\n{"outputs": {}}'])
def test_golden_ticks_that_cannot_be_used_are_an_error(line: str, tmp_path: Path) -> None:
    (tmp_path / "guard.ticks").write_text(line + "\n", encoding="utf-8")
    result = run(tmp_path, RULE)
    assert result.exit_code == 2
    assert "guard.ticks:1: " in result.stderr


def test_a_slip_takes_milliseconds(tmp_path: Path) -> None:
    begin = process_time()
    result = CliRunner().invoke(cli, ["mutate", str(ROOT / "plans" / "find_and_fetch"), "--json"])
    found = json.loads(result.stdout)
    assert found["share"] > 0.9
    assert (process_time() - begin) / len(found["mutants"]) < 0.1


# --- with tests of pytest ---------------------------------------------------------------------------


@pytest.fixture
def tests(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A file of tests; no plugin that is installed takes part."""
    monkeypatch.setenv("PYTEST_DISABLE_PLUGIN_AUTOLOAD", "1")
    monkeypatch.setattr(rplan.apps.pytest_plugin.mutants, "entry_points", lambda group: [])
    monkeypatch.setattr(sys, "path", [*sys.path])
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    (tmp_path / "pytest.ini").write_text("[pytest]\naddopts = --import-mode=importlib\n", encoding="utf-8")
    return tmp_path / f"{tmp_path.name}.py"  # pytest keeps modules by their names


TEST = "def test_{name}(plan):\n    plan('guard.rplan').given({given}).expect(action='{action}')\n"


def test_python_tests_that_use_the_plan_notice_slips(tmp_path: Path, tests: Path) -> None:
    tests.write_text("def test_else(): pass\n" + TEST.format(name="rests", given="", action="rest"), encoding="utf-8")
    found = values(tmp_path, RULE + FLEES, "--tests", str(tests))
    assert found["share"] == 1.0
    assert sum(one["by"].endswith("::test_rests") for one in found["mutants"]) == 2
    assert "2 by pytest" in run(tmp_path, RULE + FLEES, "--tests", str(tests)).stdout


def test_python_tests_that_notice_nothing_leave_what_survives(tmp_path: Path, tests: Path) -> None:
    tests.write_text(TEST.format(name="flees", given="'near'", action="flee"), encoding="utf-8")
    assert values(tmp_path, RULE + FLEES, "--tests", str(tests))["counts"]["survived"] == 2


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (TEST.format(name="wrong", given="", action="flee"), "test_wrong fails on the plan as it stands"),
        ("def test_else(): pass\n", "no test opens guard.rplan by the fixture `plan`"),
        ("def test_else(:\n", "pytest cannot run the tests (exit code 2)"),
    ],
)
def test_python_tests_that_cannot_help_are_an_error(text: str, says: str, tmp_path: Path, tests: Path) -> None:
    tests.write_text(text, encoding="utf-8")
    result = run(tmp_path, RULE + FLEES, "--tests", str(tests))
    assert result.exit_code == 2
    assert says in result.stderr


def test_without_pytest_it_says_what_to_install(tmp_path: Path, tests: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    tests.write_text("", encoding="utf-8")
    monkeypatch.setitem(sys.modules, "rplan.apps.pytest_plugin.mutants", None)
    result = run(tmp_path, RULE + FLEES, "--tests", str(tests))
    assert (result.exit_code, result.stderr.splitlines()[-1]) == (2, "error: --tests needs pytest: pip install pytest")
