"""Small worlds for the tests of the simulator, and hand-written brains to drive in them."""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest

from behaviours.interface import STOP, Command, Drive, Reading, Vec2, wrap
from sim.scenarios.format import loads
from sim.scenarios.scenario import Scenario

BARE = """
name: small world
bounds: [-10, -10, 10, 10]
robot: {{start: [0, 0], heading: {heading}, sonar: {{dropout: 0, sd: 0}}, odometry: {{scale_sd: 0, turn_sd: 0}}}}
donor: {{at: {donor}, {more_donor}}}
things: [{things}]
{more}
"""

Worlds = Callable[..., Scenario]


@pytest.fixture
def small() -> Worlds:
    """A scenario around a robot without noise at the origin; things are YAML flow mappings."""

    def make(
        *things: str, donor: str = "[0, 50]", more_donor: str = "hand_over: 15", heading: str = "0", more: str = ""
    ) -> Scenario:
        text = BARE.format(things=", ".join(things), donor=donor, more_donor=more_donor, heading=heading, more=more)
        return loads(text, "small.yaml")

    return make


class GoAndReturn:
    """Drives straight to a place by dead reckoning, waits for the object, and drives straight back."""

    def __init__(self, goal: Vec2, tolerance: float) -> None:
        self.goal, self.tolerance, self.resets = goal, tolerance, 0

    def reset(self) -> None:
        self.resets += 1

    def note(self) -> str:
        return '{"brain": "straight"}'

    def step(self, reading: Reading) -> Command:
        pose = reading.odometry.pose
        (x, y), near = ((0.0, 0.0), 0.1) if reading.object_on_board else (self.goal, self.tolerance)
        if math.hypot(x - pose.x, y - pose.y) < near:
            return STOP
        error = wrap(math.atan2(y - pose.y, x - pose.x) - pose.theta)
        return Command(Drive(0.2 * max(0.0, math.cos(error)) ** 2, 1.5 * error))


@pytest.fixture
def go_and_return() -> Callable[[Vec2, float], GoAndReturn]:
    return GoAndReturn
