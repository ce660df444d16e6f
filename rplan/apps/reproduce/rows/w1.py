"""W1: once round a building, and how far the robot believes to be from where it is."""

from __future__ import annotations

import math
import statistics
from collections.abc import Mapping, Sequence

from behaviours.interface import Pose, View
from rplan.apps.reproduce.figures import case_of, judged, judged_share, numbers, of_case, seed_of, share, spread, worst
from rplan.apps.reproduce.row import Case, Finding, Judgement, Measures, Moment, Plot, Preset, Row, Seen

PLAN, WORLDS = "perimeter", "perimeter/worlds/"
CLUTTERED, BARE = "auxiliary", "bare"
HALF = 12.5  # [m] of a side of the building
WITHIN = 3.0  # [m]
STAND_OFF = 1.5  # [m]
ASKED = 0.95
BELIEVED = "believed-pose"
TOUCHED = "the hull of 0.69 x 0.52 m touched what stands beside the way"
INCOMPLETE = "the time was over before the robot was back"
ASTRAY = "the compass is off by up to 4 degrees, differently on each side of the building, and that does not cancel"
WIDE = "docks, the dumpster and the bushes keep the robot farther from the wall than it wants to be"


def cases(seeds: int) -> tuple[Case, ...]:
    """With what stood there, and without."""
    return tuple(Case(name, PLAN, WORLDS + name, tuple(range(seeds))) for name in (CLUTTERED, BARE))


def place_in(view: View) -> Pose:
    """The pose of a view of the kind `pose`, in its frame."""
    at = view["at"]
    assert isinstance(at, list | tuple)
    return Pose(*(float(value) for value in at))


def beliefs(moments: Sequence[Moment], name: str) -> list[tuple[Pose, Pose]]:
    """The true pose and the believed one, both in the world, wherever the view tells it anew.

    Views are in the map frame: its origin lies where the robot started, its axes are those of the world.
    """
    if not moments:
        return []
    start = moments[0].pose
    told = ((moment.pose, place_in(moment.shown[name])) for moment in moments if name in moment.shown)
    return [(true, Pose(start.x + seen.x, start.y + seen.y, seen.theta)) for true, seen in told]


def errors(moments: Sequence[Moment], name: str) -> list[float]:
    """How far [m] the believed place is from the true one, time after time."""
    return [math.dist((true.x, true.y), (seen.x, seen.y)) for true, seen in beliefs(moments, name)]


def stand_off(pose: Pose) -> float:
    """Distance [m] of the robot's middle from the building."""
    return math.hypot(max(abs(pose.x) - HALF, 0.0), max(abs(pose.y) - HALF, 0.0))


def measure(seen: Seen) -> Measures:
    """Errors of the estimate [m], the way round, and what was touched."""
    verdict, off = seen.verdict, errors(seen.moments, BELIEVED)
    return {
        "complete": verdict.done,
        "share": verdict.share,
        "return_error": off[-1] if off and verdict.done else None,
        "greatest_error": max(off, default=None),
        "stand_off": statistics.median(stand_off(moment.pose) for moment in seen.moments),
        "clearance": verdict.smallest_clearance,
        "distance": verdict.distance,
        "time": verdict.duration,
        "contacts": len(verdict.contacts),
    }


def judge(_preset: Preset, measures: Sequence[Measures]) -> tuple[Finding, ...]:
    """Return error, contacts and completion with clutter and without; how far from the wall."""
    found: list[Finding] = []
    for name in (CLUTTERED, BARE):
        some = of_case(measures, name)
        if some:
            found += (_round(name, some), _returned(name, some), _beside(name, some))
    return tuple(found)


def _round(name: str, some: Sequence[Measures]) -> Finding:
    whole = [one for one in some if one.get("complete")]
    untouched = [one for one in some if one.get("contacts") == 0]
    judgements = judged_share(len(whole), len(some), 1.0), judged_share(len(untouched), len(some), 1.0)
    bad = next((one for one in some if one not in whole or one not in untouched), some[0])
    reasons: Mapping[str, Judgement] = {INCOMPLETE: judgements[0], TOUCHED: judgements[1]}
    because = " and ".join(reason for reason, judgement in reasons.items() if judgement != "met")
    ours = (
        f"{share(len(whole), len(some))} complete, {share(len(untouched), len(some))} without a contact; "
        f"{spread(whole, 'distance', 'm')}, {spread(whole, 'time', 's')}; "
        f"smallest clearance {spread(some, 'clearance', 'm', 1.0, 2)}"
    )
    return Finding(
        f"once round, {name}", "complete, steering round every obstacle", ours, worst(judgements), because,
        case_of(bad), seed_of(bad),
    )  # fmt: skip


def _returned(name: str, some: Sequence[Measures]) -> Finding:
    good = [one for one in some if numbers([one], "return_error") and numbers([one], "return_error")[0] <= WITHIN]
    bad = next((one for one in some if one not in good), some[0])
    judgement = judged_share(len(good), len(some), ASKED)
    ours = (
        f"{share(len(good), len(some))}; {spread(some, 'return_error', 'm', 1.0, 2)}, "
        f"on the way at most {spread(some, 'greatest_error', 'm', 1.0, 2)}"
    )
    unfinished = any(one.get("return_error") is None for one in some)
    because = "" if judgement == "met" else INCOMPLETE if unfinished else ASTRAY
    return Finding(
        f"error of the hybrid estimate at the end, {name}", "less than 3 m (estimated)", ours, judgement, because,
        case_of(bad), seed_of(bad),
    )  # fmt: skip


def _beside(name: str, some: Sequence[Measures]) -> Finding:
    middle = statistics.median(numbers(some, "stand_off"))
    judgement = judged(middle, STAND_OFF - 0.2, STAND_OFF + 0.3)
    return Finding(
        f"distance from the wall, {name}", "1.5 m asked for", spread(some, "stand_off", "m", 1.0, 2), judgement,
        "" if judgement == "met" else WIDE, case_of(some[0]), seed_of(some[0]),
    )  # fmt: skip


ROW = Row(
    name="W1",
    paper="wayfarer",
    title="Once round a building",
    set_up=(
        "A building of 25 x 25 m, 0.5 m/s, 1.5 m from the wall, counter-clockwise; with bushes, trees, a car, a lawn "
        "behind kerbs, docks, a dumpster and a truck (auxiliary), and with nothing (bare)."
    ),
    printed=(
        "“The robot was able to successfully navigate around all of these obstacles and return to its original "
        "starting position with an overall position error of less than 3 meters (estimated).” The hybrid method gave "
        "“the robot's position accurately to within a few meters throughout”."
    ),
    note=(
        "Neither the error of the compass nor where things stood is printed. The field that turns the compass (2.1° "
        "rms, 4.2° at most, 38 m from wave to wave) was chosen of the size that such compasses have near buildings; it "
        "decides the error at the end. The contacts that the picture marks are kerbs; tracks climb those, and they do "
        "not count."
    ),
    cases=cases,
    measure=measure,
    judge=judge,
    presets=("paper", "modern"),
    picture=CLUTTERED,
    plots=(
        Plot("return_error", "error at the end [m]", 1.0, (0.0, WITHIN)),
        Plot("greatest_error", "greatest error on the way [m]", 1.0, (0.0, WITHIN)),
        Plot("stand_off", "median distance from the building [m]"),
    ),
)
