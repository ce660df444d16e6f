"""`rplan replay`: a page with the run, its circuit and who lost to what; and clear words where there is no page."""

from __future__ import annotations

import base64
import json
import re
import zlib
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner, Result

from rplan.apps.cli import cli
from rplan.apps.simulation import load_world, simulate
from rplan.apps.viewer.telling import Loser, circuit, rules, telling
from rplan.apps.wiring import compile_file, plan_header
from rplan.driver import compile_plan
from rplan.lang.source import Source
from sim.recording import Recorder, read

PLANS = Path(__file__).parents[2] / "plans"
FIND = PLANS / "find_and_fetch" / "find_and_fetch.rplan"


def rplan_replay(*arguments: str) -> Result:
    result = CliRunner().invoke(cli, ["replay", *arguments], catch_exceptions=False)
    assert "Traceback" not in result.output
    return result


def embedded(page: Path) -> dict[str, Any]:
    text = re.findall(r'id="data">([A-Za-z0-9+/=]+)<', page.read_text(encoding="utf-8"))[0]
    value: dict[str, Any] = json.loads(zlib.decompress(base64.b64decode(text)))
    return value


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("runs") / "run.mcap"
    world = load_world(PLANS / "find_and_fetch" / "parking_lot.yaml")
    simulate(compile_file(FIND), world, 0, until=2.0, record=path)
    return path


def recorded(path: Path, plan: object, note: str = "null") -> Path:
    header = {"plan": plan, "world": {"bounds": [0, 0, 1, 1]}}
    with Recorder(path, {key: value for key, value in header.items() if value is not None}) as recorder:
        recorder.tick(0.0, {"robot": [0, 0, 0]}, note)
    return path


def test_the_page_lies_beside_the_recording_and_is_one_file(run: Path) -> None:
    result = rplan_replay(str(run))
    page = run.with_suffix(".html")
    assert (result.exit_code, result.stderr) == (0, "")
    assert result.stdout == f"wrote {page} ({page.stat().st_size / 1e6:.1f} MB)\n"
    assert embedded(page)["ticks"] == 21


def test_the_page_has_the_circuit_with_a_net_for_each_group_of_the_drawing(run: Path, tmp_path: Path) -> None:
    rplan_replay(str(run), "-o", str(tmp_path / "a.html"))
    made = embedded(tmp_path / "a.html")["circuit"]
    nets = {int(n) for n in re.findall(r'data-net="(\d+)"', made["svg"])}
    assert nets <= set(range(len(made["cells"]))) and len(nets) > 38
    assert made["svg"].count('class="end"') == 12 and made["svg"].count("<g>") == 0
    assert (made["stats"]["gates"], made["stats"]["depth"]) == (38, 15)
    assert "<style>" not in made["svg"]


def test_the_page_says_in_each_tick_who_lost_and_why(run: Path, tmp_path: Path) -> None:
    rplan_replay(str(run), "-o", str(tmp_path / "a.html"))
    lost = embedded(tmp_path / "a.html")["runs"]["lost"]["values"][0]
    because = {one["goal"]: one["because"] for one in lost}
    assert "(anything-is-too-close)" in because["(maint runaway)"]
    assert "(ach find-donor-location)" in because
    assert all(one["line"] for one in lost)


def test_a_goal_that_is_given_up_says_for_what() -> None:
    source = "(plan p)\n(defoutput a bool)\n(goalem (prio-and (do a true) (if (x) (do a false) (do anything))))\n"
    loser = Loser(compile_plan(Source("p.rplan", source)))
    assert [one["because"] for one in loser.lost("1", "")] == ["a would be false, and (goalem) sets it to true"]
    assert loser.firing("1", "") == ()


def test_in_a_hole_each_goal_says_what_does_not_go_together() -> None:
    rules = "(defgoalr (ach wash) (when (dirty) (do a wash)))\n(defgoalr (ach run) (when (late) (do a run)))\n"
    source = f"(plan p)\n(defoutput a symbol)\n{rules}(goalem (and (ach wash) (ach run)))\n"
    loser = Loser(compile_plan(Source("p.rplan", source), allow_holes=True))
    because = {(one["goal"], one["because"]) for one in loser.lost("11", "")}
    assert ("(ach run)", "no way is open: a must be wash and run") in because
    assert "hole" not in {one["reason"] for one in loser.lost("10", "")}


def test_a_rule_fires_where_it_or_a_subgoal_of_it_sets_something() -> None:
    loser = Loser(compile_file(FIND))
    assert loser.firing("0" * 12, "") == (
        "(maint find-donor-direction)",
        "(ach find-donor)",
        "(ach retrieve-widget-from-donor)",
    )
    assert "(maint runaway)" in loser.firing("1" + "0" * 11, "")


def test_a_tick_says_which_conditions_alone_make_for_it() -> None:
    loser = Loser(compile_file(FIND))
    assert loser.enough("1" + "01" * 5 + "0", "") == [{"condition": "(anything-is-too-close)", "value": True}]
    bodies = " ".join(f"(if (p{k}) (do a{k} true) (do anything))" for k in range(65))
    outputs = "".join(f"(defoutput a{k} bool)\n" for k in range(65))
    assert (
        Loser(compile_plan(Source("p.rplan", f"(plan p)\n{outputs}(goalem (and {bodies}))\n"))).enough("1" * 65, "")
        == []
    )


def test_a_circuit_that_is_too_large_is_not_drawn() -> None:
    bodies = [f"(if (and (p{k}) (q{k % 17})) (do action (a{k})) (do anything))" for k in range(600)]
    source = f"(plan p)\n(defoutput action command :idle (stop))\n(goalem (prio-and {' '.join(bodies)}))\n"
    made = circuit(compile_plan(Source("p.rplan", source)))
    assert (made["svg"], made["cells"]) == ("", [])


def test_without_a_plan_that_compiles_the_page_says_so_and_plays_the_rest(tmp_path: Path) -> None:
    good = dict(plan_header(compile_file(FIND)))
    cases = [
        (None, "no plan stands in its header"),
        (good | {"text": "(plan"}, "its plan does not compile with the libraries at hand"),
        (good | {"inputs": ["(other)"]}, "this rplan reads its plan otherwise than the one that recorded it"),
    ]
    for number, (plan, why) in enumerate(cases):
        result = rplan_replay(str(recorded(tmp_path / f"{number}.mcap", plan)))
        assert result.exit_code == 0
        assert result.stderr.startswith(f"the page has no circuit: {why}")
        assert "circuit" not in embedded(tmp_path / f"{number}.html")


def test_included_files_come_from_the_recording(tmp_path: Path) -> None:
    (tmp_path / "lib.rplan").write_text("(defgoalr (ach go) (do a true))\n", encoding="utf-8")
    main = tmp_path / "main.rplan"
    main.write_text('(plan p)\n(include "lib.rplan")\n(defoutput a bool)\n(goalem (ach go))\n', encoding="utf-8")
    header = {"plan": plan_header(compile_file(main))}
    (tmp_path / "lib.rplan").unlink()
    told, why_not = telling(header)
    assert told is not None and why_not == ""
    assert told.tick({"inputs": 1}) == {}
    missing = dict(header["plan"]) | {"included": []}
    assert telling({"plan": missing})[1].startswith("its plan does not compile")


def test_what_stands_in_an_included_file_is_told_with_its_place() -> None:
    compiled = compile_file(PLANS / "fetch_all" / "fetch_all.rplan")
    included = {one["rule"]: one for one in rules(compiled)}["(maint runaway)"]
    text = next(source.text for source in compiled.sources if source.name.endswith("fetch_by_roaming.rplan"))
    assert included["file"] == "fetch_by_roaming.rplan"
    assert text.splitlines()[included["line"] - 1].startswith("(defgoalr (maint runaway)")
    lost = Loser(compiled).lost("0" * compiled.ways.asking, "0" * 9)
    places = [one["at"].rpartition("/")[2] for one in lost if one["line"] is None]
    assert places and all(re.fullmatch(r"fetch_by_roaming\.rplan:\d+:\d+", place) for place in places)
    own = rules(compile_file(FIND))
    assert all("file" not in one for one in own) and own == plan_header(compile_file(FIND))["rules"]


def test_the_page_knows_the_rules_of_included_files(run: Path, tmp_path: Path) -> None:
    plan = plan_header(compile_file(PLANS / "fetch_all" / "fetch_all.rplan"))
    rplan_replay(str(recorded(tmp_path / "all.mcap", plan)))
    told = embedded(tmp_path / "all.html")["rules"]
    assert len(told) > 5 and {one.get("file") for one in told} == {"fetch_by_roaming.rplan"}


def test_a_recording_that_was_cut_short_is_played_as_far_as_it_goes(run: Path, tmp_path: Path) -> None:
    short = tmp_path / "short.mcap"
    short.write_bytes(run.read_bytes()[:-200])
    result = rplan_replay(str(short))
    assert result.exit_code == 0 and "was cut short" in result.stderr
    assert embedded(tmp_path / "short.html")["cut_short"] is True
    assert read(short).cut_short


def test_what_is_no_recording_and_what_cannot_be_written_is_said(run: Path, tmp_path: Path) -> None:
    text = tmp_path / "a.mcap"
    text.write_text("no recording", encoding="utf-8")
    cases = [
        ((str(text),), "is not an MCAP file"),
        ((str(tmp_path / "none.mcap"),), "No such file"),
        ((str(run), "-o", str(run)), "is the recording itself"),
        ((str(run), "-o", str(tmp_path / "no" / "a.html")), "No such file"),
    ]
    for arguments, said in cases:
        result = rplan_replay(*arguments)
        assert (result.exit_code, said in result.stderr) == (2, True), result.stderr


def test_a_recording_that_is_damaged_further_in_is_said(run: Path, tmp_path: Path) -> None:
    data = bytearray(run.read_bytes())
    middle = len(data) // 2
    data[middle : middle + 64] = bytes(64)
    damaged = tmp_path / "damaged.mcap"
    damaged.write_bytes(data)
    result = rplan_replay(str(damaged))
    assert result.exit_code == 2 and "is damaged" in result.stderr
