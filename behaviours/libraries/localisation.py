"""The library `localisation`: where the robot is, by compass and odometry.

Takes: what a plan gives. Gives: its words, and the shared estimate that other libraries take. Leaves alone: the maps.
"""

from __future__ import annotations

from dataclasses import replace

from behaviours.cores.hybrid import HeadingModel
from behaviours.declaring import chosen, number, parameters, positive, settings_of
from behaviours.estimators.localisation import Localisation, LocalisationSettings
from behaviours.interface import Library, Offer, Parameter, Pose, Values, View, Workshop
from behaviours.libraries.sharing import localisation

_PRESET = Parameter(
    "preset",
    "symbol",
    "",
    "paper",
    "`paper`: the heading of the compass as it is; `modern`: filtered with the gyroscope's and odometry's.",
)
_COMPASS = Parameter("compass", "bool", "", True, "The heading is the compass's; otherwise odometry's alone.")
_MODEL = parameters(
    HeadingModel(),
    ("compass_noise", "rad", "Modern: standard deviation of a reading of the compass (chosen here)."),
    ("iron", "rad", "Modern: standard deviation of what iron adds to the compass (chosen here)."),
    ("iron_length", "m", "Modern: over so much way that changes (chosen here)."),
    ("gyro_noise", "rad/s", "Modern: standard deviation of a reading of the gyroscope (chosen here)."),
    ("gyro_drift", "rad/s", "Modern: standard deviation of what it says at rest (chosen here)."),
    ("slip", "", "Modern: standard deviation of the turns of odometry, by share (chosen here)."),
    ("gate", "", "Modern: a compass off by more standard deviations is not believed (chosen here)."),
)


def _settings(values: Values) -> LocalisationSettings:
    model = settings_of(HeadingModel(), _MODEL, values)
    for parameter in _MODEL:
        positive(parameter.name, getattr(model, parameter.name.replace("-", "_")))
    modern = chosen(_PRESET, values, "paper", "modern") == "modern"
    settings = LocalisationSettings(bool(values.get("compass", _COMPASS.default)), modern)
    return replace(settings, model=model) if modern else settings


def _pose_view(place: Localisation, pose: Pose) -> View:
    at = [round(pose.x, 3), round(pose.y, 3), round(pose.theta, 4)]
    return {"kind": "pose", "frame": place.frame, "at": at}


def _build(values: Values, workshop: Workshop) -> Offer:
    place = localisation(workshop, _settings(values))
    return Offer(
        percepts={
            "the-heading": lambda: place.heading,
            "distance-travelled": lambda: place.travelled,
            "distance-from-start": place.from_start,
        },
        views={
            "believed-pose": lambda: _pose_view(place, place.pose),
            "odometry-pose": lambda: _pose_view(place, place.odometry),
        },
    )


LIBRARY = Library(
    "localisation",
    "Where the robot is, by the distance of odometry along the heading of a compass. Use it before what builds on it.",
    (
        number("the-heading", "rad", "In the map frame: the world's with a compass, else from the first heading."),
        number("distance-travelled", "m", "Of the way made, forwards and backwards alike."),
        number("distance-from-start", "m", "From where the first reading was made, as believed."),
    ),
    (_PRESET, _COMPASS, *_MODEL),
    _build,
    works_unasked=True,
)
