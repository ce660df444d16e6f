"""B5: a trashcan is rolled close to the robot on its way."""

from __future__ import annotations

from collections.abc import Sequence

from rplan.apps.reproduce.figures import case_of, greatest, judged_share, numbers, seed_of, share, spread
from rplan.apps.reproduce.row import Case, Finding, Measures, Plot, Preset, Row, Seen
from rplan.apps.reproduce.watch import FLEEING, episodes_of

ONE_EPISODE = 5.0  # [s] breaks of a runaway that are shorter do not make it two: backing off overshoots the radius
SIDES = (
    ("from the right", ()),
    ("from the left", (("things[4].at", "[2.4, 3.7]"),)),
    ("from ahead on the right", (("things[4].at", "[5.5, -3]"),)),
    ("from ahead on the left", (("things[4].at", "[5.5, 3]"),)),
)
BECAUSE = (
    "after the first retreat the sonar loses the trashcan's edge, and the way round it leads through its radius again"
)


def cases(seeds: int) -> tuple[Case, ...]:
    """The seeds dealt out to four sides."""
    world, sides = "find_and_fetch/worlds/trashcan", len(SIDES)
    return tuple(
        Case(name, "find_and_fetch", world, tuple(range(k, seeds, sides)), settings)
        for k, (name, settings) in enumerate(SIDES)
    )


def measure(seen: Seen) -> Measures:
    """Runaway episodes, the longest of them [s], and whether the donor was reached afterwards."""
    fled = episodes_of(seen.moments, FLEEING, ONE_EPISODE)
    arrival = seen.verdict.times.arrival
    return {
        "runaways": len(fled),
        "longest": max((end - begin + seen.period for begin, end in fled), default=None),
        "reached": bool(fled) and arrival is not None and arrival > fled[0][1],
        "driven_into": seen.verdict.driven_into,
    }


def judge(_preset: Preset, measures: Sequence[Measures]) -> tuple[Finding, ...]:
    """Exactly one episode, then the donor."""
    one = [m for m in measures if m.get("runaways") == 1 and m.get("reached") and m.get("driven_into") == 0]
    judgement = judged_share(len(one), len(measures), 1.0)
    shown = one[0] if one else greatest(measures, "runaways")
    counts = [int(value) for value in numbers(measures, "runaways")]
    told = ", ".join(f"{n}×: {counts.count(n)}" for n in sorted(dict.fromkeys(counts)))
    return (
        Finding(
            "one runaway, then the donor", "activated only once",
            f"{share(len(one), len(measures))} (runaways: {told}; longest {spread(measures, 'longest', 's', 1.0, 1)})",
            judgement, "" if judgement == "met" else BECAUSE, case_of(shown), seed_of(shown),
        ),
    )  # fmt: skip


ROW = Row(
    name="B5",
    paper="find-and-fetch",
    title="A trashcan rolled at the robot",
    set_up=(
        "2.5 m from home a trashcan is rolled to 10 cm from the hull, from four sides; two to four obstacles stand "
        "about."
    ),
    printed=(
        "“The runaway behavior was activated only once due to the fact that we deliberately rolled a trashcan within a "
        "few inches of the robot …”; it backed away and “proceeded smoothly towards the goal avoiding the obstacle”."
    ),
    cases=cases,
    measure=measure,
    judge=judge,
    plots=(Plot("longest", "longest runaway [s]"),),
)
