"""Following a wall by the directed Hough transform, in the words of the library `wall-by-ransac`.

Takes: the values of a plan. Gives: the library `wall-by-hough`. Leaves alone: how it is done.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from behaviours.competences.follow_heading import FollowHeading
from behaviours.competences.follow_wall import ClearSettings
from behaviours.competences.steer_by_vfh_plus import SteerByVfhPlus, SteerSettings
from behaviours.competences.steer_clear import SteerClear
from behaviours.cores.contour import ContourSettings
from behaviours.cores.corner import CornerSettings
from behaviours.cores.hull_paths import Hull, Motors
from behaviours.cores.orientation import FollowSettings
from behaviours.cores.pilot import PilotSettings
from behaviours.cores.svfh import SvfhSettings
from behaviours.cores.vfh_plus import VfhPlusSettings
from behaviours.declaring import boolean, chosen, command, number, parameters, positive, settings_of
from behaviours.estimators.localisation import Localisation
from behaviours.estimators.near_points import NearPoints
from behaviours.estimators.sectors import Sectors
from behaviours.estimators.surroundings import Surroundings
from behaviours.estimators.wall_of_lines import SoughtSettings, WallOfLines
from behaviours.estimators.walls import Walls, WallsSettings
from behaviours.interface import Floats, Library, Offer, Parameter, Values, View, Workshop
from behaviours.libraries.sharing import localisation, surroundings


@dataclass(frozen=True, slots=True)
class _Pace:
    """As `wall-by-ransac` has them."""

    speed: float = 0.48
    most: float = 1.5
    stand_off: float = 1.0
    look_ahead: float = 0.0
    slip: float = 1.0


BACK = math.radians(60)
"""Before the disc turns the robot away by more, smaller ones are tried: corridors are narrow."""
EVERY = 0.08
"""[s] From look to look at a scan: every third of those of X-RHex."""
ROUND = math.radians(120)
"""To what lies further aside the robot turns away from the wall."""

_PRESET = Parameter(
    "preset",
    "symbol",
    "",
    "paper",
    "`paper`: along the strongest line; `modern`: a disc rolls along what stands.",
)
_SIDE = Parameter("side", "symbol", "", "right", "The wall is to the `left` or to the `right`.")
_PACE = parameters(
    _Pace(),
    ("stand_off", "m", "Wanted distance to the wall."),
    ("speed", "m/s", "Greatest speed (that of X-RHex)."),
    ("most", "rad/s", "Greatest turn rate (chosen here)."),
    ("look_ahead", "m", "With `modern`: the disc is swept so far; 0: the stand-off (chosen here)."),
    ("slip", "", "Turn of the tracks per turn of the hull, 1.3 on tracks (chosen here)."),
)
_SOUGHT = parameters(
    SoughtSettings(),
    ("hull_radius", "m", "From the middle of the robot as far as it reaches."),
    ("margin", "m", "With `modern`: kept between the hull and what is seen (chosen here)."),
    ("patience", "s", "A lost wall is looked for so long (chosen here)."),
)
_DOOR = parameters(CornerSettings(), ("door", "m", "The wall ends at an opening that is wider (chosen here)."))
_MOTORS = parameters(
    Motors(2.0, 8.0),
    ("acceleration", "m/s^2", "With `modern`: how fast the robot brakes (X-RHex)."),
    ("turn_acceleration", "rad/s^2", "With `modern`: how fast it changes its turn rate (X-RHex)."),
)
NOTHING: Floats = np.zeros((0, 2))


def _look_ahead(pace: _Pace) -> float:
    """[m]"""
    return positive("look-ahead", pace.look_ahead or pace.stand_off)


def _walls(values: Values, pace: _Pace, sought: SoughtSettings, modern: bool) -> WallsSettings:
    follow = FollowSettings(stand_off=positive("stand-off", pace.stand_off))
    least = min(sought.hull_radius + sought.margin, follow.stand_off)
    widest = max(least, sought.corner.door / 2.0)
    contour = ContourSettings(
        look_ahead=_look_ahead(pace), least=least, back=BACK, widest=widest, beside=sought.corner.beside
    )
    right = chosen(_SIDE, values, "left", "right") == "right"
    return WallsSettings(follow, right=right, contour=contour if modern else None, every=EVERY)


def _plus(values: Values, pace: _Pace, sought: SoughtSettings, right: bool) -> SteerSettings:
    motors = settings_of(Motors(2.0, 8.0), _MOTORS, values)
    positive("acceleration", motors.acceleration)
    positive("turn-acceleration", motors.turn_acceleration)
    pilot = PilotSettings(
        cruise=pace.speed,
        max_turn_rate=positive("most", pace.most),
        margin=sought.margin,
        roomy=ClearSettings().roomy,
        tight=ClearSettings().tight,
        slip=positive("slip", pace.slip),
        hull=Hull(radius=positive("hull-radius", sought.hull_radius)),
        motors=motors,
    )
    clearance = sought.hull_radius + sought.margin
    choice = VfhPlusSettings(clearance=clearance, window=_look_ahead(pace))
    return SteerSettings(choice, pilot, left=right, round=ROUND)


def _steer(
    values: Values, workshop: Workshop, pace: _Pace, sought: SoughtSettings, walls: WallsSettings
) -> SteerByVfhPlus | SteerClear:
    """What turns away from the wall when nothing is open."""
    place, around = localisation(workshop), surroundings(workshop)
    if walls.contour is not None:
        near = workshop.share(NearPoints, lambda: NearPoints(around, place))
        plus = _plus(values, pace, sought, walls.right)
        return SteerByVfhPlus(plus, near, place, lambda: around.known, lambda: NOTHING)
    svfh = SvfhSettings(
        cruise=pace.speed,
        clearance=sought.hull_radius + sought.margin,
        window=max(pace.stand_off, 0.5) + 1.0,
        max_turn_rate=positive("most", pace.most),
        stop_range=sought.hull_radius + sought.margin,
        slow_range=sought.hull_radius + sought.margin + 0.6,
    )
    sectors = workshop.share(Sectors, lambda: Sectors(svfh, around, lambda: NOTHING))
    return SteerClear(sectors, around, place, walls.right)


def _shared(workshop: Workshop, settings: WallsSettings, place: Localisation, around: Surroundings) -> Walls:
    walls = workshop.share(Walls, lambda: Walls(settings, place, around))
    if walls.settings != settings:
        raise ValueError("the wall of wall-by-hough must be that of perimeter: use one of them")
    return walls


def _build(values: Values, workshop: Workshop) -> Offer:
    modern = chosen(_PRESET, values, "paper", "modern") == "modern"
    pace = settings_of(_Pace(), _PACE, values)
    sought = settings_of(SoughtSettings(), _SOUGHT, values)
    sought = replace(sought, corner=settings_of(CornerSettings(), _DOOR, values))
    positive("hull-radius", sought.hull_radius)
    place, around = localisation(workshop), surroundings(workshop)
    walls = _shared(workshop, _walls(values, pace, sought, modern), place, around)
    wall = workshop.share(WallOfLines, lambda: WallOfLines(sought, walls, around))
    steer = _steer(values, workshop, pace, sought, walls.settings)

    def line() -> View | None:
        at = walls.seen()
        return None if at is None else {"kind": "lines", "frame": "robot", "at": [[round(x, 3) for x in at]]}

    def heading() -> View | None:
        return {"kind": "heading", "frame": place.frame, "at": round(walls.wanted, 4)} if around.fresh else None

    return Offer(
        percepts={
            "wall-found": lambda: wall.is_found,
            "wall-lost": lambda: wall.mode == "lost",
            "wall-ends": lambda: wall.ends,
            "corner-ahead": lambda: wall.bars,
            "the-wall-distance": lambda: wall.offset,
            "the-wall-angle": lambda: wall.angle,
        },
        competences={"follow-wall": FollowHeading(wall, walls.follow, steer)},
        views={"wall-line": line, "wanted-heading": heading},
    )


LIBRARY = Library(
    "wall-by-hough",
    "Along a wall that the Hough transform finds, clear of obstacles.",
    (
        boolean("wall-found", "A wall is followed."),
        boolean("wall-lost", "There was one, and it is no longer seen."),
        boolean("wall-ends", "It ends within the view."),
        boolean("corner-ahead", "Something bars the way where the robot should turn."),
        number("the-wall-distance", "m", "From the middle of the robot; 0 without a wall."),
        number("the-wall-angle", "rad", "Of the heading against the wall, positive away from it; 0 without a wall."),
        command("follow-wall", "Drive along the wall; stand without one.", "drive"),
    ),
    (_PRESET, _SIDE, *_PACE, *_SOUGHT, *_DOOR, *_MOTORS),
    _build,
)
