"""The wall that is followed: the two sides, the frame of the heading, and coming round."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from behaviours.cores.contour import ContourSettings
from behaviours.cores.orientation import FollowSettings
from behaviours.estimators.localisation import Localisation, LocalisationSettings
from behaviours.estimators.surroundings import Surroundings, SurroundingsSettings
from behaviours.estimators.walls import Walls, WallsSettings
from behaviours.interface import Compass, Odometry, Pose, Reading, Scan, wrap

BEAMS = np.arange(360) * math.tau / 360
FAR = 20.0
PRESETS = [None, ContourSettings()]


def seen(pose, walls):
    """Ranges of all beams among walls (ax, ay, bx, by)."""
    ux, uy = np.cos(BEAMS + pose.theta), np.sin(BEAMS + pose.theta)
    best = np.full(len(BEAMS), FAR)
    for ax, ay, bx, by in walls:
        ex, ey, fx, fy = bx - ax, by - ay, ax - pose.x, ay - pose.y
        det = ux * ey - uy * ex
        det = np.where(np.abs(det) < 1e-12, np.nan, det)
        t, s = (fx * ey - fy * ex) / det, (fx * uy - fy * ux) / det
        best = np.where((t >= 0) & (s >= 0) & (s <= 1), np.fmin(best, t), best)
    return best


class Rig:
    """The estimators of a robot, and readings for them."""

    def __init__(self, walls=(), compass=True, slip=1.0, **settings):
        self.walls_there, self.compass, self.slip = walls, compass, slip
        self.place = Localisation(LocalisationSettings())
        self.around = Surroundings(SurroundingsSettings(), self.place)
        self.walls = Walls(WallsSettings(**settings), self.place, self.around)
        self.tick, self.turned, self.last = 0, 0.0, None

    def at(self, x, y, theta, ranges=None):
        """One tick with the robot there."""
        self.turned += 0.0 if self.last is None else self.slip * wrap(theta - self.last)
        self.last = theta
        ranges = seen(Pose(x, y, theta), self.walls_there) if ranges is None else ranges
        stamp = self.tick * 0.2
        scan = Scan(stamp, True, Pose(0.0, 0.0), BEAMS, ranges, 0.05, FAR)
        told = Odometry(Pose(x, y, self.turned), 0.5, 0.0)
        compass = Compass(stamp, True, theta) if self.compass else None
        reading = Reading(stamp, self.tick, told, lidar=scan, compass=compass)
        for estimator in (self.place, self.around, self.walls):
            estimator.update(reading, {}, {})
        self.tick += 1
        return self.walls


LEFT = ((-20.0, 1.5, 20.0, 1.5),)


def box(half):
    return (
        (-half, -half, half, -half), (half, -half, half, half), (half, half, -half, half), (-half, half, -half, -half),
    )  # fmt: skip


@pytest.mark.parametrize("contour", PRESETS)
def test_until_there_is_a_wall_the_heading_at_the_start_is_kept(contour):
    rig = Rig(contour=contour)
    rig.at(0, 0, 0.4)
    assert rig.walls.follow() == pytest.approx(0.4)
    rig.at(1, 0, 0.7)
    assert rig.walls.follow() == pytest.approx(0.4)
    assert rig.walls.line is None and rig.walls.distance == 1.5 and rig.walls.seen() is None


@pytest.mark.parametrize("contour", PRESETS)
def test_a_wall_at_the_stand_off_is_gone_along(contour):
    walls = Rig(LEFT, contour=contour).at(0, 0, 0.1)
    assert walls.follow() == pytest.approx(0.0, abs=0.01)
    assert walls.distance == pytest.approx(1.5, abs=0.01)
    ends = walls.seen()
    assert ends is not None and math.dist(ends[:2], ends[2:]) > 20


@pytest.mark.parametrize("contour", PRESETS)
def test_a_wall_to_the_right_is_kept_there_by_the_other_side(contour):
    walls = Rig(((-20.0, -2.5, 20.0, -2.5),), right=True, contour=contour).at(0, 0, 0.1)
    assert walls.follow() < -0.3 and walls.distance == pytest.approx(2.5, abs=0.01)
    assert walls.line is not None and walls.line.normal == pytest.approx(-math.pi / 2 - 0.1, abs=0.01)


@pytest.mark.parametrize("contour", PRESETS)
@settings(max_examples=15, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_the_right_side_is_the_mirror_image_of_the_left_to_the_last_bit(contour, seed):
    chance = np.random.default_rng(seed)
    mirror = (-np.arange(360)) % 360
    left, right = Rig(contour=contour), Rig(contour=contour, right=True)
    walls = box(float(chance.uniform(3, 9)))
    x, y, theta = chance.uniform(-1.5, 1.5), chance.uniform(-1.5, 1.5), chance.uniform(-3, 3)
    for rig in (left, right):
        rig.compass = False
        rig.around = _Exact(rig.place)
        rig.walls = Walls(rig.walls.settings, rig.place, rig.around)
    for _ in range(4):
        ranges = seen(Pose(x, y, theta), walls) + 0.02 * chance.standard_normal(360)
        points = ranges[:, None] * np.column_stack([np.cos(BEAMS), np.sin(BEAMS)])
        left.around.points, right.around.points = points, points * (1.0, -1.0)
        a, b = left.at(x, y, theta, ranges), right.at(x, -y, -theta, ranges[mirror])
        assert a.follow() == -b.follow() and a.distance == b.distance
        theta, x = theta + 0.1, x + 0.1


class _Exact(Surroundings):
    """Points as they are put there: beams of a lidar do not mirror to the last bit."""

    def __init__(self, place):
        super().__init__(SurroundingsSettings(), place)

    def update(self, reading, reports, channels):
        self.fresh = self.known = True


def test_turning_smears_the_tally_over_bins_where_odometry_slips():
    strengths = []
    for compass in (True, False):
        rig = Rig(LEFT, compass=compass, slip=1.3)
        for step in range(20):
            walls = rig.at(0, 0, -step * 0.08)
        strengths.append(float(walls._tally.max() / walls._tally.sum()))
    assert strengths[0] > 0.95 and strengths[1] < 0.6


def test_the_paper_knows_orientations_and_no_positions():
    here, there = Rig(LEFT), Rig(LEFT)
    ranges = seen(Pose(0.0, 0.3, 0.2), LEFT)
    for step in range(5):
        a, b = here.at(0, 0, 0.2, ranges), there.at(7.0 * step, -3.0 * step, 0.2, ranges)
        assert a.follow() == b.follow()


def test_coming_round_takes_a_way_a_distance_and_the_heading_of_the_start():
    rig = Rig()
    rig.at(0, 0, 0.0)
    rig.walls.follow()
    for x in range(12):
        rig.at(x, 0, 0.0)
    for x in range(12, -1, -1):
        assert not rig.at(x, 0, math.pi).has_come_round  # back the same way, facing the other way
    for place, theta in (((0, -9), -1.5), ((-9, -9), 3.0), ((-9, 0), 1.5), ((-4, 0), 0.0)):
        assert not rig.at(*place, theta).has_come_round
    assert rig.at(-2, 0, 0.0).has_come_round
    assert rig.at(9, 0, 0.0).has_come_round


def test_nobody_comes_round_who_has_not_begun():
    rig = Rig()
    for x in (0, 30, 0):
        rig.at(x, 0, 0.0)
    assert not rig.walls.has_come_round


def test_the_contour_goes_on_with_the_wall_that_it_touched_when_another_is_stronger():
    rig = Rig(((-20.0, 1.5, 20.0, 1.5), (-20.0, -2.5, 20.0, -2.5)), contour=ContourSettings())
    rig.at(0, 0, 0.0)
    for y in (0.0, -0.2, -0.4, -0.6, -0.8, -1.0, -1.2):
        walls = rig.at(0, y, 0.0)
    assert walls.line is not None and walls.line.normal > 0
    assert walls.distance == pytest.approx(2.7, abs=0.02) and 0 < walls.follow() < 1.0


def test_a_contour_that_vanishes_is_left_for_another():
    rig = Rig(LEFT, contour=ContourSettings())
    rig.at(0, 0, 0.0)
    rig.walls_there = ((4.0, -9.0, 4.0, 9.0),)
    for _ in range(6):
        walls = rig.at(0, 0, 0.0)
    assert walls.line is not None and abs(walls.line.normal) < 0.05
    rig.walls_there = ()
    assert rig.at(0, 0, 0.0).line is None


def test_follow_settings_are_those_of_the_paper():
    s = FollowSettings()
    assert (s.stand_off, s.gain, s.steepest) == (1.5, math.pi / 8, math.pi / 4)
