"""B2: how long the whole task takes, searches and their interruptions included."""

from __future__ import annotations

from collections.abc import Sequence

from rplan.apps.reproduce.figures import case_of, judged, median, of_case, seed_of, spread, typical
from rplan.apps.reproduce.row import Case, Finding, Measures, Plot, Preset, Row, Seen
from rplan.apps.reproduce.watch import starts_of

LEAST, MOST = 600.0, 720.0  # [s]
SEARCH = (360.0, 480.0)  # [s]
UNDISTURBED, INTERRUPTED = "undisturbed", "interrupted"
NOBODY = (("things[15].starts", "{at: 50 min}"),)  # after the end
FEW = "both searches run through without a pause, and half of the obstacles stand away from the course"
LATE = (
    "how often the searches were interrupted, and when, is not printed; a second sweep costs up to a minute and a half"
)
UNKNOWN = "the paper prints neither the time of a fixation nor how many there are"


def cases(seeds: int) -> tuple[Case, ...]:
    """Half of the seeds with somebody who interrupts the search."""
    plan, world = "find_and_fetch", "find_and_fetch/worlds/total"
    return (
        Case(UNDISTURBED, plan, world, tuple(range(0, seeds, 2)), NOBODY),
        Case(INTERRUPTED, plan, world, tuple(range(1, seeds, 2))),
    )


def measure(seen: Seen) -> Measures:
    """Times [s], and how often a search was begun."""
    verdict = seen.verdict
    return {
        "done": verdict.done,
        "total": verdict.times.home,
        "search": verdict.times.departure if verdict.done else None,
        "ir_searches": len(starts_of(seen.moments, "start-ir-search")),
        "stereo_searches": len(starts_of(seen.moments, "start-stereo-ranging")),
        "driven_into": verdict.driven_into,
    }


def judge(_preset: Preset, measures: Sequence[Measures]) -> tuple[Finding, ...]:
    """Both kinds of runs by their medians; the searches of undisturbed ones beside what the paper leaves for them."""
    quiet, loud = of_case(measures, UNDISTURBED), of_case(measures, INTERRUPTED)
    return (
        _median(quiet, "nobody interrupts", "10 min, the least", "total", (LEAST, MOST), FEW),
        _median(loud, "one interruption", "10 to 12 min", "total", (LEAST, MOST), LATE),
        _median(quiet, "searches alone", "about 7 min (10 to 12 less 3 to 5)", "search", SEARCH, UNKNOWN),
    )


def _median(
    some: Sequence[Measures], what: str, printed: str, key: str, bounds: tuple[float, float], because: str
) -> Finding:
    judgement, shown = judged(median(some, key), *bounds), typical(some, key)
    ours = spread(some, key, "min", 1 / 60, 1)
    return Finding(
        what, printed, ours, judgement, "" if judgement == "met" else because, case_of(shown), seed_of(shown)
    )


ROW = Row(
    name="B2",
    paper="find-and-fetch",
    title="The whole task, searches included",
    set_up=(
        "The parking lot with cars that drive, somebody who crosses, and a trashcan that is rolled at the robot; in "
        "every second run somebody passes close by while it searches."
    ),
    printed=(
        "“With IR and stereo search the total task completion time was between ten and twelve minutes, depending on "
        "the number of times dynamic obstacles interrupted the sensor searches.”"
    ),
    note=(
        "The paper prints no time of a search; the dwell of a fixation was chosen so that both searches take the seven "
        "minutes that are left, so that the agreement tells little."
    ),
    cases=cases,
    measure=measure,
    judge=judge,
    picture=INTERRUPTED,
    plots=(Plot("total", "task [min]", 1 / 60, (10.0, 12.0)), Plot("search", "searches [min]", 1 / 60)),
)
