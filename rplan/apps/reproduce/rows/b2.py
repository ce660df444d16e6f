"""B2: how long the whole task takes, searches and their interruptions included."""

from __future__ import annotations

from collections.abc import Sequence

from rplan.apps.reproduce.figures import case_of, judged, median, of_case, seed_of, spread, typical
from rplan.apps.reproduce.row import Case, Finding, Measures, Plot, Preset, Row, Seen
from rplan.apps.reproduce.watch import starts_of

LEAST, MOST = 600.0, 720.0  # [s]
SEARCH_LEAST, SEARCH_MOST = 360.0, 480.0  # [s]
UNDISTURBED, INTERRUPTED = "undisturbed", "interrupted"
NOBODY = (("things[15].starts", "{at: 50 min}"),)  # after the end
BECAUSE = "how often the searches were interrupted, and when, is not printed; a second sweep costs a minute and a half"


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
    middle = typical(measures, "total")
    total = judged(median(measures, "total"), LEAST, MOST)
    quiet = of_case(measures, UNDISTURBED)
    search = judged(median(quiet, "search"), SEARCH_LEAST, SEARCH_MOST)
    apart = ", ".join(
        f"{case}: {spread(of_case(measures, case), 'total', 'min', 1 / 60, 1)}" for case in (UNDISTURBED, INTERRUPTED)
    )
    return (
        Finding(
            "task, searches included", "10 to 12 min",
            f"{spread(measures, 'total', 'min', 1 / 60, 1)}; {apart}", total, "" if total == "met" else BECAUSE,
            case_of(middle), seed_of(middle),
        ),
        Finding(
            "searches alone", "about 7 min (10 to 12 less 3 to 5)", spread(quiet, "search", "min", 1 / 60, 1), search,
            "" if search == "met" else "the paper prints neither the time of a fixation nor how many there are",
            UNDISTURBED, seed_of(typical(quiet, "search")),
        ),
    )  # fmt: skip


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
    cases=cases,
    measure=measure,
    judge=judge,
    plots=(Plot("total", "task [min]", 1 / 60, (10.0, 12.0)), Plot("search", "searches [min]", 1 / 60)),
)
