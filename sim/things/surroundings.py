"""What the things of a world know of one another at the start of a tick.

Takes: nothing. Gives: `Surroundings` and when a trigger goes off. Leaves alone: who looks at them, and when.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from behaviours.interface import Vec2
from sim.things.thing import At, RobotLeft, RobotWithin, Thing, Trigger


@dataclass(frozen=True, slots=True)
class Disc:
    """What may stand in the way: index of the thing (-1: the robot), centre and radius [m]."""

    index: int
    x: float
    y: float
    radius: float


@dataclass(frozen=True, slots=True)
class Surroundings:
    """time [s]; dt [s]: length of the tick; robot_way [m]: how far it is from its start; others: all that can move."""

    time: float
    dt: float
    robot: Disc
    robot_way: float
    others: Callable[[], tuple[Disc, ...]]

    def gap_to_robot(self, place: Vec2, radius: float) -> float:
        """Distance [m] between the hulls."""
        return math.hypot(place[0] - self.robot.x, place[1] - self.robot.y) - radius - self.robot.radius


def goes_off(trigger: Trigger, thing: Thing, around: Surroundings) -> bool:
    """Whether the moment has come."""
    match trigger:
        case At(time):
            return around.time >= time
        case RobotWithin(distance):
            return around.gap_to_robot((thing.x, thing.y), thing.reach) <= distance
        case RobotLeft(distance):
            return around.robot_way >= distance
