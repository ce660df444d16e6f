"""Library `patrol`: a round of four places, and a charger.

Takes: the parameters of a plan. Gives: percepts of the battery and the round, and places. Leaves alone: the way between
the places.
"""

from __future__ import annotations

from behaviours.declaring import boolean, parameters
from behaviours.estimators.patrol import Patrol, PatrolSettings
from behaviours.interface import Function, Library, Offer, Parameter, Values, Workshop

_PATROL = (
    *parameters(
        PatrolSettings(),
        ("length", "m", "Of the round, ahead of the start."),
        ("width", "m", "Of the round, to the left of the start."),
        ("within", "m", "A place has been visited this near to it."),
    ),
    Parameter(
        "charger-x", "number", "m", PatrolSettings().charger_x, "Where to stand for charging, ahead of the start."
    ),
    Parameter("charger-y", "number", "m", PatrolSettings().charger_y, "Where to charge, to the left of the start."),
)


def _build(values: Values, workshop: Workshop) -> Offer:
    numbers = {p.name.replace("-", "_"): float(values.get(p.name, p.default)) for p in _PATROL}
    if min(numbers["length"], numbers["width"], numbers["within"]) <= 0:
        raise ValueError("length, width and within must be greater than 0")
    patrol = workshop.share(Patrol, lambda: Patrol(PatrolSettings(**numbers)))
    return Offer(
        percepts={
            "battery-level": lambda: patrol.level,
            "the-battery-is-charged": lambda: patrol.is_charging,
            "rounds-made": patrol.rounds,
        },
        values={"the-next-place": lambda _: patrol.next_place(), "the-charger": lambda _: patrol.charger()},
    )


LIBRARY = Library(
    "patrol",
    "A round of four places, and a charger to return to.",
    (
        Function("battery-level", "number", "From 0, empty, to 1; 1 on a robot that has none."),
        boolean("the-battery-is-charged", "A charger fills it now."),
        Function("rounds-made", "number", "Whole rounds."),
        Function("the-next-place", "pose", "Of the round."),
        Function("the-charger", "pose", "Where to stand for charging."),
    ),
    _PATROL,
    _build,
)
