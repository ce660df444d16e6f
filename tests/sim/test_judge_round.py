"""Going round a place is done once the robot has wound about it and is back; contacts fail it where they must."""

from __future__ import annotations

import pytest

from behaviours.interface import Command, Drive, Reading
from sim.episode import run
from sim.judge import Verdict
from sim.scenarios.format import loads
from sim.scenarios.schema import ScenarioError
from sim.world import World

ROBOT = "{model: pioneer, start: [2, 0], heading: 90 deg, sensors: []}"
TRACKED = "{model: packbot, start: [0, 0], sensors: []}"


class Circling:
    """A brain that drives a circle, faster and faster where `faster` [m/s2], and backwards from `back_at` [s] on."""

    def __init__(self, turn: float = 0.25, back_at: float = 1e9, speed: float = 0.5, faster: float = 0.0) -> None:
        self.turn, self.back_at, self.speed, self.faster = turn, back_at, speed, faster

    def reset(self) -> None:
        pass

    def note(self) -> str:
        return "null"

    def step(self, reading: Reading) -> Command:
        sign = 1 if reading.stamp < self.back_at else -1
        return Command(Drive(sign * (self.speed + self.faster * reading.stamp), sign * self.turn))


def driven(brain: Circling, rest: str = "", task: str = "{about: [0, 0]}", robot: str = ROBOT) -> Verdict:
    text = f"name: ring\nbounds: [-5, -5, 5, 5]\nrobot: {robot}\nround: {task}\ntime_limit: 70\n{rest}"
    return run(loads(text), 0, brain)


def wall_across(then: str) -> str:
    return f"things:\n- {then}\n"


# --- done -------------------------------------------------------------------------------------------


def test_once_round_and_back_is_done():
    verdict = driven(Circling())
    assert (verdict.task, verdict.done, verdict.reason, verdict.stage) == ("round", True, "", "done")
    assert verdict.share == 1.0 and verdict.times.arrival == pytest.approx(25.5, abs=1)
    assert verdict.distance == pytest.approx(12.6, abs=0.3)


def test_clockwise_counts_as_well():
    verdict = driven(Circling(-0.25), robot=ROBOT.replace("90 deg", "-90 deg"))
    assert verdict.done and verdict.share == 1.0


def test_two_turns_take_twice_as_long():
    verdict = driven(Circling(), task="{about: [0, 0], turns: 2}")
    assert verdict.times.arrival == pytest.approx(51, abs=1)


def test_a_round_about_another_place_does_not_count():
    verdict = driven(Circling(), task="{about: [4.5, 0]}")
    assert not verdict.done and verdict.share is not None and verdict.share < 0.2


def test_what_is_driven_back_is_taken_off():
    verdict = driven(Circling(back_at=30.0), "", "{about: [0, 0], turns: 2}")
    assert not verdict.done and verdict.share == pytest.approx(0.2, abs=0.03)


def test_it_is_not_done_until_the_robot_is_back():
    verdict = driven(Circling(speed=0.3, faster=0.01), task="{about: [1, 0], within: 10 cm}")
    assert (verdict.done, verdict.share, verdict.times.arrival) == (False, 1.0, None)
    assert verdict.reason.startswith("out of time at 70 s after the way round, ")
    assert verdict.reason.endswith(" m from the start")


def test_out_of_time_says_how_much_was_done():
    verdict = driven(Circling(0.05, speed=0.1))
    assert verdict.reason == f"out of time at 70 s on the way round: {verdict.share:.0%} of it done"
    assert verdict.share == pytest.approx(0.55, abs=0.03) and verdict.stage == "going round"


# --- contacts ---------------------------------------------------------------------------------------

POST = wall_across("{kind: post, at: [0, 2.2]}")


def test_without_the_rule_a_contact_is_only_told():
    verdict = driven(Circling(), POST)
    assert [touch.thing for touch in verdict.contacts] == ["post-1"] and verdict.stage != "touched"


def test_the_first_contact_fails_where_none_is_allowed():
    verdict = driven(Circling(), POST, "{about: [0, 0], no_contact: true}")
    assert (verdict.done, verdict.stage) == (False, "touched") and verdict.duration < 10
    assert verdict.reason.endswith(" on the way round, which must be driven without a contact: 23% of it done")


def curbed(height: str, more: str = "") -> Verdict:
    curb = wall_across(f"{{kind: curb, from: [1, -2], to: [1, 2], height: {height}}}") + more
    return driven(Circling(0.0), curb, "{about: [0, 5], no_contact: true}", TRACKED)


def test_a_curb_that_tracks_can_climb_is_ground():
    verdict = curbed("0.15")
    assert not verdict.contacts and verdict.stage == "going round" and verdict.smallest_clearance == 10


def test_a_curb_that_is_too_high_is_an_obstacle():
    verdict = curbed("0.3")
    assert [touch.thing for touch in verdict.contacts] == ["curb-1"] and verdict.stage == "touched"


@pytest.mark.parametrize(
    ("beside", "gap"),
    [
        ("{kind: disc, radius: 0.2, at: [0.3, 1]}", 0.54),
        ("{kind: box, size: [0.2, 0.2], at: [0.3, -1]}", 0.64),
        ("{kind: outline, rings: ['-1 1, 1 1, 1 2, -1 2']}", 0.74),
    ],
)
def test_clearance_is_measured_from_everything_but_the_curb(beside, gap):
    assert curbed("0.15", f"- {beside}\n").smallest_clearance == pytest.approx(gap, abs=0.01)


def test_a_round_robot_has_its_clearance_too():
    task, robot = "{about: [0, 5]}", TRACKED.replace("}", ", shape: {circle: 0.3}}")
    rest = wall_across("{kind: curb, from: [1, -2], to: [1, 2]}") + "- {kind: disc, radius: 0.2, at: [0.3, 1]}\n"
    assert driven(Circling(0.0), rest, task, robot).smallest_clearance == pytest.approx(0.5, abs=0.01)


# --- what a scenario says ---------------------------------------------------------------------------


def wrong(task: str, rest: str = "") -> str:
    with pytest.raises(ScenarioError) as caught:
        loads(f"name: ring\nbounds: [-5, -5, 5, 5]\nrobot: {ROBOT}\nround: {task}\n{rest}", "ring.yaml")
    return str(caught.value)


def test_mistakes_are_told_with_their_place():
    assert wrong("{}") == "ring.yaml:4:8: round.about: this key is missing"
    assert wrong("{about: [0, 0], turns: 0}").endswith("round.turns: expected a whole number from 1 to 1000, got '0'")
    assert "round.abouts: unknown key; did you mean 'about'?" in wrong("{abouts: [0, 0]}")


def test_there_is_one_task():
    assert "a scenario with 'round' has neither a donor nor a goal" in wrong("{about: [0, 0]}", "goal: {at: [1, 1]}")
    assert "a scenario with 'round' has neither a donor nor a goal" in wrong("{about: [0, 0]}", "donor: {at: [1, 1]}")


DRAWN = """
name: drawn
bounds: [-9, -9, 9, 9]
robot: {model: pioneer, start: [{between: [1, 2]}, 0]}
things:
- {kind: box, size: [1, 1], at: [5, {between: [-2, 2]}]}
"""


def test_the_seed_draws_places():
    worlds = [World(loads(DRAWN), seed) for seed in range(12)]
    starts = [world.start.x for world in worlds]
    boxes = [world.things[0].pose for world in worlds]
    assert all(1 <= x <= 2 for x in starts) and max(starts) - min(starts) > 0.5
    assert all(pose.x == 5 and abs(pose.y) <= 2 for pose in boxes) and len({pose.y for pose in boxes}) == 12
    assert World(loads(DRAWN), 3).start == worlds[3].start


def test_a_wrong_draw_of_a_place_is_told():
    with pytest.raises(ScenarioError, match="the first of the two numbers must not be the greater"):
        loads(DRAWN.replace("[1, 2]", "[2, 1]"))
    with pytest.raises(ScenarioError, match=r"robot.start\[0\].between: expected two lengths \[from, to\]"):
        loads(DRAWN.replace("[1, 2]", "2"))
