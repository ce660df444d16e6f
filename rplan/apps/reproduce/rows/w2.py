"""W2: the same way round, by odometry alone."""

from __future__ import annotations

import math
from collections.abc import Sequence

from behaviours.interface import wrap
from rplan.apps.reproduce.figures import case_of, judged_share, numbers, of_case, seed_of, share, spread, typical
from rplan.apps.reproduce.row import Case, Drawn, Finding, Measures, Moment, Plot, Preset, Row, Seen
from rplan.apps.reproduce.rows.w1 import ASKED, BELIEVED, CLUTTERED, PLAN, WORLDS, beliefs, errors
from rplan.apps.sweep.work import Change

ODOMETRY = "odometry-pose"
LEAST = 90.0  # [deg]
FEW_DEGREES = 5.0
LITTLE_TURNED = "the robot turned back and forth so that errors of turns to either side cancel"
TURNED_ASIDE = "where the field is bent most the compass is off by more than a few degrees for some metres"


def cases(seeds: int) -> tuple[Case, ...]:
    """The way round with what stood there."""
    return (Case(CLUTTERED, PLAN, WORLDS + CLUTTERED, tuple(range(seeds))),)


def turned_off(moments: Sequence[Moment], name: str) -> list[float]:
    """How far [rad] the believed heading is from the true one, time after time, whole turns counted."""
    off: list[float] = []
    for true, seen in beliefs(moments, name):
        last = off[-1] if off else 0.0
        off.append(last + wrap(seen.theta - true.theta - last))
    return off


def measure(seen: Seen) -> Measures:
    """Errors of odometry at the end of the way round, and of the compass's heading on the way."""
    turned, off = turned_off(seen.moments, ODOMETRY), errors(seen.moments, ODOMETRY)
    compass = sorted(abs(math.degrees(angle)) for angle in turned_off(seen.moments, BELIEVED))
    return {
        "complete": seen.verdict.done,
        "heading_error_deg": abs(math.degrees(turned[-1])) if turned else None,
        "position_error": off[-1] if off else None,
        "greatest_error": max(off, default=None),
        "hybrid_heading_error_deg": compass[int(0.95 * (len(compass) - 1))] if compass else None,
    }


def judge(_preset: Preset, measures: Sequence[Measures]) -> tuple[Finding, ...]:
    """Heading by odometry off by a right angle or more; that of the hybrid estimate by a few degrees."""
    some = of_case(measures, CLUTTERED)
    if not some:
        return ()
    far = sum(error >= LEAST for error in numbers(some, "heading_error_deg"))
    near = sum(error <= FEW_DEGREES for error in numbers(some, "hybrid_heading_error_deg"))
    wedge, good = judged_share(far, len(some), ASKED), judged_share(near, len(some), ASKED)
    shown = typical(some, "heading_error_deg")
    seen = case_of(shown), seed_of(shown)
    return (
        Finding(
            "error of the heading by odometry", "more than 90°",
            f"90° or more in {share(far, len(some))}: {spread(some, 'heading_error_deg', '°')}; "
            f"place off by {spread(some, 'position_error', 'm', 1.0, 1)}",
            wedge, "" if wedge == "met" else LITTLE_TURNED, *seen,
        ),
        Finding(
            "error of the hybrid heading", "within a few degrees",
            f"19 of 20 moments within 5° in {share(near, len(some))}: "
            f"{spread(some, 'hybrid_heading_error_deg', '°', 1.0, 1)}",
            good, "" if good == "met" else TURNED_ASIDE, *seen,
        ),
    )  # fmt: skip


ROW = Row(
    name="W2",
    paper="wayfarer",
    title="Odometry alone",
    set_up="The way round of W1 with what stood there; what odometry and what the hybrid estimate say is compared.",
    printed=(
        "“Over a single traverse of the building perimeter, pure odometry accumulated over 90 degrees of orientation "
        "error … the square building outline being distorted into a narrow wedge. In contrast, the compass was able "
        "to reliably determine the robot's position to within a few degrees.”"
    ),
    note=(
        "Tracks that scrub report 1.3 times the turn that was made. That share was chosen so that the wedge comes out: "
        "four right angles make 108°. The agreement tells little."
    ),
    cases=cases,
    measure=measure,
    judge=judge,
    maps=(
        Drawn("the map by odometry alone", (Change("mapping", "by", "odometry"),)),
        Drawn("the map by the hybrid estimate"),
    ),
    plots=(
        Plot("heading_error_deg", "error of the heading by odometry [°]", 1.0, (90.0, 180.0)),
        Plot("position_error", "place by odometry off by [m]"),
    ),
)
