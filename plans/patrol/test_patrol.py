"""The patrol, tick by tick and in the yard: round after round, and never with an empty battery."""

from __future__ import annotations

from pathlib import Path

import pytest

from rplan.apps.wiring import PlanBrain, compile_file
from sim.episode import Episode
from sim.scenarios.format import load

HERE = Path(__file__).parent
PLAN = compile_file(HERE / "patrol.rplan")
YARD = load(HERE / "yard.yaml")


class Levels:
    """The level of the battery at every tick."""

    def __init__(self) -> None:
        self.levels: list[float] = []
        self.charging = 0

    def observe(self, episode: Episode) -> None:
        battery = episode.world.sense().battery
        assert battery is not None
        self.levels.append(battery.level)
        self.charging += battery.charging


def test_the_golden_ticks_stand(plan):
    plan("patrol.rplan").golden("patrol.ticks")


@pytest.mark.parametrize("seed", [0, 1])
def test_it_goes_on_for_a_quarter_of_an_hour_and_charges_in_time(seed):
    watch = Levels()
    verdict = Episode(YARD, seed).run(PlanBrain(PLAN), 900, watch)
    assert verdict.driven_into == 0
    assert min(watch.levels) > 0.05 and watch.charging > 300
    assert verdict.distance > 45


def test_the_round_is_made_in_its_order():
    class Places:
        def __init__(self) -> None:
            self.seen: list[tuple[float, float]] = []

        def observe(self, episode: Episode) -> None:
            pose = episode.world.robot.pose
            for place in ((7.0, 0.0), (7.0, 5.0), (0.0, 5.0)):
                near = (pose.x - place[0]) ** 2 + (pose.y - place[1]) ** 2 < 0.8**2
                if near and (not self.seen or self.seen[-1] != place):
                    self.seen.append(place)

    places = Places()
    Episode(YARD, 0).run(PlanBrain(PLAN), 450, places)
    assert places.seen[:3] == [(7.0, 0.0), (7.0, 5.0), (0.0, 5.0)]
