"""`rplan why` and `rplan why-not`: of a recording, of a plan alone, and what is no question."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from pathlib import Path
from time import process_time
from typing import Any, cast

import pytest
from click.testing import CliRunner, Result

from rplan import Controller, why, why_not
from rplan.apps.cli import cli
from rplan.apps.simulation import load_world
from rplan.apps.wiring import compile_file, compile_source, crew, decider, plan_header
from rplan.lang.source import Source
from rplan.runtime.controller import Tick
from rplan.runtime.trace import Trace, texts
from sim.environment import Environment
from sim.recording import Recorder, read

ROOT = Path(__file__).parents[2]
MAKE_ROOM = ROOT / "plans" / "make_room" / "make_room.rplan"
FETCH = ROOT / "plans" / "find_and_fetch" / "find_and_fetch.rplan"
GUARD = """
(plan guard)
(declare (distance) (number m)) (declare (seen) bool)
(defoutput action symbol :idle stand)
(defoutput note symbol)
(defgoalr (maint distance) (when (< distance 0.5m) (do action back)))
(defgoalr (ach company) (when (held-for 0.3s (seen)) (do action follow)))
(goalem (prio-and (maint distance) (ach company) (when (seen) (do note hello))))
"""


def run(*arguments: str | Path) -> Result:
    result = CliRunner().invoke(cli, [*map(str, arguments)], catch_exceptions=False)
    assert "Traceback" not in result.output
    return result


def told(*arguments: str | Path) -> Any:
    result = run(*arguments, "--json")
    assert result.exit_code == 0, result.output
    return json.loads(result.stdout)


def wrong(*arguments: str | Path, code: int = 2) -> str:
    result = run(*arguments)
    assert result.exit_code == code
    return result.stderr


@pytest.fixture
def guard(tmp_path: Path) -> Path:
    path = tmp_path / "guard.rplan"
    path.write_text(GUARD)
    return path


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three seconds of find and fetch."""
    path = tmp_path_factory.mktemp("why") / "run.mcap"
    run("simulate", FETCH, "--until", "3", "--record", path)
    return path


# --- recordings ---------------------------------------------------------------------------------------


def test_a_tick_of_a_recording_is_explained_from_what_stands_in_it(recording: Path) -> None:
    found = told("why", recording, "--at", "2.25")
    assert (found["plan"], found["tick"], found["t"]) == ("find-and-fetch", 22, 2.2)
    assert found["literals"] == [
        {"text": "(anything-is-too-close)", "value": False},
        {"text": "(donor-has-been-located)", "value": False},
        {"text": "(we-know-the-donor-direction)", "value": False},
        {"text": "(ir-search-has-been-started)", "value": True},
    ]
    assert found["smallest"]
    assert found["since"]["action"] == {"tick": 1, "time": 0.1, "before": "(start-ir-search)", "first": False}
    lost = {one["goal"]: one for one in found["lost"]}
    assert lost["(maint runaway)"]["reason"] == "satisfied"
    assert lost["(ach fetch-widget&go-home)"]["because"] == "(donor-has-been-located) is false"
    assert lost["(do goal (the-robots-home-position))"]["part_of"] == "(ach fetch-widget&go-home)"
    assert [rule["rule"] for rule in found["rules"]] == found["way"]["rules"]
    assert found["rules"][0]["place"]["line"] == 20


def test_people_read_the_same(recording: Path) -> None:
    lines = run("why", recording, "--at", "2.25").stdout.splitlines()
    assert lines[0] == "find-and-fetch at 2.2 s (tick 22)"
    set_by = "set by (maint find-donor-direction), find_and_fetch.rplan:47"
    assert lines[1] == f"  action is (continue-ir-search): {set_by}; since 0.1 s, instead of (start-ir-search)"
    assert "  (maint runaway), find_and_fetch.rplan:71: already satisfied: (anything-is-too-close) is false" in lines
    now = run("why", recording, "--at", "0.1").stdout
    assert "; now, instead of (start-ir-search)" in now
    assert "instead" not in run("why", recording, "--at", "0").stdout


def test_a_change_of_percepts_is_found_for_a_tick_of_a_recording(recording: Path) -> None:
    found = told("why-not", recording, "--at", "2.25", "action=move-according-to-NaT-plan")
    assert found["wanted"] == {"action": "(move-according-to-NaT-plan)"}
    assert found["verdict"] == "percepts"
    assert [one["percept"] for one in found["changes"]] == ["(donor-has-been-located)", "(there-is-a-goal)"]
    assert [act["output"] for act in found["way"]["acts"]] == ["goal", "action"]
    already = run("why-not", recording, "action=(continue-ir-search)", "--at", "1").stdout
    assert "action = (continue-ir-search): it happens" in already


def test_a_question_about_find_and_fetch_is_answered_within_a_second() -> None:
    begin = process_time()
    told("why", FETCH, "--given", "there-is-a-goal")
    told("why-not", FETCH, "--given", "there-is-a-goal", "action=(continue-stereo-search)")
    assert process_time() - begin < 2.0


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ((), "say when: --at SECONDS"),
        (("--at", "99"), "--at 99: "),
        (("--at", "-1"), "--at -1: "),
        (("--at", "nan"), "--at nan: "),
        (("--at", "1", "--given", ""), "--given and --trace go with a plan"),
    ],
)
def test_a_time_that_is_not_of_the_run_is_a_clear_error(options: tuple[str, ...], says: str, recording: Path) -> None:
    assert says in wrong("why", recording, *options)


def test_included_texts_come_from_the_recording(tmp_path: Path) -> None:
    (tmp_path / "lib").mkdir()
    plan, rules, more = tmp_path / "plan.rplan", tmp_path / "lib" / "rules.rplan", tmp_path / "lib" / "more.rplan"
    text = MAKE_ROOM.read_text()
    begin, end = text.index("(defgoalr"), text.index("(goalem")
    rules.write_text('(include "more.rplan")' + text[begin:end])
    more.write_text("(defcond (nothing-else) (not (anything-is-too-close)))")
    plan.write_text(text[:begin] + '(include "lib/rules.rplan")' + text[end:])
    path = tmp_path / "run.mcap"
    run("simulate", plan, "--scenario", ROOT / "plans" / "make_room" / "visit.yaml", "--until", "1", "--record", path)
    for file in (plan, rules, more):
        file.unlink()
    assert "rules.rplan:" in run("why", path, "--at", "0.5").stdout


def record(path: Path, header: Mapping[str, object], *ticks: Mapping[str, object]) -> Path:
    with Recorder(path, {"plan": header} if header else {}) as recorder:
        for n, tick in enumerate(ticks):
            recorder.tick(n / 10, {}, json.dumps(tick))
    return path


def test_recordings_that_cannot_be_asked_are_clear_errors(tmp_path: Path) -> None:
    text = {"file": "p.rplan", "text": "(goalem (when (a) (do x on)))"}
    tick: dict[str, object] = {"inputs": "1", "registers": "", "outputs": {}, "sent": {}}
    cases: list[tuple[Mapping[str, object], Mapping[str, object], str]] = [
        ({}, tick, "holds no plan"),
        (text | {"inputs": ["(b)"]}, tick, "reads the plan in it otherwise"),
        (text | {"inputs": ["(a)"]}, tick | {"inputs": "11"}, "reads the plan in it otherwise"),
        (text | {"text": "(goalem"}, tick, "does not compile"),
        (text | {"text": '(include "a.rplan") (goalem (do x on))'}, tick, "does not compile"),
    ]
    for n, (header, one, says) in enumerate(cases):
        path = record(tmp_path / f"{n}.mcap", header, one)
        assert says in wrong("why", path, "--at", "0")
    assert "No such file" in wrong("why", tmp_path / "none.mcap", "--at", "0")
    (tmp_path / "text.mcap").write_text("(plan)")
    assert "is not an MCAP file" in wrong("why", tmp_path / "text.mcap", "--at", "0")
    path = record(tmp_path / "bare.mcap", text | {"inputs": ["(a)"]}, {"inputs": "1", "registers": ""})
    assert run("why", path.rename(tmp_path / "bare"), "--at", "0").exit_code == 0, "it is known by what is in it"


def test_what_a_channel_was_sent_may_be_any_value(tmp_path: Path) -> None:
    header: dict[str, object] = {"file": "p.rplan", "text": "(goalem (when (a) (do x on)))", "inputs": ["(a)"]}
    ticks = [{"inputs": "0", "registers": "", "outputs": {"x": None}, "sent": {"x": at}} for at in ([0, 1], [0, 2])]
    found = told("why", record(tmp_path / "run.mcap", header, *ticks), "--at", "0.1")
    assert found["sent"] == {"x": "[0, 2]"}
    assert found["since"]["x"]["before"] == "[0, 1]"


def long(path: Path) -> Path:
    """A plan with a number that decides, an open output and one that is kept, and what they were in 50 ticks."""
    text = """(plan far) (declare (distance) (number m)) (declare (seen) bool)
      (defoutput action symbol :idle stand) (defoutput note symbol) (defoutput kept symbol :hold)
      (goalem (prio-and (when (< distance 2m) (do action back)) (when (seen) (do note hello))
                        (when (latch (seen) (> distance 2.5m)) (do kept on))))"""
    compiled = compile_source(Source("far.rplan", text))
    decide, trace = decider(compiled), Trace(compiled.ways)
    with Recorder(path, {"plan": plan_header(compiled)}) as recorder:
        for n in range(50):
            percepts: dict[str, bool | float] = {"(distance)": 3.1 - n / 25.1, "(seen)": n % 7 == 3}
            decision = decide.tick(percepts)
            values = texts(decision.sent)
            tick: Tick[Any] = Tick(n, percepts, decision, values, (), (), (), {}, None)
            recorder.tick(n / 10, {"t": n / 10}, trace.note(tick))
        recorder.tick(5.0, {"t": 5.0}, "null")
    return path


def otherwise(whole: Path, path: Path, part: str, becomes: object) -> Path:
    """The same recording with a part of what was decided left out (None) or as something else."""
    with Recorder(path, cast(Any, read(whole).header)) as recorder:
        for tick in read(whole).ticks:
            plan: Any = tick["plan"]
            if plan is not None:
                plan = {key: value for key, value in plan.items() if key != part}
                plan |= {} if becomes is None else {part: becomes}
            recorder.tick(cast(float, tick["t"]), {}, json.dumps(plan))
    return path


def test_the_numbers_behind_comparisons_stand_in_a_recording_and_are_told(tmp_path: Path) -> None:
    path = long(tmp_path / "run.mcap")
    said = run("why", path, "--at", "0").stdout
    assert "  (< (distance) 2m) is false ((distance) = 3.1m)\n" in said
    assert "(do action back), far.rplan:3: (< (distance) 2m) is false ((distance) = 3.1m)" in said
    found = told("why", path, "--at", "1.2")
    exact = 3.1 - 12 / 25.1
    assert found["percepts"] == {"(distance)": exact, "(seen)": False}, "to the last bit"
    assert {"text": "(< (distance) 2m)", "value": False, "numbers": {"(distance)": exact}} in found["literals"]
    assert {"text": "(seen)", "value": False} in found["literals"]
    assert "(distance) = 2.62m" in run("why", path, "--at", "1.2").stdout


def test_the_number_to_change_is_named_for_a_recording(tmp_path: Path) -> None:
    path = long(tmp_path / "run.mcap")
    said = run("why-not", path, "--at", "0", "action=back").stdout
    turned = "(< (distance) 2m) is true and (> (distance) 2.5m) is false"
    assert f"  (distance) so that {turned}, such as 1.9m, not 3.1m\n" in said
    change = told("why-not", path, "--at", "0", "action=back")["changes"][0]
    assert (change["was"], change["becomes"]) == (3.1, 1.9)


def test_numbers_are_told_with_as_many_digits_as_their_comparisons_need(tmp_path: Path) -> None:
    plan = tmp_path / "near.rplan"
    plan.write_text(
        "(declare (a) (number m)) (declare (b) (number m)) (goalem (when (and (< a 2m) (< a b)) (do x on)))"
    )
    assert "((a) = 1.9999m, (b) = 2m)" in run("why", plan, "--given", "a=1.9999, b=1.99994").stdout
    assert "((a) = 1.23m)" in run("why", plan, "--given", "a=1.23456, b=5").stdout


def test_a_recording_without_the_numbers_is_explained_as_before(tmp_path: Path) -> None:
    whole = long(tmp_path / "whole.mcap")
    path = otherwise(whole, tmp_path / "old.mcap", "percepts", None)
    assert "  (< (distance) 2m) is false\n" in run("why", path, "--at", "0").stdout
    found = told("why", path, "--at", "0")
    assert found["percepts"] is None
    assert found["since"] == told("why", whole, "--at", "0")["since"]
    change = told("why-not", path, "--at", "0", "action=back")["changes"][0]
    assert change["was"] is None and change["comparisons"][0] == {"text": "(< (distance) 2m)", "value": True}


@pytest.mark.parametrize("number", [1.0, "far", True, None])
def test_numbers_that_do_not_fit_what_was_decided_are_told(number: object, tmp_path: Path) -> None:
    header: dict[str, object] = {
        "file": "p.rplan",
        "text": "(declare (d) (number m)) (goalem (when (< d 2m) (do x on)))",
        "inputs": ["(< (d) 2m)"],
    }
    tick = {"inputs": "0", "registers": "", "outputs": {"x": None}, "sent": {"x": None}, "percepts": {"(d)": number}}
    assert "reads the plan in it otherwise" in wrong("why", record(tmp_path / "run.mcap", header, tick), "--at", "0")


@pytest.mark.parametrize(
    "noted", ["as it is", None, {}, {"action": 99}, {"action": 3}, {"action": 0, "note": "0"}, [1, 2]]
)
def test_since_when_is_what_one_finds_going_through_all_ticks(tmp_path: Path, noted: object) -> None:
    path = long(tmp_path / "run.mcap")
    if noted != "as it is":
        path = otherwise(path, tmp_path / "otherwise.mcap", "since", noted)
    last: dict[str, str | None] = {}
    since: dict[str, dict[str, object]] = {}
    for tick in [*read(path).ticks][:-1]:
        number, time, plan = cast(int, tick["tick"]), cast(float, tick["t"]), cast(Any, tick["plan"])
        shown = {name: value or plan["sent"][name] for name, value in plan["outputs"].items()}
        for name, value in shown.items():
            if name not in last or last[name] != value:
                first = name not in last
                since[name] = {"tick": number, "time": time, "before": last.get(name), "first": first}
        last = shown
        if number % 3 == 1 or number > 45:
            assert told("why", path, "--at", str(time))["since"] == since, number


def test_a_recording_that_was_cut_short_is_explained_as_far_as_it_goes(tmp_path: Path) -> None:
    path = long(tmp_path / "run.mcap")
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    ticks = [*read(path).ticks]
    last = cast(float, ticks[-1]["t"])
    assert 1 < last < 4.9
    assert told("why", path, "--at", str(last))["tick"] == len(ticks) - 1
    assert f"lasts from 0 s to {last:g} s, where it was cut short" in wrong("why", path, "--at", "4.9")


# --- a controller that runs ---------------------------------------------------------------------------


def test_a_decision_of_a_controller_that_runs_is_explained() -> None:
    plan = compile_file(MAKE_ROOM)
    world = load_world(MAKE_ROOM.parent / "visit.yaml")
    environment = Environment(world.scenario)
    reading, _ = environment.reset(seed=0)
    controller = Controller(decider(plan), crew(plan))
    tick = controller.step(reading)
    found = why(plan, tick.decision)
    assert [(one.text, one.value) for one in found.literals] == [("(anything-is-too-close)", False)]
    other = why_not(plan, tick.decision, {"action": "(move-away-from-danger)"}, tick.percepts)
    assert [one.percept for one in other.changes] == ["(anything-is-too-close)"]
    controller.close()


@pytest.mark.parametrize(
    ("percepts", "says"),
    [
        ({}, "(anything-is-too-close): the plan reads it, and there is no value"),
        ({"anything-is-too-close": True}, "(anything-is-too-close): the plan reads it, and there is no value"),
        ({"(anything-is-too-close)": 1.0}, "(anything-is-too-close): true or false is wanted, not 1.0"),
        ({"(anything-is-too-close)": True}, "(anything-is-too-close) was false in the decision, and is true"),
    ],
)
def test_percepts_that_the_decision_did_not_see_are_clear_errors(percepts: dict[str, bool | float], says: str) -> None:
    plan = compile_file(MAKE_ROOM)
    decision = decider(plan).tick({"(anything-is-too-close)": False})
    with pytest.raises(ValueError, match=re.escape(says)):
        why_not(plan, decision, {"action": "(move-away-from-danger)"}, percepts)


# --- plans alone ----------------------------------------------------------------------------------------


def test_a_plan_alone_is_asked_with_percepts_and_numbers_with_units(guard: Path) -> None:
    said = run("why", guard, "--given", "distance=30cm, seen").stdout
    assert "  (< (distance) 0.5m) is true ((distance) = 0.3m)\n  (seen) is true\n" in said
    assert "  (ach company), guard.rplan:8: asks for nothing: (held-for 0.3s (seen)) is false" in said
    found = told("why-not", guard, "action=stand", "--given", "distance=0.3, seen")
    assert [(one["percept"], one["was"], one["becomes"]) for one in found["changes"]] == [("(distance)", 0.3, 0.5)]
    assert (
        "(distance) so that (< (distance) 0.5m) is false, such as 0.5m, not 0.3m"
        in run("why-not", guard, "action=stand, note=", "--given", "(distance)=0.3, seen=false").stdout
    )
    assert "  nothing: it is always so" not in said


def test_a_trace_says_what_is_kept(guard: Path, tmp_path: Path) -> None:
    trace = tmp_path / "trace.jsonl"
    trace.write_text('{"distance": 2, "seen": true}\n\n' * 2)
    after = run("why", guard, "--trace", trace, "--given", "distance=2, seen").stdout
    assert after.startswith(
        "guard at 0.2 s (tick 2)\n  action is follow: set by (ach company), guard.rplan:7; now, instead"
    )
    assert "  (held-for 0.3s (seen)) had 2 ticks counted before\n" in after
    assert run("why", guard, "--trace", trace).stdout.startswith("guard at 0.1 s (tick 1)")
    held = run("why-not", guard, "action=follow", "--trace", trace).stdout
    assert "no change of percepts would have made it happen" in held
    assert "  (held-for 0.3s (seen)) with 2 ticks counted before, not 1 tick\n" in held
    found = told("why-not", guard, "action=follow", "--trace", trace)
    assert found["past"] == [{"condition": "(held-for 0.3s (seen))", "was": 1, "becomes": 2}]
    assert "; since 0 s, instead of" not in after


@pytest.mark.parametrize(
    ("form", "says"),
    [
        ("(rose (seen))", "(seen) was true in the tick before"),
        ("(not (delay false (seen)))", "(seen) was true in the tick before"),
        ("(not (once (seen)))", "(once (seen)) was true before"),
        ("(not (within 0.3s (seen)))", "(within 0.3s (seen)) had 2 ticks left before"),
        ("(at-least 3 (seen))", "(at-least 3 (seen)) had 1 tick counted before"),
    ],
)
def test_what_is_kept_is_said_as_each_form_of_memory_means_it(form: str, says: str, tmp_path: Path) -> None:
    plan, trace = tmp_path / "kept.rplan", tmp_path / "trace.jsonl"
    plan.write_text(f"(plan kept :period 0.1s) (goalem (when {form} (do x on)))")
    trace.write_text('{"seen": true}\n')
    assert f"  {says}\n" in run("why", plan, "--trace", trace, "--given", "").stdout


def test_times_of_a_plan_alone_are_round(guard: Path, tmp_path: Path) -> None:
    trace = tmp_path / "trace.jsonl"
    trace.write_text('{"distance": 2, "seen": true}\n' * 4)
    found = told("why", guard, "--trace", trace)
    assert found["t"] == 0.3 and found["since"]["action"]["time"] == 0.2


def test_before_the_first_tick_nothing_is_said_to_have_been(tmp_path: Path) -> None:
    plan = tmp_path / "first.rplan"
    plan.write_text("(goalem (when (rose (seen)) (do x on)))")
    assert "  (seen) counts as true before the first tick\n" in run("why", plan, "--given", "seen").stdout
    other = run("why-not", plan, "x=on", "--given", "seen").stdout
    assert "  (seen) false in the tick before, not true\n" in other


def test_a_past_that_was_not_found_leaves_no_sentence_open(guard: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("rplan.ways.why_not.MOST_PASTS", 0)
    said = run("why-not", guard, "action=follow", "--given", "distance=2").stdout
    assert said.endswith("what would have had to be kept was not found\n")


def test_what_stands_where_nothing_sets_it_is_said(tmp_path: Path) -> None:
    plan, trace = tmp_path / "lamp.rplan", tmp_path / "trace.jsonl"
    plan.write_text(
        "(plan lamp) (defoutput light symbol :hold :initial off) (defoutput action symbol :idle rest)\n"
        "(goalem (cond ((a) (do light on)) ((b) (and (do light off) (do action work)))))"
    )
    trace.write_text('{"a": true, "b": false}\n{"a": false, "b": true}\n')
    said = run("why", plan, "--trace", trace, "--given", "").stdout
    assert "  open: action (rest stands); now, instead of work\n" in said
    assert "  open: light (off stands); since 0.1 s, instead of on\n" in said
    held = run("why-not", plan, "light=off", "--trace", trace, "--given", "").stdout
    assert "  light is off already, held from before; this tick does not set it\nlight = off: it would have" in held
    assert "held" not in run("why-not", plan, "light=on", "--trace", trace, "--given", "").stdout
    idle = run("why-not", plan, "action=rest", "--given", "b").stdout
    assert idle.endswith("set by (goalem), lamp.rplan:2\n  action is rest: its idle value, since nothing sets it\n")


def test_what_can_never_be_and_what_is_open_is_said(guard: Path, tmp_path: Path) -> None:
    plan = tmp_path / "never.rplan"
    plan.write_text("(goalem (and (do x on) (when (and (a) (not (a))) (do y on))))")
    found = run("why-not", plan, "y=on", "--given", "")
    assert "y = (on): it never happens: no tick of this plan that can be does it" in found.stdout
    assert told("why-not", plan, "y=(on)", "--given", "")["way"] is None
    said = run("why", plan, "--given", "").stdout
    assert "  nothing: it is always so" in said
    assert "  open: y" in said
    found = told("why-not", guard, "(open note), action=back", "--given", "seen, distance=2m")
    assert found["wanted"] == {"note": None, "action": "back"}


def test_a_hole_is_explained_as_well(tmp_path: Path) -> None:
    plan = tmp_path / "hole.rplan"
    plan.write_text("(goalem (and (do x on) (when (a) (do x off))))")
    said = run("why", plan, "--given", "a").stdout
    assert "  no way is open: a hole\n" in said
    assert "  (a) is true\n" in said
    assert "  (do x (off)), hole.rplan:1: no way is open: x must be (on) and (off)\n" in said


def test_a_plan_in_which_nothing_lost_says_so(tmp_path: Path) -> None:
    plan = tmp_path / "all.rplan"
    plan.write_text("(goalem (do x on))")
    assert run("why", plan, "--given", "").stdout.endswith("what lost\n  nothing\n")


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ((), "say which tick is meant: --given"),
        (("--at", "1"), "--at goes with a recording"),
        (("--given", "distanc"), "neither declares nor reads (did you mean `distance`?)"),
        (("--given", "seen, seen"), "--given: `seen`: it is there twice"),
        (("--given", "seen, (seen)"), "is there twice, also as"),
        (("--given", "()=4"), "--given: `()` is a percept that the plan neither declares nor reads"),
        (("--given", "=4"), "--given: `=4`: a percept is wanted"),
        (("--given", "seen,, distance=1"), "--given: ``: a percept is wanted"),
        (
            ("--given", "seen distance=1"),
            "--given: `seen distance=1`: a percept is wanted; several are separated by commas",
        ),
        (("--given", "seen=maybe"), "--given: `seen=maybe`: true, false or a number is wanted"),
        (("--given", "distance=3x"), "`x` is not a unit"),
        (("--given", "distance=3s"), "--given: `distance=3s`: its unit is m, not s"),
        (("--given", "distance"), "--given: `distance`: a finite number is wanted, not true"),
        (("--given", "seen=3"), "--given: `seen`: true or false is wanted, not 3"),
        (("--trace", "none.jsonl"), "none.jsonl: No such file"),
    ],
)
def test_what_is_no_tick_of_a_plan_is_a_clear_error(options: tuple[str, ...], says: str, guard: Path) -> None:
    assert says in wrong("why", guard, *options)


@pytest.mark.parametrize(
    ("lines", "says"),
    [
        ("", "has no tick"),
        ('{"distance": 1}', "line 1: `seen`: the plan reads it, and there is no value"),
        ('{"distance": 1, "seen": true}\n{', "line 2: not JSON"),
    ],
)
def test_a_bad_trace_is_a_clear_error(lines: str, says: str, guard: Path, tmp_path: Path) -> None:
    trace = tmp_path / "trace.jsonl"
    trace.write_text(lines)
    assert says in wrong("why", guard, "--trace", trace)


@pytest.mark.parametrize(
    ("wanted", "says"),
    [
        ("", "OUTPUT=VALUE is wanted"),
        ("action", "`action`: OUTPUT=VALUE is wanted, or OUTPUT= for one that stays open"),
        ("action=back, action=", "`action` is there twice"),
        ("=5", "`=5`: OUTPUT=VALUE is wanted"),
        ("acton=back", "there is no output acton (there are: action, note)"),
        ("action=fly", "the plan never sets action to fly (what it can be: back, follow, stand)"),
    ],
)
def test_what_cannot_be_wanted_is_a_clear_error(wanted: str, says: str, guard: Path) -> None:
    assert says in wrong("why-not", guard, wanted, "--given", "")


def test_a_plan_that_is_wrong_is_said_to_be(tmp_path: Path) -> None:
    plan = tmp_path / "wrong.rplan"
    plan.write_text("(goalem (ach nothing))")
    assert "error[no-rule]" in wrong("why", plan, "--given", "", code=1)
    assert json.loads(run("why", plan, "--given", "", "--json").stdout)["ok"] is False


def test_percepts_and_values_may_have_arguments(tmp_path: Path) -> None:
    plan = tmp_path / "rooms.rplan"
    plan.write_text(
        "(plan rooms) (declare (door (place symbol)) bool) (declare (far (place symbol)) (number m))\n"
        "(defoutput x symbol) (defgoalr (ach go ?p) (do x (enter ?p)))\n"
        "(goalem (if (and (door hall) (< (far hall) 2m)) (ach go hall) (ach go home)))"
    )
    given = "( door  hall ), (far hall) = 150cm"
    assert "  x is (enter (hall)): set by" in run("why", plan, "--given", given).stdout
    for meant in ("(enter home)", "enter home", "( enter  (home) )"):
        assert told("why-not", plan, f"x={meant}", "--given", given)["wanted"] == {"x": "(enter (home))"}
    assert "its unit is m, not s" in wrong("why", plan, "--given", "(far hall)=3s")
    assert "never sets x to (enter home (" in wrong("why-not", plan, "x=(enter home", "--given", given)


def test_a_number_may_be_wanted_in_any_unit(tmp_path: Path) -> None:
    plan = tmp_path / "far.rplan"
    plan.write_text("(defoutput speed (number m/s)) (goalem (when (a) (do speed 0.5m/s)))")
    assert told("why-not", plan, "speed=50cm/s", "--given", "")["wanted"] == {"speed": "0.5m/s"}
