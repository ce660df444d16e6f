"""B7: the donor walks off while the robot drives to it."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from rplan.apps.reproduce.figures import case_of, judged_share, seed_of, share, spread, typical
from rplan.apps.reproduce.row import Case, Finding, Measures, Moment, Plot, Preset, Row, Seen
from rplan.apps.reproduce.watch import starts_of

CASE = "1 m aside"
ONE_METRE = (("donor.move.by", "[0, 1]"),)
WITHIN = 5.0  # [s]
MOVED = 0.001  # [m] a tick
STARTED, LOCATED = "(stereo-ranging-is-started)", "(donor-has-been-located)"
LATE = "three bearings in a row must differ, by what 0.4 m is at that distance, and none counts while the robot turns"
LOST = "the donor has walked out of the beacon's field, and the search from where the robot stands does not hear it"


def cases(seeds: int) -> tuple[Case, ...]:
    """One run a seed."""
    return (Case(CASE, "find_and_fetch", "find_and_fetch/worlds/donor_moves", tuple(range(seeds)), ONE_METRE),)


def measure(seen: Seen) -> Measures:
    """How long [s] after the donor stands again its place is given up and both searches begin from scratch."""
    stopped = stands_again(seen.moments)
    since = begun(seen.moments)
    after = [moment for moment in seen.moments if moment.time >= since]
    sweeps = starts_of(after, "start-ir-search")
    forgotten = next((m.time for m in after if not m.percepts[LOCATED] and not m.percepts[STARTED]), None)
    both = None if stopped is None or forgotten is None or not sweeps else max(0.0, max(forgotten, sweeps[0]) - stopped)
    return {
        "moved": stopped is not None,
        "restarted_after": both,
        "stereo_again": bool(sweeps) and any(t > sweeps[0] for t in starts_of(after, "start-stereo-ranging")),
        "done": seen.verdict.done,
        "driven_into": seen.verdict.driven_into,
    }


def _steps(moments: Sequence[Moment]) -> list[tuple[float, bool]]:
    """For each tick but the first, whether the donor moved in it."""
    pairs = ((before.movers.get("donor"), now.movers.get("donor"), now.time) for before, now in pairwise(moments))
    return [(t, abs(a.x - b.x) + abs(a.y - b.y) > MOVED) for a, b, t in pairs if a is not None and b is not None]


def begun(moments: Sequence[Moment]) -> float:
    """When [s] the donor begins to move; the end of time where it never does."""
    return next((time for time, moves in _steps(moments) if moves), float("inf"))


def stands_again(moments: Sequence[Moment]) -> float | None:
    """When [s] it stands again; None where it never moved."""
    return max((time for time, moves in _steps(moments) if moves), default=None)


def judge(_preset: Preset, measures: Sequence[Measures]) -> tuple[Finding, ...]:
    """Both searches anew, and the object fetched all the same."""
    soon = [m for m in measures if isinstance(after := m.get("restarted_after"), float) and after <= WITHIN]
    restarted = judged_share(len(soon), len(measures), 1.0)
    shown = typical(measures, "restarted_after") or (measures[0] if measures else None)
    fetched = [m for m in measures if m.get("done") and m.get("stereo_again")]
    found = judged_share(len(fetched), len(measures), 1.0)
    seen = case_of(shown), seed_of(shown)
    return (
        Finding(
            "both searches restarted within 5 s", "yes",
            f"{share(len(soon), len(measures))}, after {spread(measures, 'restarted_after', 's', 1.0, 1)}", restarted,
            "" if restarted == "met" else LATE, *seen,
        ),
        Finding(
            "found again and fetched", "yes", share(len(fetched), len(measures)), found,
            "" if found == "met" else LOST, *seen,
        ),
    )  # fmt: skip


ROW = Row(
    name="B7",
    paper="find-and-fetch",
    title="The donor walks off",
    set_up="While the robot drives to the donor it walks one metre to the side; timed from when it stands again.",
    printed=(
        "The plan “will restart both the stereo search and IR search if the homing to the beacon is lost, e.g., if the "
        "Hero robot moves”."
    ),
    cases=cases,
    measure=measure,
    judge=judge,
    plots=(Plot("restarted_after", "until the searches restart [s]", 1.0, (0.0, 5.0)),),
)
