"""Library `stereo-search`: the distance of the donor by stereo ranging.

Takes: the parameters of a plan. Gives: percepts of the search, and the competences that start it and go on;
`share_stereo` for libraries that build on it. Leaves alone: the direction, which is found before.
"""

from __future__ import annotations

from dataclasses import replace

from behaviours.competences.fixate import Fixate
from behaviours.competences.un_stick import UnStick, UnStickSettings
from behaviours.cores.ground import GroundSettings
from behaviours.declaring import (
    agreed,
    boolean,
    command,
    is_on,
    parameters,
    preset,
    settings_of,
    switch,
)
from behaviours.estimators import stereo_search
from behaviours.estimators.head import HeadWatch
from behaviours.estimators.ir_search import IrSearch, IrSettings
from behaviours.estimators.stereo_search import StereoSearch, StereoSettings
from behaviours.interface import Function, Library, Offer, Parameter, Values, Workshop

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
_STEREO_PRESET = preset("`paper`, or `modern`, which turns `from-horizon` on.")
_FROM_HORIZON = switch("from-horizon", "Look from far to near, for what fits the strength of the beacon.")


def share_stereo(workshop: Workshop, values: Values) -> StereoSearch:
    """The search with these values; ValueError where it was made with others."""
    ground = settings_of(GroundSettings(), _GROUND, values)
    from_horizon = is_on(values, _STEREO_PRESET, _FROM_HORIZON)
    settings = replace(settings_of(StereoSettings(), _STEREO, values), ground=ground, from_horizon=from_horizon)
    if not settings.camera_height > ground.object_height > 0.0:
        raise ValueError("object-height must be more than 0 and less than camera-height")
    ir = workshop.share(IrSearch, lambda: IrSearch(IrSettings()))

    def bearing() -> float | None:
        return None if ir.direction is None else ir.direction.bearing

    def reach() -> float | None:
        return None if ir.direction is None else ir.direction.reach

    return agreed(workshop, StereoSearch, lambda: StereoSearch(settings, bearing, reach), settings, "stereo-search")


def _build(values: Values, workshop: Workshop) -> Offer:
    search = share_stereo(workshop, values)
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


LIBRARY = Library(
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
    _build,
)
