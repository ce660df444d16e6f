"""Assumptions that leave nothing over.

Takes: a `Reach`. Gives: a warning where no first tick meets all of them, so that everything else holds emptily. Leaves
alone: whether what is assumed is so in the world.
"""

from __future__ import annotations

from collections.abc import Iterator

from rplan.lang.diagnostic import Diagnostic
from rplan.ways.checks.finding import also
from rplan.ways.guards import TRUE
from rplan.ways.reach import Reach


def check_assumptions(reach: Reach) -> Iterator[Diagnostic]:
    """Assumptions that cannot all be."""
    assumptions = reach.ways.goals.assumptions
    if assumptions and reach.first_tick((TRUE, True)) is None:
        yield Diagnostic(
            "no-situation", "warning", "what is assumed cannot all be: no situation is left",
            assumptions[0].span, also("and this", (one.span for one in assumptions[1:])),
        )  # fmt: skip
