"""B6: how far, and in which weather, the beacon is found."""

from __future__ import annotations

import math
from collections.abc import Sequence

from behaviours.cores.ground import GroundSettings, pans
from behaviours.interface import wrap
from rplan.apps.reproduce.figures import (
    case_of,
    count,
    judged,
    judged_share,
    numbers,
    of_case,
    seed_of,
    share,
    spread,
    worst,
)
from rplan.apps.reproduce.row import Case, Finding, Judgement, Measures, Plot, Preset, Row, Seen
from rplan.apps.reproduce.watch import starts_of

SWEEP, STEREO = "start-ir-search", "start-stereo-ranging"
NEAR, FAR, SUN, BLOCKED, WIND = "24 ft", "28 ft", "sun behind", "sun, person behind", "wind"
WORLDS = {NEAR: "ir_24ft", FAR: "ir_28ft", SUN: "ir_sun", BLOCKED: "ir_sun_blocked", WIND: "ir_wind"}
ENOUGH = "2 min"
"""For one sweep; wind has time for several."""
ENVELOPE = 2.0  # [deg]
RETRIES = 3
FAINT = (
    "near the end of its range the signal is heard in some fixations only, and too few on one side of the zero crossing"
)
HEARD = "the strength falls smoothly with the range, so that a few sweeps beyond 25 ft still hear enough"
GLARE = "the sun's noise is drawn anew at each fixation, and luck lets some sweeps through"
ROCKED = "gusts come at random, and a sweep that meets one at the zero crossing is retried"


def cases(seeds: int) -> tuple[Case, ...]:
    """Every weather with every seed."""
    short = (("time_limit", ENOUGH),)
    return tuple(
        Case(
            name, "find_and_fetch", f"find_and_fetch/worlds/{world}", tuple(range(seeds)), () if name == WIND else short
        )
        for name, world in WORLDS.items()
    )


def measure(seen: Seen) -> Measures:
    """Whether the first sweep found the beacon, how many sweeps there were until one did, and its error [deg]."""
    sweeps, found = starts_of(seen.moments, SWEEP), starts_of(seen.moments, STEREO)
    if not found:
        return {"found": False, "found_at_once": False, "sweeps": None, "error_deg": None}
    before = sum(begin < found[0] for begin in sweeps)
    return {"found": True, "found_at_once": before == 1, "sweeps": before, "error_deg": error_of(seen, found[0])}


def error_of(seen: Seen, time: float) -> float | None:
    """How far [deg] the stereo search that begins now looks past the donor."""
    moment = next(moment for moment in seen.moments if moment.time == time)
    donor, head = moment.movers.get("donor"), moment.command.head
    if donor is None or head is None:
        return None
    true = math.atan2(donor.y - moment.pose.y, donor.x - moment.pose.x)
    looked = moment.pose.theta + head.pan - pans(GroundSettings())[0]
    return math.degrees(wrap(looked - true))


def judge(_preset: Preset, measures: Sequence[Measures]) -> tuple[Finding, ...]:
    """Shares of sweeps that find it; in wind how many sweeps it takes."""
    judges = {NEAR: _near, FAR: _far, SUN: _sun, BLOCKED: _blocked, WIND: _wind}
    return tuple(judges[name](some) for name in WORLDS if (some := of_case(measures, name)))


def _near(some: Sequence[Measures]) -> Finding:
    within = sum(abs(error) <= ENVELOPE for error in numbers(some, "error_deg"))
    judgement = judged_share(within, len(some), 0.95)
    ours = f"{share(within, len(some))} within 2° (error {spread(some, 'error_deg', '°', 1.0, 2)})"
    return _finding(some, NEAR, "found, within ± 2°", ours, judgement, FAINT)


def _far(some: Sequence[Measures]) -> Finding:
    found = count(some, "found_at_once")
    judgement = judged_share(len(some) - found, len(some), 0.95)
    return _finding(some, FAR, "not found (25 ft at most)", f"{share(found, len(some))} found", judgement, HEARD)


def _sun(some: Sequence[Measures]) -> Finding:
    found = count(some, "found_at_once")
    judgement = judged_share(len(some) - found, len(some), 0.9)
    return _finding(some, SUN, "no reliable readings", f"{share(found, len(some))} found", judgement, GLARE)


def _blocked(some: Sequence[Measures]) -> Finding:
    found = count(some, "found_at_once")
    judgement = judged_share(found, len(some), 0.9)
    return _finding(some, BLOCKED, "found", f"{share(found, len(some))} found", judgement, FAINT)


def _wind(some: Sequence[Measures]) -> Finding:
    retries = [sweeps - 1 for sweeps in numbers(some, "sweeps")]
    mean = sum(retries) / len(retries) if retries else None
    parts: list[Judgement] = [judged(mean, 0.0, RETRIES), judged_share(count(some, "found"), len(some), 1.0)]
    told = "never" if mean is None else f"{mean:.1f} retries on average"
    ours = f"{share(count(some, 'found'), len(some))} found, {told}"
    return _finding(some, WIND, "found after retries", ours, worst(parts), ROCKED)


def _finding(
    some: Sequence[Measures], what: str, printed: str, ours: str, judgement: Judgement, because: str
) -> Finding:
    shown = some[0]
    return Finding(
        what, printed, ours, judgement, "" if judgement == "met" else because, case_of(shown), seed_of(shown)
    )


ROW = Row(
    name="B6",
    paper="find-and-fetch",
    title="The reach of the beacon",
    set_up="The robot searches for the beacon from where it stands: one sweep each, in wind as many as it takes.",
    printed=(
        "“The maximum range we were able to achieve was 25 feet. When the sun was in the background of the transmitter "
        "… the signal to noise ratio was too low to get reliable readings; a person was needed to serve as a sun "
        "block”; in wind “the reaction plan would appropriately restart (retry) the search”. Error: ± 2 degrees."
    ),
    cases=cases,
    measure=measure,
    judge=judge,
    plots=(Plot("error_deg", "error of the direction [°]", 1.0, (-2.0, 2.0)), Plot("sweeps", "sweeps until found")),
)
