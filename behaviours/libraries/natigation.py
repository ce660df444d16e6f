"""Library `natigation`: to the goal among obstacles by navigation templates.

Takes: the parameters of a plan. Gives: percepts of the goal, a goal of its own, and the competence that drives there.
Leaves alone: what is at the goal.
"""

from __future__ import annotations

import math
from dataclasses import replace

from behaviours.competences.natigation import GazeSettings, Natigate, Traffic
from behaviours.cores.circles import CircleSettings
from behaviours.cores.collision import GateSettings
from behaviours.cores.commitment import CommitmentSettings
from behaviours.cores.evidence import EvidenceSettings
from behaviours.cores.nat import NatSettings
from behaviours.cores.places import PlacesSettings
from behaviours.cores.sectors import FINE, LidarRing, RingOf, waist
from behaviours.declaring import (
    agreed,
    boolean,
    chosen,
    command,
    is_on,
    parameters,
    positive,
    preset,
    settings_of,
    switch,
)
from behaviours.estimators.navigation import ArrivalSettings, NavigationGoal
from behaviours.estimators.obstacles import DeadlockSettings, Obstacles
from behaviours.estimators.perception import PerceptionSettings
from behaviours.estimators.places import Places
from behaviours.interface import Function, Library, Offer, Parameter, Pose, Values, Workshop
from behaviours.libraries.runaway import RANGES

NAVIGATE = "move-according-to-NaT-plan"
_ARRIVAL = parameters(
    ArrivalSettings(),
    (
        "goal_tolerance",
        "m",
        "The goal counts as reached this near to it when something stands before it (paper: 1.5 ft).",
    ),
    ("arrival", "m", "The goal counts as reached this near to it in any case (chosen here)."),
    ("leave", "m", "A reached goal is left this much beyond the goal tolerance (chosen here)."),
    ("stand_off", "m", "Something nearer to the hull than this stands before the goal (chosen here)."),
    ("stand_off_angle", "rad", "Half the angle about the goal's direction that is watched for it (chosen here)."),
    ("same_goal", "m", "A goal that moves by more is another goal (chosen here)."),
)
_CIRCLES = parameters(
    CircleSettings(),
    ("obstacles", "", "Greatest number of obstacle circles (printed in the paper)."),
    ("readings", "", "Readings a circle holds, one a sweep; each lives as many sweeps (printed in the paper)."),
    ("far", "m", "Echoes beyond are not aggregated (chosen here)."),
    ("max_radius", "m", "No reading is added that makes a circle larger (chosen here)."),
    ("pad", "m", "Added to the radius of every circle (chosen here)."),
    ("half_cone", "rad", "Half the cone of a sonar; 0 puts every echo on the axis (chosen here)."),
    ("neighbours_near", "m", "Echoes of neighbours that differ by less are of one thing (chosen here)."),
)
_NAT = parameters(
    NatSettings(),
    ("robot_width", "m", "Diameter of the hull."),
    ("clearance", "m", "Kept to obstacles; more than the safety radius of runaway (chosen here)."),
    (
        "group_margin",
        "m",
        "Kept on either side in a gap; the gap is then wider than twice the safety radius (chosen here).",
    ),
    ("group_hysteresis", "m", "A group is parted only by a gap so much wider (chosen here)."),
    ("spin_hysteresis", "", "A spin is kept unless the other side deviates by less than this share (chosen here)."),
    ("squeeze", "rad", "Where two groups overlap by less, the way is the middle between them (chosen here)."),
    ("narrow_margin", "m", "Replaces group-margin while a group closes a ring around the robot (chosen here)."),
    ("look_ahead", "m", "Groups beyond do not bound the heading (chosen here)."),
    ("max_speed", "m/s", "Greatest speed (printed in the paper)."),
    ("stop_distance", "m", "Least speed at this range of the nearest echo (chosen here)."),
    ("slow_distance", "m", "Full speed from this range of the nearest echo (chosen here)."),
    ("least_speed", "", "Share of the greatest speed that is kept near obstacles (chosen here)."),
    ("steering_gain", "", "Turn rate per heading error, 1/s (chosen here)."),
    ("max_turn_rate", "rad/s", "Greatest turn rate (chosen here)."),
)
_DEADLOCK = parameters(
    DeadlockSettings(),
    ("progress", "m", "A robot that does not leave a circle of this radius makes no progress (chosen here)."),
    ("patience", "s", "Without progress for this long, a group is passed on the other side (chosen here)."),
    ("lock", "s", "For this long it is kept to that side (chosen here)."),
    ("new_goal", "m", "A goal that jumps by more is planned for without the spins of before (chosen here)."),
)
_GAZE = parameters(
    GazeSettings(),
    ("gaze_beyond", "m", "The head looks this far past the goal, in the direction of the goal pose (chosen here)."),
    ("pan_step", "rad", "The head is moved by no less, so that it settles (chosen here)."),
    ("pan_limit", "rad", "Greatest pan to either side (chosen here)."),
)


AHEAD = math.radians(50.0)
"""With commitment, only echoes within this of the heading slow the robot down: it goes along walls."""
LANE = 0.1
"""With places, a lane is clear with so much room [m] on either side of the hull."""
_PRESET = preset("All switches off (`paper`) or on (`modern`).")
_SWITCHES = tuple(
    switch(name, doc)
    for name, doc in (
        ("tracking", "What moves is followed, and the robot gives way to it in time."),
        ("commitment", "A group that stands is passed on one side until that has paid."),
        ("memory", "What stands is remembered in a grid instead of in circles that forget."),
        ("places", "Where the robot has been is remembered, and dead ends are left by ways not tried."),
    )
)
_EVIDENCE = parameters(
    EvidenceSettings(),
    ("cell", "m", "Side of a cell of the grid of `memory` and `tracking`."),
    ("reach", "m", "The memory gives circles within this distance."),
    ("keep", "s", "What is not heard again is forgotten after this time."),
    ("kept_obstacles", "", "Greatest number of circles of the memory."),
    ("was_free", "s", "An echo from where it was free this short a time ago is one of something that moves."),
)
_GATE = parameters(
    GateSettings(),
    ("horizon", "s", "What moves and meets the robot later than this does not count."),
    ("keep_off", "m", "A gap to what moves that is smaller counts as a collision."),
)
_PLACE = (
    Parameter("goal-x", "number", "m", 0.0, "Of `(the-set-goal)`, in the odometry frame: ahead of the start."),
    Parameter("goal-y", "number", "m", 0.0, "To the left of the start."),
    Parameter("goal-heading", "number", "rad", 0.0, "Relative to the heading at the start."),
)


def _is_on(name: str, values: Values) -> bool:
    return is_on(values, _PRESET, next(one for one in _SWITCHES if one.name == name))


def _set_goal(values: Values) -> Pose:
    x, y, theta = (float(values.get(parameter.name, parameter.default)) for parameter in _PLACE)
    if not all(map(math.isfinite, (x, y, theta))):
        raise ValueError("goal-x, goal-y and goal-heading must be finite")
    return Pose(x, y, theta)


def _obstacles(values: Values, nat: NatSettings, ring_of: RingOf) -> Obstacles:
    perception = PerceptionSettings(
        memory=_is_on("memory", values),
        tracking=_is_on("tracking", values),
        evidence=settings_of(EvidenceSettings(), _EVIDENCE, values),
    )
    circles = settings_of(CircleSettings(), _CIRCLES, values)
    if isinstance(ring_of, LidarRing) and (perception.memory or perception.tracking):
        circles, ring_of = replace(circles, half_cone=0.0), LidarRing(nat.robot_width / 2, FINE)
    deadlock = settings_of(DeadlockSettings(), _DEADLOCK, values)
    lane = PlacesSettings(half_width=nat.robot_width / 2 + LANE, speed=nat.max_speed or PlacesSettings().speed)
    return Obstacles(
        circles,
        nat,
        deadlock,
        NAVIGATE,
        perception,
        CommitmentSettings() if _is_on("commitment", values) else None,
        ring_of,
        Places(lane, deadlock.new_goal) if _is_on("places", values) else None,
    )


def _build(values: Values, workshop: Workshop) -> Offer:
    arrival = settings_of(ArrivalSettings(), _ARRIVAL, values)
    nat = settings_of(NatSettings(), _NAT, values)
    if _is_on("commitment", values):
        nat = replace(nat, minds=AHEAD)
    from_lidar = chosen(RANGES, values, "sonar", "lidar") == "lidar"
    ring_of: RingOf = LidarRing(positive("robot-width", nat.robot_width) / 2) if from_lidar else waist
    goal = agreed(workshop, NavigationGoal, lambda: NavigationGoal(arrival, ring_of), arrival, "natigation")
    obstacles = workshop.share(Obstacles, lambda: _obstacles(values, nat, ring_of))
    perception, gates = obstacles.perception, settings_of(GateSettings(), _GATE, values)
    traffic = Traffic(perception.moving_points, perception.velocities, gates) if perception.settings.tracking else None
    natigate = Natigate(obstacles.plan_to, nat, settings_of(GazeSettings(), _GAZE, values), ring_of, traffic)
    set_goal = _set_goal(values)
    return Offer(
        percepts={"there-is-a-goal": goal.exists, "we-are-at-the-goal": lambda: goal.is_reached},
        values={"the-set-goal": lambda channels: set_goal},
        competences={NAVIGATE: natigate},
    )


LIBRARY = Library(
    "natigation",
    "To the goal among obstacles by navigation templates.",
    (
        boolean("there-is-a-goal", "The channel `goal` had a value in the last tick."),
        boolean("we-are-at-the-goal", "The robot stands at the goal of the last tick."),
        Function("the-set-goal", "pose", "The pose of goal-x, goal-y and goal-heading."),
        command(NAVIGATE, "Drive towards the channel `goal` among the obstacles.", "drive", "head", reads=("goal",)),
    ),
    (_PRESET, *_SWITCHES, RANGES, *_ARRIVAL, *_CIRCLES, *_NAT, *_DEADLOCK, *_GAZE, *_EVIDENCE, *_GATE, *_PLACE),
    _build,
)
