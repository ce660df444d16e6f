"""The pytest plugin: rules, tests, properties and golden ticks of plans are items, where a project asks for them."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from time import process_time

import pytest
from click.testing import CliRunner

import rplan.apps.pytest_plugin.coverage
import rplan.apps.pytest_plugin.items
import rplan.apps.testing  # noqa: F401
from rplan.apps import pytest_plugin
from rplan.apps.cli import cli
from rplan.apps.wiring import compile_file

pytest_plugins = ["pytester"]

ROOT = Path(__file__).parents[2]
HEAD = """\
(plan guard "Keeps its distance." :period 0.1s)
(declare (near) bool "")
(declare (lost) bool "")
(declare (distance) (number m) "")
(declare (flee) command "")
(declare (rest) command "")
(declare (go) command "")
(defoutput action command :idle (rest))
(defgoalr (maint distance)
  (when (held-for 0.2s (near)) (do action (flee))))
(defgoalr (ach move)
  (cond ((and (> (distance) 3m) (not (lost))) (do action (go)))
        ((> (distance) 4m) (do action (rest)))
        (else (do anything))))
(goalem (prio-and (maint distance) (ach move)))
"""
TESTS = """\
(deftest flees
  (tick :given ((near true)) :expect ((action open)))
  (tick :times 3 :expect ((action (flee)))))
(defproperty safe :always (= action (flee)) :provided (held-for 0.2s (near)))
"""


@pytest.fixture
def run(pytester: pytest.Pytester, monkeypatch: pytest.MonkeyPatch):
    """Runs pytest with the plugin and with no other that is installed."""
    monkeypatch.setenv("PYTEST_DISABLE_PLUGIN_AUTOLOAD", "1")

    def with_plugin(*arguments: str) -> pytest.RunResult:
        result = pytester.runpytest_inprocess(*arguments, plugins=[pytest_plugin])
        assert "INTERNALERROR" not in result.stdout.str()
        return result

    return with_plugin


def write(pytester: pytest.Pytester, text: str, name: str = "guard.rplan") -> Path:
    path = pytester.path / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")
    return path


# --- which files ------------------------------------------------------------------------------------


def test_each_rule_test_and_property_is_an_item(pytester: pytest.Pytester, run) -> None:
    write(pytester, HEAD + TESTS)
    result = run("--rplan", "--collect-only", "-q")
    assert result.stdout.lines[:4] == [
        "guard.rplan::(maint distance)/branches",
        "guard.rplan::(ach move)/branches",
        "guard.rplan::test flees",
        "guard.rplan::property safe",
    ]
    run("--rplan").assert_outcomes(passed=4)


def test_one_item_is_run_by_its_name(pytester: pytest.Pytester, run) -> None:
    write(pytester, HEAD + TESTS)
    run("--rplan", "guard.rplan::test flees").assert_outcomes(passed=1)


def test_nothing_is_collected_unasked(pytester: pytest.Pytester, run) -> None:
    write(pytester, "(this is no plan")
    write(pytester, "; guard.rplan\n[]\n", "guard.ticks")
    write(pytester, "def test_it(): pass", "test_it.py")
    result = run("-v")
    result.assert_outcomes(passed=1)
    result.stdout.no_fnmatch_line("*rplan*")


def test_the_setting_names_the_plans_by_patterns(pytester: pytest.Pytester, run) -> None:
    pytester.makeini("[pytest]\nrplan_files = robots/*.rplan\n")
    write(pytester, HEAD + TESTS, "robots/guard.rplan")
    write(pytester, HEAD, "other/guard.rplan")
    write(pytester, "[]\n", "other/guard.ticks")
    result = run("--collect-only", "-q")
    assert [line.partition("::")[0] for line in result.stdout.lines[:4]] == ["robots/guard.rplan"] * 4
    result.stdout.no_fnmatch_line("*other*")


def test_libraries_in_files_are_a_setting(pytester: pytest.Pytester, run) -> None:
    pytester.makeini("[pytest]\nrplan_files = *.rplan\nrplan_libraries = arm.py\n")
    library = (
        "from behaviours.interface import Library, Offer\n"
        "ARM = Library('arm', 'An arm.', (), (), lambda values, workshop: Offer())\n"
    )
    write(pytester, library, "arm.py")
    write(pytester, "(use arm)" + HEAD)
    result = run()
    assert "unknown-library" not in result.stdout.str()
    assert "errors" not in result.parseoutcomes()


@pytest.mark.parametrize(
    ("library", "says"), [(None, "there is no file *arm.py"), ("import nothing_there\n", "*arm.py cannot be loaded: *")]
)
def test_a_library_that_cannot_be_loaded_is_one_clear_error(
    library: str | None, says: str, pytester: pytest.Pytester, run
) -> None:
    pytester.makeini("[pytest]\nrplan_files = *.rplan\nrplan_libraries = arm.py\n")
    if library is not None:
        write(pytester, library, "arm.py")
    write(pytester, HEAD)
    write(pytester, "[]\n", "guard.ticks")
    pytester.makepyfile("def test_it(plan):\n    plan('guard.rplan')\n")
    result = run("--continue-on-collection-errors")
    result.assert_outcomes(errors=1, failed=2)
    result.stdout.fnmatch_lines([says] * 3)
    assert "libraries.py" not in result.stdout.str()
    assert "another exception" not in result.stdout.str()


def test_a_plan_that_does_not_compile_is_one_clear_error(pytester: pytest.Pytester, run) -> None:
    write(pytester, HEAD.replace("(maint distance) (ach", "(maint distence) (ach"))
    result = run("--rplan")
    result.assert_outcomes(errors=1)
    result.stdout.fnmatch_lines(["error?no-rule?: *(maint distence)*", "*--> *guard.rplan:15:*"])
    assert "Traceback" not in result.stdout.str()
    assert "items.py" not in result.stdout.str()


# --- rules ------------------------------------------------------------------------------------------

DEAD = HEAD.replace("((> (distance) 4m) (do action (rest)))", "((> (distance) 4m) (if (lost) (do action (rest)) (go)))")
DEAD = DEAD.replace("(if (lost) (do action (rest)) (go))", "(if (lost) (do action (rest)) (do action (flee)))")


def test_a_branch_that_can_never_be_taken_fails_with_the_situations_of_the_others(
    pytester: pytest.Pytester, run
) -> None:
    write(pytester, DEAD)
    result = run("--rplan")
    result.assert_outcomes(passed=1, failed=1)
    result.stdout.fnmatch_lines(
        [
            "*guard.rplan:11:1: not every branch of (ach move) can be taken",
            "    12: (and (> (distance) 3m) (not (lost))) -> (do action (go)): taken when *(distance) = 3.5m*".replace(
                "->", "→"
            ),
            "  - 13: (not (lost)) → (do action (flee)): can never be taken",
            "warning?always-true?: `(lost)` is always true where it is asked",
        ]
    )


@pytest.mark.parametrize("automatic", ["", "1"])
def test_one_dead_branch_fails_exactly_the_item_of_its_rule_and_says_why(
    pytester: pytest.Pytester, run, monkeypatch: pytest.MonkeyPatch, automatic: str
) -> None:
    monkeypatch.setenv("CI", automatic)  # where it is set, pytest cuts nothing in its summary
    monkeypatch.delenv("BUILD_NUMBER", raising=False)
    write(pytester, DEAD + TESTS)
    result = run("--rplan", "-rfE")
    result.assert_outcomes(passed=3, failed=1)
    failed = [line for line in result.stdout.lines if line.startswith(("FAILED", "ERROR"))]
    assert [line.partition(" - ")[0] for line in failed] == ["FAILED guard.rplan::(ach move)/branches"]
    result.stdout.fnmatch_lines(
        [
            "*guard.rplan:11:1: not every branch of (ach move) can be taken",
            "  - 13: (not (lost)) → (do action (flee)): can never be taken",
            "warning?always-true?: `(lost)` is always true where it is asked",
            "  --> *guard.rplan:12:9 *after what is asked here",
            "  --> *guard.rplan:13:58 *so this is never done",
        ]
    )
    assert sum(line.endswith("can never be taken") for line in result.stdout.lines) == 1
    assert result.stdout.lines[-2] in failed, "the summary has one line for it"
    assert " - not every branch of (ach move)" in failed[0]


def test_one_line_a_failure_is_its_place_and_what_it_says_first(pytester: pytest.Pytester, run) -> None:
    path = write(pytester, DEAD + TESTS)
    lines = run("--rplan", "--tb=line").stdout.lines
    begin = next(number for number, line in enumerate(lines) if " FAILURES " in line)
    assert lines[begin + 1] == f"{path}:11: not every branch of (ach move) can be taken"
    assert lines[begin + 2].startswith("====")


def test_a_file_of_rules_for_other_plans_has_no_items_of_its_own(pytester: pytest.Pytester, run) -> None:
    write(pytester, "(use robot) (defoutput action command) (defgoalr (maint rest) (do action (stop)))")
    assert run("--rplan", "--collect-only").ret == pytest.ExitCode.NO_TESTS_COLLECTED
    write(pytester, "(plan p) (use robot) (defoutput action command) (defgoalr (maint rest) (do action (stop)))")
    run("--rplan", "--collect-only").stdout.fnmatch_lines(["*error?no-goal?*"])


def test_a_rule_that_nothing_asks_for_fails(pytester: pytest.Pytester, run) -> None:
    write(pytester, HEAD + "(defgoalr (ach nap) (do action (rest)))")
    result = run("--rplan")
    result.assert_outcomes(passed=2, failed=1)
    result.stdout.fnmatch_lines(["*nothing asks for (ach nap), so that none of it is ever done"])


def test_a_member_and_an_alternative_that_are_never_taken_fail(pytester: pytest.Pytester, run) -> None:
    text = HEAD.replace("(goalem (prio-and (maint distance) (ach move)))", "")
    text += "(defgoalr (ach choose) (or (do action (go)) (do action (rest))))\n"
    text += "(defgoalr (ach both) (prio-and (ach choose) (do action (flee))))\n(goalem (ach both))"
    write(pytester, text)
    result = run("--rplan")
    result.stdout.fnmatch_lines(
        [
            "  - 16: alternative 2 → (do action (rest)): can never be taken",
            "  - 17: member 2 → (do action (flee)): *never*",
        ]
    )


def generated(rules: int) -> str:
    """A plan of so many rules, each with two branches that can be taken."""
    lines = ['(plan big :period 0.1s) (declare (stop) command "") (defoutput action command :idle (stop))']
    lines += [f'(declare (p{n}) bool "") (declare (d{n}) (number m) "")' for n in range(rules // 10)]
    lines += [f'(declare (go{n}) command "")' for n in range(rules)]
    for n in range(rules):
        rest = f"(ach r{n + 1})" if (n + 1) % 10 else "(do anything)"
        asks = f"(and (p{n % (rules // 10)}) (> (d{n // 10}) {1 + n % 10}m))"
        lines.append(f"(defgoalr (ach r{n}) (if {asks} (do action (go{n})) {rest}))")
    tops = " ".join(f"(ach r{n})" for n in range(0, rules, 10))
    return "\n".join([*lines, f"(goalem (prio-and {tops}))"])


def test_five_hundred_rules_take_less_than_five_seconds(pytester: pytest.Pytester, run) -> None:
    path = write(pytester, generated(500))
    begin = process_time()
    compile_file(path)
    compiled = process_time()
    run("--rplan", "-q").assert_outcomes(passed=500)
    took = process_time() - compiled
    assert took < 5.0 or took < 16 * (compiled - begin)  # where every line is traced, all is slower


# --- tests and properties ---------------------------------------------------------------------------


def test_a_failing_test_shows_what_was_given_and_the_way(pytester: pytest.Pytester, run) -> None:
    write(pytester, HEAD + "(deftest goes (tick :given ((distance 3.5m)) :expect ((action open))))")
    result = run("--rplan")
    result.assert_outcomes(passed=2, failed=1)
    result.stdout.fnmatch_lines(
        [
            "*guard.rplan:16:15: guard: not as expected in tick 0 (at 0 s)",
            "  `action`: expected open, got (go)",
            "  given: (distance) = 3.5m",
            "  by: (maint distance), (ach move)",
            "    10: (held-for 0.2s (near)) is false",
            "    12: (and (> (distance) 3m) (not (lost))) is true",
            "    12: (ach move) sets action to (go)",
        ]
    )


def test_a_refuted_property_fails_with_the_trace_that_breaks_it(pytester: pytest.Pytester, run) -> None:
    write(pytester, HEAD + "(defproperty still :always (not (= action (go))))")
    result = run("--rplan")
    result.assert_outcomes(passed=2, failed=1)
    result.stdout.fnmatch_lines(
        [
            "*guard.rplan:16:1: still is refuted",
            "  broken when not (near) and (distance) = 3.5m and not (lost)",
            "    12: (ach move) sets action to (go)",
        ]
    )


def test_what_cannot_be_decided_fails_too(pytester: pytest.Pytester, run, monkeypatch: pytest.MonkeyPatch) -> None:
    from rplan.apps.pytest_plugin import items
    from rplan.ways.prove import Proof
    from rplan.ways.situations import Undecided

    monkeypatch.setattr(items, "prove", lambda reach, promise: Proof(promise, "unknown"))
    monkeypatch.setattr(items, "taken", lambda reach, arm: Undecided())
    write(pytester, HEAD + TESTS)
    result = run("--rplan")
    result.assert_outcomes(passed=1, failed=3)
    result.stdout.fnmatch_lines(["  ? 10: *: could not be decided", "  the budget did not suffice; *"])


# --- golden ticks -----------------------------------------------------------------------------------

TICKS = '; guard.rplan\n; the robot is alone\n{"near": true, "distance": 5}\n{}\n["lost"]\n'


def test_golden_ticks_are_blessed_and_compared(pytester: pytest.Pytester, run) -> None:
    write(pytester, HEAD)
    path = write(pytester, TICKS, "alone.ticks")
    run("--rplan", "alone.ticks").assert_outcomes(failed=1)
    run("--rplan", "--rplan-bless", "alone.ticks").assert_outcomes(passed=1)
    lines = path.read_text(encoding="utf-8").splitlines()
    assert lines[:3] == TICKS.splitlines()[:3]
    assert [json.loads(line)["outputs"]["action"] for line in lines[3::2]] == ["(go)", "(flee)", None]
    run("--rplan", "alone.ticks").assert_outcomes(passed=1)


def test_golden_ticks_are_what_rplan_tick_prints(pytester: pytest.Pytester, run) -> None:
    plan = write(pytester, HEAD)
    values = {"near": True, "lost": False, "distance": 5}
    printed = CliRunner().invoke(cli, ["tick", str(plan)], input=json.dumps(values) + "\n").output
    write(pytester, json.dumps(values) + "\n" + printed, "guard.ticks")
    run("--rplan", "guard.ticks").assert_outcomes(passed=1)


def test_an_edited_plan_shows_what_differs_and_moved_lines_are_no_difference(pytester: pytest.Pytester, run) -> None:
    write(pytester, HEAD)
    write(pytester, TICKS, "guard.ticks")
    run("--rplan", "--rplan-bless", "guard.ticks").assert_outcomes(passed=1)
    write(pytester, "\n\n; moved\n" + HEAD)
    run("--rplan", "guard.ticks").assert_outcomes(passed=1)
    write(pytester, HEAD.replace("(do action (flee))", "(do action (rest))"))
    result = run("--rplan", "guard.ticks")
    result.stdout.fnmatch_lines(
        [
            "1 of 3 ticks differ (- golden, + now; --rplan-bless writes them anew)",
            "guard.ticks:5: tick 1",
            "    - outputs: action = (flee)",
            "    + outputs: action = (rest)",
            "    - way: (maint distance) sets action to (flee)",
        ]
    )


def test_json_lines_name_their_plan_as_json(pytester: pytest.Pytester, run) -> None:
    write(pytester, HEAD, "robots/guard.rplan")
    first = '{"plan": "robots/guard.rplan"}\n'
    path = write(
        pytester, first + '{"near": true}\n{"tick": 0, "hole": false, "outputs": {"action": null}}\n', "a.ticks.jsonl"
    )
    run("--rplan", "a.ticks.jsonl").assert_outcomes(passed=1)
    path.write_text(first + '{"near": true}\n{"outputs": {"action": "(go)"}}\n', encoding="utf-8")
    run("--rplan", "a.ticks.jsonl").assert_outcomes(failed=1)
    assert all(json.loads(line) for line in path.read_text(encoding="utf-8").splitlines())


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("{near\n", "guard.ticks:1: not JSON: *"),
        ('{"neer": true}\n', "guard.ticks:1: `neer` is a percept that the plan neither declares nor reads"),
        ('{"distence": 1}\n', "guard.ticks:1: *did you mean `distance`?"),
        ("3\n", "guard.ticks:1: an object percept → value or a list is wanted, not 3"),
        ('{"outputs": {}}\n', "guard.ticks:1: a line of outputs without a line of percepts before it"),
        ('{"near": 3}\n', "guard.ticks:1: (near): true or false is wanted, not 3"),
    ],
)
def test_wrong_golden_ticks_say_file_and_line(text: str, says: str, pytester: pytest.Pytester, run) -> None:
    write(pytester, HEAD)
    write(pytester, text, "guard.ticks")
    result = run("--rplan", "guard.ticks")
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines([f"*{says}"])


def test_golden_ticks_that_are_no_text_are_told(pytester: pytest.Pytester, run) -> None:
    write(pytester, HEAD)
    write(pytester, "", "guard.ticks").write_bytes(b"[]\n\xff\n")
    result = run("--rplan", "guard.ticks")
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(["*guard.ticks: this is not a text: * at byte 3, where UTF-8 is wanted"])
    assert "codecs" not in result.stdout.str()


def test_golden_ticks_that_cannot_be_written_are_told(
    pytester: pytest.Pytester, run, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refused(path: Path, text: str, encoding: str) -> int:
        raise PermissionError(13, "Permission denied", str(path))

    write(pytester, HEAD)
    write(pytester, "[]\n", "guard.ticks")
    monkeypatch.setattr(Path, "write_text", refused)
    result = run("--rplan", "--rplan-bless", "-p", "no:cacheprovider", "guard.ticks")
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(["*Permission denied: *guard.ticks'"])
    assert "items.py" not in result.stdout.str()


def test_ticks_of_no_plan_are_left_alone(pytester: pytest.Pytester, run) -> None:
    write(pytester, "12 31 44\n", "clock.ticks")
    write(pytester, '{"plan"\n', "broken.ticks.jsonl")
    assert run("--rplan").ret == pytest.ExitCode.NO_TESTS_COLLECTED


# --- what it costs those who have no plans ----------------------------------------------------------


def test_the_plugin_imports_nothing_of_rplan_until_it_is_asked(tmp_path: Path) -> None:
    (tmp_path / "test_it.py").write_text(
        "import sys\ndef test_it():\n"
        "    heavy = {'z3', 'numpy', 'pymunk', 'lark', 'rplan.driver', 'behaviours'}\n"
        "    assert not heavy & set(sys.modules)\n"
    )
    environment = {"PYTHONPATH": str(ROOT), "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1", "PATH": ""}
    arguments = [sys.executable, "-m", "pytest", "-p", "rplan.apps.pytest_plugin", "-q", "-W", "error", str(tmp_path)]
    result = subprocess.run(arguments, capture_output=True, text=True, env=environment, cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    assert "rplan" not in result.stdout


def test_help_has_a_group(run) -> None:
    run("--help").stdout.fnmatch_lines(["plans for robots:", "  --rplan *", "  --rplan-bless *", "  --rplan-coverage*"])
