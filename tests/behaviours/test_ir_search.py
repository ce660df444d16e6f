"""The search for the beacon: the line fit, and sweeps in the stand-in."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from behaviours.cores.crossing import CrossingSettings, crossing
from behaviours.estimators.ir_search import IrSearch, IrSettings
from behaviours.interface import IrReading, wrap

SETTINGS = CrossingSettings()
DEGREE = math.radians(1)


def fixations(beacon, pans, noise=0.0, seed=0):
    chance = np.random.default_rng(seed)
    return [(p * DEGREE, (beacon - p + noise * chance.standard_normal()) * DEGREE) for p in pans]


def test_the_crossing_is_where_the_offset_changes_sign():
    found = crossing(fixations(12.3, range(0, 24, 2)), SETTINGS)
    assert found.bearing == pytest.approx(12.3 * DEGREE) and found.reason == ""


@pytest.mark.parametrize(
    ("pans", "reason"),
    [
        (range(0, 10, 2), "too few readings"),
        (range(13, 40, 2), "no plus-to-minus change"),
        (range(-20, 11, 2), "no plus-to-minus change"),
        (range(9, 40, 2), "no plus-to-minus change"),
    ],
)
def test_without_three_readings_on_either_side_there_is_no_angle(pans, reason):
    assert crossing(fixations(12.3, pans), SETTINGS).reason == reason


def test_offsets_that_do_not_fall_are_no_beacon():
    turned_round = [(p * DEGREE, (p - 12.3) * DEGREE) for p in range(0, 24, 2)]
    assert crossing(turned_round, SETTINGS).reason == "no plus-to-minus change"


def test_readings_that_disagree_give_no_angle():
    rocked = fixations(12.3, range(-20, 44, 2))
    rocked = [(p, o + (6 if i % 2 else -6) * DEGREE) for i, (p, o) in enumerate(rocked)]
    assert crossing(rocked, SETTINGS).reason == "readings disagree"


@given(st.lists(st.tuples(st.floats(-3, 3), st.floats() | st.floats(-0.5, 0.5)), max_size=40))
def test_a_bearing_is_finite_or_there_is_a_reason(heard):
    found = crossing(heard, SETTINGS)
    assert (found.reason == "") == math.isfinite(found.bearing)


@given(st.floats(-60, 60), st.floats(-3, 3))
def test_turning_the_axes_turns_the_bearing(beacon, turn):
    heard = fixations(beacon, [beacon + k for k in range(-15, 17, 2)])
    turned = crossing([(p + turn, o) for p, o in heard], SETTINGS)
    assert turned.bearing - turn == pytest.approx(beacon * DEGREE, abs=1e-9)


# --- sweeps -----------------------------------------------------------------------------------------


def sweep(standin, world, limit=200.0, interrupt_at=None):
    """Sweep once; the estimator, and the world's stamp when the sweep was at its end."""
    robot = standin.Robot("robot", "ir-search")
    search = robot.estimator(IrSearch)
    while world.stamp < limit:
        reading = world.read()
        percepts = robot.sense(reading)
        if percepts["the-ir-search-is-finished"]:
            break
        name = "continue-ir-search" if percepts["ir-search-has-been-started"] else "start-ir-search"
        if interrupt_at is not None and abs(world.stamp - interrupt_at) < 0.01:
            name = "stop"
        world.act(robot.act(reading, name))
    return search, percepts


def beacon(standin, feet, seed, **weather):
    """A robot that looks anywhere, and a beacon somewhere in its front half."""
    chance = np.random.default_rng(seed)
    heading, off = chance.uniform(-3, 3), chance.uniform(-1.0, 1.0)
    away = feet * standin.FOOT
    donor = standin.Disc(away * math.cos(heading + off), away * math.sin(heading + off), 0.25)
    world = standin.World(seed=seed, pose=standin.Pose(0, 0, heading), donor=donor, ir_period=0.1, far=0.4, **weather)
    return world, off


def test_a_beacon_at_24_feet_is_found_within_two_degrees(standin):
    good = 0
    for seed in range(20):
        world, off = beacon(standin, 24, seed)
        search, percepts = sweep(standin, world)
        good += percepts["we-know-the-donor-direction"] and abs(wrap(search.direction.bearing - off)) <= 2 * DEGREE
    assert good >= 19


def test_a_beacon_at_28_feet_is_not_found(standin):
    found = [sweep(standin, beacon(standin, 28, seed)[0])[1]["we-know-the-donor-direction"] for seed in range(20)]
    assert sum(found) <= 1


def test_with_the_sun_behind_it_no_beacon_is_found_and_the_angle_is_no_good(standin):
    for seed in range(5):
        _, percepts = sweep(standin, beacon(standin, 20, seed, sun=True)[0])
        assert percepts["the-returned-angle-is-no-good"] and not percepts["we-know-the-donor-direction"]


def test_in_the_wind_a_sweep_succeeds_within_three_retries(standin):
    tries = []
    for seed in range(6):
        world, off = beacon(standin, 20, seed, wind=1.5 * DEGREE)
        count = 0
        while True:
            count += 1
            search, percepts = sweep(standin, world, limit=world.stamp + 200)
            if percepts["we-know-the-donor-direction"]:
                break
        tries.append(count)
        assert abs(wrap(search.direction.bearing - off)) <= 3 * DEGREE
    assert np.mean(tries) <= 3


def test_a_sweep_that_loses_its_turn_starts_from_scratch(standin):
    world, _ = beacon(standin, 20, 3)
    robot = standin.Robot("robot", "ir-search")
    search = robot.estimator(IrSearch)
    seen = []
    for name in ["start-ir-search", *["continue-ir-search"] * 60, "stop", "stop", "start-ir-search", "stop"]:
        reading = world.read()
        percepts = robot.sense(reading)
        seen.append((percepts["ir-search-has-been-started"], search.progress()["fixation"]))
        world.act(robot.act(reading, name))
    assert seen[0] == (False, 0) and seen[1] == (True, 0)
    assert seen[61][0] and seen[61][1] > 5
    assert not seen[62][0] and not seen[63][0], "interrupted"
    assert seen[64] == (True, 0), "from scratch"


def test_a_reader_that_does_not_answer_ends_the_search(standin):
    world = standin.World(donor=None)
    _, percepts = sweep(standin, world)
    assert percepts["the-returned-angle-is-no-good"] and world.stamp < 60


def test_a_sweep_takes_about_a_hundred_seconds(standin):
    world, _ = beacon(standin, 20, 1)
    world.ir_period = 1.0
    sweep(standin, world)
    assert 90 <= world.stamp <= 120, "91 fixations of a second each, and the head's moves"


# --- why there is no direction ----------------------------------------------------------------------


CAUSES = ["too-few-ir-readings", "no-plus-to-minus-change", "the-ir-readings-disagree", "the-sun-is-suspected"]


def causes(percepts):
    return [name for name in CAUSES if percepts[name]]


def test_nothing_heard_is_too_few_readings_and_no_sun(standin):
    _, percepts = sweep(standin, beacon(standin, 200, 1)[0])
    assert causes(percepts) == ["too-few-ir-readings"]


@pytest.mark.parametrize("feet", [15, 20, 24])
def test_a_faint_swelling_is_suspected_to_be_a_beacon_in_the_sun(standin, feet):
    for seed in range(3):
        _, percepts = sweep(standin, beacon(standin, feet, seed, sun=True)[0])
        assert causes(percepts) == ["too-few-ir-readings", "the-sun-is-suspected"]


def test_a_beacon_at_the_edge_of_the_sweep_does_not_change_from_plus_to_minus(standin):
    away = 15 * standin.FOOT
    donor = standin.Disc(away * math.cos(1.55), away * math.sin(1.55), 0.25)
    world = standin.World(seed=2, donor=donor, ir_period=0.1, far=0.4)
    _, percepts = sweep(standin, world)
    assert causes(percepts) == ["no-plus-to-minus-change"]


def test_a_beacon_that_rocks_too_much_gives_readings_that_disagree(standin):
    _, percepts = sweep(standin, beacon(standin, 20, 0, wind=8 * DEGREE)[0])
    assert causes(percepts) == ["the-ir-readings-disagree"]


def test_a_search_that_succeeds_has_no_cause_of_failure(standin):
    _, percepts = sweep(standin, beacon(standin, 20, 0)[0])
    assert causes(percepts) == []


def test_the_next_search_reports_why_the_last_one_failed(standin):
    world = beacon(standin, 20, 0, sun=True)[0]
    robot = standin.Robot("robot", "ir-search")
    while not robot.sense(reading := world.read())["the-ir-search-is-finished"]:
        running = robot.percepts["ir-search-has-been-started"]()
        world.act(robot.act(reading, "continue-ir-search" if running else "start-ir-search"))
    robot.act(reading, "start-ir-search")
    assert robot.reports["start-ir-search"].details == {"failed": "too few readings", "sun_suspected": True}


# --- a search that listens all round first -------------------------------------------------------------


def listen(standin, off, feet, seed=0):
    """One search with roam; the estimator, the world, and the percepts at its end."""
    away = feet * standin.FOOT
    donor = standin.Disc(away * math.cos(off), away * math.sin(off), 0.25)
    world = standin.World(seed=seed, donor=donor, ir_period=0.2, far=0.4)
    robot = standin.Robot("robot", "ir-search", ir_search={"preset": "modern"})
    while world.stamp < 200 and not robot.sense(reading := world.read())["the-ir-search-is-finished"]:
        running = robot.percepts["ir-search-has-been-started"]()
        world.act(robot.act(reading, "continue-ir-search" if running else "start-ir-search"))
    return robot.estimator(IrSearch), world, robot


@pytest.mark.parametrize("off", [0.0, 1.2, -2.0, 3.1])
def test_a_search_with_roam_turns_to_a_beacon_on_any_side(standin, off):
    search, world, _ = listen(standin, off, 22)
    assert wrap(search.direction.bearing - off) == pytest.approx(0.0, abs=2 * DEGREE)
    assert abs(wrap(world.pose.theta - off)) < 5 * DEGREE
    assert math.hypot(world.pose.x, world.pose.y) < 0.01


def test_the_strength_of_the_signal_tells_how_far_the_beacon_is(standin):
    for feet in (10, 18, 23):
        search, _, _ = listen(standin, 0.5, feet)
        assert search.direction.reach == pytest.approx(feet * standin.FOOT, rel=0.05)


def test_a_circle_in_which_nothing_is_heard_is_enough_to_fail(standin):
    search, world, robot = listen(standin, 0.5, 40)
    assert robot.percepts["too-few-ir-readings"]()
    assert search.progress()["of"] == 24 and world.stamp < 30


def test_a_beacon_that_is_not_wanted_is_not_turned_to(standin):
    search = IrSearch(IrSettings(roam=True))
    search.wants = lambda name: name != "served"
    heard = IrReading(0.0, True, 0.0, True, 0.1, 5.0, "served")
    assert not search._counts(heard)
    assert search._counts(IrReading(0.0, True, 0.0, True, 0.1, 5.0, "other"))
