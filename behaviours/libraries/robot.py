"""Library `robot`: what every robot can do.

Takes: the parameters of a plan. Gives: standing still, its speed and the time. Leaves alone: where it goes.
"""

from __future__ import annotations

from behaviours.competences.stop import Stop
from behaviours.declaring import command
from behaviours.estimators.latest import Latest
from behaviours.interface import Function, Library, Offer, Values, Workshop


def _build(values: Values, workshop: Workshop) -> Offer:
    latest = workshop.share(Latest, Latest)
    return Offer(
        percepts={"speed": latest.speed, "time-since-start": latest.time_since_start},
        competences={"stop": Stop()},
    )


LIBRARY = Library(
    "robot",
    "What every robot can do.",
    (
        Function("speed", "number", "Speed along the drive heading, negative backwards.", unit="m/s"),
        Function("time-since-start", "number", "Stamp of the latest reading.", unit="s"),
        command("stop", "Stand still; the head stays where it is.", "drive"),
    ),
    (),
    _build,
)
