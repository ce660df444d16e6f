"""Library `svfh`: steering clear of obstacles towards a wanted heading.

Takes: the parameters of a plan, localisation, surroundings and recent path of the robot. Gives: a competence,
a percept, the heading to a goal, a view. Leaves alone: where to go.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import partial

from behaviours.competences.steer_by_vfh_plus import CARROT, SteerByVfhPlus, SteerSettings
from behaviours.competences.steer_clear import SteerClear
from behaviours.cores.hull_paths import Hull, Motors
from behaviours.cores.look_ahead import LookAheadSettings
from behaviours.cores.pilot import PilotSettings
from behaviours.cores.steering import KEEP_OFF
from behaviours.cores.svfh import SvfhSettings
from behaviours.cores.vfh_plus import VfhPlusSettings, is_blocked
from behaviours.cores.way_back import WayBackSettings
from behaviours.declaring import boolean, chosen, command, number, parameters, positive, settings_of
from behaviours.estimators.goal_heading import GoalHeading
from behaviours.estimators.near_points import NearPoints
from behaviours.estimators.sectors import Sectors
from behaviours.interface import Function, Library, Offer, Parameter, Pose, Values, Workshop
from behaviours.libraries.recent_path import recent_path
from behaviours.libraries.sharing import localisation, surroundings

NEAR = 1.5
"""[m]: so far it is remembered what stands where the lidar does not look now."""
STEER = "steer-clear-of-obstacles"
_SVFH = parameters(
    SvfhSettings(),
    ("directions", "", "Directions of the histogram (printed for the perimeter's accumulator)."),
    ("clearance", "m", "A reading at range r blocks what lies within clearance / r of it (chosen here)."),
    ("threshold", "", "So many readings block a direction (chosen here)."),
    ("window", "m", "Readings beyond it do not count (chosen here)."),
    ("cruise", "m/s", "Greatest speed."),
    ("deflected", "", "Share of the speed while something stands in the wanted direction (chosen here)."),
    ("stop_range", "m", "No speed when something stands ahead at this range from the middle (chosen here)."),
    ("slow_range", "m", "Full speed when nothing stands ahead within this range (chosen here)."),
    ("gain", "", "Turn rate per angle, 1/s (chosen here)."),
    ("max_turn_rate", "rad/s", "Greatest turn rate (chosen here)."),
    ("blocked_turn_rate", "rad/s", "On the spot, when no direction is open (chosen here)."),
)


@dataclass(frozen=True, slots=True)
class _Outline:
    """The hull as parameters name it [m]."""

    hull_length: float = 0.69
    hull_width: float = 0.52
    hull_radius: float = 0.0


_HULL_OF = _Outline()
_HULL = parameters(
    _HULL_OF,
    ("hull_length", "m", "With `modern`: of the rectangle round the robot's middle (PackBot)."),
    ("hull_width", "m", "With `modern`: of that rectangle."),
    ("hull_radius", "m", "With `modern`: of a round hull, which counts in place of the rectangle where it is not 0."),
)
_PLUS = parameters(
    VfhPlusSettings(),
    ("low", "", "With `modern`: a direction becomes open below this density (chosen here)."),
    ("high", "", "With `modern`: a direction becomes blocked above this density (chosen here)."),
    ("wide", "rad", "With `modern`: a wider opening is taken near its sides, half of this from them (chosen here)."),
    ("to_target", "", "With `modern`: cost of an angle from the wanted direction."),
    ("to_heading", "", "With `modern`: cost of an angle from the robot's heading."),
    ("to_previous", "", "With `modern`: cost of an angle from what was chosen before."),
)
_PILOT = parameters(
    PilotSettings(),
    ("margin", "m", "With `modern`: kept between the hull and what was seen (chosen here)."),
    ("roomy", "m", "With `modern`: full speed with so much room before and beside the hull (chosen here)."),
    ("tight", "", "With `modern`: share of the speed with no room at all (chosen here)."),
    ("slip", "", "With `modern`: turn of the tracks per turn of the hull."),
)
_MOTORS = parameters(
    Motors(),
    ("acceleration", "", "With `modern`: how fast the robot brakes, m/s^2."),
    ("turn_acceleration", "", "With `modern`: how fast it changes its turn rate, rad/s^2."),
    ("hold", "s", "With `modern`: so long a command may last until the next one has its effect (chosen here)."),
)
_WAY_BACK = parameters(
    WayBackSettings(),
    ("stalled", "s", "With `modern`: not getting away for so long, the robot goes back the way it came (chosen here)."),
    ("back", "m", "With `modern`: so far at first (chosen here)."),
    ("remembered", "s", "With `modern`: so long it keeps off that place (chosen here)."),
)
_PRESET = Parameter("preset", "symbol", "", "paper", "`paper` or `modern`.")
_RANGES = Parameter("ranges", "symbol", "", "lidar", "From a `lidar`, or from `sonar` rings.")
_LOOK_AHEAD = Parameter("look-ahead", "number", "m", 0.0, "With `modern`: a way is looked for as far as this; 0: not.")
_WHEN_BLOCKED = Parameter("when-blocked", "symbol", "", "left", "Where to turn: `left` or `right`.")
_GOAL = (
    Parameter("goal-x", "number", "m", 0.0, "Of `(the-place-to-go)`, in the odometry frame: ahead of the start."),
    Parameter("goal-y", "number", "m", 0.0, "To the left of the start."),
)


def _goal(values: Values) -> Pose:
    x, y = (float(values.get(parameter.name, parameter.default)) for parameter in _GOAL)
    if not (math.isfinite(x) and math.isfinite(y)):
        raise ValueError("goal-x and goal-y must be finite")
    return Pose(x, y)


def svfh_settings(values: Values) -> SvfhSettings:
    """The settings with the values of a plan. Raises ValueError for those that make no sense."""
    settings = settings_of(SvfhSettings(), _SVFH, values)
    if not 8 <= settings.directions <= 3600:
        raise ValueError("directions must be from 8 to 3600")
    for name, value in (("window", settings.window), ("clearance", settings.clearance)):
        positive(name, value)
    if settings.slow_range <= settings.stop_range:
        raise ValueError("slow-range must be more than stop-range")
    return settings


def _modern(values: Values, settings: SvfhSettings, left: bool) -> SteerSettings:
    """The settings of VFH+ with the values of a plan."""
    choice = settings_of(VfhPlusSettings(), _PLUS, values)
    choice = replace(choice, directions=settings.directions, clearance=settings.clearance, window=settings.window)
    hull, motors = settings_of(_HULL_OF, _HULL, values), settings_of(Motors(), _MOTORS, values)
    pilot = settings_of(PilotSettings(), _PILOT, values)
    for name, value in (("hull-length", hull.hull_length), ("hull-width", hull.hull_width), ("slip", pilot.slip)):
        positive(name, value)
    positive("acceleration", motors.acceleration)
    positive("turn-acceleration", motors.turn_acceleration)
    outline = Hull(hull.hull_length, hull.hull_width, hull.hull_radius)
    pilot = replace(
        pilot,
        cruise=settings.cruise,
        gain=settings.gain,
        max_turn_rate=settings.max_turn_rate,
        hull=outline,
        motors=motors,
    )
    far = float(values.get("look-ahead", _LOOK_AHEAD.default))
    if not 0.0 <= far <= 10.0:
        raise ValueError(f"look-ahead must be from 0 to 10 m, not {far}")
    ahead = LookAheadSettings(half=far, keep=outline.half_width + pilot.margin) if far else None
    if ahead is not None:
        choice = replace(choice, window=min(choice.window, 2 * CARROT))
    return SteerSettings(choice, pilot, settings_of(WayBackSettings(), _WAY_BACK, values), left, ahead)


def _build(values: Values, workshop: Workshop) -> Offer:
    modern = chosen(_PRESET, values, "paper", "modern") == "modern"
    settings = svfh_settings(values)
    left = chosen(_WHEN_BLOCKED, values, "left", "right") == "left"
    place = localisation(workshop)
    around = surroundings(workshop, sonar=chosen(_RANGES, values, "lidar", "sonar") == "sonar")
    path = recent_path(workshop)
    goal = _goal(values)
    target = workshop.share(GoalHeading, lambda: GoalHeading(place))
    steer: SteerClear | SteerByVfhPlus
    if modern:
        plus = _modern(values, settings, left)
        near = workshop.share(
            NearPoints, lambda: NearPoints(around, place, max(NEAR, plus.ahead.half if plus.ahead else 0.0))
        )
        steer = SteerByVfhPlus(plus, near, place, lambda: around.known, lambda: path.points)
        blocked = partial(_is_blocked, near, plus)
    else:
        sectors = workshop.share(Sectors, lambda: Sectors(settings, around, lambda: path.points))
        steer, blocked = SteerClear(sectors, around, place, left), partial(getattr, sectors, "is_blocked")
    return Offer(
        percepts={"the-way-is-blocked": blocked, "the-distance-to-the-goal": target.distance},
        values={"the-place-to-go": lambda channels: goal, "the-heading-to-the-goal": target.heading},
        competences={STEER: steer},
        views={"sectors": steer.view},
    )


def _is_blocked(near: NearPoints, settings: SteerSettings) -> bool:
    return is_blocked(near.points, settings.choice)


LIBRARY = Library(
    "svfh",
    "Obstacle avoidance by the scaled vector field histogram, after Yamauchi 2005.",
    (
        boolean("the-way-is-blocked", "No direction is open."),
        number("the-distance-to-the-goal", "m", "To the goal of the last tick; 0 without one."),
        Function("the-place-to-go", "pose", "The place of goal-x and goal-y."),
        Function("the-heading-to-the-goal", "number", "In the map frame; none without a goal.", "rad", reads=("goal",)),
        command(
            STEER,
            "Drive where the channel `heading` says, as near to it as is open.",
            "drive",
            reads=("heading", KEEP_OFF),
        ),
    ),
    (_PRESET, _RANGES, _WHEN_BLOCKED, _LOOK_AHEAD, *_SVFH, *_PLUS, *_HULL, *_PILOT, *_MOTORS, *_WAY_BACK, *_GOAL),
    _build,
)
