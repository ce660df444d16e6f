"""Where the robot believes to be: distances of odometry along a compass, as printed and repaired, and filtered."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from behaviours.catalogue import library
from behaviours.cores.hybrid import HeadingModel, signed_distance, step, turned
from behaviours.estimators.localisation import Localisation, LocalisationSettings
from behaviours.interface import Compass, Imu, Odometry, Pose, Reading, Workshop, wrap
from behaviours.libraries.sharing import localisation

PAPER, MODERN = LocalisationSettings(), LocalisationSettings(modern=True)
NO_COMPASS = LocalisationSettings(compass=False)
TICK = 0.1


def reading(n, odometry, compass=None, gyro=None, fresh=True):
    return Reading(
        n * TICK,
        n,
        Odometry(odometry, 0.0, 0.0),
        compass=None if compass is None else Compass(n * TICK, fresh, compass),
        imu=None if gyro is None else Imu(n * TICK, True, gyro, (0.0, 0.0)),
    )


def fed(place, *readings):
    for one in readings:
        place.update(one, {}, {})
    return place


def drive(legs):
    """True poses: (speed [m/s], turn rate [rad/s], ticks) leg by leg."""
    poses = [Pose(0.0, 0.0, 0.0)]
    for speed, rate, ticks in legs:
        for _ in range(ticks):
            last = poses[-1]
            middle = last.theta + rate * TICK / 2
            x, y = step((last.x, last.y), speed * TICK, middle)
            poses.append(Pose(x, y, wrap(last.theta + rate * TICK)))
    return poses


SQUARE = [leg for _ in range(4) for leg in ((0.5, 0.0, 500), (0.0, math.pi / 2, 10))]


def scrubbed(poses, slip=1.3):
    """What odometry says: turns count `slip` times."""
    told = [Pose(0.0, 0.0, 0.0)]
    for a, b in pairwise(poses):
        turn, way, last = slip * wrap(b.theta - a.theta), signed_distance(a, b), told[-1]
        x, y = step((last.x, last.y), way, last.theta + turn / 2)
        told.append(Pose(x, y, wrap(last.theta + turn)))
    return told


# --- the equations --------------------------------------------------------------------------------


def test_ten_metres_ahead_and_three_back_are_seven():
    poses = drive([(0.5, 0.0, 200), (-0.5, 0.0, 60)])
    place = fed(Localisation(PAPER), *(reading(n, p, p.theta) for n, p in enumerate(poses)))
    assert place.pose.x == pytest.approx(7.0)
    assert place.pose.y == pytest.approx(0.0)
    assert place.travelled == pytest.approx(13.0)
    assert place.from_start() == pytest.approx(7.0)


def test_as_printed_the_place_never_leaves_the_origin_and_as_repaired_the_square_closes():
    poses = drive(SQUARE)
    ways = [signed_distance(a, b) for a, b in pairwise(poses)]
    printed = [step((0.0, 0.0), abs(way), p.theta) for way, p in zip(ways, poses[1:], strict=True)]
    assert max(math.hypot(*one) for one in printed) <= max(ways) + 1e-12
    place = Localisation(PAPER)
    farthest = 0.0
    for n, p in enumerate(poses):
        fed(place, reading(n, p, p.theta))
        farthest = max(farthest, place.from_start())
    assert farthest == pytest.approx(25 * math.sqrt(2), abs=0.01)
    assert place.from_start() < 0.01


def test_distances_are_negative_backwards_even_in_a_turn():
    assert signed_distance(Pose(0, 0, 3.0), Pose(-1, 0, -3.0)) == pytest.approx(1.0)
    assert signed_distance(Pose(0, 0, 3.0), Pose(1, 0, -3.0)) == pytest.approx(-1.0)
    assert signed_distance(Pose(1, 2, 0.5), Pose(1, 2, 0.9)) == 0.0


def test_the_middle_of_a_tick_is_nearer_to_the_truth_than_its_end():
    poses = drive([(0.5, 0.4, 150)])
    readings = [reading(n, p, p.theta, 0.4) for n, p in enumerate(poses)]
    off = {}
    for settings in (PAPER, MODERN):
        pose = fed(Localisation(settings), *readings).pose
        off[settings.modern] = math.hypot(pose.x - poses[-1].x, pose.y - poses[-1].y)
    assert off[True] < 0.25 * off[False]


# --- what is missing ------------------------------------------------------------------------------


def test_with_a_compass_the_axes_are_the_worlds_from_the_first_reading_on():
    place = fed(Localisation(PAPER), reading(0, Pose(0, 0, 0), 1.0), reading(1, Pose(2, 0, 0), 1.0))
    assert place.frame == "map"
    assert place.pose == Pose(pytest.approx(2 * math.cos(1)), pytest.approx(2 * math.sin(1)), pytest.approx(1.0))
    assert place.odometry == Pose(*map(pytest.approx, (2 * math.cos(1), 2 * math.sin(1), 1.0)))


@pytest.mark.parametrize("settings", [PAPER, NO_COMPASS])
def test_without_a_compass_the_pose_is_odometrys(settings):
    told = scrubbed(drive(SQUARE))
    compass = 2.0 if not settings.compass else None
    place = fed(Localisation(settings), *(reading(n, p, compass) for n, p in enumerate(told)))
    assert place.frame == "odom"
    end = told[-1]
    assert place.odometry == Pose(*map(pytest.approx, (end.x, end.y, end.theta)))
    assert abs(wrap(place.heading - end.theta)) < 1e-9
    assert math.hypot(place.pose.x - end.x, place.pose.y - end.y) < 0.2


@pytest.mark.parametrize("lost", [{"compass": math.nan}, {"compass": 1.0, "fresh": False}, {}])
def test_while_the_compass_says_nothing_the_heading_turns_as_odometry_does(lost):
    place = fed(
        Localisation(PAPER),
        reading(0, Pose(0, 0, 0), 1.0),
        reading(1, Pose(0, 0, 0.2), **lost),
        reading(2, Pose(0, 0, 0.3), **lost),
    )
    assert place.heading == pytest.approx(1.3)
    assert place.frame == "map"
    assert fed(place, reading(3, Pose(0, 0, 0.3), 1.1)).heading == pytest.approx(1.1)


@pytest.mark.parametrize("settings", [PAPER, MODERN])
def test_a_compass_that_wakes_up_late_does_not_turn_the_frame(settings):
    place = fed(Localisation(settings), reading(0, Pose(0, 0, 0), math.nan), reading(1, Pose(0, 0, 0.1), math.nan))
    heading = place.heading
    fed(place, reading(2, Pose(0, 0, 0.1), 2.0))
    assert place.frame == "odom"
    assert place.heading == pytest.approx(heading, abs=1e-6)
    fed(place, *(reading(n, Pose(0, 0, 0.1), 2.4) for n in range(3, 200)))
    assert place.heading == pytest.approx(heading + (0.4 if settings is PAPER else 0.0), abs=0.05)


def test_odometry_that_fails_counts_as_standing_still():
    nan = Pose(math.nan, 0, 0)
    place = fed(Localisation(PAPER), reading(0, nan, 0.0), reading(1, Pose(1, 0, 0), 0.0), reading(2, nan, 0.0))
    assert fed(place, reading(3, Pose(2, 0, 0), 0.0)).pose == Pose(2.0, 0.0, 0.0)


# --- the filter -----------------------------------------------------------------------------------


def noisy(poses, chance, bias=0.0, gyro=True):
    """Readings of a run on tracks: a compass with 1 degree of noise, a gyroscope with a drift."""
    told = scrubbed(poses)
    rates = [0.0, *(wrap(b.theta - a.theta) / TICK for a, b in pairwise(poses))]
    for n, (p, o) in enumerate(zip(poses, told, strict=True)):
        compass = wrap(p.theta + math.radians(1.0) * chance.standard_normal())
        yield reading(n, o, compass, rates[n] + bias + 0.002 * chance.standard_normal() if gyro else None)


def headings(settings, readings, poses):
    place, off = Localisation(settings), []
    for one, p in zip(readings, poses, strict=True):
        fed(place, one)
        off.append(wrap(place.heading - p.theta))
    return np.array(off)


def test_the_filtered_heading_is_smoother_and_truer_than_the_compass():
    poses = drive(SQUARE)
    raw = headings(PAPER, noisy(poses, np.random.default_rng(1)), poses)
    smooth = headings(MODERN, noisy(poses, np.random.default_rng(1), bias=0.0005), poses)
    assert np.std(np.diff(smooth)) < 0.1 * np.std(np.diff(raw))
    assert np.sqrt(np.mean(smooth**2)) < np.sqrt(np.mean(raw**2))


def test_one_reading_of_the_compass_that_is_far_off_moves_nothing():
    poses = drive([(0.5, 0.0, 100)])
    readings = list(noisy(poses, np.random.default_rng(2)))
    readings[60] = reading(60, readings[60].odometry.pose, 1.5, 0.0)
    assert np.abs(headings(MODERN, readings, poses)).max() < math.radians(3)
    assert np.abs(headings(PAPER, readings, poses)).max() > 1.4


def test_a_gyroscope_that_drifts_is_found_out_while_standing():
    still = [Pose(0.0, 0.0, 0.0)] * 100
    place = fed(Localisation(MODERN), *noisy(still, np.random.default_rng(3), bias=0.001))
    fed(place, *(reading(n, Pose(0, 0, 0), None, 0.001) for n in range(100, 700)))
    assert abs(place.heading) < math.radians(2.5)


def test_without_a_gyroscope_the_filter_learns_how_much_the_tracks_scrub():
    poses = drive([(0.3, 0.3, 1200)])
    off = headings(MODERN, noisy(poses, np.random.default_rng(4), gyro=False), poses)
    assert np.abs(off).max() < math.radians(8)
    told = scrubbed(drive([(0.3, 0.3, 1300)]))
    place = fed(Localisation(MODERN), *noisy(poses, np.random.default_rng(4), gyro=False))
    before = place.heading
    fed(place, *(reading(n, told[n]) for n in range(1201, 1301)))
    assert wrap(place.heading - before - 3.0) == pytest.approx(0.0, abs=math.radians(8))


def test_what_iron_adds_here_and_there_is_taken_out_in_part():
    poses = drive([(0.5, 0.1, 1800)])
    field = [0.036 * (math.sin(p.x / 6 + 1) + math.sin(p.y / 6 + 2)) for p in poses]
    clean = noisy(poses, np.random.default_rng(7), bias=0.0005)
    askew = [
        replace(r, compass=replace(r.compass, heading=r.compass.heading + f)) for r, f in zip(clean, field, strict=True)
    ]
    raw, smooth = headings(PAPER, askew, poses), headings(MODERN, askew, poses)
    assert np.std(smooth) < 0.6 * np.std(raw)


@pytest.mark.parametrize("settings", [PAPER, MODERN])
def test_a_run_in_a_mirror_is_believed_in_a_mirror(settings):
    poses = drive([(0.5, 0.3, 60), (0.0, -0.7, 30), (-0.2, 0.1, 40)])
    there, mirrored = Localisation(settings), Localisation(settings)
    for one in noisy(poses, np.random.default_rng(5)):
        fed(there, one)
        o = one.odometry.pose
        fed(mirrored, reading(one.tick, Pose(o.x, -o.y, -o.theta), -one.compass.heading, -one.imu.turn_rate))
    assert (mirrored.pose.x, mirrored.pose.y, mirrored.heading) == (there.pose.x, -there.pose.y, -there.heading)


def test_the_filter_stays_sane_on_a_long_way():
    place = Localisation(MODERN)
    for one in noisy(drive([(0.5, 0.2, 3000)]), np.random.default_rng(6)):
        fed(place, one)
    cov = place._belief.cov
    assert np.linalg.eigvalsh(cov).min() >= -1e-12
    assert math.sqrt(cov[0, 0]) < math.radians(3)


# --- the library ----------------------------------------------------------------------------------


def test_the_library_gives_its_words_and_views():
    workshop = Workshop()
    offer = library("localisation").build({}, workshop)
    fed(workshop.estimators[0], reading(0, Pose(0, 0, 0), 0.5), reading(1, Pose(-1, 0, 0), 0.5))
    assert offer.percepts["the-heading"]() == 0.5
    assert offer.percepts["distance-travelled"]() == 1.0
    assert offer.percepts["distance-from-start"]() == pytest.approx(1.0)
    assert offer.views["believed-pose"]() == {"kind": "pose", "frame": "map", "at": [-0.878, -0.479, 0.5]}
    assert offer.views["odometry-pose"]() == {"kind": "pose", "frame": "map", "at": [-0.878, -0.479, 0.5]}


@pytest.mark.parametrize(
    ("values", "told"),
    [
        ({"preset": "best"}, "preset must be paper or modern, not best"),
        ({"gate": 0.0}, "gate must be finite and more than 0"),
        ({"compass-noise": -1.0}, "compass-noise must be finite and not negative"),
    ],
)
def test_a_parameter_that_cannot_be_is_told(values, told):
    with pytest.raises(ValueError, match=told):
        library("localisation").build(values, Workshop())


def test_all_who_ask_for_the_place_get_the_one_that_the_plan_set_up():
    workshop = Workshop()
    library("localisation").build({"preset": "modern", "compass": False, "iron": 0.1}, workshop)
    assert localisation(workshop).settings == LocalisationSettings(False, True, HeadingModel(iron=0.1))


def test_a_place_that_was_made_before_with_other_settings_is_told():
    workshop = Workshop()
    localisation(workshop)
    with pytest.raises(ValueError, match="use localisation before the libraries that build on it"):
        library("localisation").build({"preset": "modern"}, workshop)


def test_turning_a_pose_turns_its_place_and_its_heading():
    assert turned(Pose(1, 0, 0.25), math.pi / 2) == Pose(pytest.approx(0), 1.0, pytest.approx(0.25 + math.pi / 2))
