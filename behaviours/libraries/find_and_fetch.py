"""Library `find-and-fetch`: where the donor is and where home is.

Takes: the parameters of a plan. Gives: percepts and values of the errand, and the competence that keeps the station.
Leaves alone: the searches and the way.
"""

from __future__ import annotations

import math
from dataclasses import replace

from behaviours.competences.keep_station import KeepStation, StationSettings
from behaviours.declaring import boolean, chosen, command, is_on, parameters, preset, settings_of, switch
from behaviours.estimators.beacons import Beacons, BeaconSettings
from behaviours.estimators.donor import DonorMemory, DonorSettings
from behaviours.estimators.home import Home
from behaviours.estimators.ir_search import IrSearch
from behaviours.estimators.latest import Latest
from behaviours.estimators.navigation import ArrivalSettings, NavigationGoal
from behaviours.estimators.roaming import Roaming, RoamingSettings
from behaviours.estimators.stereo_search import StereoSearch
from behaviours.interface import Channels, Function, Library, Offer, Parameter, Values, Workshop
from behaviours.libraries.ir_search import share_ir
from behaviours.libraries.stereo_search import share_stereo

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
_FETCH_PRESET = preset("`paper`, or `modern`, which turns `several` and `faint` on.")
_SEVERAL = switch("several", "Donors are told apart by their beacons, and served one after the other.")
_FAINT = switch("faint", "Signals below the reader's threshold tell where to listen next.")
_HOME = Parameter("home-patience", "number", "s", 20.0, "With several: a place at home is left after waiting so long.")
_ROUTE = Parameter("route", "symbol", "", "chance", "Listen next by `chance` to hear, or along a `spiral`.")


def _build(values: Values, workshop: Workshop) -> Offer:
    several = is_on(values, _FETCH_PRESET, _SEVERAL)
    settings = replace(settings_of(DonorSettings(), _DONOR, values), several=several)
    hearing = replace(settings_of(BeaconSettings(), _BEACONS, values), faint=is_on(values, _FETCH_PRESET, _FAINT))
    spiral = chosen(_ROUTE, values, "chance", "spiral") == "spiral"
    roaming = replace(settings_of(RoamingSettings(), _ROAMING, values), spiral=spiral)
    ir = workshop.share(IrSearch, lambda: share_ir(workshop, {}))
    stereo = workshop.share(StereoSearch, lambda: share_stereo(workshop, {}))
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


LIBRARY = Library(
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
    _build,
)
