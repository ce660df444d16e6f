"""What rows measure of hand-made runs, and how they judge."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import pytest

from behaviours.cores.ground import GroundSettings, pans
from behaviours.interface import STOP, Command, Head, Odometry, Pose, Reading, Report
from rplan.apps.reproduce import figures
from rplan.apps.reproduce.row import Finding, Measures, Moment, Seen
from rplan.apps.reproduce.rows import b1, b2, b3, b4, b5, b6, b7, b8
from rplan.apps.reproduce.watch import FLEEING, NAVIGATE, episodes_of, share_in_motion, starts_of
from sim.judge import Times, Verdict
from sim.world import Touch

NAVIGATION = f"({NAVIGATE})"


def moment(
    time: float,
    action: str = NAVIGATION,
    *,
    pose: Pose = Pose(0.0, 0.0),  # noqa: B008
    speed: float = 0.2,
    command: Command = STOP,
    details: Mapping[str, object] | None = None,
    movers: Mapping[str, Pose] | None = None,
    percepts: Mapping[str, bool] | None = None,
) -> Moment:
    reading = Reading(time, 0, Odometry(pose, speed, 0.0))
    reports = {} if details is None else {NAVIGATE: Report(details=details)}
    return Moment(time, pose, speed, action, reading, command, percepts or {}, reports, movers or {}, {})


def seen(
    moments: Sequence[Moment],
    *,
    done: bool = True,
    times: Times = Times(),  # noqa: B008
    contacts: tuple[Touch, ...] = (),
) -> Seen:
    verdict = Verdict("fetch", done, "", "done", times, moments[-1].time if moments else 0.0, 1.0, contacts, 0.3)
    return Seen(verdict, 0.1, moments)


def told(findings: Sequence[Finding]) -> list[tuple[str, str, bool]]:
    """What was judged, how, and whether a reason is given: one is exactly where it is not met."""
    assert all(bool(f.because) == (f.judgement != "met") for f in findings)
    return [(f.what, f.judgement, bool(f.because)) for f in findings]


# --- figures ------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("value", "judgement"),
    [(10.0, "met"), (12.0, "met"), (12.5, "close"), (9.1, "close"), (8.9, "missed"), (None, "missed")],
)
def test_a_figure_within_a_tenth_of_a_bound_is_close(value: float | None, judgement: str) -> None:
    assert figures.judged(value, 10.0, 12.0) == judgement


@pytest.mark.parametrize(
    ("met", "of", "judgement"), [(19, 20, "met"), (18, 20, "close"), (16, 20, "missed"), (0, 0, "missed")]
)
def test_a_share_within_a_tenth_of_all_is_close(met: int, of: int, judgement: str) -> None:
    assert figures.judged_share(met, of, 0.95) == judgement


def test_a_spread_is_the_median_and_the_range_of_what_is_there() -> None:
    some: list[Measures] = [{"t": 60.0}, {"t": None}, {"t": 180.0}, {"t": 120.0}]
    assert figures.spread(some, "t", "min", 1 / 60, 1) == "2.0 min (1.0 to 3.0, n = 3)"
    assert figures.spread([], "t", "s") == "never"


def test_the_typical_episode_is_the_one_in_the_middle() -> None:
    some: list[Measures] = [{"t": 3.0, "seed": 0}, {"t": 1.0, "seed": 1}, {"t": 2.0, "seed": 2}, {"seed": 3}]
    assert figures.seed_of(figures.typical(some, "t")) == 2
    assert figures.seed_of(figures.greatest(some, "t")) == 0
    assert figures.typical([], "t") is None and figures.case_of(None) == ""


def test_the_worst_judgement_counts() -> None:
    assert figures.worst(["met", "missed", "close"]) == "missed"
    assert figures.worst([]) == "met"


# --- watching -----------------------------------------------------------------------------------------


def test_short_breaks_do_not_part_an_episode() -> None:
    moments = [moment(k / 10, FLEEING if k in (1, 2, 4, 9) else NAVIGATION) for k in range(10)]
    assert episodes_of(moments, FLEEING) == [(0.1, 0.2), (0.4, 0.4), (0.9, 0.9)]
    assert episodes_of(moments, FLEEING, apart=0.25) == [(0.1, 0.4), (0.9, 0.9)]
    assert starts_of(moments, "move-away-from-danger") == [0.1, 0.4, 0.9]


def test_motion_is_the_share_of_ticks_faster_than_a_centimetre_a_second() -> None:
    assert share_in_motion([moment(0.0), moment(0.1, speed=0.005), moment(0.2, speed=-0.1)]) == pytest.approx(2 / 3)
    assert share_in_motion([]) == 0.0


# --- B1, B2 -------------------------------------------------------------------------------------------


def times(departure: float, arrival: float, home: float) -> Times:
    return Times(departure, arrival, arrival + 15.0, home)


def test_b1_measures_the_way_and_the_round_trip() -> None:
    measured = b1.measure(seen([moment(0.0)], times=times(400.0, 490.0, 620.0)))
    assert (measured["one_way"], measured["round_trip"], measured["done"]) == (90.0, 220.0, True)


def trips(*seconds: float, one_way: float = 100.0) -> list[Measures]:
    return [
        {"case": "4 obstacles", "seed": k, "done": True, "driven_into": 0, "one_way": one_way, "round_trip": s}
        for k, s in enumerate(seconds)
    ]


def test_b1_is_met_by_its_median_close_with_a_long_run_and_missed_when_slow() -> None:
    assert told(b1.judge("paper", trips(200.0, 240.0, 280.0)))[0][1] == "met"
    assert told(b1.judge("paper", trips(200.0, 240.0, 380.0)))[0][1] == "close"
    assert told(b1.judge("paper", trips(400.0, 440.0, one_way=200.0)))[0:2] == [
        ("round trip", "missed", True), ("one way", "missed", True),
    ]  # fmt: skip


def test_b1_names_an_episode_that_came_to_grief() -> None:
    some = trips(200.0, 240.0, 280.0)
    some[2]["driven_into"] = 1
    found = b1.judge("paper", some)[2]
    assert (found.ours, found.judgement, found.seed) == ("2 of 3", "missed", 2)


def test_b2_measures_the_task_and_counts_searches() -> None:
    moments = [moment(0.0, "(start-ir-search)"), moment(0.1, FLEEING), moment(0.2, "(start-ir-search)")]
    measured = b2.measure(seen(moments, times=times(400.0, 490.0, 660.0)))
    assert (measured["total"], measured["search"], measured["ir_searches"], measured["stereo_searches"]) == (
        660.0,
        400.0,
        2,
        0,
    )


def test_b2_judges_quiet_and_interrupted_runs_apart() -> None:
    some: list[Measures] = [
        {"case": b2.UNDISTURBED, "seed": 0, "total": 560.0, "search": 420.0},
        {"case": b2.INTERRUPTED, "seed": 1, "total": 700.0, "search": 500.0},
    ]
    assert [judgement for _, judgement, _ in told(b2.judge("paper", some))] == ["close", "met", "met"]


def test_b2_shares_the_seeds_and_only_one_half_is_interrupted() -> None:
    quiet, loud = b2.cases(5)
    assert (quiet.seeds, loud.seeds) == ((0, 2, 4), (1, 3))
    assert quiet.settings and not loud.settings


# --- B3 -----------------------------------------------------------------------------------------------

CAR = Pose(0.0, 3.0, math.pi)


def plan(*spins: str, at: tuple[float, float] = (0.0, 2.5)) -> dict[str, object]:
    """One circle near the car in the last group, one elsewhere in the first."""
    circles = [[4.0, 0.0, 0.2, 0], [at[0], at[1], 0.2, len(spins) - 1], [9.0, 9.0, 0.2, -1]]
    return {"circles": circles, "groups": [{"spin": spin} for spin in spins]}


def test_b3_follows_the_spin_of_the_group_that_holds_the_car() -> None:
    moments = [
        moment(0.0, movers={"car": CAR}, details=plan("ccw", "cw")),
        moment(0.1, movers={"car": CAR}, details=plan("ccw", "ccw")),
        moment(0.2, movers={"car": CAR}, details=plan("cw", "cw", at=(9.0, 0.0))),
        moment(0.3, movers={}, details=plan("cw", "cw")),
        moment(0.4, movers={"car": CAR}),
    ]
    assert list(b3.spins_of_car(moments)) == ["cw", "ccw"]
    measured = b3.measure(seen(moments))
    assert (measured["first_spin"], measured["flips"], measured["in_motion"], measured["behind"]) == (
        "cw",
        1,
        1.0,
        None,
    )


def test_b3_places_circles_by_the_true_pose_whatever_odometry_believes() -> None:
    here = moment(0.0, pose=Pose(1.0, 2.0, math.pi / 2))
    believed = replace(here, reading=Reading(0.0, 0, Odometry(Pose(0.0, 0.0), 0.0, 0.0)))
    place = b3.in_world(believed, 1.0, 0.0)
    assert (place.x, place.y) == pytest.approx((1.0, 3.0))


@pytest.mark.parametrize(("car_x", "behind"), [(-3.0, True), (3.0, False)])
def test_b3_passes_behind_where_the_car_had_passed_when_its_line_was_crossed(car_x: float, behind: bool) -> None:
    car = Pose(car_x, 3.0, math.pi)
    moments = [
        moment(t, pose=Pose(0.0, y), movers={"car": car} if t else {}) for t, y in ((0, 2.0), (1, 2.9), (2, 3.1))
    ]
    assert b3.passes_behind(moments) is behind
    assert b3.passes_behind(moments[:2]) is None


def test_b3_looks_no_further_than_the_first_contact() -> None:
    moments = [moment(0.0, speed=0.2), moment(1.0, speed=0.0), moment(2.0, speed=0.0)]
    measured = b3.measure(seen(moments, contacts=(Touch("car", 0.5, False),)))
    assert (measured["contacts"], measured["driven_into"], measured["in_motion"], measured["behind"]) == (
        1,
        0,
        1.0,
        None,
    )
    assert measured["first_spin"] is None


def crossings(contacts: int, own: int, /, **figure: bool | float) -> list[Measures]:
    good: Measures = {
        "first_spin": "cw",
        "flips": 1,
        "behind": True,
        "in_motion": 0.95,
        "contacts": 0,
        "driven_into": 0,
    }
    of_figure: Measures = {**good, **figure, "case": "Figure 2: 1 m/s", "seed": 0}
    matrix: list[Measures] = [
        {**good, "contacts": k < contacts, "driven_into": k < own, "case": f"crossing: {k}", "seed": 0}
        for k in range(64)
    ]
    return [of_figure, *matrix]


def test_b3_allows_the_car_to_strike_the_robot_but_not_the_other_way_round() -> None:
    assert [j for _, j, _ in told(b3.judge("paper", crossings(30, 0)))] == ["met"] * 5
    assert [j for _, j, _ in told(b3.judge("paper", crossings(30, 2)))] == ["met"] * 4 + ["missed"]
    assert [j for _, j, _ in told(b3.judge("modern", crossings(4, 0)))] == ["met"] * 5
    assert told(b3.judge("modern", crossings(5, 0)))[-1] == ("64 crossings", "missed", True)


def test_b3_misses_what_dithers_stops_or_passes_in_front() -> None:
    some = crossings(0, 0, flips=3, behind=False, in_motion=0.5)
    assert [j for _, j, _ in told(b3.judge("paper", some))] == ["missed", "missed", "missed", "met", "met"]
    touched = crossings(0, 0, contacts=1, driven_into=1)
    assert [j for _, j, _ in told(b3.judge("paper", touched))] == ["missed", "missed", "missed", "missed", "met"]


def test_b3_makes_the_car_cross_when_it_is_told_to() -> None:
    key, frames = b3.crossing(1.0, 16.0)
    assert key == "things[0].keyframes"
    assert frames.startswith("[[0.0, 13.079, 0.454], [2.0, 13.079, 0.454], [3600.0,")
    assert b3.crossing(0.6, 10.0)[1].count("[") == 3, "it is on its way from the first moment on"


# --- B4, B5 -------------------------------------------------------------------------------------------


def test_b4_counts_circles_and_how_often_their_memory_is_full() -> None:
    full, half = {"circles": [[0, 0, 0, 0]] * 10, "groups": []}, {"circles": [[0, 0, 0, 0]] * 5, "groups": []}
    measured = b4.measure(
        seen([moment(0.0, details=full), moment(0.1, details=half), moment(0.2)], times=Times(0.0, 70.0))
    )
    assert (measured["most_circles"], measured["full"], measured["time"]) == (10, 0.5, 70.0)
    assert b4.measure(seen([moment(0.0)]))["full"] == 0.0


def canyon(size: str, out: int) -> list[Measures]:
    return [
        {"case": size, "seed": k, "reached": k < out, "time": 100.0 if k < out else None, "most_circles": 10}
        for k in range(20)
    ]


@pytest.mark.parametrize(
    ("preset", "size", "out", "judgement"),
    [
        ("paper", "3x2", 20, "met"), ("paper", "3x2", 3, "missed"), ("paper", "4x3", 0, "met"),
        ("paper", "4x3", 2, "close"), ("paper", "5x4", 20, "missed"), ("modern", "4x3", 19, "met"),
        ("modern", "6x5", 10, "missed"),
    ],
)  # fmt: skip
def test_b4_wants_the_paper_to_be_trapped_and_modern_to_get_out(
    preset: str, size: str, out: int, judgement: str
) -> None:
    assert told(b4.judge("paper" if preset == "paper" else "modern", canyon(size, out)))[0][1] == judgement


def test_b5_counts_runaways_and_wants_the_donor_afterwards() -> None:
    moments = [moment(k / 10, FLEEING if 20 <= k < 40 else NAVIGATION) for k in range(100)]
    measured = b5.measure(seen(moments, times=Times(0.0, 9.0)))
    assert (measured["runaways"], measured["reached"]) == (1, True)
    assert measured["longest"] == pytest.approx(2.0)
    assert b5.measure(seen(moments, times=Times(0.0, 1.0)))["reached"] is False
    assert b5.measure(seen([moment(0.0)]))["runaways"] == 0


def test_b5_is_met_by_one_runaway_each() -> None:
    fine: Measures = {
        "case": "from the right",
        "seed": 0,
        "runaways": 1,
        "reached": True,
        "driven_into": 0,
        "longest": 1.8,
    }
    assert told(b5.judge("paper", [fine] * 4))[0][1] == "met"
    found = b5.judge("paper", [{**fine, "runaways": 3, "seed": 7}] * 4)[0]
    assert (found.judgement, found.seed) == ("missed", 7)
    assert found.ours.startswith("0 of 4 (runaways: 3×: 4")
    assert [case.seeds for case in b5.cases(6)] == [(0, 4), (1, 5), (2,), (3,)]


# --- B6, B7, B8 ---------------------------------------------------------------------------------------


def search(*sweeps: float, found: float | None, donor: Mapping[str, Pose], head: Head | None = None) -> Seen:
    moments = [moment(t, "(start-ir-search)") for t in sweeps]
    if found is not None:
        moments.append(moment(found, "(start-stereo-ranging)", movers=donor, command=Command(head=head)))
    return seen(moments)


def test_b6_measures_how_far_the_stereo_search_looks_past_the_donor() -> None:
    offset = pans(GroundSettings())[0]
    looks = Head(math.radians(31.0) + offset, 0.3)
    donor = {"donor": Pose(5.0 * math.cos(math.radians(30)), 5.0 * math.sin(math.radians(30)))}
    measured = b6.measure(search(0.0, found=90.0, donor=donor, head=looks))
    assert (measured["found_at_once"], measured["sweeps"]) == (True, 1)
    assert measured["error_deg"] == pytest.approx(1.0)
    assert b6.measure(search(0.0, found=90.0, donor={}))["error_deg"] is None


def test_b6_counts_sweeps_and_says_where_none_found_it() -> None:
    nowhere: dict[str, Pose] = {}
    retried = seen(
        [
            moment(0.0, "(start-ir-search)"),
            moment(1.0),
            moment(90.0, "(start-ir-search)"),
            moment(180.0, "(start-stereo-ranging)"),
        ]
    )
    measured = b6.measure(retried)
    assert (measured["found"], measured["found_at_once"], measured["sweeps"]) == (True, False, 2)
    assert b6.measure(search(0.0, found=None, donor=nowhere))["found"] is False


def beacon(case: str, found: int, error: float = 0.5, sweeps: int = 1) -> list[Measures]:
    return [
        {
            "case": case, "seed": k, "found": k < found, "found_at_once": k < found,
            "sweeps": sweeps if k < found else None, "error_deg": error if k < found else None,
        }
        for k in range(20)
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("some", "judgement"),
    [
        (beacon(b6.NEAR, 20), "met"), (beacon(b6.NEAR, 20, error=3.0), "missed"), (beacon(b6.FAR, 1), "met"),
        (beacon(b6.FAR, 20), "missed"), (beacon(b6.SUN, 2), "met"), (beacon(b6.SUN, 10), "missed"),
        (beacon(b6.BLOCKED, 18), "met"), (beacon(b6.BLOCKED, 5), "missed"), (beacon(b6.WIND, 20, sweeps=3), "met"),
        (beacon(b6.WIND, 20, sweeps=9), "missed"), (beacon(b6.WIND, 0), "missed"),
    ],
)  # fmt: skip
def test_b6_judges_each_weather_by_its_own_share(some: list[Measures], judgement: str) -> None:
    assert [j for _, j, _ in told(b6.judge("paper", some))] == [judgement]


def walking(knows_until: float, sweep: float | None) -> list[Moment]:
    """The donor walks from 1.0 s to 2.0 s."""
    moments = []
    for k in range(100):
        t = k / 10
        known = t < knows_until
        action = "(start-ir-search)" if t == sweep else "(start-stereo-ranging)" if t == 9.0 else NAVIGATION
        place = Pose(5.0, min(1.0, max(0.0, t - 1.0)))
        moments.append(moment(t, action, movers={"donor": place}, percepts={b7.STARTED: known, b7.LOCATED: known}))
    return moments


def test_b7_times_the_restart_from_when_the_donor_stands_again() -> None:
    measured = b7.measure(seen(walking(3.0, 3.5)))
    assert measured["restarted_after"] == pytest.approx(1.5)
    assert measured["stereo_again"] is True
    assert b7.measure(seen(walking(1.2, 1.5)))["restarted_after"] == 0.0, "while it still walks"


def test_b7_says_where_nothing_was_restarted() -> None:
    assert b7.measure(seen(walking(99.0, None)))["restarted_after"] is None
    still = [moment(t / 10, movers={"donor": Pose(5.0, 0.0)}) for t in range(5)]
    measured = b7.measure(seen([*still, moment(0.5)]))
    assert (measured["moved"], measured["restarted_after"]) == (False, None)


def test_b7_wants_both_searches_soon_and_the_object_all_the_same() -> None:
    fine: Measures = {"case": b7.CASE, "seed": 0, "restarted_after": 1.0, "stereo_again": True, "done": True}
    assert [j for _, j, _ in told(b7.judge("paper", [fine] * 3))] == ["met", "met"]
    late: Measures = {**fine, "restarted_after": 8.0, "done": False}
    assert [j for _, j, _ in told(b7.judge("paper", [late]))] == ["missed", "missed"]
    assert b7.judge("paper", [{**fine, "restarted_after": None}])[0].seed == 0


def test_b8_counts_the_ways_of_the_text(monkeypatch: pytest.MonkeyPatch) -> None:
    assert b8.cases(20) == () and b8.measure(seen([])) == {}
    assert told(b8.judge("paper", [])) == [("ways", "met", False)]
    monkeypatch.setattr(b8, "WAYS", 64)
    assert told(b8.judge("paper", [])) == [("ways", "missed", True)]


def test_b3_counts_circles_that_the_car_has_left_behind_while_they_are_remembered() -> None:
    gone = Pose(-9.0, 3.0, math.pi)
    moments = [
        moment(0.0, movers={"car": CAR}, details=plan("ccw", "cw")),
        moment(1.5, movers={"car": gone}, details=plan("ccw", "ccw")),
        moment(3.0, movers={"car": gone}, details=plan("ccw", "cw")),
    ]
    assert list(b3.spins_of_car(moments)) == ["cw", "ccw"]
