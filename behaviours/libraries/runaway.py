"""Library `runaway`: away from what is suddenly close.

Takes: the parameters of a plan. Gives: percepts of danger, and the competence that flees. Leaves alone: where to.
"""

from __future__ import annotations

from behaviours.competences.runaway import Runaway
from behaviours.cores.runaway import RunawaySettings
from behaviours.cores.sectors import LidarRing, RingOf, skirt, waist
from behaviours.declaring import boolean, chosen, command, parameters, positive, settings_of
from behaviours.estimators.danger import Danger
from behaviours.interface import Function, Library, Offer, Parameter, Values, Workshop

_RUNAWAY = parameters(
    RunawaySettings(),
    ("safety_radius", "m", "A range below it, measured from the hull, is danger (printed in the paper)."),
    ("release", "m", "Danger ends this much beyond the safety radius (chosen here)."),
    ("max_speed", "m/s", "Greatest speed (printed in the paper)."),
    ("steering_gain", "", "Turn rate per angle, 1/s (chosen here)."),
    ("max_turn_rate", "rad/s", "Greatest turn rate (chosen here)."),
    ("min_range", "m", "Shorter ranges count as this, so that no echo outweighs all others (chosen here)."),
    ("pinch", "", "Below this share of their sum the echoes count as a symmetric pinch (chosen here)."),
)
RANGES = Parameter("ranges", "symbol", "", "sonar", "From `sonar` rings, or from a `lidar` in their place.")
_HULL = Parameter("hull-radius", "number", "m", 0.35, "From its middle to the hull, with `:ranges lidar` alone.")


def _build(values: Values, workshop: Workshop) -> Offer:
    settings = settings_of(RunawaySettings(), _RUNAWAY, values)
    hull = positive("hull-radius", float(values.get("hull-radius", _HULL.default)))
    from_lidar = chosen(RANGES, values, "sonar", "lidar") == "lidar"
    rings: tuple[RingOf, ...] = (LidarRing(hull),) if from_lidar else (waist, skirt)
    danger = workshop.share(Danger, lambda: Danger(settings, rings))
    return Offer(
        percepts={"anything-is-too-close": lambda: danger.is_near, "nearest-range": lambda: danger.nearest_range},
        competences={"move-away-from-danger": Runaway(lambda: danger.echoes, settings)},
    )


LIBRARY = Library(
    "runaway",
    "Away from what is suddenly close, forward or backward, whichever is quicker.",
    (
        boolean("anything-is-too-close", "An echo of either ring lies within the safety radius."),
        Function("nearest-range", "number", "The shortest range of both rings, from the hull.", unit="m"),
        command("move-away-from-danger", "Drive away from the echoes within the safety radius.", "drive"),
    ),
    (*_RUNAWAY, RANGES, _HULL),
    _build,
)
