"""Why a plan decided so, and why not otherwise, asked of a live decision.

Takes: a compiled plan and a `Decision` of it. Gives: `Why` and `WhyNot`. Leaves alone: recordings and text; see
rplan/apps/asking.py.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

from rplan.runtime.encode import PerceptValue, encoder
from rplan.runtime.tick import Decision
from rplan.ways.reduce import Ways
from rplan.ways.why import Reasons, Why
from rplan.ways.why_not import Changes, Wanted, WhyNot


class Planned(Protocol):
    """A compiled plan."""

    @property
    def ways(self) -> Ways: ...


def why(compiled: Planned, decision: Decision) -> Why:
    """Why a decision of this plan is as it is: the way, the literals that are enough for it, and what lost.

    Ask many ticks of one plan by `rplan.ways.why.Reasons`, which keeps what it has set up.
    """
    return Reasons(compiled.ways).why(decision.inputs, decision.registers)


def why_not(
    compiled: Planned, decision: Decision, wanted: Wanted, percepts: Mapping[str, PerceptValue] | None = None
) -> WhyNot:
    """The smallest change of percepts that would have made a decision of this plan set `wanted`.

    wanted: output -> canonical text, None to leave it open. percepts: their values in that tick (`Tick.percepts`);
    without them a number is known only as far as the plan's comparisons say. Raises `WantedError` (a ValueError) for
    an output or value that the plan does not have, `PerceptError` (a ValueError) for a percept that is missing or has
    no proper value, and ValueError for percepts that the decision did not see.
    """
    if percepts is not None:
        _same(compiled.ways, decision, percepts)
    return Changes(compiled.ways, wanted).why_not(decision.inputs, decision.registers, percepts)


def _same(ways: Ways, decision: Decision, percepts: Mapping[str, PerceptValue]) -> None:
    asked = ways.atoms[: ways.asking]
    for atom, value, was in zip(asked, encoder(ways.goals, asked)(percepts), decision.inputs, strict=True):
        if value != was:
            said = f"{atom.text} was {str(was).lower()} in the decision, and is {str(value).lower()} in the percepts"
            raise ValueError(f"the percepts are those of another tick: {said}")
