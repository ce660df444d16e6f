"""Library `drive`: steady motion, whatever the sensors say.

Takes: the parameters of a plan. Gives: competences. Leaves alone: obstacles.
"""

from __future__ import annotations

from behaviours.competences.steady import Steady
from behaviours.declaring import command
from behaviours.interface import Library, Offer, Parameter, Values, Workshop

_STEADY = (
    Parameter("speed", "number", "m/s", 0.2, "Ahead and back."),
    Parameter("turn-rate", "number", "rad/s", 0.5, "On the spot."),
)


def _build(values: Values, workshop: Workshop) -> Offer:
    speed, turn_rate = (float(values.get(parameter.name, parameter.default)) for parameter in _STEADY)
    return Offer(
        competences={
            "drive-ahead": Steady(speed, 0.0),
            "back-up": Steady(-speed, 0.0),
            "turn-left": Steady(0.0, turn_rate),
            "turn-right": Steady(0.0, -turn_rate),
        }
    )


LIBRARY = Library(
    "drive",
    "Steady motion, whatever the sensors say.",
    (
        command("drive-ahead", "Straight ahead.", "drive"),
        command("back-up", "Straight back.", "drive"),
        command("turn-left", "To the left on the spot.", "drive"),
        command("turn-right", "To the right on the spot.", "drive"),
    ),
    _STEADY,
    _build,
)
