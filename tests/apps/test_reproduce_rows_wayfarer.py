"""What the rows of the perimeter's paper measure of hand-made runs, and how they judge; their pictures of maps."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import pytest
from PIL import Image

from behaviours.interface import STOP, Odometry, Pose, Reading, View
from rplan.apps.files import plans_folder
from rplan.apps.reproduce import experiment, page, report, showing
from rplan.apps.reproduce.experiment import Asked
from rplan.apps.reproduce.report import Result
from rplan.apps.reproduce.row import Case, Drawn, Finding, Measures, Moment, Preset, Row, Seen
from rplan.apps.reproduce.rows import every_row, w1, w2, w3
from rplan.apps.reproduce.showing import Shown
from rplan.apps.sweep.work import Change
from sim.judge import Stage, Times, Verdict
from sim.noise import chance
from sim.scenarios.format import load
from sim.scenarios.layout import distance, lay_out
from sim.world import Touch


def moment(time: float, pose: Pose, shown: Mapping[str, View] | None = None) -> Moment:
    return Moment(time, pose, 0.5, "", Reading(time, 0, Odometry(pose, 0.5, 0.0)), STOP, {}, {}, {}, shown or {})


def view(x: float, y: float, theta: float = 0.0) -> View:
    return {"kind": "pose", "frame": "map", "at": [x, y, theta]}


def seen(moments: Sequence[Moment], *, done: bool = True, contacts: tuple[Touch, ...] = ()) -> Seen:
    end = moments[-1].time if moments else 0.0
    stage: Stage = "done" if done else "going round"
    return Seen(
        Verdict("round", done, "", stage, Times(), end, 110.0, contacts, 0.3, (), 1.0 if done else 0.4), 0.1, moments
    )


def told(findings: Sequence[Finding]) -> list[tuple[str, str]]:
    """What was judged and how: a reason is given exactly where it is not met."""
    assert all(bool(f.because) == (f.judgement != "met") for f in findings)
    return [(f.what, f.judgement) for f in findings]


def test_the_paper_has_its_rows_in_order() -> None:
    names = [row.name for row in every_row() if row.paper == "wayfarer"]
    assert names[:3] == ["W1", "W2", "W3"]
    assert page.TITLES["wayfarer"].startswith("Perimeter reconnaissance")


# --- W1: once round -----------------------------------------------------------------------------------

SOUTH = Pose(-2.0, -14.0)


def test_the_error_is_between_the_belief_and_the_truth_in_the_world() -> None:
    moments = [
        moment(0.1, SOUTH, {w1.BELIEVED: view(0, 0)}),
        moment(0.2, Pose(1.0, -14.0), {w1.BELIEVED: view(3, 4)}),
        moment(0.3, Pose(2.0, -14.0)),
        moment(0.4, Pose(2.0, -14.5), {w1.BELIEVED: view(4, 0.5)}),
    ]
    assert w1.errors(moments, w1.BELIEVED) == [0.0, 4.0, 1.0]
    measured = w1.measure(seen(moments))
    assert (measured["return_error"], measured["greatest_error"]) == (1.0, 4.0)
    assert (measured["complete"], measured["contacts"], measured["stand_off"]) == (True, 0, 1.5)


def test_who_is_not_back_has_no_error_at_the_end() -> None:
    measured = w1.measure(seen([moment(0.1, SOUTH, {w1.BELIEVED: view(0, 0)})], done=False))
    assert (measured["return_error"], measured["share"]) == (None, 0.4)
    assert w1.measure(seen([moment(0.1, SOUTH)]))["greatest_error"] is None
    assert w1.beliefs([], w1.BELIEVED) == []


@pytest.mark.parametrize(
    ("pose", "away"), [(Pose(0, -14), 1.5), (Pose(14.5, 3), 2.0), (Pose(15.5, 16.5), 5.0), (Pose(12, 12), 0.0)]
)
def test_the_stand_off_is_the_distance_from_the_building(pose: Pose, away: float) -> None:
    assert w1.stand_off(pose) == away


ROUND: Measures = {
    "case": w1.BARE, "seed": 3, "complete": True, "contacts": 0, "return_error": 1.0, "greatest_error": 1.5,
    "stand_off": 1.5, "clearance": 0.4, "distance": 115.0, "time": 234.0,
}  # fmt: skip


def test_a_round_without_a_fault_meets_all() -> None:
    assert told(w1.judge("paper", [ROUND])) == [
        ("once round, bare", "met"),
        ("error of the hybrid estimate at the end, bare", "met"),
        ("distance from the wall, bare", "met"),
    ]
    assert w1.judge("paper", []) == ()


@pytest.mark.parametrize(
    ("changed", "which", "why"),
    [
        ({"contacts": 1}, 0, w1.TOUCHED),
        ({"complete": False, "return_error": None}, 0, w1.INCOMPLETE),
        ({"complete": False, "return_error": None}, 1, w1.INCOMPLETE),
        ({"return_error": 3.5}, 1, w1.ASTRAY),
        ({"stand_off": 2.5}, 2, w1.WIDE),
    ],
)
def test_what_is_missed_has_its_reason_and_a_run_to_see(changed: Measures, which: int, why: str) -> None:
    finding = w1.judge("paper", [ROUND | changed])[which]
    assert (finding.judgement, finding.because, finding.case, finding.seed) == ("missed", why, w1.BARE, 3)


def test_one_in_twenty_may_be_farther_off() -> None:
    some = [ROUND] * 19 + [ROUND | {"return_error": 4.0, "seed": 7}]
    finding = w1.judge("paper", some)[1]
    assert (finding.judgement, finding.seed) == ("met", 7)
    assert w1.judge("paper", [*some[:17], *[some[-1]] * 3])[1].judgement == "close"


# --- W2: odometry alone -------------------------------------------------------------------------------


def turning(slip: float) -> list[Moment]:
    """Four right angles, of which odometry tells so many times as much."""
    steps = [k * math.pi / 20 for k in range(41)]
    return [
        moment(
            k / 10, Pose(0, 0, angle), {w2.ODOMETRY: view(0, 0, slip * angle), w1.BELIEVED: view(0, 0, angle + 0.02)}
        )
        for k, angle in enumerate(steps)
    ]


def test_the_heading_by_odometry_counts_whole_turns() -> None:
    measured = w2.measure(seen(turning(1.3)))
    assert measured["heading_error_deg"] == pytest.approx(108)
    assert w2.measure(seen(turning(1.6)))["heading_error_deg"] == pytest.approx(216)
    assert measured["hybrid_heading_error_deg"] == pytest.approx(math.degrees(0.02))
    assert w2.measure(seen([moment(0.0, SOUTH)]))["heading_error_deg"] is None


WEDGE: Measures = {
    "case": w1.CLUTTERED, "seed": 0, "heading_error_deg": 108.0, "position_error": 12.0,
    "hybrid_heading_error_deg": 4.0,
}  # fmt: skip


def test_a_wedge_is_a_heading_off_by_a_right_angle() -> None:
    assert [judgement for _, judgement in told(w2.judge("paper", [WEDGE]))] == ["met", "met"]
    askew = w2.judge("paper", [WEDGE | {"heading_error_deg": 40.0, "hybrid_heading_error_deg": 9.0}])
    assert [f.because for f in askew] == [w2.LITTLE_TURNED, w2.TURNED_ASIDE]
    assert w2.judge("paper", []) == ()


# --- W3: alleys ---------------------------------------------------------------------------------------


def drive(*places: tuple[float, float]) -> list[Moment]:
    return [moment(10.0 * k, Pose(*place)) for k, place in enumerate(places)]


BEFORE, IN, OUT, BEHIND = (-6.0, -1.5), (3.0, -1.5), (-1.5, -3.0), (3.5, -4.5)


@pytest.mark.parametrize(
    ("way", "left", "how", "entries"),
    [
        ([BEFORE, IN, OUT, (-1.5, -7.0)], ("on", 30.0), "out", 1),
        ([BEFORE, IN, OUT, IN, OUT, (-1.5, -7.0)], ("on", 50.0), "out", 2),
        ([BEFORE, IN, OUT, (-7.0, -1.5), (-1.5, -7.0)], ("back", 30.0), "back", 1),
        ([BEFORE, IN, OUT, IN, OUT, IN], None, "trapped", 3),
        ([(-6.5, -1.5), OUT, (-1.5, -7.0), IN], ("on", 20.0), "passed", 0),
        ([(-6.5, -1.5), (-6.4, -1.5)], None, "trapped", 0),
        ([BEFORE, IN, OUT, BEHIND, OUT, IN], ("on", 30.0), "out", 1),
        ([BEFORE, OUT, (2.0, -4.5), BEHIND], ("on", 30.0), "passed", 0),
        ([BEFORE, OUT, (2.0, -4.5), OUT], None, "trapped", 0),
    ],
)
def test_an_alley_is_left_on_or_back_or_passed_or_it_is_a_trap(
    way: list[tuple[float, float]], left: tuple[str, float] | None, how: str, entries: int
) -> None:
    moments = drive(*way)
    assert w3.left(moments) == left
    measured = w3.measure(seen(moments))
    assert [name for name in ("trapped", "out", "passed", "back") if measured[name]] == [how]
    assert measured["entries"] == entries


def alleys(name: str, trapped: int, of: int) -> list[Measures]:
    """The first of them traps, two passed."""
    ways: Measures = {"case": name, "back": False, "entries": 1}
    hows = ["trapped"] * trapped + ["passed"] * 2 + ["out"] * of
    return [ways | {"seed": k, "trapped": False, "passed": False, "out": False, hows[k]: True} for k in range(of)]


def test_how_alleys_are_left_is_told_apart() -> None:
    (finding,) = w3.judge("paper", alleys(w3.WITH, 1, 24))
    assert finding.ours.startswith("trapped: 1 of 24; out and on: 21, back the way it came: 0, passed the mouth: 2;")


@pytest.mark.parametrize(
    ("preset", "name", "trapped", "judgement", "why"),
    [
        ("paper", w3.WITHOUT, 8, "met", ""),
        ("paper", w3.WITHOUT, 2, "missed", w3.ALL_OUT),
        ("paper", w3.WITHOUT, 20, "missed", w3.HELD),
        ("paper", w3.WITH, 1, "met", ""),
        ("paper", w3.WITH, 4, "missed", w3.STILL),
        ("modern", w3.WITHOUT, 20, "met", ""),
        ("modern", w3.WITH, 0, "met", ""),
        ("modern", w3.WITH, 1, "missed", w3.STILL),
        ("modern", w3.NEARER, 1, "missed", w3.STILL),
    ],
)
def test_a_third_is_trapped_without_the_path_and_none_with_it(
    preset: Preset, name: str, trapped: int, judgement: str, why: str
) -> None:
    (finding,) = w3.judge(preset, alleys(name, trapped, 24))
    assert (finding.judgement, finding.because, finding.seed) == (judgement, why, 0)


def test_there_are_twenty_four_alleys_unless_fewer_are_asked_for() -> None:
    assert [len(case.seeds) for case in w3.cases(20)] == [96, 96, 24, 24, 24]
    assert [len(case.seeds) for case in w3.cases(3)] == [3] * 5
    assert [len(w3.ROW.cases_with(preset, 3)) for preset in ("paper", "modern")] == [2, 3]
    assert w3.cases(1)[1].changes == w3.FORGOTTEN


# --- worlds -------------------------------------------------------------------------------------------

WORLDS = plans_folder() / "perimeter" / "worlds"


@pytest.mark.parametrize("name", ["auxiliary", "bare", "headquarters", "alley", "alley_corner"])
def test_the_robot_starts_one_to_two_metres_from_the_wall_to_its_left(name: str) -> None:
    scenario = load(WORLDS / f"{name}.yaml")
    for seed in range(8):
        layout = lay_out(scenario, chance(seed).layout)
        walls = [thing for thing in layout.things if thing.kind in ("box", "outline")]
        gap = min(distance((layout.start.x, layout.start.y), wall.outline, wall.pose) for wall in walls)
        assert 1 <= gap <= 2 and abs(layout.start.theta) < 0.15


@pytest.mark.parametrize("name", ["alley", "alley_corner"])
def test_twenty_four_alleys_differ_within_their_bounds(name: str) -> None:
    scenario = load(WORLDS / f"{name}.yaml")
    things = [lay_out(scenario, chance(seed).layout).things for seed in range(24)]
    mouths = [-right.pose.y - max(y for _, y in right.outline.vertices) for _, right, _ in things]
    depths = [back.pose.x - 0.2 for *_, back in things]
    assert 2.4 <= min(mouths) < 2.6 and 3.0 < max(mouths) <= 3.2
    assert 3.5 <= min(depths) < 4.0 and 8.5 < max(depths) <= 9.0


# --- cases that change the plan, and maps -------------------------------------------------------------


def test_a_case_may_change_the_plan() -> None:
    (batch,) = experiment.batches([Asked(w3.ROW, "paper")], 1)
    with_path, without = batch.work.variants
    assert without.changes == (*with_path.changes, *w3.FORGOTTEN)
    assert (with_path.scenario, without.scenario) == ("alley", "W3, without it")


def test_a_run_with_a_changed_plan_is_seen_through_reproduce() -> None:
    result = Result(Asked(w3.ROW, "paper"), w3.cases(1), (), (), ())
    finding = Finding("x", "x", "x", "met", "", w3.WITHOUT, 0)
    assert report.see(result, finding) == "rplan reproduce W3 --case 'without it' --seed 0 --replay x.html"
    plain = report.see(result, replace(finding, case=w3.WITH))
    assert plain == "rplan simulate plans/perimeter --scenario worlds/alley --seed 0 --replay x.html"


MAPS = (Drawn("askew", (Change("mapping", "by", "odometry"),)), Drawn("as it is"))


def short(seconds: str) -> tuple[Row, Case]:
    """W2 for some seconds only."""
    case = replace(w2.cases(1)[0], settings=(("time_limit", seconds),))
    return replace(w2.ROW, cases=lambda _: (case,), maps=MAPS), case


def test_maps_are_drawn_side_by_side(tmp_path: Path) -> None:
    row, case = short("4 s")
    showing.draw_maps(Shown(Asked(row, "paper"), case), 0, tmp_path / "maps.png")
    with Image.open(tmp_path / "maps.png") as image:
        assert image.width > 1.5 * image.height and len(image.getcolors(1 << 24) or []) > 3


def test_a_page_shows_the_maps_below_the_run(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    row, case = short("4 s")
    result = Result(Asked(row, "paper"), (case,), (WEDGE,), (), w2.judge("paper", [WEDGE]))
    written = [path.name for path in page.write([result], 1, tmp_path)]
    assert written == ["w2-paper.png", "w2-paper-maps.png", "w2-paper-spread.png", "wayfarer.csv", "wayfarer.md"]
    text = (tmp_path / "experiments" / "wayfarer.md").read_text()
    assert "![W2, auxiliary, seed 0: askew; as it is](../pictures/reproduce/w2-paper-maps.png)" in text
