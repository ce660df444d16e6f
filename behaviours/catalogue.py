"""The libraries of behaviours that plans may use.

Takes: nothing. Gives: for each library its words, its parameters with defaults, and how it comes to life.
Leaves alone: who uses them. To add a library, write a function like `_runaway` and name it in `LIBRARIES`.

The defaults are the settings of the find-and-fetch robot of Bonasso, Antonisse and Slack 1992 where that paper prints
them; the docs of the others say that they are chosen here.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import TypeVar

from behaviours.competences.fixate import Fixate
from behaviours.competences.keep_station import KeepStation, StationSettings
from behaviours.competences.natigation import GazeSettings, Natigate, Traffic
from behaviours.competences.runaway import Runaway
from behaviours.competences.steady import Steady
from behaviours.competences.stop import Stop
from behaviours.competences.un_stick import UnStick, UnStickSettings
from behaviours.cores.circles import CircleSettings
from behaviours.cores.collision import GateSettings
from behaviours.cores.commitment import CommitmentSettings
from behaviours.cores.crossing import DISAGREE, NO_CHANGE, TOO_FEW, CrossingSettings
from behaviours.cores.evidence import EvidenceSettings
from behaviours.cores.ground import GroundSettings
from behaviours.cores.nat import NatSettings
from behaviours.cores.places import PlacesSettings
from behaviours.cores.runaway import RunawaySettings
from behaviours.cores.sectors import FINE, LidarRing, RingOf, skirt, waist
from behaviours.declaring import boolean, chosen, command, number, parameters, positive, settings_of
from behaviours.estimators import ir_search, stereo_search
from behaviours.estimators.beacons import Beacons, BeaconSettings
from behaviours.estimators.danger import Danger
from behaviours.estimators.donor import DonorMemory, DonorSettings
from behaviours.estimators.head import HeadWatch
from behaviours.estimators.home import Home
from behaviours.estimators.ir_search import IrSearch, IrSettings
from behaviours.estimators.latest import Latest
from behaviours.estimators.navigation import ArrivalSettings, NavigationGoal
from behaviours.estimators.obstacles import DeadlockSettings, Obstacles
from behaviours.estimators.patrol import Patrol, PatrolSettings
from behaviours.estimators.perception import PerceptionSettings
from behaviours.estimators.places import Places
from behaviours.estimators.roaming import Roaming, RoamingSettings
from behaviours.estimators.sensed import Sensed, SensedSettings
from behaviours.estimators.stereo_search import StereoSearch, StereoSettings
from behaviours.interface import Channels, Function, Library, Offer, Parameter, Pose, Values, Workshop
from behaviours.libraries.flippers import LIBRARY as FLIPPERS
from behaviours.libraries.localisation import LIBRARY as LOCALISATION
from behaviours.libraries.mapping import LIBRARY as MAPPING
from behaviours.libraries.perimeter import LIBRARY as PERIMETER
from behaviours.libraries.recent_path import LIBRARY as RECENT_PATH
from behaviours.libraries.stasis import LIBRARY as STASIS
from behaviours.libraries.svfh import LIBRARY as SVFH
from behaviours.libraries.wall_by_hough import LIBRARY as WALL_BY_HOUGH
from behaviours.libraries.wall_by_ransac import LIBRARY as WALL_BY_RANSAC

NAVIGATE = "move-according-to-NaT-plan"

# --- robot ----------------------------------------------------------------------------------------


def _build_robot(values: Values, workshop: Workshop) -> Offer:
    latest = workshop.share(Latest, Latest)
    return Offer(
        percepts={"speed": latest.speed, "time-since-start": latest.time_since_start},
        competences={"stop": Stop()},
    )


ROBOT = Library(
    "robot",
    "What every robot can do.",
    (
        Function("speed", "number", "Speed along the drive heading, negative backwards.", unit="m/s"),
        Function("time-since-start", "number", "Stamp of the latest reading.", unit="s"),
        command("stop", "Stand still; the head stays where it is.", "drive"),
    ),
    (),
    _build_robot,
)

# --- runaway --------------------------------------------------------------------------------------

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
_RANGES = Parameter("ranges", "symbol", "", "sonar", "From `sonar` rings, or from a `lidar` in their place.")
_HULL = Parameter("hull-radius", "number", "m", 0.35, "From its middle to the hull, with `:ranges lidar` alone.")


def _build_runaway(values: Values, workshop: Workshop) -> Offer:
    settings = settings_of(RunawaySettings(), _RUNAWAY, values)
    hull = positive("hull-radius", float(values.get("hull-radius", _HULL.default)))
    from_lidar = chosen(_RANGES, values, "sonar", "lidar") == "lidar"
    rings: tuple[RingOf, ...] = (LidarRing(hull),) if from_lidar else (waist, skirt)
    danger = workshop.share(Danger, lambda: Danger(settings, rings))
    return Offer(
        percepts={"anything-is-too-close": lambda: danger.is_near, "nearest-range": lambda: danger.nearest_range},
        competences={"move-away-from-danger": Runaway(lambda: danger.echoes, settings)},
    )


RUNAWAY = Library(
    "runaway",
    "Away from what is suddenly close, forward or backward, whichever is quicker.",
    (
        boolean("anything-is-too-close", "An echo of either ring lies within the safety radius."),
        Function("nearest-range", "number", "The shortest range of both rings, from the hull.", unit="m"),
        command("move-away-from-danger", "Drive away from the echoes within the safety radius.", "drive"),
    ),
    (*_RUNAWAY, _RANGES, _HULL),
    _build_runaway,
)

# --- natigation -----------------------------------------------------------------------------------

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
_PRESET = Parameter("preset", "symbol", "", "paper", "All switches off (`paper`) or on (`modern`).")
_SWITCHES = tuple(
    Parameter(name, "symbol", "", "preset", f"{doc} `on`, `off`, or as the `preset` has it.")
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
    """Whether a switch is on: by itself, or by the preset."""
    modern = chosen(_PRESET, values, "paper", "modern") == "modern"
    switch = next(parameter for parameter in _SWITCHES if parameter.name == name)
    return {"preset": modern, "on": True, "off": False}[chosen(switch, values, "preset", "on", "off")]


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


def _build_natigation(values: Values, workshop: Workshop) -> Offer:
    arrival = settings_of(ArrivalSettings(), _ARRIVAL, values)
    nat = settings_of(NatSettings(), _NAT, values)
    if _is_on("commitment", values):
        nat = replace(nat, minds=AHEAD)
    from_lidar = chosen(_RANGES, values, "sonar", "lidar") == "lidar"
    ring_of: RingOf = LidarRing(positive("robot-width", nat.robot_width) / 2) if from_lidar else waist
    goal = _share(workshop, NavigationGoal, lambda: NavigationGoal(arrival, ring_of), arrival, "natigation")
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


NATIGATION = Library(
    "natigation",
    "To the goal among obstacles by navigation templates.",
    (
        boolean("there-is-a-goal", "The channel `goal` had a value in the last tick."),
        boolean("we-are-at-the-goal", "The robot stands at the goal of the last tick."),
        Function("the-set-goal", "pose", "The pose of goal-x, goal-y and goal-heading."),
        command(NAVIGATE, "Drive towards the channel `goal` among the obstacles.", "drive", "head", reads=("goal",)),
    ),
    (_PRESET, *_SWITCHES, _RANGES, *_ARRIVAL, *_CIRCLES, *_NAT, *_DEADLOCK, *_GAZE, *_EVIDENCE, *_GATE, *_PLACE),
    _build_natigation,
)

# --- the searches ---------------------------------------------------------------------------------


def _search_preset(doc: str) -> Parameter:
    return Parameter("preset", "symbol", "", "paper", doc)


def _search_switch(name: str, doc: str) -> Parameter:
    return Parameter(name, "symbol", "", "preset", f"{doc} `on`, `off`, or as the `preset` has it.")


def _search_is_on(values: Values, preset: Parameter, switch: Parameter) -> bool:
    """Whether a switch is on, by itself or by the preset of its library."""
    modern = chosen(preset, values, "paper", "modern") == "modern"
    return {"preset": modern, "on": True, "off": False}[chosen(switch, values, "preset", "on", "off")]


_IR = parameters(
    IrSettings(),
    ("sweep", "rad", "The head sweeps so far to either side (chosen here)."),
    ("step", "rad", "From fixation to fixation (chosen here)."),
    ("pan_tolerance", "rad", "A fixation counts this near to where it was to look (chosen here)."),
    ("fixation_timeout", "s", "Longest wait for a fixation (chosen here)."),
    ("misses", "", "Fixations without an answer after which the search fails (chosen here)."),
    ("turn_after", "", "Sweeps in a row without a beacon after which the robot turns before the next (chosen here)."),
    ("turn", "rad", "How far it turns then (chosen here)."),
    ("turn_tolerance", "rad", "It has turned when it is this near (chosen here)."),
    ("steering_gain", "", "Turn rate per angle, 1/s (chosen here)."),
    ("max_turn_rate", "rad/s", "Greatest turn rate (chosen here)."),
    ("listen_step", "rad", "With roam: from fixation to fixation all round (chosen here)."),
    ("fine_sweep", "rad", "With roam: the sweep reaches so far to either side of what was heard (chosen here)."),
)
_IR_PRESET = _search_preset("`paper`, or `modern`, which turns `roam` on.")
_ROAM = _search_switch("roam", "Listen all round in wide steps, turn to what is heard, and sweep only there.")
_CROSSING = parameters(
    CrossingSettings(),
    ("side", "", "Least number of fixations on either side of the plus-to-minus change (chosen here)."),
    ("max_error", "rad", "Greatest standard error of the angle; the paper allows the result 2 degrees (chosen here)."),
    ("max_slope_error", "", "Greatest deviation of that line's slope from -1 (chosen here)."),
)


def _share_ir(workshop: Workshop, values: Values) -> IrSearch:
    crossing = settings_of(CrossingSettings(), _CROSSING, values)
    roam = _search_is_on(values, _IR_PRESET, _ROAM)
    settings = replace(settings_of(IrSettings(), _IR, values), crossing=crossing, roam=roam)
    return _share(workshop, IrSearch, lambda: IrSearch(settings), settings, "ir-search")


def _build_ir_search(values: Values, workshop: Workshop) -> Offer:
    search = _share_ir(workshop, values)
    return Offer(
        percepts={
            "ir-search-has-been-started": search.is_running,
            "the-ir-search-is-finished": search.is_finished,
            "the-returned-angle-is-no-good": search.is_no_good,
            "we-know-the-donor-direction": search.knows_direction,
            "too-few-ir-readings": lambda: search.failed_by(TOO_FEW),
            "no-plus-to-minus-change": lambda: search.failed_by(NO_CHANGE),
            "the-ir-readings-disagree": lambda: search.failed_by(DISAGREE),
            "the-sun-is-suspected": search.failed_by_sun,
        },
        competences={
            ir_search.START: Fixate(search.first_look, search.last_result),
            ir_search.CONTINUE: Fixate(search.look, search.progress, search.turn_rate),
        },
    )


IR_SEARCH = Library(
    "ir-search",
    "The direction of the donor's infra-red beacon, by a sweep of the head while standing.",
    (
        boolean("ir-search-has-been-started", "A sweep is going on."),
        boolean("the-ir-search-is-finished", "The last sweep came to its end."),
        boolean("the-returned-angle-is-no-good", "It came to its end without a direction."),
        boolean("we-know-the-donor-direction", "A direction was found, and nothing has spoken against it since."),
        boolean("too-few-ir-readings", "The last sweep failed: the beacon was heard too rarely."),
        boolean("no-plus-to-minus-change", "The last sweep failed: what was heard did not change from plus to minus."),
        boolean("the-ir-readings-disagree", "The last sweep failed: the beacon rocked too much for a direction."),
        boolean("the-sun-is-suspected", "The last sweep failed, and its faint signals look like a beacon in the sun."),
        command(ir_search.START, "Begin a sweep from scratch.", "drive", "head"),
        command(ir_search.CONTINUE, "Go on with the sweep.", "drive", "head"),
    ),
    (_IR_PRESET, _ROAM, *_IR, *_CROSSING),
    _build_ir_search,
)

_GROUND = parameters(
    GroundSettings(),
    ("start", "m", "Ground distance of the first fixations (paper: six feet)."),
    ("cut_off", "m", "What stands beyond is no good (paper: 23 to 25 feet)."),
    ("reach", "m", "Rays meet the ground up to here, so that what stands before the cut-off is told (chosen here)."),
    ("object_height", "m", "Least height of an object, which makes the step of the tilt (chosen here)."),
    ("pan_span", "rad", "The pans cover the bearing so far to either side (paper: 2 degrees)."),
    ("pans", "", "Fixations of a row (chosen here)."),
    ("error_linear", "", "Standard deviation of a range, share of the range (chosen here)."),
    ("error_square", "", "Standard deviation of a range, share of its square, 1/m (chosen here)."),
    ("error_factor", "", "A discontinuity is more than so many standard deviations (chosen here)."),
)
_STEREO = parameters(
    StereoSettings(),
    ("camera_height", "m", "Until a reading tells it."),
    ("angle_tolerance", "rad", "A fixation counts this near to where it was to look (chosen here)."),
    ("looks", "", "Fixations at one place that must agree on a discontinuity (chosen here)."),
    ("fixation_timeout", "s", "Longest wait for a fixation; then the head is freed (chosen here)."),
    ("unsticks", "", "Attempts to free the head before the search fails (chosen here)."),
    ("unstick_time", "s", "For so long it looks level to free itself (chosen here)."),
    ("reach_slack", "m", "With from-horizon: what fits the strength of the beacon may be so far off (chosen here)."),
    ("reach_share", "", "With from-horizon: and by this share of the distance (chosen here)."),
)
_UN_STICK = parameters(
    UnStickSettings(),
    ("tilting", "s", "un-stick-the-head: so long the tilt alone is sent home (chosen here)."),
    ("homing", "s", "un-stick-the-head: so long both axes are sent home, before a person is asked (chosen here)."),
)
_STUCK_AFTER = Parameter("stuck-after", "number", "s", 8.0, "A head that does not settle for longer is stuck.")
_STEREO_PRESET = _search_preset("`paper`, or `modern`, which turns `from-horizon` on.")
_FROM_HORIZON = _search_switch("from-horizon", "Look from far to near, for what fits the strength of the beacon.")


def _share_stereo(workshop: Workshop, values: Values) -> StereoSearch:
    ground = settings_of(GroundSettings(), _GROUND, values)
    from_horizon = _search_is_on(values, _STEREO_PRESET, _FROM_HORIZON)
    settings = replace(settings_of(StereoSettings(), _STEREO, values), ground=ground, from_horizon=from_horizon)
    if not settings.camera_height > ground.object_height > 0.0:
        raise ValueError("object-height must be more than 0 and less than camera-height")
    ir = workshop.share(IrSearch, lambda: IrSearch(IrSettings()))

    def bearing() -> float | None:
        return None if ir.direction is None else ir.direction.bearing

    def reach() -> float | None:
        return None if ir.direction is None else ir.direction.reach

    return _share(workshop, StereoSearch, lambda: StereoSearch(settings, bearing, reach), settings, "stereo-search")


def _build_stereo_search(values: Values, workshop: Workshop) -> Offer:
    search = _share_stereo(workshop, values)
    patience = float(values.get(_STUCK_AFTER.name, _STUCK_AFTER.default))
    head = workshop.share(HeadWatch, lambda: HeadWatch(patience))
    return Offer(
        percepts={
            "the-head-is-stuck": lambda: head.is_stuck,
            "the-head-needs-a-person": search.needs_help,
            "the-returned-range": search.range_found,
            "the-error-of-the-range": search.envelope,
            "stereo-ranging-is-started": search.is_started,
            "a-range-value-has-been-returned": search.is_finished,
            "the-range-value-is-no-good": search.is_no_good,
        },
        competences={
            stereo_search.START: Fixate(search.first_look, search.last_result),
            stereo_search.CONTINUE: Fixate(search.look, search.progress),
            "un-stick-the-head": UnStick(settings_of(UnStickSettings(), _UN_STICK, values)),
        },
    )


STEREO_SEARCH = Library(
    "stereo-search",
    "The distance of what stands in the donor's direction, by stereo ranging along the ground while standing.",
    (
        boolean("stereo-ranging-is-started", "A search is going on or has come to its end."),
        boolean("a-range-value-has-been-returned", "The search has come to its end."),
        boolean("the-range-value-is-no-good", "It has come to its end without a range within the cut-off."),
        Function("the-returned-range", "number", "Distance of what was found, 0 where nothing is.", unit="m"),
        Function("the-error-of-the-range", "number", "How far that range may be off, 0 where there is none.", unit="m"),
        boolean("the-head-is-stuck", "It has not come to rest where it was sent for some time."),
        boolean("the-head-needs-a-person", "The search has tried in vain to free the head."),
        command("un-stick-the-head", "Stand; send the tilt home, then both axes, then ask a person.", "drive", "head"),
        command(stereo_search.START, "Begin a search from scratch.", "drive", "head"),
        command(stereo_search.CONTINUE, "Go on with the search.", "drive", "head"),
    ),
    (_STEREO_PRESET, _FROM_HORIZON, *_GROUND, *_STEREO, *_UN_STICK, _STUCK_AFTER),
    _build_stereo_search,
)

# --- find and fetch -------------------------------------------------------------------------------

_DONOR = parameters(
    DonorSettings(),
    ("docking_distance", "m", "From the robot's middle to the donor's front when docked (chosen here)."),
    (
        "patience",
        "s",
        "Waiting for the object longer than this, the robot takes the place for the wrong one (chosen here).",
    ),
    ("moved_angle", "rad", "Later bearings that differ by more say that the donor has moved (chosen here)."),
    ("moved_distance", "m", "They must also differ by more than this sideways (chosen here)."),
    ("moved_readings", "", "So many bearings in a row must say so (chosen here)."),
    ("watch_beyond", "m", "Nearer than this to the donor, bearings say nothing (chosen here)."),
    ("watch_turn_rate", "rad/s", "Bearings taken while turning faster are not counted (chosen here)."),
    (
        "direction_holds_within",
        "m",
        "Driven off by more before the range is known, the direction is lost (chosen here).",
    ),
    ("stereo_attempts", "", "Failed stereo searches in one direction before it is given up (chosen here)."),
    ("donors", "", "With several: how many donors there are."),
    ("trips", "", "With several: how many objects each of them holds."),
)
_BEACONS = parameters(
    BeaconSettings(),
    ("farthest", "m", "With several: no donor is farther from home (chosen here)."),
)
_ROAMING = parameters(
    RoamingSettings(),
    ("approach", "m", "A beacon that was heard is listened to again from so near (chosen here)."),
    ("near", "m", "A beacon heard on the way from nearer than this is worth a stop (chosen here)."),
    ("apart", "m", "Places where the robot listens are so far apart (chosen here)."),
    ("stalled", "s", "Getting no nearer to such a place for longer, the robot gives it up (chosen here)."),
)
_STATION = parameters(
    StationSettings(),
    ("slack", "m", "keep-station: pushed off by less, the robot stays (chosen here)."),
    ("heading_slack", "rad", "keep-station: turned by less, it stays (chosen here)."),
    ("station_speed", "m/s", "keep-station: greatest speed (paper: of the base)."),
)
_FETCH_PRESET = _search_preset("`paper`, or `modern`, which turns `several` and `faint` on.")
_SEVERAL = _search_switch("several", "Donors are told apart by their beacons, and served one after the other.")
_FAINT = _search_switch("faint", "Signals below the reader's threshold tell where to listen next.")
_HOME = Parameter("home-patience", "number", "s", 20.0, "With several: a place at home is left after waiting so long.")
_ROUTE = Parameter("route", "symbol", "", "chance", "Listen next by `chance` to hear, or along a `spiral`.")


def _build_find_and_fetch(values: Values, workshop: Workshop) -> Offer:
    several = _search_is_on(values, _FETCH_PRESET, _SEVERAL)
    settings = replace(settings_of(DonorSettings(), _DONOR, values), several=several)
    hearing = replace(
        settings_of(BeaconSettings(), _BEACONS, values), faint=_search_is_on(values, _FETCH_PRESET, _FAINT)
    )
    spiral = chosen(_ROUTE, values, "chance", "spiral") == "spiral"
    roaming = replace(settings_of(RoamingSettings(), _ROAMING, values), spiral=spiral)
    ir = workshop.share(IrSearch, lambda: _share_ir(workshop, {}))
    stereo = workshop.share(StereoSearch, lambda: _share_stereo(workshop, {}))
    goal = workshop.share(NavigationGoal, lambda: NavigationGoal(ArrivalSettings()))
    donor = workshop.share(DonorMemory, lambda: DonorMemory(settings, ir, stereo, goal))
    patience = float(values.get(_HOME.name, _HOME.default)) if several else math.inf
    home, latest = workshop.share(Home, lambda: Home(patience)), workshop.share(Latest, Latest)
    beacons = workshop.share(Beacons, lambda: Beacons(hearing))
    roam = workshop.share(Roaming, lambda: Roaming(roaming, ir, donor, beacons))
    return Offer(
        percepts={
            "a-donor-is-left": donor.is_left,
            "it-is-time-to-listen": lambda: roam.is_due,
            "donor-has-been-located": donor.is_located,
            "we-already-have-the-widget": latest.object_on_board,
        },
        values={
            "the-robots-home-position": lambda channels: home.place,
            "set-goal-as-the-donors-location": lambda channels: donor.docking_pose(),
            "remember-the-current-goal-if-any": _current_goal,
            "where-to-listen-next": lambda channels: roam.place,
        },
        competences={"keep-station": KeepStation(settings_of(StationSettings(), _STATION, values))},
    )


def _current_goal(channels: Channels) -> object:
    return channels.get("goal")


FIND_AND_FETCH = Library(
    "find-and-fetch",
    "Where the donor is and where home is. Use ir-search, stereo-search and natigation before it.",
    (
        boolean("donor-has-been-located", "Its place is known, and nothing has spoken against it since."),
        boolean("we-already-have-the-widget", "The donor's object lies on the platform."),
        Function(
            "the-robots-home-position",
            "pose",
            "The pose of the first reading; with several, places about it in turn where nobody takes the object.",
        ),
        Function(
            "set-goal-as-the-donors-location", "pose", "Before the donor, looking at it; no goal while not located."
        ),
        Function("remember-the-current-goal-if-any", "pose", "The goal of the last tick.", reads=("goal",)),
        boolean("a-donor-is-left", "With several: not everything was fetched from every donor."),
        boolean("it-is-time-to-listen", "For a search that drives: stop here and listen."),
        Function("where-to-listen-next", "pose", "For a search that drives: the place; none while a search goes on."),
        command("keep-station", "Hold place and heading against being pushed, by odometry.", "drive"),
    ),
    (_FETCH_PRESET, _SEVERAL, _FAINT, _ROUTE, _HOME, *_DONOR, *_BEACONS, *_ROAMING, *_STATION),
    _build_find_and_fetch,
)

# --- sensors ----------------------------------------------------------------------------------------

_SENSED = parameters(
    SensedSettings(),
    ("sector", "rad", "Half the angle of a direction of the lidar."),
    ("far", "m", "The range where the lidar meets nothing, and before its first scan."),
    ("patience", "s", "A sensor without a sound value for longer is lost."),
)


def _build_sensors(values: Values, workshop: Workshop) -> Offer:
    settings = settings_of(SensedSettings(), _SENSED, values)
    sensed = workshop.share(Sensed, lambda: Sensed(settings))
    return Offer(
        percepts={
            "lidar-range-ahead": lambda: sensed.range_towards(0.0),
            "lidar-range-left": lambda: sensed.range_towards(math.pi / 2),
            "lidar-range-right": lambda: sensed.range_towards(-math.pi / 2),
            "lidar-range-behind": lambda: sensed.range_towards(math.pi),
            "lidar-nearest-range": sensed.nearest_range,
            "lidar-nearest-bearing": sensed.nearest_bearing,
            "lidar-is-lost": sensed.lidar_is_lost,
            "compass-heading": lambda: sensed.heading,
            "compass-is-lost": sensed.compass_is_lost,
            "turn-rate": lambda: sensed.turn_rate,
            "pitch": lambda: sensed.pitch,
            "roll": lambda: sensed.roll,
            "motor-current": lambda: sensed.current,
            "bumped": lambda: sensed.bumped,
        }
    )


SENSORS = Library(
    "sensors",
    "What the sensors say, the last sound value of each: for any robot, and for recordings.",
    (
        number("lidar-range-ahead", "m", "Least range ahead."),
        number("lidar-range-left", "m", "Least range to the left."),
        number("lidar-range-right", "m", "Least range to the right."),
        number("lidar-range-behind", "m", "Least range behind."),
        number("lidar-nearest-range", "m", "Least range of the whole scan."),
        number("lidar-nearest-bearing", "rad", "Where the least range was met, left positive."),
        boolean("lidar-is-lost", "No sound scan has come for some time."),
        number("compass-heading", "rad", "Heading in the world."),
        boolean("compass-is-lost", "No sound heading has come for some time."),
        number("turn-rate", "rad/s", "Of the IMU, or of odometry without one."),
        number("pitch", "rad", "Nose up positive."),
        number("roll", "rad", "Left side up positive."),
        number("motor-current", "A", "The greater of both motors."),
        boolean("bumped", "A contact switch is pressed."),
    ),
    _SENSED,
    _build_sensors,
)

# --- patrol -----------------------------------------------------------------------------------------

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


def _build_patrol(values: Values, workshop: Workshop) -> Offer:
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


PATROL = Library(
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
    _build_patrol,
)

# --- drive ------------------------------------------------------------------------------------------

_STEADY = (
    Parameter("speed", "number", "m/s", 0.2, "Ahead and back."),
    Parameter("turn-rate", "number", "rad/s", 0.5, "On the spot."),
)


def _build_drive(values: Values, workshop: Workshop) -> Offer:
    speed, turn_rate = (float(values.get(parameter.name, parameter.default)) for parameter in _STEADY)
    return Offer(
        competences={
            "drive-ahead": Steady(speed, 0.0),
            "back-up": Steady(-speed, 0.0),
            "turn-left": Steady(0.0, turn_rate),
            "turn-right": Steady(0.0, -turn_rate),
        }
    )


DRIVE = Library(
    "drive",
    "Steady motion, whatever the sensors say.",
    (
        command("drive-ahead", "Straight ahead.", "drive"),
        command("back-up", "Straight back.", "drive"),
        command("turn-left", "To the left on the spot.", "drive"),
        command("turn-right", "To the right on the spot.", "drive"),
    ),
    _STEADY,
    _build_drive,
)

# --------------------------------------------------------------------------------------------------

Shared = TypeVar("Shared", IrSearch, StereoSearch, NavigationGoal)


def _share(workshop: Workshop, kind: type[Shared], make: Callable[[], Shared], settings: object, name: str) -> Shared:
    """The shared estimator with these settings; another library may have made it with others already."""
    shared = workshop.share(kind, make)
    if shared.settings != settings:
        raise ValueError(f"use {name} before the libraries that build on it: they took it with other parameters")
    return shared


LIBRARIES: Mapping[str, Library] = MappingProxyType(
    {
        item.name: item
        for item in (
            ROBOT,
            RUNAWAY,
            NATIGATION,
            IR_SEARCH,
            STEREO_SEARCH,
            FIND_AND_FETCH,
            SENSORS,
            PATROL,
            DRIVE,
            LOCALISATION,
            MAPPING,
            PERIMETER,
            RECENT_PATH,
            SVFH,
            FLIPPERS,
            STASIS,
            WALL_BY_HOUGH,
            WALL_BY_RANSAC,
        )
    }
)
"""Every library, by name."""


def library(name: str) -> Library:
    """The library of this name. Raises KeyError where there is none."""
    return LIBRARIES[name]
