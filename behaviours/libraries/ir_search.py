"""Library `ir-search`: the direction of the donor's infra-red beacon.

Takes: the parameters of a plan. Gives: percepts of the search, and the competences that start it and go on; `share_ir`
for libraries that build on it. Leaves alone: how far the donor is.
"""

from __future__ import annotations

from dataclasses import replace

from behaviours.competences.fixate import Fixate
from behaviours.cores.crossing import DISAGREE, NO_CHANGE, TOO_FEW, CrossingSettings
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
from behaviours.estimators import ir_search
from behaviours.estimators.ir_search import IrSearch, IrSettings
from behaviours.interface import Library, Offer, Values, Workshop

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
_IR_PRESET = preset("`paper`, or `modern`, which turns `roam` on.")
_ROAM = switch("roam", "Listen all round in wide steps, turn to what is heard, and sweep only there.")
_CROSSING = parameters(
    CrossingSettings(),
    ("side", "", "Least number of fixations on either side of the plus-to-minus change (chosen here)."),
    ("max_error", "rad", "Greatest standard error of the angle; the paper allows the result 2 degrees (chosen here)."),
    ("max_slope_error", "", "Greatest deviation of that line's slope from -1 (chosen here)."),
)


def share_ir(workshop: Workshop, values: Values) -> IrSearch:
    """The search with these values; ValueError where it was made with others."""
    crossing = settings_of(CrossingSettings(), _CROSSING, values)
    roam = is_on(values, _IR_PRESET, _ROAM)
    settings = replace(settings_of(IrSettings(), _IR, values), crossing=crossing, roam=roam)
    return agreed(workshop, IrSearch, lambda: IrSearch(settings), settings, "ir-search")


def _build(values: Values, workshop: Workshop) -> Offer:
    search = share_ir(workshop, values)
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


LIBRARY = Library(
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
    _build,
)
