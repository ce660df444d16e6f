"""The ways that can be taken, each with a situation.

Takes: `Ways`. Gives: traces whose last tick takes one way each, as many as are wanted. Leaves alone: their order,
which is that in which z3 comes upon them, and ways that show only late in the memory of a plan.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import z3

from rplan.ways.reduce import Ways
from rplan.ways.simplest import value_of
from rplan.ways.situations import Trace, Unrolling, nothing

LATEST = 12
"""Ways of plans with memory are sought in so many ticks."""


def taken_ways(ways: Ways, limit: int, known: Sequence[Sequence[bool]] = ()) -> Iterator[Trace]:
    """A trace for each way that can be taken, at most `limit`. known: signatures of ways that are not wanted."""
    found = 0
    guards = tuple(dict.fromkeys(ways.signature()))
    seen: list[Sequence[bool]] = [*known]
    for tick in range(LATEST if ways.registers[: ways.driving] else 1):
        unrolling = Unrolling(ways, first=True)
        unrolling.solver.add(*unrolling.ask(tick, ((ways.hole, False),)), *unrolling.assumed(tick + 1))
        literals = [unrolling.literal(tick, guard) for guard in guards]
        for way in seen:
            unrolling.solver.add(_other(literals, way))
        while found < limit and unrolling.solver.check() == z3.sat:
            model = unrolling.model()
            yield _read(ways, unrolling, model, tick)
            found += 1
            seen.append([z3.is_true(model.eval(literal, model_completion=True)) for literal in literals])
            unrolling.solver.add(_other(literals, seen[-1]))


def _other(literals: list[z3.BoolRef], way: Sequence[bool]) -> z3.BoolRef:
    return z3.Or([z3.Not(one) if value else one for one, value in zip(literals, way, strict=True)])


def _read(ways: Ways, unrolling: Unrolling, model: z3.ModelRef, tick: int) -> Trace:
    trace = [nothing(ways) for _ in range(tick + 1)]
    for (here, text), symbol in unrolling.symbols().items():
        value = model.eval(symbol, model_completion=True)
        if here <= tick:
            trace[here][text] = value_of(value)
    return tuple(trace)
