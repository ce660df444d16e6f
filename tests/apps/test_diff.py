"""`rplan diff`: equal exactly where no situation tells the plans apart; else cubes with witnesses and rules."""

from __future__ import annotations

import json
from itertools import product
from pathlib import Path

from click.testing import CliRunner
from hypothesis import given, settings
from properties.strategies import ATOMS, do, remembering, whole

from rplan.apps.cli import cli
from rplan.goals.condition import Condition
from rplan.goals.goal import If
from rplan.lang.source import NOWHERE
from rplan.ways.differ import differences
from rplan.ways.meaning import Situation, holds
from rplan.ways.reduce import Ways, reduce

PLANS = Path(__file__).parents[2] / "plans"
TICKS = [dict(zip(ATOMS[:2], bits, strict=True)) for bits in product((False, True), repeat=2)]


def switch(condition: Condition) -> Ways:
    return reduce(whole(If(condition, do("x", "(p)"), do("x", "(q)"), "(goalem)", NOWHERE)))


def told_apart(one: Condition, other: Condition) -> bool:
    for length in range(1, 5):
        for trace in product(TICKS, repeat=length):
            here = None
            for tick in trace:
                here = Situation(tick.__getitem__, here)
            assert here is not None
            if holds(one, here) != holds(other, here):
                return True
    return False


@settings(max_examples=60, deadline=None, derandomize=True)
@given(remembering(), remembering())
def test_plans_differ_where_some_trace_tells_them_apart(one: Condition, other: Condition) -> None:
    first, second = switch(one), switch(other)
    found = differences(first, second)
    if told_apart(one, other):
        assert found.found
    if len(first.registers) + len(second.registers) <= 2:
        assert found.equal == (not told_apart(one, other))
    for each in found.found:
        assert each.first.value != each.second.value
        assert {act.value for act in each.first.way.acts} == {each.first.value}
        assert {act.value for act in each.second.way.acts} == {each.second.value}


def diff(first: str, second: str, tmp_path: Path) -> tuple[int, dict[str, object]]:
    for name, text in (("a", first), ("b", second)):
        (tmp_path / f"{name}.rplan").write_text(text)
    result = CliRunner().invoke(cli, ["diff", str(tmp_path / "a.rplan"), str(tmp_path / "b.rplan"), "--json"])
    return result.exit_code, json.loads(result.stdout)


def test_the_two_top_goals_of_figure_1_differ_in_three_cubes() -> None:
    result = CliRunner().invoke(cli, ["diff", str(PLANS / "figure_1/figure.rplan"), str(PLANS / "figure_1/text.rplan")])
    assert result.exit_code == 1
    assert result.stdout.endswith("3 differences\n")


def test_a_cube_has_only_what_matters(tmp_path: Path) -> None:
    code, found = diff(
        "(goalem (if (and (p) (q)) (do x a) (if (r) (do x b) (do x c))))",
        "(goalem (if (r) (do x b) (do x c)))",
        tmp_path,
    )
    assert code == 1
    (b, c) = found["differences"]
    assert [b["when"], c["when"]] == [{"(p)": True, "(q)": True, "(r)": True}, {"(p)": True, "(q)": True, "(r)": False}]
    assert [b["a"]["value"], b["b"]["value"]] == ["(a)", "(b)"]


def test_numbers_that_mean_the_same_make_no_difference(tmp_path: Path) -> None:
    text = "(goalem (if {} (do x a) (do x b)))"
    assert diff(text.format("(< (d) 50cm)"), text.format("(not (>= (d) 0.5m))"), tmp_path) == (
        0,
        {"equal": True, "decided": True, "cut_short": False, "differences": []},
    )


def test_what_stands_in_the_place_of_an_open_output_is_compared(tmp_path: Path) -> None:
    text = "(defoutput x bool {}) (goalem (when (p) (do x true)))"
    code, found = diff(text.format(":idle false"), text.format(""), tmp_path)
    assert code == 1
    assert [one["when"] for one in found["differences"]] == [{"(p)": False}]


def test_a_percept_that_is_two_things_cannot_be_compared(tmp_path: Path) -> None:
    for name, text in (("a", "(goalem (when (d) (do x a)))"), ("b", "(goalem (when (< (d) 1) (do x a)))")):
        (tmp_path / f"{name}.rplan").write_text(text)
    result = CliRunner().invoke(cli, ["diff", str(tmp_path / "a.rplan"), str(tmp_path / "b.rplan")])
    assert result.exit_code == 2
