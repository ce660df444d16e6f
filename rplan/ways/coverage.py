"""What is to be said of the situations of a plan.

Takes: `Ways`. Gives: diagnostics. `find` has what makes a plan wrong, holes and required outputs that stay open, and is
asked whenever a plan is compiled; `review` has the rest, for who wants to know. Leaves alone: what happens in a hole at
run time.

Decided exactly (reach.py); every finding that a situation shows has the simplest one as its witness (L26).
"""

from __future__ import annotations

from rplan.lang.diagnostic import Diagnostic
from rplan.ways.checks.acts import check_competences, check_outputs
from rplan.ways.checks.assumptions import check_assumptions
from rplan.ways.checks.branches import check_branches
from rplan.ways.checks.conflicts import check_conflicts, check_ties
from rplan.ways.checks.holes import check_holes, check_required
from rplan.ways.checks.percepts import check_percepts
from rplan.ways.reach import Reach
from rplan.ways.reduce import Ways


def find(ways: Ways, *, allow_holes: bool = False) -> tuple[Diagnostic, ...]:
    """What makes a plan wrong."""
    reach = Reach(ways)
    return (*check_holes(reach, allow_holes), *check_required(reach))


def review(ways: Ways, *, notes: bool = True) -> tuple[Diagnostic, ...]:
    """What is surely a mistake, as warnings; notes: also what one may want to know.

    Nothing is done in a hole, so that what is never done is told only of plans that have none.
    """
    reach = Reach(ways)
    found = [*check_assumptions(reach)]
    if not any(one.code == "hole" for one in check_holes(reach, allow_holes=True)):
        found += [*check_branches(reach), *check_outputs(reach)]
    if notes:
        found += [*check_conflicts(reach), *check_ties(reach), *check_competences(reach), *check_percepts(reach)]
    return tuple(one for one in found if notes or one.severity != "note")
