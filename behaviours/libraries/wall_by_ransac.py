"""Following a wall on a fitted curve.

Takes: the values of a plan. Gives: the library `wall-by-ransac`. Leaves alone: how it is done.
"""

from __future__ import annotations

import math
from dataclasses import replace

from behaviours.competences.follow_wall import ClearSettings, FollowWall, FollowWallClear, PaceSettings
from behaviours.cores.corner import CornerSettings
from behaviours.cores.hull_paths import Motors
from behaviours.cores.view_path import ViewPath
from behaviours.cores.wall_fit import FitSettings
from behaviours.cores.wall_law import LawSettings
from behaviours.declaring import boolean, chosen, command, number, parameters, positive, settings_of
from behaviours.estimators.fitted_wall import FittedWall, FittedWallSettings
from behaviours.estimators.wall_and_corners import AroundSettings, WallAndCorners
from behaviours.interface import Library, Offer, Parameter, Values, Workshop

_PRESET = Parameter("preset", "symbol", "", "paper", "`paper`, `tuned` (critically damped), or `modern` (corners).")
_SIDE = Parameter("side", "symbol", "", "right", "The wall is to the `left` or to the `right`.")
_LOSS = Parameter("wall-loss", "symbol", "", "on", "Points are invented where the wall ends: `on` or `off`.")
_CURVE = Parameter("curvature", "symbol", "", "on", "The curvature of the wall counts: `on` or `off`.")
_VIEW_ANGLE = Parameter("view-angle", "number", "rad", math.radians(60), "Of the view path, from ahead to the wall.")
_VIEW = parameters(ViewPath(), ("width", "m", "Of the view path."), ("reach", "m", "How far the lidar sees."))
_LAW = parameters(
    LawSettings(),
    ("stand_off", "m", "Wanted distance to the wall."),
    ("gain", "", "k of equation (2) [1/m]."),
    ("curvature_gain", "", "Factor of the curvature (chosen here)."),
    ("most", "rad/s", "Greatest turn rate (chosen here)."),
)
_FIT = parameters(
    FitSettings(),
    ("iterations", "", "Of the sampling."),
    ("share", "", "A wall has so many of the points looked at."),
    ("least", "", "A wall has so many points."),
    ("residual", "", "A wall so straight is taken at once [m²] (repaired)."),
    ("acquire_band", "m", "Points so near to a line are on it, while one is looked for."),
    ("track_band", "m", "The same while one is followed."),
)
_PACE = parameters(PaceSettings(), ("speed", "m/s", "0.32 m/s for each of X-RHex's units, 1.5 of them."))
_CLEAR = parameters(
    AroundSettings(),
    ("hull_radius", "m", "With `modern`: from the middle of the robot as far as it reaches."),
    ("margin", "m", "With `modern`: kept between the hull and what is seen (chosen here)."),
)
_PATIENCE = parameters(
    AroundSettings(), ("patience", "s", "With `modern`: a lost wall is looked for so long (chosen here).")
)
_CORNER = parameters(
    CornerSettings(),
    ("door", "m", "With `modern`: an opening no wider is passed by where the wall goes on behind it (chosen here)."),
)
_MOTORS = parameters(
    Motors(2.0, 8.0, 0.1, 0.1),
    ("acceleration", "m/s^2", "With `modern`: how fast the robot brakes (X-RHex)."),
    ("turn_acceleration", "rad/s^2", "With `modern`: how fast it changes its turn rate (X-RHex)."),
)


def _wall(values: Values) -> FittedWall:
    preset = chosen(_PRESET, values, "paper", "tuned", "modern")
    law = settings_of(LawSettings(), _LAW, values)
    positive("stand-off", law.stand_off)
    fit = settings_of(FitSettings(), _FIT, values)
    if preset != "paper":
        law = replace(law, offset_gain=law.gain**2 / 4)
        fit = replace(fit, track_band=float(values.get("track-band", 0.35)))
    angle = -float(values.get(_VIEW_ANGLE.name, _VIEW_ANGLE.default))
    view = replace(settings_of(ViewPath(), _VIEW, values), angle=angle)
    modern = preset == "modern"
    settings = FittedWallSettings(
        left=chosen(_SIDE, values, "left", "right") == "left",
        loss=chosen(_LOSS, values, "on", "off") == "on",
        curve=chosen(_CURVE, values, "on", "off") == "on" and not modern,
        fit=replace(fit, patient=modern, track_band=min(fit.track_band, 0.12) if modern else fit.track_band),
        view=view,
        law=law,
    )
    return WallAndCorners(settings, _around(values)) if modern else FittedWall(settings)


def _around(values: Values) -> AroundSettings:
    settings = settings_of(AroundSettings(), (*_CLEAR, *_PATIENCE), values)
    positive("hull-radius", settings.hull_radius)
    return replace(settings, corner=settings_of(CornerSettings(), _CORNER, values))


def _competence(wall: FittedWall, values: Values) -> FollowWall | FollowWallClear:
    pace = settings_of(PaceSettings(), _PACE, values)
    if not isinstance(wall, WallAndCorners):
        return FollowWall(wall, pace)
    motors = settings_of(Motors(2.0, 8.0, 0.1, 0.1), _MOTORS, values)
    positive("acceleration", motors.acceleration)
    positive("turn-acceleration", motors.turn_acceleration)
    return FollowWallClear(wall, pace, replace(settings_of(ClearSettings(), _CLEAR, values), motors=motors))


def _build(values: Values, workshop: Workshop) -> Offer:
    wall = workshop.share(FittedWall, lambda: _wall(values))
    return Offer(
        percepts={
            "wall-found": lambda: wall.is_found,
            "wall-lost": lambda: wall.mode == "lost",
            "wall-ends": lambda: wall.ends,
            "corner-ahead": lambda: wall.bars,
            "the-wall-distance": lambda: target[0] if (target := wall.target()) is not None else 0.0,
            "the-wall-angle": lambda: target[1] if (target := wall.target()) is not None else 0.0,
        },
        competences={"follow-wall": _competence(wall, values)},
        views={"wall-line": wall.line_view, "wall-points": wall.inliers_view, "invented-points": wall.added_view},
    )


LIBRARY = Library(
    "wall-by-ransac",
    "Along a wall that is fitted to every scan as a straight line, with its curvature.",
    (
        boolean("wall-found", "A wall is followed."),
        boolean("wall-lost", "There was one, and it is no longer seen."),
        boolean("wall-ends", "It ends within the view."),
        boolean("corner-ahead", "Something bars the way where the robot should turn."),
        number("the-wall-distance", "m", "From the middle of the robot; 0 without a wall."),
        number("the-wall-angle", "rad", "Of the heading against the wall, positive away from it; 0 without a wall."),
        command("follow-wall", "Drive along the wall; stand without one.", "drive"),
    ),
    (_PRESET, _SIDE, *_LAW, *_PACE, _VIEW_ANGLE, *_VIEW, *_FIT, _LOSS, _CURVE, *_CLEAR, *_PATIENCE, *_CORNER, *_MOTORS),
    _build,
)
