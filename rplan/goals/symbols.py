"""The symbols that a plan names (L20).

Takes: a `Plan`. Gives: the names that stand as arguments without arguments of their own, once each, in textual order.
Leaves alone: whether something else goes by the same name.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator

from rplan.lang import plan as p


def symbols_of(plan: p.Plan) -> tuple[str, ...]:
    """What the variables of operators range over."""
    if not plan.operators:
        return ()
    parts = (plan.conditions, plan.rules, plan.operators, plan.top)
    found = sorted(_symbols(parts), key=lambda call: call.span)
    return tuple(dict.fromkeys(call.name for call in found))


def _symbols(node: object) -> Iterator[p.Call]:
    if isinstance(node, tuple):
        for part in node:
            yield from _symbols(part)
    elif dataclasses.is_dataclass(node):
        if isinstance(node, p.Call | p.Subgoal):
            yield from (one for one in node.arguments if isinstance(one, p.Call) and not one.arguments)
        if isinstance(node, p.Rule):
            yield from (one for one in node.parameters if isinstance(one, p.Call) and not one.arguments)
        for field in dataclasses.fields(node):
            yield from _symbols(getattr(node, field.name))
