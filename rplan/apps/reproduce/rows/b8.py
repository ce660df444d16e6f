"""B8: how many ways the plan of Figure 1 compiles to."""

from __future__ import annotations

from collections.abc import Sequence

from rplan.apps.files import plans_folder
from rplan.apps.reproduce.row import Case, Finding, Measures, Preset, Row, Seen
from rplan.apps.wiring import compile_file
from rplan.ways.count import count

WAYS = 63


def cases(_seeds: int) -> tuple[Case, ...]:
    """Nothing is driven."""
    return ()


def measure(_seen: Seen) -> Measures:
    """Nothing is driven."""
    return {}


def judge(_preset: Preset, _measures: Sequence[Measures]) -> tuple[Finding, ...]:
    """The plan as the text describes its top goal."""
    ways = count(compile_file(plans_folder() / "figure_1" / "text.rplan", allow_holes=True).goals.top)
    return (
        Finding(
            "ways", str(WAYS), f"{ways.total} ({ways.distinct} distinct, {ways.taken} ever taken)",
            "met" if ways.total == WAYS else "missed",
            "" if ways.total == WAYS else "conditions are put into another form than the paper's compiler put them",
        ),
    )  # fmt: skip


ROW = Row(
    name="B8",
    paper="find-and-fetch",
    title="The ways of Figure 1",
    set_up="The plan of Figure 1 with the top goal that the text describes, counted as the paper counts.",
    printed="The plan compiles to 63 ways.",
    cases=cases,
    measure=measure,
    judge=judge,
)
