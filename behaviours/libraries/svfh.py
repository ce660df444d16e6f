"""Library `svfh`: steering clear of obstacles towards a wanted heading.

Takes: the parameters of a plan, localisation, surroundings and recent path of the robot. Gives: a competence,
a percept, the heading to a goal, a view. Leaves alone: where to go.
"""

from __future__ import annotations

import math

from behaviours.competences.steer_clear import SteerClear
from behaviours.cores.svfh import SvfhSettings
from behaviours.declaring import boolean, chosen, command, number, parameters, settings_of
from behaviours.estimators.goal_heading import GoalHeading
from behaviours.estimators.sectors import KEEP_OFF, Sectors
from behaviours.interface import Function, Library, Offer, Parameter, Pose, Values, Workshop
from behaviours.libraries.recent_path import recent_path
from behaviours.libraries.sharing import localisation, surroundings

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
_PRESET = Parameter("preset", "symbol", "", "paper", "`paper` or `modern`.")
_RANGES = Parameter("ranges", "symbol", "", "lidar", "From a `lidar`, or from `sonar` rings.")
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
    if settings.slow_range <= settings.stop_range:
        raise ValueError("slow-range must be more than stop-range")
    return settings


def _build(values: Values, workshop: Workshop) -> Offer:
    chosen(_PRESET, values, "paper", "modern")
    settings = svfh_settings(values)
    left = chosen(_WHEN_BLOCKED, values, "left", "right") == "left"
    place = localisation(workshop)
    around = surroundings(workshop, sonar=chosen(_RANGES, values, "lidar", "sonar") == "sonar")
    path = recent_path(workshop)
    sectors = workshop.share(Sectors, lambda: Sectors(settings, around, lambda: path.points))
    goal = _goal(values)
    target = workshop.share(GoalHeading, lambda: GoalHeading(place))
    steer = SteerClear(sectors, around, place, left)
    return Offer(
        percepts={"the-way-is-blocked": lambda: sectors.is_blocked, "the-distance-to-the-goal": target.distance},
        values={"the-place-to-go": lambda channels: goal, "the-heading-to-the-goal": target.heading},
        competences={STEER: steer},
        views={"sectors": steer.view},
    )


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
    (_PRESET, _RANGES, _WHEN_BLOCKED, *_SVFH, *_GOAL),
    _build,
)
