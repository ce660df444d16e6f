"""The tally of orientations and the law of the perimeter, with a test for each misprint and gap of the paper."""

import math

import numpy as np
import pytest

from behaviours.cores.hough import Line
from behaviours.cores.orientation import (
    BIN,
    BINS,
    FollowSettings,
    Tracked,
    along,
    bin_of,
    correction,
    no_votes,
    tallied,
    tracked,
    wanted_heading,
)
from behaviours.interface import wrap

SETTINGS = FollowSettings()


def left(orientation, votes=50, rho=1.5):
    """A wall to the left whose direction along it is `orientation` [rad] from the robot's heading."""
    return Line(wrap(orientation + math.pi / 2), rho, votes)


def after(scans, heading=0.0, settings=SETTINGS):
    tally = no_votes()
    for lines in scans:
        tally = tallied(tally, lines, heading, settings)
    return tally


@pytest.mark.parametrize("k", range(BINS))
def test_a_line_on_the_edge_of_a_bin_votes_in_the_bin_that_begins_there(k):
    tally = after([[left(0.0)]], heading=wrap(math.radians(5.0 * k)))
    assert int(tally.argmax()) == k and tally.sum() == pytest.approx(10.0)


def test_a_bin_excludes_its_upper_edge():
    assert bin_of(BIN - 1e-6) == 0 and bin_of(BIN) == 1 and bin_of(-1e-6) == BINS - 1


@pytest.mark.parametrize(
    ("off", "turned"), [(0.0, 0.0), (0.5, 11.25), (1.0, 22.5), (2.0, 45.0), (2.5, 45.0), (-1.0, -22.5), (-1.5, -33.75)]
)
def test_the_correction_is_pi_eighths_a_metre_up_to_forty_five_degrees(off, turned):
    assert math.degrees(correction(1.5 + off, SETTINGS)) == pytest.approx(turned)


def test_the_correction_is_clamped_away_from_the_wall_too():
    assert math.degrees(correction(0.5, FollowSettings(stand_off=3.0))) == pytest.approx(-45.0)


def test_the_two_walls_of_an_alley_lead_in_opposite_directions():
    assert along(Line(math.pi / 2, 1.5, 50)) == 0.0
    assert abs(along(Line(-math.pi / 2, 1.5, 50))) == math.pi
    everything = FollowSettings(backwards=math.pi)
    tally = after([[Line(math.pi / 2, 1.5, 50), Line(-math.pi / 2, 1.5, 50)]], settings=everything)
    assert np.flatnonzero(tally).tolist() == [0, BINS // 2]


def test_a_line_that_leads_back_does_not_vote_and_is_not_followed():
    back = Line(-math.pi / 2, 1.2, 90)
    assert after([[back]]).sum() == 0.0
    tally = after([[left(0.0)]])
    turned = tracked(tally, [back], math.pi, SETTINGS)
    assert turned is not None and turned.line is None
    assert after([[left(math.radians(134))]]).sum() > 0 and after([[left(math.radians(136))]]).sum() == 0


def test_steering_takes_the_line_and_not_the_middle_of_its_bin():
    wall = tracked(after([[left(0.0)]]), [left(0.0)], 0.0, SETTINGS)
    assert wall is not None and wanted_heading(wall, SETTINGS) == pytest.approx(0.0, abs=1e-12)
    beside = BIN / 2 / SETTINGS.gain
    assert beside == pytest.approx(0.111, abs=1e-3)  # [m] where the middle of the bin would hold the robot


@pytest.mark.parametrize(("decay", "scans"), [(0.05, 14), (0.2, 4)])
def test_a_new_wall_of_equal_strength_takes_over_after_so_many_scans(decay, scans):
    settings = FollowSettings(decay=decay)
    tally = after([[left(0.0)]] * 400, settings=settings)
    scan = 0
    while int(tally.argmax()) == 0:
        tally, scan = tallied(tally, [left(-math.pi / 2)], 0.0, settings), scan + 1
    assert scan == math.ceil(math.log(2) / -math.log(1 - decay)) == scans


def test_the_strongest_line_of_the_bin_and_its_neighbours_is_taken():
    tally = after([[left(math.radians(2))]])
    lines = [left(math.radians(8), 30), left(math.radians(-4), 40), left(math.radians(12), 90)]
    wall = tracked(tally, lines, 0.0, SETTINGS)
    assert wall is not None and wall.line == lines[1]


def test_neighbours_go_round_the_circle():
    tally = after([[left(math.radians(358 - 360))]])
    wall = tracked(tally, [left(math.radians(3))], 0.0, SETTINGS)
    assert wall is not None and wall.line is not None


def test_without_a_line_the_middle_of_the_bin_and_the_stand_off_stand_in():
    wall = tracked(after([[left(0.0)]]), [], 0.0, SETTINGS)
    assert wall == Tracked(BIN / 2, 1.5, None)


def test_before_any_line_there_is_no_wall():
    assert tracked(no_votes(), [], 0.0, SETTINGS) is None


def test_a_turning_robot_votes_for_one_orientation_in_the_world():
    tally = no_votes()
    for degrees in range(0, 90, 6):
        heading = math.radians(degrees)
        tally = tallied(tally, [left(math.radians(7) - heading)], heading, SETTINGS)
    assert np.flatnonzero(tally).tolist() == [1]


def test_the_closed_form_of_the_approach_is_kept():
    """e' = -v sin(k e): from 1 m to 5 cm takes 7.65 m."""
    off, way = 1.0, 0.0
    while off > 0.05:
        off, way = off - 0.001 * math.sin(correction(1.5 + off, SETTINGS)), way + 0.001
    assert way == pytest.approx(7.65, abs=0.02)
