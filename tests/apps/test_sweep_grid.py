"""What is asked of a sweep: seeds, parameters of the plan and of scenarios, and every mistake before anything runs."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

from rplan.apps.libraries import catalogue
from rplan.apps.simulation import load_world
from rplan.apps.sweep.grid import GridError, Loaded, axes, path, seeds, split, variants, with_value
from rplan.apps.sweep.work import Change, Variant, changed
from rplan.apps.wiring import compile_file
from rplan.driver import Compiled

PLANS = Path(__file__).parents[2] / "plans"
LOT = PLANS / "find_and_fetch" / "parking_lot.yaml"


@pytest.fixture(scope="module")
def plan() -> Compiled:
    return compile_file(PLANS / "make_room" / "make_room.rplan")


@pytest.fixture(scope="module")
def visit() -> Loaded:
    file = PLANS / "make_room" / "visit.yaml"
    return Loaded(file, load_world(file))


def made(plan: Compiled, *scenarios: Loaded, params: tuple[str, ...]) -> tuple[Variant, ...]:
    return variants(scenarios, axes(params, plan, catalogue()), plan, catalogue())


def problems(plan: Compiled, *scenarios: Loaded, params: tuple[str, ...]) -> tuple[str, ...]:
    with pytest.raises(GridError) as caught:
        made(plan, *scenarios, params=params)
    return caught.value.problems


# --- seeds --------------------------------------------------------------------------------------------


def test_seeds_are_numbers_and_ranges_each_once_in_order() -> None:
    assert seeds(["7", "3,5..6", " 5 , 0..1"]) == (0, 1, 3, 5, 6, 7)


@pytest.mark.parametrize(
    "text", ["", "a", "-1", "3..", "..3", "5..4", "1,,2", "0...3", "1.5", "9223372036854775808", "9" * 30]
)
def test_what_is_no_seed_is_told(text: str) -> None:
    with pytest.raises(GridError, match="--seeds: expected whole numbers such as"):
        seeds([text])


def test_more_seeds_than_can_be_are_refused_at_once() -> None:
    with pytest.raises(GridError, match="more than 1,000,000 seeds"):
        seeds(["0..9223372036854775806"])


# --- parameters of the plan ---------------------------------------------------------------------------


def test_values_of_a_parameter_are_read_with_their_units(plan: Compiled, visit: Loaded) -> None:
    some = made(plan, visit, params=("runaway.safety-radius=0.2m,30cm,1ft",))
    assert [one.shown for one in some] == [(("runaway.safety-radius", value),) for value in (0.2, 0.3, 0.3048)]
    assert some[1].changes == (Change("runaway", "safety-radius", 0.3),)
    assert all(one.text == visit.world.text for one in some)


def test_a_changed_plan_has_the_new_value_and_all_others_as_they_were(plan: Compiled) -> None:
    new = changed(plan, [Change("runaway", "release", 0.5), Change("nobody", "release", 9.0)])
    before = {bound.name: dict(bound.settings) for bound in plan.goals.libraries}
    after = {bound.name: dict(bound.settings) for bound in new.goals.libraries}
    assert after == {**before, "runaway": {**before["runaway"], "release": 0.5}}
    assert new.circuit is plan.circuit


@pytest.mark.parametrize(
    ("param", "said"),
    [
        ("runaway", "expected LIBRARY.PARAMETER=VALUE,… or scenario.KEY=VALUE,…"),
        ("radius=1", "expected LIBRARY.PARAMETER=VALUE,… or scenario.KEY=VALUE,…"),
        ("runawy.release=1m", "the plan uses no library `runawy` (did you mean `runaway`?; keys of the scenario"),
        ("natigation.leave=1m", "the plan uses no library `natigation` (it uses: robot, runaway; keys of the scenario"),
        ("runaway.releas=1m", "`runaway` has no parameter `:releas` (did you mean `:release`?)"),
        ("runaway.nothing=1m", "`runaway` has no parameter `:nothing` (it has: safety-radius, release,"),
        ("runaway.=1m", "`runaway.` is no name of a parameter"),
        ("runaway.release=1s", "`1s` is in [s]; wanted is [m]"),
        ("runaway.release=1parsec", "`1parsec`: `parsec` is not a unit"),
        ("runaway.release=true", "`true` is of type bool; wanted is (number m)"),
        ("runaway.release=far", "`:release` wants"),
        ("runaway.release=1m) (use robot", "`1m) (use robot` is no value of a parameter"),
        ("runaway.release=1m,", "a value is empty"),
        ("runaway.release=", "a value is empty"),
        ("runaway.release=20cm,0.2m", "the value 0.2m is given twice"),
    ],
)
def test_a_parameter_that_cannot_be_is_told_with_its_reason(
    plan: Compiled, visit: Loaded, param: str, said: str
) -> None:
    (problem,) = problems(plan, visit, params=(param,))
    assert problem.startswith(f"--param {param}: {said}")


def test_all_mistakes_are_told_at_once(plan: Compiled, visit: Loaded) -> None:
    found = problems(plan, visit, params=("runaway.releas=1m", "runaway.release=1s,2A", "robot.x=1"))
    assert [problem.partition(": ")[0] for problem in found] == [
        "--param runaway.releas=1m",
        "--param runaway.release=1s,2A",
        "--param runaway.release=1s,2A",
        "--param robot.x=1",
    ]


def test_a_value_that_the_library_refuses_is_told(plan: Compiled, visit: Loaded) -> None:
    found = problems(plan, visit, params=("runaway.release=1m,-1m", "runaway.pinch=0.1,0.2"))
    assert found == tuple(
        f"--param runaway.release=-1m --param runaway.pinch={pinch}: "
        "`runaway`: release must be finite and not negative, not -1.0"
        for pinch in ("0.1", "0.2")
    )


def test_a_parameter_that_is_given_twice_is_refused(plan: Compiled, visit: Loaded) -> None:
    found = problems(plan, visit, params=("runaway.release=1m", "runaway.release=2m"))
    assert found == ("--param runaway.release=…: it is given twice",)


# --- keys of scenarios --------------------------------------------------------------------------------


def test_a_key_of_the_scenario_is_changed_and_nothing_else(plan: Compiled, visit: Loaded) -> None:
    slow, fast = made(plan, visit, params=("scenario.robot.max_speed=0.1,1 ft/s",))
    assert (slow.shown, fast.shown) == (
        (("scenario.robot.max_speed", "0.1"),),
        (("scenario.robot.max_speed", "1 ft/s"),),
    )
    before, after = yaml.safe_load(visit.world.text), yaml.safe_load(fast.text)
    assert after["robot"].pop("max_speed") == "1 ft/s"
    before["robot"].pop("max_speed", None)
    assert after == before


def test_keys_that_are_numbers_or_truths_are_so_in_rows(plan: Compiled, visit: Loaded) -> None:
    some = made(plan, visit, params=("scenario.time_limit=10,20.5",))
    assert [one.shown[0][1] for one in some] == [10, 20.5]


def test_scenarios_and_values_are_combined_in_the_order_in_which_they_are_given(plan: Compiled, visit: Loaded) -> None:
    lot = Loaded(LOT, load_world(LOT))
    some = made(plan, lot, visit, params=("scenario.time_limit=20,10", "runaway.release=0.2m,0.1m"))
    assert [(one.scenario, *(value for _, value in one.shown)) for one in some] == [
        (name, limit, release) for name in ("parking lot", "visit") for limit in (20, 10) for release in (0.2, 0.1)
    ]


@pytest.mark.parametrize(
    ("param", "said"),
    [
        ("scenario.robot.max_sped=1", "visit.yaml: robot.max_sped: unknown key; did you mean 'max_speed'?"),
        ("scenario.robt.max_speed=1", "visit.yaml: robt: unknown key; did you mean 'robot'?"),
        ("scenario.robot.max_speed=fast", "visit.yaml: robot.max_speed: expected a speed"),
        ("scenario.robot.start[2]=1", "visit.yaml: there is no [2]: the list has 2"),
        ("scenario.robot[0]=1", "visit.yaml: there is no [0] in what is no list"),
        ("scenario.robot.start.x=1", "visit.yaml: there is no x in what is no mapping"),
    ],
)
def test_a_key_that_cannot_be_is_told_with_its_reason(plan: Compiled, visit: Loaded, param: str, said: str) -> None:
    (problem,) = problems(plan, visit, params=(param,))
    assert problem.startswith(f"--param {param}: {said}")


@pytest.mark.parametrize(
    ("param", "said"),
    [
        ("scenario.=1", "expected a key of the scenario such as"),
        ("scenario.a..b=1", "expected a key of the scenario such as"),
        ("scenario.a[x]=1", "expected a key of the scenario such as"),
        ("scenario.name=x", "the name of a scenario is what tells its rows apart"),
        ("scenario.time_limit=[", "`[` is not YAML"),
        ("scenario.time_limit=1,1.0", "the value 1.0 is given twice"),
    ],
)
def test_what_is_no_key_is_told(plan: Compiled, visit: Loaded, param: str, said: str) -> None:
    (problem,) = problems(plan, visit, params=(param,))
    assert problem.startswith(f"--param {param}: {said}")


def test_two_scenarios_of_one_name_are_refused(plan: Compiled, visit: Loaded) -> None:
    assert problems(plan, visit, visit, params=()) == ("two scenarios are called 'visit': no row would say which",)


def test_values_that_go_wrong_only_together_are_told_together(plan: Compiled, visit: Loaded) -> None:
    params = ("scenario.bounds[0]=-6,50", "scenario.bounds[2]=-5.5,60")
    found = problems(plan, visit, params=params)
    assert found
    assert all(
        "--param scenario.bounds" in problem and "visit.yaml: bounds: the region is empty" in problem
        for problem in found
    )


def test_commas_within_brackets_part_nothing() -> None:
    assert split("[1,2], {a: [3,4]} ,5") == ["[1,2]", "{a: [3,4]}", "5"]


@pytest.mark.parametrize(
    ("key", "value", "expected"),
    [
        ("a", "9", {"a": 9, "c": {"d": [1, {"e": 2}]}}),
        ("c.d[1].e", "[x, 1]", {"a": 1, "c": {"d": [1, {"e": ["x", 1]}]}}),
        ("c.d[0]", "{between: [1, 2]}", {"a": 1, "c": {"d": [{"between": [1, 2]}, {"e": 2}]}}),
        ("c.f.g", "20 deg", {"a": 1, "c": {"d": [1, {"e": 2}], "f": {"g": "20 deg"}}}),
        ("c", "", {"a": 1, "c": None}),
    ],
)
def test_a_value_is_put_at_a_key_that_need_not_be_there(key: str, value: str, expected: object) -> None:
    assert yaml.safe_load(with_value("{a: 1, c: {d: [1, {e: 2}]}}", path(key), value)) == expected


def test_what_an_anchor_shares_is_changed_in_one_place_only() -> None:
    text = "a: &one {x: 1}\nb: *one\n"
    assert yaml.safe_load(with_value(text, path("a.x"), "2")) == {"a": {"x": 2}, "b": {"x": 1}}
