"""A robot that is told to move and does not is stuck; one that stands by command, drives or lifts itself is not."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from behaviours.catalogue import LIBRARIES
from behaviours.competences.escape import Escape
from behaviours.cores.stasis import (
    STILL,
    Cycle,
    CycleSettings,
    EscapeSettings,
    FreePath,
    Level,
    LevelSettings,
    Patience,
    PatienceSettings,
    draw,
    profile,
    repeats,
    stood_still,
)
from behaviours.estimators.stasis import Stasis, commanded
from behaviours.estimators.surroundings import moved
from behaviours.interface import Command, Drive, Flippers, Odometry, Pose, Reading, Scan, Workshop
from rplan.apps.reproduce.rows import w4
from rplan.apps.reproduce.watch import watch
from rplan.apps.wiring import compile_file
from sim.scenarios.format import load

PLANS = Path(__file__).parents[2] / "plans"
AHEAD = Drive(0.3, 0.0)


class Held:
    """The library with a robot that a test moves; odometry says what `made` says."""

    def __init__(self, **values):
        workshop = Workshop()
        self.offer = LIBRARIES["stasis"].build({"preset": "paper", **values}, workshop)
        self.estimators = workshop.estimators
        self.stasis = next(e for e in self.estimators if isinstance(e, Stasis))
        self.tick, self.pose = 0, Pose(0.0, 0.0, 0.0)

    def step(self, told, made=STILL, flippers=None, scan=None):
        theta = self.pose.theta + made.turn_rate * 0.1
        self.pose = Pose(
            self.pose.x + made.speed * 0.1 * math.cos(theta), self.pose.y + made.speed * 0.1 * math.sin(theta), theta
        )
        reading = Reading(
            self.tick / 10, self.tick, Odometry(self.pose, made.speed, made.turn_rate), lidar=scan and scan(self.tick)
        )
        channels = {"heading": 0.0, "action": Command(told), "flippers": flippers and Command(flippers=flippers)}
        for estimator in self.estimators:
            estimator.update(reading, {}, channels)
        self.tick += 1
        return self.offer.percepts["the-robot-is-stuck"]()

    @property
    def level(self):
        return self.offer.percepts["stasis-level"]()


def test_the_level_rises_by_one_a_second_to_the_cap_and_falls_as_fast():
    held = Held()
    stuck = [held.step(AHEAD) for _ in range(41)]
    assert stuck.index(True) == 10
    assert held.level == 3.0
    after = [held.step(AHEAD, AHEAD) for _ in range(30)]
    assert after.index(False) == 20, "two seconds of motion, from the cap to below the threshold"
    assert held.level == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("told", [Drive(0.1, 0.0), Drive(-0.1, 0.0), Drive(0.0, 0.3), Drive(0.0, -0.3)])
def test_being_held_in_any_motion_is_stasis(told):
    held = Held()
    assert [held.step(told) for _ in range(20)][-1]


def test_standing_by_command_is_no_stasis():
    held = Held()
    assert not any(held.step(STILL) for _ in range(300))
    assert held.level == 0.0


@pytest.mark.parametrize("motion", [Drive(0.05, 0.0), Drive(0.0, 0.11), Drive(-0.25, 0.5)])
def test_a_robot_that_does_as_it_is_told_is_never_stuck(motion):
    held = Held()
    assert not any(held.step(motion, motion) for _ in range(100))


def test_creeping_below_the_threshold_of_motion_is_no_motion():
    held = Held()
    assert [held.step(AHEAD, Drive(0.02, 0.05)) for _ in range(20)][-1]
    held = Held()
    assert not any(held.step(AHEAD, Drive(0.021, 0.0)) for _ in range(20))


def test_while_flippers_have_only_just_been_sent_out_being_held_is_no_stasis():
    held = Held()
    stuck = [held.step(AHEAD, flippers=Flippers(True)) for _ in range(60)]
    assert stuck.index(True) == 39, "three seconds of lifting, and then one of stasis"


def test_what_was_commanded_is_the_last_word_of_all_channels():
    channels = {"a": Command(Drive(1.0, 0.0)), "b": Command(flippers=Flippers(True)), "c": None, "d": 3.0}
    assert commanded(channels) == Drive(1.0, 0.0)
    assert commanded({}) == STILL


def test_an_escape_that_saturates_at_the_threshold_would_end_at_once():
    low, high = Level(LevelSettings(cap=1.0)), Level(LevelSettings())
    for level in (low, high):
        for _ in range(50):
            level.take(AHEAD, False, 0.1)
    ticks = {}
    for name, level in (("low", low), ("high", high)):
        ticks[name] = 0
        while level.stuck:
            level.take(AHEAD, True, 0.1)
            ticks[name] += 1
    assert ticks == {"low": 1, "high": 21}


def test_with_release_at_zero_an_escape_goes_on_until_the_level_is_gone():
    level = Level(LevelSettings(release=0.0))
    for _ in range(10):
        level.take(AHEAD, False, 0.1)
    ticks = 0
    while level.stuck:
        level.take(AHEAD, True, 0.1)
        ticks += 1
    assert ticks == 10


# --- escapes ----------------------------------------------------------------------------------------


def test_draws_fill_the_printed_ranges_and_are_never_next_to_nothing():
    chance = np.random.default_rng(5)
    drawn = [draw(EscapeSettings(), chance) for _ in range(2000)]
    speeds, turns = [d.speed for d in drawn], [d.turn_rate for d in drawn]
    assert -0.25 <= min(speeds) < -0.24 and 0.24 < max(speeds) <= 0.25
    assert -1.0 <= min(turns) < -0.97 and 0.97 < max(turns) <= 1.0
    assert all(abs(d.speed) >= 0.05 or abs(d.turn_rate) >= 0.2 for d in drawn)


def test_settings_that_allow_no_draw_end_all_the_same():
    assert draw(EscapeSettings(speed=0.0, turn_rate=0.0), np.random.default_rng(0)) == STILL


def test_a_motion_is_tried_for_two_seconds():
    draws = iter([Drive(0.1, 0.1), Drive(0.2, 0.2), Drive(0.3, 0.3)])
    escape = Escape(lambda: (), lambda: next(draws), 2.0, lambda: False)
    readings = [Reading(k / 10, k, Odometry(Pose(0, 0), 0.0, 0.0)) for k in range(45)]
    escape.start(readings[0], {})
    told = [escape.step(reading, {})[0].drive.speed for reading in readings]
    assert told == [0.1] * 20 + [0.2] * 20 + [0.3] * 5


def test_the_same_seed_draws_the_same_and_another_one_does_not():
    def first(seed):
        return Held(seed=seed).stasis.draw()

    assert first(3) == first(3) != first(4)


def test_modern_drives_the_way_in_backwards_first():
    held = Held(preset="modern")
    for _ in range(10):
        held.step(AHEAD, AHEAD)
    for _ in range(5):
        held.step(Drive(0.1, 0.5), Drive(0.1, 0.5))
    while not held.step(AHEAD):
        pass
    back = held.stasis.way_back()
    assert back[:5] == (Drive(-0.1, -0.5),) * 5
    assert back[5:] == (Drive(-0.25, 0.0),) * 10, "no faster than an escape"


def test_the_way_back_keeps_its_curve_where_it_is_slowed_down():
    path = FreePath(5)
    path.add(Drive(0.5, 1.0))
    assert path.backwards(EscapeSettings()) == (Drive(-0.25, -0.5),)


# --- motion by what is seen -------------------------------------------------------------------------


def room(pose):
    """Points of the walls of a room of 6 x 8 m, robot frame."""
    bearings = np.arange(360) * math.tau / 360 + pose.theta
    c, s = np.cos(bearings), np.sin(bearings)
    with np.errstate(divide="ignore"):
        reach = np.minimum((np.copysign(3.0, c) - pose.x) / c, (np.copysign(4.0, s) - pose.y) / s)
    turned = bearings - pose.theta
    return np.column_stack([reach * np.cos(turned), reach * np.sin(turned)])


def test_tracks_that_turn_in_the_air_are_seen_through():
    start, claimed = Pose(0.0, 0.0, 0.0), Pose(0.25, 0.0, 0.1)
    before = room(start)
    expected = profile(moved(before, start, claimed))
    assert stood_still(profile(before), expected, profile(before), 0.05)
    assert not stood_still(profile(before), expected, profile(room(claimed)), 0.05)


def test_where_nothing_is_seen_the_tracks_are_believed():
    nothing = profile(np.zeros((0, 2)))
    assert not stood_still(nothing, nothing, nothing, 0.05)


@pytest.mark.parametrize(("preset", "stuck"), [("modern", True), ("paper", False)])
def test_only_modern_notices_slipping_tracks(preset, stuck):
    held = Held(preset=preset)
    points = room(Pose(0.0, 0.0, 0.0))
    bearings, ranges = np.arctan2(points[:, 1], points[:, 0]), np.hypot(points[:, 0], points[:, 1])

    def scan(tick):
        return Scan(tick / 10, tick % 2 == 0, Pose(0, 0), bearings, ranges, 0.05, 20.0)

    assert any(held.step(AHEAD, AHEAD, scan=scan) for _ in range(40)) is stuck


# --- motion that repeats itself ---------------------------------------------------------------------


def series(pose_at, seconds=30.0):
    cycle = Cycle(CycleSettings())
    return any(cycle.take(k / 10, pose_at(k / 10)) for k in range(round(seconds * 10)))


def test_to_and_fro_and_dithering_are_cycles():
    assert series(lambda t: Pose(math.sin(t), 0.0, 0.0))
    assert series(lambda t: Pose(0.0, 0.0, 0.6 * math.sin(1.5 * t)))
    assert series(lambda t: Pose(math.cos(t), math.sin(t), t))


def test_going_straight_standing_and_long_rounds_are_none():
    assert not series(lambda t: Pose(0.5 * t, 0.0, 0.0))
    assert not series(lambda t: Pose(0.0, 0.0, 0.0))
    assert not series(lambda t: Pose(12 * math.cos(t / 25), 12 * math.sin(t / 25), t / 25), 120.0)
    corner = [
        Pose(min(5.0, t / 2), max(0.0, t / 2 - 5.0), 0.0 if t < 10 else math.pi / 2) for t in np.arange(0, 30, 0.1)
    ]
    assert not series(lambda t: corner[round(t * 10)])


def test_the_period_of_a_cycle_is_found():
    poses = np.array([(math.sin(math.tau * k * 0.5 / 6.0), 0.0) for k in range(60)])
    assert repeats(poses, CycleSettings()) == pytest.approx(6.0, abs=0.6)


def test_a_cycle_is_stasis_with_modern_alone():
    def ends_stuck(preset):
        held = Held(preset=preset)
        sway = [Drive(math.copysign(0.3, math.sin(k / 10)), 0.0) for k in range(400)]
        return any(held.step(motion, motion) for motion in sway)

    assert ends_stuck("modern") and not ends_stuck("paper")


# --- giving up --------------------------------------------------------------------------------------


def test_after_five_episodes_at_one_place_an_operator_is_called():
    patience = Patience(PatienceSettings())
    for _ in range(5):
        patience.take(True, Pose(0.0, 0.0))
        patience.take(False, Pose(0.1, 0.0))
    assert not patience.is_over
    patience.take(True, Pose(0.2, 0.0))
    assert patience.is_over


def test_another_place_is_another_chance():
    patience = Patience(PatienceSettings())
    for k in range(20):
        patience.take(True, Pose(1.1 * k, 0.0))
        patience.take(False, Pose(1.1 * k, 0.0))
    assert not patience.is_over


def test_modern_stands_and_asks_in_the_end_and_paper_tries_for_ever():
    for preset, asks in (("modern", True), ("paper", False)):
        held = Held(preset=preset)
        for _ in range(8):
            while not held.step(AHEAD):
                pass
            while held.step(AHEAD, Drive(0.0, 0.3)) and not held.offer.percepts["an-operator-is-needed"]():
                pass
        assert held.offer.percepts["an-operator-is-needed"]() is asks
        escape = held.offer.competences["escape-from-stasis"]
        reading = Reading(9.0, 90, Odometry(Pose(0, 0), 0.0, 0.0))
        escape.start(reading, {})
        command, report = escape.step(reading, {})
        assert (command.drive == STILL) is asks is (report.status == "failed")


# --- in the world -----------------------------------------------------------------------------------


def test_a_robot_wedged_between_low_posts_gets_out():
    plan, world = compile_file(PLANS / "steer_clear/steer_clear.rplan"), load(PLANS / "perimeter/worlds/low_post.yaml")
    for seed in range(2):
        told = w4.measure(watch(plan, world, seed))
        assert told["held"] and told["in_time"]


def test_ordinary_driving_raises_no_alarm():
    seen = watch(compile_file(PLANS / "perimeter/perimeter.rplan"), load(PLANS / "perimeter/worlds/alley.yaml"), 0)
    assert seen.verdict.distance > 20
    assert not any(moment.percepts["(the-robot-is-stuck)"] for moment in seen.moments)


@pytest.mark.parametrize(
    ("values", "says"),
    [
        ({"window": 0.0}, "window must be from 16 to 600 s, not 0"),
        ({"window": 1e9}, "window must be from 16 to 600 s"),
        ({"cap": 0.5}, "cap must be at least the threshold, 1.0"),
        ({"threshold": 0.0}, "threshold must be finite and more than 0"),
    ],
)
def test_parameters_that_make_no_sense_are_refused(values, says):
    with pytest.raises(ValueError, match=says):
        LIBRARIES["stasis"].build({"preset": "modern", **values}, Workshop())


def test_the_shortest_window_sees_motion_that_repeats_itself():
    poses = np.array([(math.cos(0.5 * k), math.sin(0.5 * k)) for k in range(32)])
    assert repeats(poses, CycleSettings(window=16.0)) == pytest.approx(6.5, abs=0.5)
