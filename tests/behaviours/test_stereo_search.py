"""The search along the ground: where to look, what to believe, what to report."""

import itertools
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from behaviours.cores.ground import GroundSettings, ground_points, off_the_ground, pans, sigma, tilt
from behaviours.estimators.stereo_search import StereoSearch, StereoSettings
from behaviours.interface import Odometry, Pose, Reading, Report, StereoReading

SETTINGS = GroundSettings()


def test_the_search_starts_at_six_feet_and_goes_beyond_the_cut_off():
    points = ground_points(1.2, SETTINGS)
    assert points[0] == pytest.approx(6 * 0.3048)
    assert points[-1] > 25 * 0.3048


@given(st.floats(0.5, 2.0), st.floats(0.05, 0.4))
def test_each_ray_still_cuts_an_object_that_the_ray_before_just_missed(height, least):
    settings = GroundSettings(object_height=least)
    points = ground_points(height, settings)
    for near, far in itertools.pairwise(points):
        assert height * (1 - near / far) <= least + 1e-9


def test_the_pans_cover_two_degrees_to_either_side_and_begin_in_the_middle():
    offsets = [math.degrees(p) for p in pans(SETTINGS)]
    assert sorted(offsets) == pytest.approx([-2, -2 / 3, 2 / 3, 2])
    assert abs(offsets[0]) == pytest.approx(2 / 3)


@given(st.floats(1.8, 9.5), st.floats(-0.99, 0.99))
def test_accountable_errors_are_ground(ground, share):
    down = tilt(1.2, ground)
    slant = 1.2 / math.sin(down)
    assert not off_the_ground(slant + share * 3 * sigma(slant, SETTINGS), 1.2, down, SETTINGS)
    assert off_the_ground(slant - 3.01 * sigma(slant, SETTINGS), 1.2, down, SETTINGS)


def test_a_range_that_failed_is_no_discontinuity():
    assert not off_the_ground(math.nan, 1.2, 0.3, SETTINGS)


def test_something_just_before_the_cut_off_can_be_told_from_the_ground():
    front, last = 25 * 0.3048, ground_points(1.2, SETTINGS)[-1]
    down = tilt(1.2, last)
    assert off_the_ground(front / math.cos(down), 1.2, down, SETTINGS)


# --- searches ---------------------------------------------------------------------------------------


def search(standin, world, limit=600.0, **settings):
    """One search straight ahead; the estimator and the percepts at its end."""
    robot = standin.Robot("robot", "stereo-search", stereo_search=settings)
    while world.stamp < limit:
        reading = world.read()
        percepts = robot.sense(reading)
        if percepts["a-range-value-has-been-returned"]:
            break
        started = percepts["stereo-ranging-is-started"]
        world.act(robot.act(reading, "continue-stereo-search" if started else "start-stereo-ranging"))
    return robot.estimator(StereoSearch), percepts


def ahead(standin, front, seed=0, period=0.2, **kinds):
    things = [standin.Disc(front + 0.25, 0.0, 0.25, 0.8)]
    return standin.World(seed=seed, donor=things[0], stereo_period=period, far=0.4, **kinds)


@pytest.mark.parametrize("feet", [10, 15, 20, 23])
def test_the_range_of_a_donor_is_within_thirty_centimetres(standin, feet):
    front = feet * standin.FOOT
    for seed in range(6):
        found, percepts = search(standin, ahead(standin, front, seed))
        assert not percepts["the-range-value-is-no-good"]
        assert abs(found.found.ground - front) <= 0.3


def test_a_donor_whose_middle_is_at_25_feet_is_found(standin):
    for seed in range(10):
        found, percepts = search(standin, ahead(standin, 25 * standin.FOOT - 0.25, seed))
        assert not percepts["the-range-value-is-no-good"], found.reason


@pytest.mark.parametrize(("feet", "reason"), [(27, "beyond the cut-off"), (40, "nothing stands there")])
def test_a_donor_beyond_the_cut_off_gives_the_error_flag(standin, feet, reason):
    for seed in range(5):
        found, percepts = search(standin, ahead(standin, feet * standin.FOOT, seed))
        assert percepts["the-range-value-is-no-good"] and found.reason == reason


def test_an_obstacle_between_returns_its_own_range(standin):
    world = ahead(standin, 6.0)
    world.discs.append(standin.Disc(4.3, 0.0, 0.3))
    found, _ = search(standin, world)
    assert found.found.ground == pytest.approx(4.0, abs=0.3), "the limitation that the paper states"


def test_what_only_passes_by_is_not_believed(standin):
    world = ahead(standin, 6.0, period=9.0)
    world.discs.append(standin.Disc(1.5, 4.5, 0.4, vy=-0.5))
    found, _ = search(standin, world)
    assert found.found.ground == pytest.approx(6.0, abs=0.3)


def test_a_single_look_would_have_believed_it(standin):
    world = ahead(standin, 6.0, period=9.0)
    world.discs.append(standin.Disc(1.5, 4.5, 0.4, vy=-0.5))
    found, _ = search(standin, world, looks=1)
    assert found.found.ground == pytest.approx(1.1, abs=0.3)


def test_an_interrupted_search_restarts_from_six_feet(standin):
    world = ahead(standin, 6.0)
    robot = standin.Robot("robot", "stereo-search")
    estimator, tilts = robot.estimator(StereoSearch), []
    for tick in range(80):
        reading = world.read()
        percepts = robot.sense(reading)
        started = percepts["stereo-ranging-is-started"]
        name = "continue-stereo-search" if started else "start-stereo-ranging"
        command = robot.act(reading, "stop" if tick == 60 else name)
        tilts.append(None if command.head is None else 1.2 / math.tan(command.head.tilt))
        world.act(command)
        if tick == 61:
            assert not started and estimator.progress()["fixation"] > 0
        if tick == 62:
            assert estimator.progress()["fixation"] == 0, "nothing is saved"
    assert tilts[59] > 3.0
    assert tilts[61] == pytest.approx(6 * 0.3048)


def test_a_head_that_sticks_is_freed_or_the_search_asks_for_help(standin):
    world = ahead(standin, 6.0, stuck=True)
    world.head = world.wanted = (0.3, 0.6)
    found, percepts = search(standin, world)
    assert percepts["the-range-value-is-no-good"] and "tap" in found.reason
    assert found.progress()["unsticks"] == 4


def test_a_search_of_nine_seconds_a_look_takes_about_five_minutes(standin):
    world = ahead(standin, 25 * standin.FOOT - 0.25, period=9.0)
    search(standin, world)
    assert 240 <= world.stamp <= 330


# --- from the horizon down --------------------------------------------------------------------------


class Over:
    """A stand-in for the searches alone: a low box before a donor, at rest, without noise. Lengths [m]."""

    def __init__(self, *things, reach=math.nan, **settings):
        self.things, self.stamp = things, 0.0
        self.search = StereoSearch(StereoSettings(**settings), lambda: 0.0, lambda: reach)

    def slant(self, head):
        """To the first of (distance, height) that the ray is not above, or to the ground."""
        falls = math.tan(head.tilt)
        met = [away for away, height in self.things if 1.2 - falls * away < height]
        return min([1.2 / falls, *met]) / math.cos(head.tilt)

    def run(self, limit=400):
        reports = {"start-stereo-ranging": Report()}
        for _ in range(limit):
            self.stamp += 9.0
            here = reading(self.stamp)
            look = self.search.look(here) if self.search.is_started() else self.search.first_look(here)
            stereo = StereoReading(self.stamp, True, look.pan, look.tilt, self.slant(look), 1.2)
            self.search.update(reading(self.stamp, stereo), reports, {})
            reports = {"continue-stereo-search": Report()}
            if self.search.is_finished():
                return self.search
        raise AssertionError("no end")


def reading(stamp, stereo=None):
    return Reading(stamp, 0, Odometry(Pose(0.0, 0.0), 0.0, 0.0), stereo=stereo)


LOW_BOX, DONOR = (3.0, 0.5), (5.8, 0.9)


def test_near_to_far_finds_the_box_before_the_donor():
    assert Over(LOW_BOX, DONOR).run().found.ground == pytest.approx(3.0, abs=0.1)


def test_from_the_horizon_finds_the_donor_behind_the_box():
    search = Over(LOW_BOX, DONOR, reach=6.05, from_horizon=True).run()
    assert search.found.ground == pytest.approx(5.8, abs=0.1)


def test_what_does_not_fit_the_strength_of_the_beacon_is_passed_over():
    wall = (8.5, 2.0)
    assert Over(wall, from_horizon=True, reach=6.05).run().found is None
    search = Over((3.2, 0.9), wall, from_horizon=True, reach=3.45).run()
    assert search.found.ground == pytest.approx(3.2, abs=0.1)


def test_without_a_strength_the_farthest_within_the_cut_off_is_taken():
    assert Over(LOW_BOX, DONOR, from_horizon=True).run().found.ground == pytest.approx(5.8, abs=0.1)


def test_the_range_comes_with_its_error_envelope():
    search = Over(DONOR).run()
    assert 0.2 < search.envelope() < 0.6
    assert search.range_found() == search.found.ground


def test_a_head_that_is_lifted_in_vain_is_sent_home():
    search = Over(DONOR, fixation_timeout=5.0).search
    search.update(reading(0.0), {"start-stereo-ranging": Report()}, {})
    looks, stamp = [], 0.0
    while not search.is_finished():
        stamp += 1.0
        search.update(reading(stamp), {"continue-stereo-search": Report()}, {})
        look = search.look(reading(stamp))
        looks.append((look.pan == 0.0, look.tilt == 0.0, search.needs_help()))
    lifted, homed = looks.index((False, True, False)), looks.index((True, True, False))
    asked = looks.index((True, True, True))
    assert lifted < homed < asked
    assert search.is_no_good() and "tap" in search.reason
