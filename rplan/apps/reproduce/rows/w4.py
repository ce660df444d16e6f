"""W4: wedged between low posts."""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from itertools import pairwise

from rplan.apps.reproduce.figures import (
    case_of,
    count,
    greatest,
    judged,
    judged_share,
    numbers,
    seed_of,
    share,
    spread,
    worst,
)
from rplan.apps.reproduce.row import Case, Finding, Judgement, Measures, Moment, Plot, Preset, Row, Seen
from rplan.apps.sweep.work import Change

PLAN, WORLD = "steer_clear", "perimeter/worlds/low_post"
ESCAPE = "(escape-from-stasis)"
LEFT, RIGHT, NOSE = "things[0].at", "things[1].at", "things[2].at"
POSITIONS = (
    ("behind the middle of the left tread", ()),
    ("farther behind it", ((LEFT, "[-0.2, 0.313]"),)),
    ("at the middle, left of the nose", ((LEFT, "[-0.1, 0.313]"), (NOSE, "[0.398, 0.1]"))),
    ("at the middle, right of the nose", ((LEFT, "[-0.1, 0.313]"), (NOSE, "[0.398, -0.1]"))),
)
SOON, MEDIAN, MOST = 60.0, 8.0, 17.0  # [s]
AGAIN = (
    "a motion that the posts allow lowers the level at once; below the threshold the robot turns back into the posts "
    "unless it has come 0.15 m or more by then"
)


def cases(seeds: int) -> tuple[Case, ...]:
    """Every position with every seed, each with other escapes."""
    drawn = {(k, seed): 1 + seed * len(POSITIONS) + k for k in range(len(POSITIONS)) for seed in range(seeds)}
    return tuple(
        Case(
            f"{POSITIONS[k][0]}, escapes {chance}",
            PLAN,
            WORLD,
            (seed,),
            POSITIONS[k][1],
            (Change("stasis", "seed", float(chance)),),
        )
        for (k, seed), chance in drawn.items()
    )


def escaping(moments: Sequence[Moment]) -> tuple[float, float] | None:
    """When [s] the first escape began and the last one ended; None where there was none."""
    told = [moment.time for moment in moments if moment.action == ESCAPE]
    period = next((b.time - a.time for a, b in pairwise(moments)), 0.0)
    return (told[0], told[-1] + period) if told else None


def measure(seen: Seen) -> Measures:
    """How long [s] the robot took to get out, from the first escape to the end of the last; None where it did not."""
    when = escaping(seen.moments)
    took = when[1] - when[0] if when is not None and seen.verdict.done else None
    return {
        "held": when is not None,
        "took": took,
        "in_time": took is not None and took <= SOON,
        "escapes": sum(b.action == ESCAPE != a.action for a, b in pairwise(seen.moments)),
    }


def judge(preset: Preset, measures: Sequence[Measures]) -> tuple[Finding, ...]:
    """Always out within a minute, in the median soon."""
    held = [one for one in measures if one.get("held")]
    out, took = count(held, "in_time"), numbers(held, "took")
    shown, printed = greatest(held, "took"), "escapes" if preset == "paper" else "not printed"
    middle = statistics.median(took) if took else None
    late = statistics.quantiles(took, n=10)[-1] if len(took) > 1 else middle
    times = worst((_below(middle, MEDIAN), _below(late, MOST)))
    told = "never" if late is None else f"{spread(held, 'took', 's', digits=1)}, nine in ten within {late:.1f} s"
    return (
        Finding("held between the posts", "gets stuck", share(len(held), len(measures)),
                judged_share(len(held), len(measures), 1.0)),
        Finding("free within a minute", printed, share(out, len(held)), judged_share(out, len(held), 1.0),
                "" if out == len(held) else AGAIN, case_of(shown), seed_of(shown)),
        Finding("time to get free", "not printed; 8 s in the median, nine in ten within 17 s", told, times,
                "" if times == "met" else AGAIN, case_of(shown), seed_of(shown)),
    )  # fmt: skip


def _below(value: float | None, most: float) -> Judgement:
    return judged(value, 0.0, most)


ROW = Row(
    name="W4",
    paper="wayfarer",
    title="Stasis",
    set_up=(
        "A robot stands between three posts lower than its lidar, one beside each tread and one before its nose, in "
        "four arrangements, and wants to turn round; of the random motions of an escape four in ten do not free it."
    ),
    printed=(
        "“In practice, the stasis-escape behavior successfully allows the robot to escape from stasis in the current "
        "environment …”"
    ),
    note=(
        "A single post does not hold the hull in this world, which slides round it; treads would catch on it. So there "
        "are three. The flippers come out first, and in vain: the three seconds that they are given do not count. "
        "In these, some 0.15 m free the hull; beside the rear of a tread it takes more, and up to half a minute."
    ),
    cases=cases,
    measure=measure,
    judge=judge,
    presets=("paper", "modern"),
    plots=(Plot("took", "time to get free [s]"), Plot("escapes", "escapes")),
)
