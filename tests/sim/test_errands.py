"""Several donors, several trips, a battery and a charger, a head that gets stuck."""

from __future__ import annotations

import math

import pytest

from behaviours.interface import STOP, Command, Drive, Head
from sim.episode import Episode
from sim.scenarios.format import loads
from sim.scenarios.schema import ScenarioError
from sim.world import World

ROOM = """
name: room
bounds: [-10, -10, 10, 10]
robot: {{start: [0, 0], {robot}}}
{more}
"""


def world(more: str, robot: str = "sonar: {dropout: 0}") -> World:
    return World(loads(ROOM.format(more=more, robot=robot)), 0)


def let(world: World, command: Command, seconds: float) -> World:
    for _ in range(round(seconds * 10)):
        world.step(command)
    return world


NEAR = "donors: [{id: ann, at: [1.2, 0], hand_over: 1, trips: 2}]"


def test_an_object_changes_hands_and_is_brought_where_the_robot_stands_at_home():
    at = let(world(NEAR + "\nhome: {unload: 2}"), STOP, 1.0)
    assert at.errand.on_board and at.errand.deliveries == ()
    let(at, STOP, 2.0)
    assert not at.errand.on_board and at.errand.deliveries == (3.0,)


def test_every_trip_counts_until_nothing_is_left():
    at = let(world(NEAR + "\nhome: {unload: 2}"), STOP, 6.2)
    assert at.errand.deliveries == (3.0, 6.0) and at.errand.done
    assert not let(at, STOP, 5).errand.on_board


def test_without_an_unloading_the_last_object_stays_on_board():
    at = let(world(NEAR), STOP, 4.2)
    assert at.errand.deliveries == (2.0, 4.0) and at.errand.done and at.errand.on_board


def test_the_judge_waits_for_every_object():
    class Still:
        def reset(self) -> None:
            pass

        def step(self, reading):
            return STOP

        def note(self) -> str:
            return "null"

    verdict = Episode(loads(ROOM.format(more=NEAR, robot="heading: 0")), 0).run(Still())
    assert verdict.done and verdict.deliveries == (2.0, 4.0) and verdict.times.home == 4.0


def test_the_reader_hears_the_strongest_beacon_and_names_it():
    at = world("donors: [{id: ann, at: [5, 0.3]}, {id: bob, at: [3, -0.3]}]")
    heard = let(at, STOP, 1.5).sense().ir
    assert heard is not None and heard.detected and heard.beacon == "bob"


def test_a_reader_that_hears_nothing_names_nobody():
    heard = let(world("donors: [{id: ann, at: [-5, 0]}]"), STOP, 1.5).sense().ir
    assert heard is not None and not heard.detected and heard.beacon == ""


def test_donors_have_names_of_their_own():
    with pytest.raises(ScenarioError, match="the name 'ann' is taken"):
        world("donors: [{id: ann, at: [1, 0]}, {id: ann, at: [3, 0]}]")
    with pytest.raises(ScenarioError, match="give 'donor' or 'donors', not both"):
        world("donors: [{id: ann, at: [1, 0]}]\ndonor: {at: [3, 0]}")


# --- the battery --------------------------------------------------------------------------------------


def test_driving_empties_the_battery_and_an_empty_one_stops_the_drive():
    at = let(world("", "battery: {lasts: 10 s, charges_in: 5 s}"), Command(Drive(0.2, 0.0)), 5)
    battery = at.sense().battery
    assert battery is not None and battery.level == pytest.approx(0.5, abs=0.03) and not battery.charging
    let(at, Command(Drive(0.2, 0.0)), 8)
    assert at.robot.standing and at.sense().battery.level == 0.0


def test_a_charger_fills_it_while_the_robot_stands_there():
    at = world(
        "things: [{kind: charger, at: [1, 0], reach: 0.6}]", "battery: {lasts: 10 s, charges_in: 5 s, level: 0.2}"
    )
    let(at, STOP, 2)
    battery = at.sense().battery
    assert battery.charging and battery.level == pytest.approx(0.6)
    assert let(at, STOP, 5).sense().battery.level == 1.0


def test_a_robot_without_a_battery_of_its_own_says_nothing_of_it():
    assert world("").sense().battery is None


# --- the head -----------------------------------------------------------------------------------------

DOWN = Command(head=Head(0.4, 0.8))


@pytest.mark.parametrize(
    ("jam", "jolt", "seconds", "freed"),
    [
        ("light-jam", Head(0.4, 0.0), 1.2, True),
        ("bad-jam", Head(0.4, 0.0), 5.0, False),
        ("bad-jam", Head(0.0, 0.0), 3.2, True),
        ("worst-jam", Head(0.0, 0.0), 20.0, False),
    ],
)
def test_a_stuck_head_gives_way_to_the_right_jolt(jam, jolt, seconds, freed):
    at = let(world(f"events: [{{at: 2, head: {jam}}}]"), DOWN, 3)
    assert not at.sense().head.settled
    let(at, Command(head=jolt), seconds)
    let(at, DOWN, 3)
    assert at.sense().head.settled is freed


def test_a_person_frees_even_the_worst_jam():
    at = let(world("events: [{at: 2, head: worst-jam}, {at: 4, head: free}]"), DOWN, 6)
    assert at.sense().head.settled


def test_steep_fixations_may_jam_the_head():
    at = world("", "stereo: {stuck: 1.0, period: 1}")
    let(at, DOWN, 4)
    assert at.head.jam > 0
    shallow = let(world("", "stereo: {stuck: 1.0, period: 1}"), Command(head=Head(0.0, math.radians(20))), 4)
    assert shallow.head.jam == 0
