"""`rplan test`: tests that stand in a plan are run on it alone; a failure says place, tick, expected and got."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from rplan.apps.cli import cli

PLAN = """\
(declare (near) bool "")
(declare (distance) (number m) "")
(declare (flee) command "")
(declare (rest) command "")
(defoutput action command :idle (rest))
(defgoalr (maint distance) (when (held-for 0.2s (near)) (do action (flee))))
(goalem (and (maint distance) (when (> (distance) 3m) (do action (rest)))))
"""
BEGINS = PLAN.count("\n") + 1


@pytest.fixture
def plan(tmp_path: Path) -> Path:
    return tmp_path / "guard.rplan"


def run(path: Path, tests: str, *arguments: str) -> Result:
    """`rplan test` on the plan with these tests."""
    path.write_text(PLAN + tests, encoding="utf-8")
    return CliRunner().invoke(cli, ["test", str(path), *arguments], catch_exceptions=False)


@pytest.mark.rule("L24")
def test_tests_that_pass_are_counted(plan: Path) -> None:
    result = run(
        plan,
        """(deftest flees (tick :given ((near true)) :expect ((action open))) (tick :times 3 :expect ((action (flee)))))
           (deftest stays (tick :expect ((action open))))""",
    )
    assert (result.exit_code, result.stdout) == (0, "passed  flees  (4 ticks)\npassed  stays  (1 tick)\n2 passed\n")


@pytest.mark.rule("L24")
def test_a_failing_test_shows_place_tick_rule_and_both_values(plan: Path) -> None:
    result = run(
        plan,
        "(deftest flees\n  (tick)\n  (tick :times 5 :given ((near true)) :expect ((action open))))\n"
        "(deftest idle (tick))",
    )
    assert result.exit_code == 1
    assert result.stdout.splitlines() == [
        "failed  flees  (3 ticks)",
        f"  --> {plan}:{BEGINS + 2}:3, in tick 2",
        "  `action`: expected open, got (flee)",
        "  by (maint distance)",
        "passed  idle  (1 tick)",
        "1 of 2 failed",
    ]


def test_a_test_begins_on_a_plan_that_remembers_nothing(plan: Path) -> None:
    one = "(tick :given ((near true)) :expect ((action open)))"
    result = run(plan, f"(deftest first {one}) (deftest second {one})")
    assert result.exit_code == 0


def test_what_is_not_given_keeps_its_value_and_begins_false_or_zero(plan: Path) -> None:
    result = run(
        plan,
        """(deftest keeps
             (tick :expect ((action open)))
             (tick :given ((distance 4m)) :expect ((action (rest))))
             (tick :times 2 :expect ((action (rest)))))""",
    )
    assert result.exit_code == 0


@pytest.mark.parametrize(
    ("step", "says"),
    [
        ("(tick :times 2 :given ((near true) (distance 4m)))", "  expected no hole, got hole"),
        ("(tick :hole true)", "  expected hole, got no hole"),
    ],
)
def test_a_hole_fails_where_it_is_not_expected_and_its_absence_where_it_is(step: str, says: str, plan: Path) -> None:
    result = run(plan, f"(deftest it {step})")
    assert result.exit_code == 1
    assert says in result.stdout.splitlines()


def test_an_expected_hole_passes(plan: Path) -> None:
    both = "((near true) (distance 4m))"
    result = run(plan, f"(deftest it (tick :given {both}) (tick :hole true :expect ((action open))))")
    assert result.exit_code == 0


@pytest.mark.rule("L24")
def test_json_has_every_test_and_what_differs(plan: Path) -> None:
    result = run(plan, "(deftest a (tick))\n(deftest b (tick :expect ((action (flee)))))", "--json")
    assert result.exit_code == 1
    assert json.loads(result.stdout) == {
        "ok": False,
        "tests": [
            {"name": "a", "passed": True, "ticks": 1},
            {
                "name": "b",
                "passed": False,
                "ticks": 1,
                "failure": {
                    "place": {
                        "file": str(plan),
                        "line": BEGINS + 1,
                        "column": 12,
                        "end_line": BEGINS + 1,
                        "end_column": 44,
                    },
                    "tick": 0,
                    "differs": {"action": {"expected": "(flee)", "got": "open"}},
                    "rules": ["(maint distance)"],
                },
            },
        ],
    }
    assert json.loads(run(plan, "(deftest a (tick))", "--json").stdout)["ok"] is True


def test_a_plan_without_a_test_says_so(plan: Path) -> None:
    result = run(plan, "")
    assert (result.exit_code, result.stdout) == (0, "the plan has no test\n")


@pytest.mark.rule("L24")
@pytest.mark.parametrize(
    ("tests", "code"),
    [
        ("(deftest a (tick :expect ((motion (flee)))))", "no-output"),
        ("(deftest a (tick :given ((flee true))))", "type-mismatch"),
        ("(deftest a (tick)", "missing-parenthesis"),
    ],
)
def test_a_wrong_plan_runs_no_test(tests: str, code: str, plan: Path) -> None:
    result = run(plan, tests)
    assert (result.exit_code, result.stdout) == (1, "")
    assert f"error[{code}]" in result.stderr


@pytest.mark.rule("L24")
def test_a_missing_plan_ends_with_2() -> None:
    result = CliRunner().invoke(cli, ["test", "nowhere.rplan"])
    assert result.exit_code == 2
    assert "there is no file or folder nowhere.rplan" in result.stderr
