"""Properties and assumptions with their names looked up: what must hold, and what may be taken for granted.

Takes: a `Plan`, its scope and its outputs. Gives: `Property`s and `Assumption`s, in textual order. Leaves alone:
whether they hold.
"""

from __future__ import annotations

from rplan.goals import condition as c
from rplan.goals import goal as g
from rplan.goals.resolve import resolve_condition
from rplan.goals.scope import Asks, Scope
from rplan.lang import plan as p


def resolve_properties(plan: p.Plan, scope: Scope, outputs: tuple[g.Output, ...]) -> tuple[g.Property, ...]:
    """What must hold in every tick; these conditions may ask outputs."""

    def one(claim: p.Property) -> g.Property:
        always = _asked(claim.always, "outputs", scope, outputs)
        provided = _asked(claim.provided, "outputs", scope, outputs) if claim.provided else c.Constant(True)
        return g.Property(claim.name, claim.doc, always, provided, claim.span)

    return tuple(map(one, plan.properties))


def resolve_assumptions(plan: p.Plan, scope: Scope, outputs: tuple[g.Output, ...]) -> tuple[g.Assumption, ...]:
    """What may be taken for granted of the percepts."""
    return tuple(g.Assumption(_asked(a.condition, "percepts", scope, outputs), a.span) for a in plan.assumptions)


def _asked(condition: p.Condition, asks: Asks, scope: Scope, outputs: tuple[g.Output, ...]) -> c.Condition:
    scope.asks, scope.channels = asks, {output.name: output.type for output in outputs}
    return resolve_condition(condition, scope)
