"""The wall beside the robot from scan to scan, and following it."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from behaviours.competences.follow_wall import FollowWall, PaceSettings
from behaviours.estimators.fitted_wall import SHOWN, FittedWall, FittedWallSettings
from behaviours.interface import STOP, Odometry, Pose, Reading, Scan

BEAMS = 667
HALF = np.radians(120) * np.arange(1, BEAMS // 2 + 1) / (BEAMS // 2)
BEARINGS = np.concatenate([-HALF[::-1], [0.0], HALF])
"""240 degrees; the same to both sides, to the last bit."""
PERIOD, REACH, NEAR = 0.028, 4.0, 0.02
SPEED, WALL_TO = 0.48, 4.0
RIGHT, LEFT = FittedWallSettings(), FittedWallSettings(left=True)


def distances(pose, corner=math.inf):
    """To a wall along the x-axis, below the robot, that goes straight down at `corner`."""
    heading = pose.theta + BEARINGS
    with np.errstate(divide="ignore", invalid="ignore"):
        first = np.where(np.sin(heading) < -1e-9, -pose.y / np.sin(heading), np.inf)
        first = np.where(pose.x + first * np.cos(heading) <= corner, first, np.inf)
        second = np.where(np.cos(heading) < -1e-9, (corner - pose.x) / np.cos(heading), np.inf)
        beyond = (second > 0) & (pose.y + second * np.sin(heading) < 0)
    return np.minimum(first, np.where(beyond, second, np.inf))


def reading(tick, pose, ranges, speed=SPEED):
    scan = Scan(tick * PERIOD, True, Pose(0.0, 0.0), BEARINGS, ranges, NEAR, REACH)
    return Reading(tick * PERIOD, tick, Odometry(pose, speed, 0.0), lidar=scan)


def mirrored(seen):
    """The same before a mirror that lies along the x-axis."""
    pose, scan = seen.odometry.pose, seen.lidar
    odometry = replace(seen.odometry, pose=Pose(pose.x, -pose.y, -pose.theta))
    return replace(seen, odometry=odometry, lidar=replace(scan, ranges=scan.ranges[::-1]))


def drive(wall, ticks, pose, corner=math.inf, seed=0, each=lambda *_: None):
    """A unicycle that follows the wall."""
    chance = np.random.default_rng(seed)
    follow = FollowWall(wall, PaceSettings())
    for tick in range(ticks):
        told = np.minimum(distances(pose, corner) * (1 + chance.normal(0, 0.01, BEAMS)), REACH)
        seen = reading(tick, pose, told)
        wall.update(seen, {}, {})
        command, _ = follow.step(seen, {})
        each(tick, seen, wall)
        v, w = (0.0, 0.0) if command.drive is None else (command.drive.speed, command.drive.turn_rate)
        middle = pose.theta + w * PERIOD / 2
        x, y = pose.x + v * PERIOD * math.cos(middle), pose.y + v * PERIOD * math.sin(middle)
        pose = Pose(x, y, pose.theta + w * PERIOD)
    return pose, command


@pytest.mark.parametrize(("offset", "heading"), [(0.3, 80), (1.5, 20), (1.5, -110)])
def test_it_ends_beside_the_wall(offset, heading):
    pose, _ = drive(FittedWall(RIGHT), 1200, Pose(0.0, offset, math.radians(heading)))
    assert pose.y == pytest.approx(1.0, abs=0.02)
    assert pose.theta == pytest.approx(0.0, abs=math.radians(1))


def test_the_view_is_not_restricted_before_the_robot_is_along_the_wall():
    seen = []
    drive(
        FittedWall(RIGHT), 300, Pose(0.0, 1.5, math.radians(-110)), each=lambda t, r, w: seen.append((w.state, w.end))
    )
    first = next(k for k, (_, end) in enumerate(seen) if end is not None)
    assert all(abs(state.angle) > math.radians(29) for state, _ in seen[:first])
    assert all(end is not None for _, end in seen[first:])


def test_with_wall_loss_the_robot_comes_round_a_corner_and_without_it_stops():
    on, _ = drive(FittedWall(RIGHT), 900, Pose(1.0, 1.0), WALL_TO)
    off_settings = replace(RIGHT, loss=False, curve=False)
    wall = FittedWall(off_settings)
    off, command = drive(wall, 900, Pose(1.0, 1.0), WALL_TO)
    assert (on.x, math.cos(on.theta + math.pi / 2)) == pytest.approx((5.0, 1.0), abs=0.05)
    assert on.y < -2.0
    assert wall.mode == "lost" and command == STOP
    assert off.x < 4.5 and off.y > 0.8


def test_a_wall_to_the_left_is_the_mirror_of_one_to_the_right_to_the_last_bit():
    left = FittedWall(LEFT)
    told = []

    def compare(_tick, seen, right):
        left.update(mirrored(seen), {}, {})
        told.append(
            (left.mode, left.state, left.curvature, left.end) == (right.mode, right.state, right.curvature, right.end)
        )
        for ours, theirs in ((left.line_view(), right.line_view()), (left.inliers_view(), right.inliers_view())):
            assert (ours is None) == (theirs is None)
            if ours is not None:
                flip = [[-value if k % 2 else value for k, value in enumerate(at)] for at in ours["at"]]
                assert flip == theirs["at"]

    drive(FittedWall(RIGHT), 700, Pose(0.0, 1.4, 0.3), WALL_TO, each=compare)
    assert len(told) == 700 and all(told)


def test_the_turn_is_mirrored_too():
    seen = reading(0, Pose(0.0, 1.4, 0.2), np.minimum(distances(Pose(0.0, 1.4, 0.2)), REACH))
    right, left = FittedWall(RIGHT), FittedWall(LEFT)
    right.update(seen, {}, {})
    left.update(mirrored(seen), {}, {})
    ours, _ = FollowWall(left, PaceSettings()).step(mirrored(seen), {})
    theirs, _ = FollowWall(right, PaceSettings()).step(seen, {})
    assert ours.drive.turn_rate == -theirs.drive.turn_rate != 0.0


def points(count):
    ranges = np.full(BEAMS, REACH)
    beside = np.flatnonzero(np.abs(BEARINGS + math.pi / 2) < 0.6)[:count]
    ranges[beside] = distances(Pose(0.0, 1.0))[beside]
    return ranges


FRAMES = {
    "nothing met": np.full(BEAMS, REACH),
    "no point": points(0),
    "one point": points(1),
    "two points": points(2),
    "nineteen points": points(19),
    "all at minimum range": np.full(BEAMS, NEAR),
    "all at zero": np.zeros(BEAMS),
    "all NaN": np.full(BEAMS, math.nan),
    "all infinite": np.full(BEAMS, math.inf),
    "all minus infinity": np.full(BEAMS, -math.inf),
    "nineteen points and NaN": np.where(points(19) < REACH, points(19), math.nan),
    "points and infinities in turn": np.where(np.arange(BEAMS) % 40 == 0, 1.0, math.inf),
}


@pytest.mark.parametrize("settings", [RIGHT, LEFT, replace(RIGHT, loss=False)])
@pytest.mark.parametrize("name", FRAMES)
@pytest.mark.parametrize("after", [0, 60])
def test_a_frame_that_says_nothing_stops_the_robot(name, after, settings):
    wall = FittedWall(settings)
    pose = Pose(0.0, 1.0)
    for tick in range(after):
        seen = reading(tick, pose, np.minimum(distances(pose), REACH))
        wall.update(mirrored(seen) if settings.left else seen, {}, {})
    assert wall.is_found == (after > 0)
    seen = reading(after, pose, FRAMES[name])
    wall.update(mirrored(seen) if settings.left else seen, {}, {})
    command, report = FollowWall(wall, PaceSettings()).step(seen, {})
    assert wall.mode == ("lost" if after else "none")
    assert command == STOP and report.status == "failed"
    assert wall.target() is None and not wall.is_found and not wall.ends


def test_frames_of_no_beams_at_all_are_borne():
    wall = FittedWall(RIGHT)
    empty = Scan(0.0, True, Pose(0.0, 0.0), np.zeros(0), np.zeros(0), NEAR, REACH)
    wall.update(Reading(0.0, 0, Odometry(Pose(0.0, 0.0), 0.0, 0.0), lidar=empty), {}, {})
    wall.update(Reading(0.0, 0, Odometry(Pose(0.0, 0.0), 0.0, 0.0)), {}, {})
    assert wall.mode == "none"


def test_some_beams_that_fail_do_not_matter():
    ranges = np.minimum(distances(Pose(0.0, 1.0)), REACH)
    ranges[::3] = math.nan
    ranges[1::7] = math.inf
    wall = FittedWall(RIGHT)
    wall.update(reading(0, Pose(0.0, 1.0), ranges), {}, {})
    assert wall.is_found
    assert (wall.state.offset, wall.state.angle) == pytest.approx((1.0, 0.0), abs=1e-6)


def test_a_stale_scan_only_moves_the_state():
    wall = FittedWall(RIGHT)
    seen = reading(0, Pose(0.0, 1.0, 0.2), np.minimum(distances(Pose(0.0, 1.0, 0.2)), REACH))
    wall.update(seen, {}, {})
    before = wall.state
    stale = replace(seen.lidar, fresh=False)
    moved = replace(seen.odometry, pose=Pose(0.1 * math.cos(0.2), 1.0 + 0.1 * math.sin(0.2), 0.2))
    wall.update(replace(seen, odometry=moved, lidar=stale), {}, {})
    assert wall.state.offset == pytest.approx(before.offset + 0.1 * math.sin(before.angle))


def test_what_is_shown_comes_with_every_fifth_scan_short_and_rounded():
    shown = []
    drive(
        FittedWall(RIGHT),
        40,
        Pose(2.6, 1.0),
        WALL_TO,
        each=lambda t, r, w: shown.append((w.line_view(), w.inliers_view(), w.added_view())),
    )
    assert [k for k, (line, _, _) in enumerate(shown) if line is not None] == [4, 9, 14, 19, 24, 29, 34, 39]
    line, inliers, added = shown[39]
    assert 20 < len(inliers["at"]) <= SHOWN
    assert len(line["at"]) == 1 and len(added["at"]) == 1
    assert all(value == round(value, 3) for place in inliers["at"] + line["at"] + added["at"] for value in place)


def test_the_same_run_twice_is_the_same_run():
    assert drive(FittedWall(RIGHT), 300, Pose(0.0, 1.4)) == drive(FittedWall(RIGHT), 300, Pose(0.0, 1.4))
