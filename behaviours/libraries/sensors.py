"""Library `sensors`: what the sensors say, for any robot.

Takes: the parameters of a plan. Gives: percepts. Leaves alone: what follows from it.
"""

from __future__ import annotations

import math

from behaviours.declaring import boolean, number, parameters, settings_of
from behaviours.estimators.sensed import Sensed, SensedSettings
from behaviours.interface import Library, Offer, Values, Workshop

_SENSED = parameters(
    SensedSettings(),
    ("sector", "rad", "Half the angle of a direction of the lidar."),
    ("far", "m", "The range where the lidar meets nothing, and before its first scan."),
    ("patience", "s", "A sensor without a sound value for longer is lost."),
)


def _build(values: Values, workshop: Workshop) -> Offer:
    settings = settings_of(SensedSettings(), _SENSED, values)
    sensed = workshop.share(Sensed, lambda: Sensed(settings))
    return Offer(
        percepts={
            "lidar-range-ahead": lambda: sensed.range_towards(0.0),
            "lidar-range-left": lambda: sensed.range_towards(math.pi / 2),
            "lidar-range-right": lambda: sensed.range_towards(-math.pi / 2),
            "lidar-range-behind": lambda: sensed.range_towards(math.pi),
            "lidar-nearest-range": sensed.nearest_range,
            "lidar-nearest-bearing": sensed.nearest_bearing,
            "lidar-is-lost": sensed.lidar_is_lost,
            "compass-heading": lambda: sensed.heading,
            "compass-is-lost": sensed.compass_is_lost,
            "turn-rate": lambda: sensed.turn_rate,
            "pitch": lambda: sensed.pitch,
            "roll": lambda: sensed.roll,
            "motor-current": lambda: sensed.current,
            "bumped": lambda: sensed.bumped,
        }
    )


LIBRARY = Library(
    "sensors",
    "What the sensors say, the last sound value of each: for any robot, and for recordings.",
    (
        number("lidar-range-ahead", "m", "Least range ahead."),
        number("lidar-range-left", "m", "Least range to the left."),
        number("lidar-range-right", "m", "Least range to the right."),
        number("lidar-range-behind", "m", "Least range behind."),
        number("lidar-nearest-range", "m", "Least range of the whole scan."),
        number("lidar-nearest-bearing", "rad", "Where the least range was met, left positive."),
        boolean("lidar-is-lost", "No sound scan has come for some time."),
        number("compass-heading", "rad", "Heading in the world."),
        boolean("compass-is-lost", "No sound heading has come for some time."),
        number("turn-rate", "rad/s", "Of the IMU, or of odometry without one."),
        number("pitch", "rad", "Nose up positive."),
        number("roll", "rad", "Left side up positive."),
        number("motor-current", "A", "The greater of both motors."),
        boolean("bumped", "A contact switch is pressed."),
    ),
    _SENSED,
    _build,
)
