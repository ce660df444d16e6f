"""What the rows of wall following measure of hand-made runs, how they judge, and how they draw a run."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from behaviours.interface import STOP, Odometry, Pose, Reading, Report, Scan, View
from rplan.apps.reproduce import courses, page, report
from rplan.apps.reproduce.experiment import Asked
from rplan.apps.reproduce.row import Finding, Measures, Moment, Row, Seen
from rplan.apps.reproduce.rows import every_row, y1, y2, y3
from sim.judge import Times, Verdict
from sim.world import Touch

TOUCH = Touch("wall-1", 1.0, True)
ROWS = (y1.ROW, y2.ROW, y3.ROW)


def moment(time: float, pose: Pose, told: Mapping[str, object] | None = None, **shown: View) -> Moment:
    scan = Scan(time, True, Pose(0, 0), np.array([-1.5, -1.0, -0.5]), np.array([1.0, 1.2, 4.0]), 0.02, 4.0)
    reading = Reading(time, 0, Odometry(pose, 0.48, 0.0), lidar=scan)
    reports = {} if told is None else {"follow-wall": Report(details=told)}
    views = {name.replace("_", "-"): view for name, view in shown.items()}
    return Moment(time, pose, 0.48, "(follow-wall)", reading, STOP, {}, reports, {}, views)


def seen(moments: Sequence[Moment], *, done: bool = True, contacts: tuple[Touch, ...] = (), clear: float = 0.5) -> Seen:
    end = moments[-1].time if moments else 0.0
    times = Times(arrival=end if done else None)
    return Seen(Verdict("reach", done, "", "done", times, end, 1.0, contacts, clear), 0.028, moments)


def told(findings: Sequence[Finding]) -> list[tuple[str, str]]:
    """What was judged and how: a reason is given exactly where it is not met."""
    assert all(bool(f.because) == (f.judgement != "met") for f in findings)
    return [(f.what, f.judgement) for f in findings]


def test_the_paper_has_its_rows_in_order() -> None:
    assert [row.name for row in every_row() if row.paper == "wall-following"] == ["Y1", "Y2", "Y3"]
    assert page.TITLES["wall-following"].startswith("Wall following")


@pytest.mark.parametrize("row", ROWS)
def test_cases_have_names_of_their_own_and_what_is_drawn_is_one_of_them(row: Row) -> None:
    names = [case.name for case in row.cases(20)]
    assert len(names) == len(set(names))
    assert set(row.courses) <= set(names)
    assert row.picture in names


@pytest.mark.parametrize("row", ROWS)
def test_cases_of_one_preset_are_not_run_with_the_other(row: Row) -> None:
    paper, modern = ({case.name for case in row.cases_with(preset, 3)} for preset in ("paper", "modern"))
    assert paper and modern
    assert paper != modern


# --- Y1 -----------------------------------------------------------------------------------------------


def test_what_remains_after_12_m_is_measured() -> None:
    way = [moment(k / 10, Pose(k / 10, 1.3 - min(k, 50) * 0.0058, math.radians(0.5))) for k in range(140)]
    measured = y1.measure(seen(way))
    assert measured["end_offset"] == pytest.approx(0.01)
    assert measured["end_angle"] == pytest.approx(0.5)
    assert measured["overshoot"] == 0.0


def test_who_crosses_the_stand_off_overshoots_and_who_never_gets_there_has_no_end() -> None:
    measured = y1.measure(seen([moment(0.0, Pose(0.0, 1.5)), moment(0.1, Pose(0.1, 0.9))], contacts=(TOUCH,)))
    assert measured["overshoot"] == pytest.approx(0.1)
    assert measured["end_offset"] is None
    assert measured["contacts"] == 1


def settled(name: str, offset: float | None = 0.01, contacts: int = 0) -> Measures:
    return {"case": name, "seed": 0, "end_offset": offset, "end_angle": 0.2, "overshoot": 0.1, "contacts": contacts}


@pytest.mark.parametrize(
    ("some", "judgement"),
    [
        ([settled(y1.NARROW)], "met"),
        ([settled(y1.NARROW, 0.03)], "missed"),
        ([settled(y1.NARROW, None)], "missed"),
        ([settled(y1.NARROW, contacts=1)], "missed"),
        ([settled(y1.NARROW, -0.02)] * 19 + [settled(y1.NARROW, -0.03)], "close"),
    ],
)
def test_every_run_must_end_within_2_cm_and_1_degree(some: list[Measures], judgement: str) -> None:
    assert told(y1.judge("modern", some)) == [(f"start at {y1.NARROW}", judgement)]


def test_the_paper_s_three_starts_must_overshoot_each() -> None:
    every = [settled(name) for name in y1.PRINTED]
    assert told(y1.judge("paper", every))[-1] == ("overshoot of the target", "met")
    short = [{**settled(y1.NARROW), "overshoot": 0.0}, *every[1:]]
    assert y1.judge("paper", short)[-1].because == y1.OVERDAMPED
    assert y1.judge("paper", short)[-1].case == y1.NARROW


def test_the_narrow_start_has_a_small_hull_and_tuned_is_run_with_the_paper_s_only() -> None:
    cases = {case.name: case for case in y1.cases(2)}
    assert ("robot.radius", "0.04") in cases[y1.NARROW].settings
    assert all(
        ("preset" in {change.parameter for change in c.changes}) == name.endswith(y1.TUNED) for name, c in cases.items()
    )
    assert all(case.presets == ("paper",) for name, case in cases.items() if name.endswith(y1.TUNED))


# --- Y2 -----------------------------------------------------------------------------------------------


def went(kind: str, round_: bool, seed: int = 0) -> Measures:
    return {"case": f"{kind}: +0.0 m, 0 deg", "seed": seed, "round": round_, "clearance": 0.4}


def test_round_is_without_a_contact() -> None:
    way = [
        moment(0.1, Pose(0, 0), {"curvature": -2.5}),
        moment(0.2, Pose(0, 0), {"mode": "lost"}),
        moment(0.3, Pose(0, 0)),
    ]
    assert y2.measure(seen(way))["round"] is True
    assert y2.measure(seen(way))["most_curvature"] == 2.5
    assert y2.measure(seen(way, contacts=(TOUCH,)))["round"] is False
    assert y2.measure(seen(way, done=False))["round"] is False


def test_off_none_may_come_round_and_on_at_least_half() -> None:
    good = [
        went(y2.OFF, False),
        went(y2.ON, True),
        went(y2.ON, False, 1),
        went(y2.NEAR_OFF, False),
        went(y2.NEAR_ON, True),
    ]
    assert {judgement for _, judgement in told(y2.judge("paper", good))} == {"met"}
    bad = [went(y2.OFF, True), went(y2.ON, False), went(y2.FITTED, True)]
    assert told(y2.judge("paper", bad)) == [(y2.OFF, "missed"), (y2.ON, "missed"), (y2.FITTED, "met")]


def test_one_run_to_see_is_one_that_explains_the_verdict() -> None:
    (off,) = y2.judge("paper", [went(y2.OFF, False, 0), went(y2.OFF, True, 1)])
    (on,) = y2.judge("paper", [went(y2.ON, True, 0), went(y2.ON, False, 1)])
    assert (off.seed, on.seed) == (1, 1)


def test_with_pivots_all_must_come_round() -> None:
    some = [went(y2.PIVOT, True), went(y2.ROUND, True), went(y2.ROUND, False, 1), went(y2.ON, False)]
    assert told(y2.judge("modern", some)) == [(y2.PIVOT, "met"), (y2.ROUND, "missed")]


# --- Y3 -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("number", range(y3.WALLS))
def test_a_wall_has_seven_bends_and_one_gap(number: int) -> None:
    bent = y3.wall(number)
    headings = [math.atan2(b[1] - a[1], b[0] - a[0]) for a, b in bent.pieces]
    bends = [math.degrees(abs(after - before)) for before, after in itertools.pairwise(headings)]
    assert len([bend for bend in bends if bend > 5]) == y3.BENDS
    assert all(19.9 < bend < 55.1 for bend in bends if bend > 5)
    gaps = [math.dist(before[1], after[0]) for before, after in itertools.pairwise(bent.pieces)]
    assert sorted(round(gap, 2) for gap in gaps)[-2:] == [0.0, y3.GAP]


def test_walls_are_the_same_each_time_and_differ_from_each_other() -> None:
    assert y3.wall(3) == y3.wall(3) != y3.wall(4)


def test_the_nearest_is_from_the_middle_of_the_robot() -> None:
    assert y3.measure(seen([moment(0.1, Pose(0, 0))], clear=0.3))["nearest"] == pytest.approx(0.55)


def along(complete: bool = True, nearest: float = 0.7, kind: str = "bends") -> Measures:
    return {"case": f"{kind}: wall 0", "seed": 0, "complete": complete, "nearest": nearest, "contacts": 0}


def test_all_walls_and_none_nearer_than_half_a_metre() -> None:
    assert told(y3.judge("paper", [along()])) == [("ten walls", "met")]
    assert y3.judge("paper", [along(), along(nearest=0.4)])[0].because == y3.NEAR
    assert y3.judge("paper", [along(), along(complete=False)])[0].because == y3.LOST
    assert told(y3.judge("paper", [along(False, kind=y3.NARROW_BAND)])) == [("ten walls, band of 8 cm", "met")]
    assert y3.judge("modern", [along(kind=y3.TUNED)]) == ()


# --- pictures -----------------------------------------------------------------------------------------

LINE: View = {"kind": "lines", "frame": "robot", "at": [[0.0, -1.0, 2.0, -1.0]]}
POINTS: View = {"kind": "points", "frame": "robot", "at": [[0.0, -1.0], [0.5, -1.0]]}


def run(spike: float, shown: bool = True) -> Seen:
    views = {"wall_points": POINTS, "wall_line": LINE, "invented_points": POINTS} if shown else {}
    return seen(
        [
            moment(
                k / 10,
                Pose(k / 20, 1.0),
                {"offset": 1.0, "angle": 0.1, "curvature": spike if k == 50 else 0.0},
                **views,
            )
            for k in range(150)
        ]
        + [moment(15.0 + k, Pose(7.5, 1.0), {"mode": "lost"}, **views) for k in range(5)]
    )


def test_scans_are_from_round_the_spike_of_the_curvature() -> None:
    times = [one.time for one in courses._snapshots(run(-2.0).moments)]
    assert (times[0], times[-1], len(times)) == (2.0, 9.0, courses.SNAPSHOTS)


def test_without_a_spike_they_are_from_as_long_as_a_wall_was_followed() -> None:
    times = [one.time for one in courses._snapshots(run(0.1).moments)]
    assert (times[0], times[-1]) == (0.0, 15.0)


@pytest.mark.parametrize("some", [run(-2.0), seen([])], ids=["a run", "nothing"])
def test_runs_are_drawn_whatever_was_seen(some: Seen, tmp_path: Path) -> None:
    courses.draw_clouds(some, "a run", tmp_path / "run.png")
    with Image.open(tmp_path / "run.png") as image:
        assert image.width > 1000


def test_a_page_draws_the_courses_of_a_row(tmp_path: Path) -> None:
    name = "0.30 m, 80 deg"
    row = replace(y1.ROW, courses=(name,), plots=(), picture="", cases=lambda _: y1.cases(1)[:2])
    result = report.results([Asked(row, "paper")], [], 1)[0]
    (path,) = [path for path, _ in page._draw_courses(result, tmp_path)]
    assert path.name == "y1-paper-0-30-m-80-deg.png"
    assert path.stat().st_size > 5000
