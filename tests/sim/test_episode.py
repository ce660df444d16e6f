"""A run ends as it should, is judged by the truth, and is the same again with the same seed."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest

from behaviours.interface import STOP, Command, Drive, Head, Reading
from sim.episode import Episode, run
from sim.judge import Judge
from sim.scenarios.format import load
from sim.world import World

LOT = load(Path(__file__).parents[2] / "plans" / "find_and_fetch" / "parking_lot.yaml")


class Keeping:
    """An observer that keeps every snapshot."""

    def __init__(self) -> None:
        self.snapshots: list[dict] = []
        self.notes: list[str] = []

    def observe(self, episode: Episode) -> None:
        self.snapshots.append(episode.snapshot())
        self.notes.append(episode.note)


class Wandering:
    """A brain that uses all actuators."""

    def reset(self) -> None:
        pass

    def note(self) -> str:
        return "null"

    def step(self, reading: Reading) -> Command:
        near = reading.sonar is not None and reading.sonar.ranges.min() < 0.5
        return Command(
            Drive(0.1 if near else 0.2, 0.4 * math.sin(reading.stamp / 3)), Head(0.5 * (reading.tick // 100), 0.3)
        )


class Faulty(Wandering):
    """A brain that raises after a second."""

    def step(self, reading: Reading) -> Command:
        if reading.tick == 10:
            raise ArithmeticError("no idea")
        return Command(Drive(0.2, 0.0))


# --- the task -------------------------------------------------------------------------------------


def test_a_straight_driver_fetches_the_object_in_an_empty_world(small, go_and_return):
    brain = go_and_return((4.0, 0.0), 0.9)
    verdict = run(small(donor="[4, 0]"), 0, brain, 200)
    assert (verdict.done, verdict.reason, verdict.stage, brain.resets) == (True, "", "done", 1)
    times = verdict.times
    assert times.departure == pytest.approx(0.3 / 0.2, abs=0.4)
    assert times.arrival == pytest.approx((4 - 0.9) / 0.2, abs=1.0)
    assert times.loaded is not None and times.arrival is not None and times.home is not None
    assert times.loaded - times.arrival == pytest.approx(15, abs=0.11)
    assert times.home > times.loaded + 10
    assert verdict.one_way == times.arrival - times.departure
    assert verdict.round_trip == times.home - times.departure
    assert verdict.duration == times.home
    assert verdict.distance == pytest.approx(2 * 3.1, abs=0.2)
    assert verdict.contacts == ()
    assert verdict.smallest_clearance == pytest.approx(4 - 3.1 - 0.6, abs=0.08)


@pytest.mark.parametrize(
    ("until", "stage", "reason"),
    [
        (5, "to the donor", "out of time at 5 s before it came to the donor"),
        (22, "hand-over", "out of time at 22 s during the hand-over"),
        (38, "return", "out of time at 38 s on the way back"),
    ],
)
def test_a_run_that_is_out_of_time_says_at_which_stage(small, go_and_return, until, stage, reason):
    verdict = run(small(donor="[4, 0]"), 0, go_and_return((4.0, 0.0), 0.9), until)
    assert (verdict.done, verdict.stage, verdict.reason) == (False, stage, reason)
    assert verdict.round_trip is None


def test_a_run_that_never_arrives_has_no_times(small, go_and_return):
    verdict = run(small(), 0, go_and_return((4.0, 0.0), 0.9), 30)
    assert (verdict.one_way, verdict.times.departure, verdict.times.loaded) == (None, None, None)


def test_without_a_limit_the_scenario_has_the_word(small, go_and_return):
    verdict = run(small(more="time_limit: 3"), 0, go_and_return((4.0, 0.0), 0.9))
    assert verdict.duration == pytest.approx(3.0)


def test_being_home_with_the_object_counts_only_when_the_robot_stands(small):
    world = World(small(donor="[1.5, 0]"), 0)
    judge = Judge(world)
    for tick in range(200):
        world.step(STOP if tick < 152 else Command(Drive(0.1 * (-1) ** (tick // 10), 0.0)))
        judge.observe()
    assert judge.stage == "return"
    for _ in range(14):
        world.step(STOP)
        judge.observe()
    assert judge.done


def test_contacts_are_told_with_who_drove_into_whom(small, go_and_return):
    car = "{kind: car, id: lorry, track: [[-20, 0], [20, 0]], speed: 9, starts: {at: 6}}"  # cannot brake in time
    verdict = run(small("{kind: wall, from: [0.6, -1], to: [0.6, 1], id: wall}", car), 0, go_and_return((3, 0), 1), 12)
    assert [(touch.thing, touch.driven_into) for touch in verdict.contacts] == [("wall", True), ("lorry", False)]
    assert verdict.driven_into == 1
    assert verdict.smallest_clearance < 0


def test_scraping_along_is_one_contact(small):
    class Scraper(Wandering):
        def step(self, reading: Reading) -> Command:
            return Command(Drive(0.2, 0.0))

    verdict = run(small("{kind: wall, from: [-1, 0.6], to: [3, 1.0]}", heading="0.3"), 0, Scraper(), 12)
    assert len(verdict.contacts) == 1


# --- stopping -------------------------------------------------------------------------------------


def test_when_the_brain_raises_the_robot_is_stopped_and_the_fault_goes_on(small):
    episode = Episode(small(), 0)
    with pytest.raises(ArithmeticError, match="no idea"):
        episode.run(Faulty(), 5)
    assert episode.command == STOP
    assert episode.world.tick == 11
    assert episode.world.robot.speed < 0.2


def test_the_last_command_of_a_run_is_stop(small):
    keeping = Keeping()
    run(small(), 0, Wandering(), 2, keeping)
    assert keeping.snapshots[-1]["command"] == {"drive": [0.0, 0.0]}
    assert keeping.snapshots[-2]["command"]["drive"][0] == 0.2


# --- what recordings get --------------------------------------------------------------------------


def test_the_observer_sees_every_tick_and_the_end(small, go_and_return):
    keeping = Keeping()
    run(small(), 0, go_and_return((4, 0), 1), 1, keeping)
    assert [snapshot["t"] for snapshot in keeping.snapshots] == [*(n / 10 for n in range(10)), 1.1]
    assert keeping.notes == ['{"brain": "straight"}'] * 10 + ["null"]


def test_header_and_snapshots_are_json_and_small():
    keeping = Keeping()
    episode = Episode(LOT, 1)
    episode.run(Wandering(), 15, keeping)
    header = json.loads(json.dumps(episode.header(), allow_nan=False))
    assert header["robot"] == {"radius": 0.35, "shape": {"circle": 0.35}, "height": 1.2}
    assert header["donor"]["pose"] == [7.62, 0.0, 0.0]
    assert [mover["id"] for mover in header["movers"]][:4] == ["donor", "driving-car", "walker", "rolled-trashcan"]
    assert {"wall-1", "parked-car-7"} & {thing["id"] for thing in header["things"]}
    shapes = {thing["id"]: thing["shape"] for thing in header["things"]}
    assert shapes["wall-1"]["polygon"][0] == [-10.0, -0.1]
    texts = [json.dumps(snapshot, allow_nan=False) for snapshot in keeping.snapshots]
    assert max(map(len, texts)) < 1000


def test_a_snapshot_carries_sensors_only_when_they_are_fresh(small):
    keeping = Keeping()
    run(small("{kind: post, at: [2, 0]}", donor="[5, 0]"), 0, Wandering(), 25, keeping)
    assert ["sonar" in snapshot for snapshot in keeping.snapshots[:6]] == [True, False, False] * 2
    assert len(keeping.snapshots[0]["sonar"]) == 30
    assert sum("ir" in snapshot for snapshot in keeping.snapshots) in (22, 23, 24)
    assert {"pan", "detected", "offset", "strength"} == set(next(s["ir"] for s in keeping.snapshots if "ir" in s))
    assert all("stereo" not in snapshot for snapshot in keeping.snapshots)


def test_a_car_is_in_the_snapshot_only_while_it_is_in_the_world(small):
    keeping = Keeping()
    car = "{kind: car, id: car, track: [[-5, 4], [5, 4]], speed: 5, starts: {at: 1}}"
    run(small(car), 0, Wandering(), 5, keeping)
    there = ["car" in snapshot["movers"] for snapshot in keeping.snapshots]
    assert (there[0], there[20], there[-1]) == (False, True, False)


# --- again ----------------------------------------------------------------------------------------


def sixty_seconds(seed: int) -> str:
    keeping = Keeping()
    episode = Episode(LOT, seed)
    episode.run(Wandering(), 60, keeping)
    return json.dumps([episode.header(), *keeping.snapshots])


def test_the_same_seed_gives_the_same_run_and_another_one_another():
    first = sixty_seconds(7)
    assert sixty_seconds(7) == first
    assert sixty_seconds(8) != first


def test_the_run_does_not_depend_on_who_watches():
    watched, alone = Episode(LOT, 7), Episode(LOT, 7)
    watched.run(Wandering(), 20, Keeping())
    alone.run(Wandering(), 20)
    assert watched.snapshot() == alone.snapshot()
