"""`perimeter`: along the walls of a building, as the navigation payload of Yamauchi 2005 does it.

Takes: what a plan sets. Gives: the library. Leaves alone: which one steers (`svfh`).
"""

from __future__ import annotations

import math
from dataclasses import replace

from behaviours.cores.contour import ContourSettings
from behaviours.cores.hough import HoughSettings
from behaviours.cores.orientation import FollowSettings
from behaviours.declaring import boolean, chosen, number, parameters, positive, settings_of
from behaviours.estimators.walls import RoundSettings, Walls, WallsSettings
from behaviours.interface import Function, Library, Offer, Parameter, Values, View, Workshop
from behaviours.libraries.sharing import localisation, surroundings

_PRESET = Parameter(
    "preset",
    "symbol",
    "",
    "paper",
    "`paper`: along the strongest line; `modern`: a disc rolls along what stands there.",
)
_SIDE = Parameter("side", "symbol", "", "left", "The wall is kept to the `left` or to the `right`.")
_FOLLOW = parameters(
    FollowSettings(),
    ("stand_off", "m", "Wanted distance from the middle of the robot to the wall (printed in the paper)."),
    ("gain", "", "How steeply a metre off it is corrected, rad/m (printed in the paper)."),
    ("steepest", "rad", "The steepest correction (printed in the paper)."),
    ("decay", "", "Share of the tally of orientations that each scan replaces (chosen here)."),
    ("backwards", "rad", "A line that would turn the robot by more does not vote (chosen here)."),
)
_HOUGH = parameters(
    HoughSettings(),
    ("least_votes", "", "Fewer points make no line (chosen here)."),
    ("peaks", "", "The most lines of a scan (chosen here)."),
    ("band", "m", "A line is fitted to the points so near to it (chosen here)."),
)
_CONTOUR = parameters(
    ContourSettings(),
    ("look_ahead", "m", "With `modern`: the disc is swept so far; with the stand-off, the window of `svfh`."),
    ("regain", "", "With `modern`: how steeply a metre off the stand-off is corrected, rad/m (chosen here)."),
    ("snap", "m", "With `modern`: points so near to a line lie on it (chosen here)."),
    ("leap", "m", "With `modern`: the place of contact moves by no more from scan to scan (chosen here)."),
)
_REFINE = Parameter(
    "refine", "symbol", "", "on", "`on`: lines are fitted to their points; `off`: they are middles of bins."
)
BACK = math.radians(90.0)
"""Before the disc turns the robot back, and not only aside, smaller ones are tried (chosen here)."""
_ROUND = parameters(
    RoundSettings(),
    ("round_within", "m", "The robot has come round so near to where it began (chosen here)."),
    ("round_after", "m", "And not before it has driven so far (chosen here)."),
)


def _contour(values: Values, follow: FollowSettings) -> ContourSettings:
    contour = settings_of(ContourSettings(), _CONTOUR, values)
    positive("look-ahead", contour.look_ahead)
    return replace(contour, steepest=follow.steepest, back=BACK, least=min(contour.least, follow.stand_off))


def walls_settings(values: Values) -> WallsSettings:
    """The settings of the estimator that a plan asks for. Raises ValueError."""
    follow = settings_of(FollowSettings(), _FOLLOW, values)
    positive("stand-off", follow.stand_off)
    positive("decay", follow.decay)
    if follow.decay > 1.0:
        raise ValueError(f"decay must be a share of 1, not {follow.decay}")
    hough = settings_of(HoughSettings(), _HOUGH, values)
    refine = chosen(_REFINE, values, "on", "off") == "on"
    return WallsSettings(
        follow,
        HoughSettings(hough.least_votes, hough.peaks, refine, positive("band", hough.band)),
        settings_of(RoundSettings(), _ROUND, values),
        chosen(_SIDE, values, "left", "right") == "right",
        _contour(values, follow) if chosen(_PRESET, values, "paper", "modern") == "modern" else None,
    )


def _build(values: Values, workshop: Workshop) -> Offer:
    settings = walls_settings(values)
    place, around = localisation(workshop), surroundings(workshop)
    walls = workshop.share(Walls, lambda: Walls(settings, place, around))

    def wall_line() -> View | None:
        at = walls.seen()
        return None if at is None else {"kind": "lines", "frame": "robot", "at": [[round(x, 3) for x in at]]}

    def wanted_heading() -> View | None:
        return {"kind": "heading", "frame": place.frame, "at": round(walls.wanted, 4)} if around.fresh else None

    return Offer(
        percepts={
            "a-wall-is-tracked": lambda: walls.line is not None,
            "the-wall-distance": lambda: walls.distance,
            "we-have-come-round": lambda: walls.has_come_round,
        },
        values={"follow-perimeter": lambda channels: walls.follow()},
        views={"wall-line": wall_line, "wanted-heading": wanted_heading},
    )


LIBRARY = Library(
    "perimeter",
    "Along the walls of a building at a set distance, after Yamauchi 2005.",
    (
        Function("follow-perimeter", "number", "The heading along the wall, in the map frame.", unit="rad"),
        boolean("a-wall-is-tracked", "The wall that is followed was seen in the latest scan."),
        number("the-wall-distance", "m", "To the wall that is followed; the stand-off where it is not seen."),
        boolean("we-have-come-round", "The robot is, or has been, back where following began."),
    ),
    (_PRESET, _SIDE, *_FOLLOW, *_HOUGH, _REFINE, *_CONTOUR, *_ROUND),
    _build,
)
