"""Coverage of plans: ways, branches and conditions that the tests reached, as a table and as pages."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import pytest
import z3

from rplan.apps import pytest_plugin
from rplan.apps.pytest_plugin.coverage import MOST_ON_PAGE, Found, sections
from rplan.apps.pytest_plugin.shelf import Plan, Shelf
from rplan.apps.testing import PlanUnderTest
from rplan.apps.wiring import decider
from rplan.ways.situations import Undecided
from rplan.ways.tally import PartReached, Reached

pytest_plugins = ["pytester"]

PLAN = """\
(plan guard "Keeps its <distance>." :period 0.1s)
(declare (near) bool "")
(declare (lost) bool "")
(declare (slow) bool "")
(declare (flee) command "")
(declare (rest) command "")
(defoutput action command :idle (rest))
(defcond (bad) (or (near) (lost)))
(defgoalr (maint distance)
  (if (and (bad) (not (slow)))
      (do action (flee))
      (if (slow) (do action (rest)) (do anything))))
(goalem (maint distance))
"""


@pytest.fixture
def plan(tmp_path: Path) -> Plan:
    return opened(tmp_path, PLAN)


def opened(folder: Path, text: str) -> Plan:
    path = folder / "guard.rplan"
    path.write_text(text, encoding="utf-8")
    return Shelf().plan(path)


def seen(plan: Plan) -> Reached:
    return plan.reached()


def decided(part: PartReached) -> tuple[bool, bool]:
    """As true, as false."""
    return part.values[0].seen, part.values[1].seen


def under_test(plan: Plan) -> PlanUnderTest:
    return PlanUnderTest(plan.compiled, watch=plan.watch)


# --- what is counted --------------------------------------------------------------------------------


def test_nothing_is_reached_without_a_tick(plan: Plan) -> None:
    none = seen(plan)
    assert (none.ways, none.ticks, none.arms, none.conditions) == ((), 0, (0, 4), (0, 8))


def test_branches_are_counted_by_tick(plan: Plan) -> None:
    under_test(plan).given("near").then().then("slow")
    found = seen(plan)
    assert (len(found.ways), found.ticks, found.arms) == (2, 3, (3, 4))
    times = [arm.times for fork in found.forks for arm in fork.arms]
    assert times == [3, 2, 1, 1, 0]


def test_a_part_counts_where_it_alone_decides(plan: Plan) -> None:
    under_test(plan).given("near", "lost")
    parts = {(p.part.span.line, p.part.text): decided(p) for p in seen(plan).parts}
    assert parts == {
        (10, "(near)"): (False, False),
        (10, "(lost)"): (False, False),
        (10, "(slow)"): (False, True),
        (12, "(slow)"): (False, False),
    }
    under_test(plan).given("near").then("not near", "lost").then("not lost").then("near", "slow")
    assert seen(plan).conditions == (8, 8)


def test_forms_with_memory_are_parts(tmp_path: Path) -> None:
    forms = [
        "(held-for 0.2s (near))",
        "(within 0.2s (near))",
        "(since (near) (lost))",
        "(rose (near))",
        "(at-least 2 (near))",
        "(delay true (near))",
        "(latch (near) (lost))",
        "(once (and (near) (not (bad)) (or (lost) true)))",
        "(since (not (near)) (lost))",
    ]
    for form in forms:
        plan = opened(tmp_path, PLAN.replace("(and (bad) (not (slow)))", f"(and {form} (not (slow)))"))
        under_test(plan).given().then("near").then().then("not near").then().then().then("lost").then("not lost")
        under_test(plan).given("lost", "near").then("not lost").then("not near", "lost").then()
        parts = {p.part.text.partition(" ")[0]: decided(p) for p in seen(plan).parts if p.part.span.line == 10}
        assert parts[form.partition(" ")[0]] == (True, True) or "bad" in form, form


def test_a_condition_that_asks_its_own_past_is_a_part(tmp_path: Path) -> None:
    text = PLAN.replace("(or (near) (lost))", "(or (near) (delay false (bad)))")
    plan = opened(tmp_path, text)
    under_test(plan).given().then("near").then("not near").then("slow")
    parts = {p.part.text: decided(p) for p in seen(plan).parts if p.part.span.line == 10}
    assert parts == {"(near)": (True, True), "(delay false (bad))": (True, True), "(slow)": (True, True)}


def test_a_branch_that_can_never_be_taken_does_not_count_against_the_tests(tmp_path: Path) -> None:
    text = PLAN.replace(
        "(if (slow) (do action (rest)) (do anything))",
        "(if (not (bad)) (do anything) (if (slow) (do action (rest)) (do action (flee))))",
    )
    plan = opened(tmp_path, text)
    under_test(plan).given().then("near").then("slow")
    found = seen(plan)
    assert found.arms == (5, 5)
    assert [arm.arm.text for fork in found.forks for arm in fork.arms if arm.never] == [
        "(not (slow)) → (do action (flee))"
    ]


def test_a_part_that_can_never_decide_does_not_count_against_the_tests(tmp_path: Path) -> None:
    text = PLAN.replace("(if (slow) (do action (rest))", "(if (and (slow) (not (lost))) (do action (rest))")
    text = text.replace("(or (near) (lost))", "(or (near) (and (lost) (not (near)) (near)))")
    plan = opened(tmp_path, text)
    under_test(plan).given().then("near").then("slow").then("lost").then("not near").then("not lost")
    found = seen(plan)
    never = [(part.part.text, part.part.span.line, part.never) for part in found.parts if part.never]
    assert never == [("(lost)", 10, "true or false")]
    assert (found.arms, found.conditions) == ((4, 4), (8, 8))


def test_a_part_that_numbers_rule_out_cannot_be_reached(tmp_path: Path) -> None:
    text = PLAN.replace("(declare (slow) bool", "(declare (d) (number m)").replace("(not (slow))", "(< (d) 2m)")
    plan = opened(tmp_path, text.replace("(if (slow)", "(if (and (< (d) 1m) (< (d) 2m))"))
    found = seen(plan)
    assert [(p.part.text, p.part.span.line, p.never) for p in found.parts if p.never] == [("(< (d) 2m)", 12, "false")]
    assert found.conditions == (0, 9)


def test_a_part_that_is_not_decided_counts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    plan = opened(tmp_path, PLAN.replace("(if (slow)", "(if (and (slow) (not (slow)))"))
    assert seen(plan).conditions == (0, 6)
    undecided = opened(tmp_path, PLAN.replace("(if (slow)", "(if (and (slow) (not (slow)))"))
    monkeypatch.setattr(z3.Solver, "check", lambda *_: z3.unknown)
    assert seen(undecided).conditions == (0, 8)


@pytest.mark.parametrize("held", ["(slow)", "(held-for 0.3s (slow))"])
def test_every_situation_that_is_said_to_reach_something_does(tmp_path: Path, held: str) -> None:
    plan = opened(tmp_path, PLAN.replace("(if (slow)", f"(if {held}"))
    under_test(plan).given()
    found = Found(plan, seen(plan), MOST_ON_PAGE)
    for one in (*found.branches, *found.conditions, *found.ways):
        assert one.trace is not None
        fresh = decider(plan.compiled)
        for witness in one.trace:
            plan.watch(fresh.tick(witness))
    after = Found(plan, seen(plan), MOST_ON_PAGE)
    assert (after.branches, after.conditions, after.ways) == ((), (), ())
    for some, every in (after.seen.arms, after.seen.conditions, (len(after.seen.ways), after.every_way)):
        assert some == every > 0


def test_what_is_missing_of_a_plan_that_comes_with_rplan_is_reached_by_what_is_said() -> None:
    plan = Shelf().plan(Path(__file__).parents[2] / "plans" / "patrol" / "patrol.rplan")
    under_test(plan).given()
    before = Found(plan, seen(plan), MOST_ON_PAGE)
    for one in (*before.branches, *before.conditions, *before.ways):
        assert one.trace is not None
        fresh = decider(plan.compiled)
        for witness in one.trace:
            plan.watch(fresh.tick(witness))
    assert list(sections(Found(plan, seen(plan), MOST_ON_PAGE))) == []


def test_a_plan_that_the_solver_does_not_get_through_is_asked_once(plan: Plan, monkeypatch: pytest.MonkeyPatch) -> None:
    asked = []

    def possible(*question: tuple[int, bool]) -> Undecided:
        asked.append(question)
        return Undecided()

    monkeypatch.setattr(plan.prover.reach, "possible", possible)
    under_test(plan).given("near")
    found = Found(plan, seen(plan), MOST_ON_PAGE)
    assert (len(asked), found.seen.arms, found.seen.conditions) == (1, (1, 4), (2, 8))
    assert {one.trace for one in (*found.branches, *found.conditions)} == {None}


def test_what_stands_in_an_included_file_is_said_with_its_name(tmp_path: Path) -> None:
    (tmp_path / "part.rplan").write_text("(defgoalr (maint b) (when (near) (do x on)))", encoding="utf-8")
    plan = opened(tmp_path, '(plan guard "" :period 0.1s)\n(include "part.rplan")\n(goalem (maint b))')
    under_test(plan).given()
    lines = [line for one in sections(Found(plan, seen(plan), MOST_ON_PAGE)) for line in one.lines]
    assert ("part.rplan:1: (maint b): (near) → (do x (on))", "near") in lines


def test_a_large_plan_is_told_its_branches_without_situations(plan: Plan, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("rplan.ways.missing.LARGE", 1)
    under_test(plan).given("near")
    found = Found(plan, seen(plan), MOST_ON_PAGE)
    assert [(one.text, one.trace) for one in found.branches][-1] == ("(not (slow)) → (do anything)", None)
    assert (found.ways, found.count) == ((), "1/3")
    assert [section.title for section in sections(found)] == ["branches not taken", "never decided so"]


def test_a_rule_in_two_places_is_one_rule(tmp_path: Path) -> None:
    text = PLAN.replace("(goalem (maint distance))", "(goalem (if (lost) (maint distance) (maint distance)))")
    plan = opened(tmp_path, text)
    under_test(plan).given("near").then("lost")
    found = seen(plan)
    rule = next(fork for fork in found.forks if fork.fork.kind == "rule")
    assert (len(rule.fork.nodes), rule.arms[0].times) == (2, 2)


def test_a_rule_with_arguments_counts_its_parts_together(tmp_path: Path) -> None:
    text = PLAN.replace("(goalem (maint distance))", "(goalem (and (maint distance) (ach go left) (ach go right)))")
    text += '(declare (free (side symbol)) bool "")(defoutput side symbol)\n'
    text += "(defgoalr (ach go ?where) (when (and (free ?where) (slow)) (do side ?where)))"
    plan = opened(tmp_path, text)
    under_test(plan).given("(free left)", "slow").then("not slow").then("slow", "not (free left)")
    parts = {p.part.text: decided(p) for p in seen(plan).parts if p.part.rule == "(ach go ?where)"}
    assert list(parts.values()) == [(True, True), (True, True)]


def test_ways_are_counted_in_full_where_all_can_be_tried(plan: Plan, tmp_path: Path) -> None:
    under_test(plan).given("near")
    assert Found(plan, seen(plan), MOST_ON_PAGE).count == "1/3"
    other = opened(tmp_path, PLAN.replace("(slow)))", "(held-for 1s (slow))))"))
    assert Found(other, seen(other), MOST_ON_PAGE).count.startswith("0/≥")


# --- under pytest -----------------------------------------------------------------------------------

TESTS = """
(deftest flees (tick :given ((near true)) :expect ((action (flee)))))
"""


@pytest.fixture
def run(pytester: pytest.Pytester, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("PYTEST_DISABLE_PLUGIN_AUTOLOAD", "1")
    (pytester.path / "guard.rplan").write_text(PLAN + TESTS, encoding="utf-8")
    (pytester.path / "guard.ticks").write_text('["slow"]\n{"outputs": {"action": "(rest)"}}\n', encoding="utf-8")
    pytester.makepyfile("def test_it(plan):\n    plan('guard.rplan').given('near').then().expect(action='flee')\n")
    return lambda *arguments: pytester.runpytest_inprocess(*arguments, plugins=[pytest_plugin])


def test_deftests_golden_ticks_and_fixtures_are_counted_together(run) -> None:
    result = run("--rplan", "--rplan-coverage")
    result.assert_outcomes(passed=4)
    result.stdout.fnmatch_lines(
        [
            "*- coverage of plans -*",
            "plan  *ticks * ways * branches * conditions",
            "guard.rplan        4 * 2/3 * 3/4   75% * 3/8   37%",
            "  ways not taken",
            "    sets nothing by (maint distance)",
            "      given nothing",
            "  branches not taken",
            "    12: (maint distance): (not (slow)) → (do anything)",
            "      given nothing",
            "  never decided so",
            "    10: (maint distance): (near) as false",
            "      given nothing",
            "    10: (maint distance): (lost) as true",
            "      given lost",
            "    … and 1 more",
        ]
    )


def test_without_a_plan_it_says_so(pytester: pytest.Pytester, run) -> None:
    pytester.makepyfile(test_other="def test_it(): pass")
    run("test_other.py", "--rplan-coverage").stdout.fnmatch_lines(["no plan was tested"])


def test_pages_are_written_with_what_was_not_taken(pytester: pytest.Pytester, run) -> None:
    result = run("--rplan", "--rplan-coverage=html:pages/here")
    result.stdout.fnmatch_lines(["pages/here/guard.html"])
    page = (pytester.path / "pages" / "here" / "guard.html").read_text(encoding="utf-8")
    assert "Keeps its &lt;distance&gt;." in page
    assert "prefers-color-scheme: dark" in page
    assert '<span class="yes">(do action (flee))</span>' in page
    assert '<span class="no">(do anything)</span>' in page
    assert "(near) never decided as false" in page
    assert "<li>12: (maint distance): (not (slow)) → (do anything)<small>given nothing</small></li>" in page
    assert "<h2>branches not taken <span>1</span></h2>" in page
    assert "http" not in page


def test_what_is_never_is_painted_so(pytester: pytest.Pytester, run) -> None:
    text = PLAN.replace("(if (slow)", "(if (and (slow) (not (slow)))").replace("Keeps its <distance>.", "")
    (pytester.path / "guard.rplan").write_text(text, encoding="utf-8")
    result = run("--rplan-coverage=html:pages")
    page = (pytester.path / "pages" / "guard.html").read_text(encoding="utf-8")
    assert '<span class="never">(do action (rest))</span>' in page
    assert "<p>guard.rplan</p>" in page
    assert '<span class="chip never">(slow) cannot decide as true or false</span>' in page
    cannot = "cannot be reached, and does not count"
    assert cannot in page
    result.stdout.fnmatch_lines(
        [f"  {cannot}", "    12: (maint distance): (and (slow) (not (slow))) → *", "    12: *: (slow) as true or false"]
    )


def test_plans_of_one_name_get_a_page_each(pytester: pytest.Pytester, run) -> None:
    (pytester.path / "b").mkdir()
    (pytester.path / "b" / "guard.rplan").write_text(PLAN, encoding="utf-8")
    result = run("--rplan", "--rplan-coverage=html:pages")
    result.stdout.fnmatch_lines(["b/guard.rplan        0 * 0/3 * 0/4    0% *", "guard.rplan          4 * 2/3 *"])
    result.stdout.no_fnmatch_line("*: (slow) →*")
    assert sorted(path.name for path in (pytester.path / "pages").iterdir()) == ["guard-2.html", "guard.html"]


def test_a_folder_that_cannot_be_written_is_said(run) -> None:
    result = run("--rplan", "--rplan-coverage=html:guard.rplan/pages")
    result.stdout.fnmatch_lines(["guard.rplan/pages: *"])
    assert "Traceback" not in result.stdout.str()


@pytest.mark.parametrize("asked", ["html", "html:", "guard.rplan"])
def test_another_form_of_coverage_is_one_clear_error(asked: str, run) -> None:
    result = run(f"--rplan-coverage={asked}")
    assert result.ret == pytest.ExitCode.USAGE_ERROR
    result.stderr.fnmatch_lines([f"*--rplan-coverage={asked}: `=html:FOLDER` or `=table` is wanted"])


def test_what_a_worker_saw_is_handed_over(plan: Plan, tmp_path: Path) -> None:
    worker, here = Shelf(), Shelf()
    path = tmp_path / "guard.rplan"
    worker.under_test(path).given("near").then()
    config = SimpleNamespace(workeroutput={}, stash={pytest_plugin.SHELF: worker})
    pytest_plugin.pytest_sessionfinish(SimpleNamespace(config=config))
    node = SimpleNamespace(workeroutput=config.workeroutput, config=SimpleNamespace(stash={pytest_plugin.SHELF: here}))
    here.under_test(path).given("near")
    pytest_plugin.pytest_testnodedown(node)
    assert sum(here.plan(path).ticks.values()) == 3
    pytest_plugin.pytest_testnodedown(SimpleNamespace(config=node.config))
