"""Running away: the core's laws, and fifty trashcans."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from behaviours.cores.runaway import RunawaySettings, flee, nearest
from behaviours.interface import wrap

SETTINGS = RunawaySettings()
angles = st.floats(-math.pi, math.pi)
rings = st.lists(st.tuples(st.floats(0.0, 5.0), angles), max_size=30)


def test_danger_ahead_is_left_backwards_without_turning():
    speed, turn = flee([(0.1, 0.0)], SETTINGS)
    assert speed == pytest.approx(-0.2) and turn == pytest.approx(0.0)


def test_danger_behind_is_left_forwards():
    speed, turn = flee([(0.1, math.pi)], SETTINGS)
    assert speed == pytest.approx(0.2) and turn == pytest.approx(0.0, abs=1e-9)


def test_the_shorter_turn_decides_between_forwards_and_backwards():
    ahead_left, behind_left = flee([(0.1, 0.8)], SETTINGS), flee([(0.1, 2.3)], SETTINGS)
    assert ahead_left[0] < 0 < behind_left[0]
    assert ahead_left[1] > 0 > behind_left[1]


def test_nearer_echoes_weigh_by_the_inverse_square():
    settings = RunawaySettings(pinch=0.0)
    _, turn = flee([(0.1, math.pi / 2), (0.2, -math.pi / 2), (0.2, math.pi)], settings)
    away = math.atan2(-1 / 0.1**2 + 1 / 0.2**2, 1 / 0.2**2)
    assert turn == pytest.approx(max(-0.8, 1.5 * away))


def test_a_symmetric_pinch_turns_to_the_widest_gap_and_leaves_through_it():
    pinched = [(0.1, math.pi / 2), (0.1, -math.pi / 2)]
    assert flee([*pinched, (0.5, 0.0), (3.0, 2.5)], SETTINGS) == (0.0, pytest.approx(0.8))
    assert flee([*pinched, (3.0, 0.0), (0.5, 2.5)], SETTINGS) == (pytest.approx(0.2), pytest.approx(0.0))


def test_what_is_outside_the_safety_radius_and_its_margin_moves_nothing():
    assert flee([(0.23, 0.0)], SETTINGS) == (0.0, 0.0)


@given(rings)
def test_the_drive_keeps_its_limits_and_is_finite(ring):
    speed, turn = flee(ring, SETTINGS)
    assert abs(speed) <= 0.2 and abs(turn) <= 0.8


@given(rings)
def test_left_and_right_are_alike(ring):
    speed, turn = flee(ring, RunawaySettings(pinch=0.0))
    mirrored = flee([(r, -b) for r, b in ring], RunawaySettings(pinch=0.0))
    assert mirrored == (pytest.approx(speed, abs=1e-9), pytest.approx(-turn, abs=1e-6)) or abs(abs(turn) - 0.8) < 1e-6


@given(st.lists(st.tuples(st.floats(0.0, 5.0) | st.just(math.nan), angles), max_size=30))
def test_a_range_that_is_not_a_number_counts_as_nothing_heard(ring):
    heard = [echo for echo in ring if not math.isnan(echo[0])]
    assert flee(ring, SETTINGS) == flee(heard, SETTINGS)
    assert nearest(ring) == nearest(heard)


def test_danger_has_a_release_margin(standin):
    world = standin.World(discs=[standin.Disc(0.35 + 0.19 + 0.3, 0.0, 0.3)], sonar_sd=0.0)
    robot = standin.Robot("runaway")
    felt = []
    for gap in (0.205, 0.19, 0.21, 0.23, 0.21):
        world.discs[0].x = 0.35 + gap + 0.3
        world.tick = 0
        felt.append(robot.sense(world.read())["anything-is-too-close"])
    assert felt == [False, True, True, False, False]


def test_fifty_trashcans_at_a_hand_are_escaped_within_three_seconds_without_touch(standin):
    late, touched = 0, 0
    for i in range(50):
        angle = wrap(i * 2.4)
        away = standin.HULL + 0.1 + 0.3
        world = standin.World(seed=i, discs=[standin.Disc(away * math.cos(angle), away * math.sin(angle), 0.3)])
        robot = standin.Robot("runaway", "robot")
        while world.stamp < 3.0:
            reading = world.read()
            if robot.sense(reading)["anything-is-too-close"]:
                world.act(robot.act(reading, "move-away-from-danger"))
            else:
                world.act(robot.act(reading, "stop"))
        late += world.gap() <= 0.2
        touched += world.touched
    assert (late, touched) == (0, 0)
