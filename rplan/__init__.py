"""Plans for robots: goals, priorities and reduction rules, compiled into a circuit of fixed cost.

Takes: plan texts. Gives: the public names of the compiler and the runtime; they are imported when they are asked for,
so that the command line answers at once. Leaves alone: robots and worlds; see rplan/apps.

    >>> from rplan import Source, compile_plan
    >>> compile_plan(Source("p.rplan", "(goalem (do action (stop)))")).circuit.outputs[1][0].name
    'action=(stop)'
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rplan.circuit.circuit import Circuit
    from rplan.circuit.engine import Engine
    from rplan.driver import Compiled, compile_plan, load
    from rplan.lang.diagnostic import Diagnostic, PlanError
    from rplan.lang.plan import Plan
    from rplan.lang.source import Source
    from rplan.runtime.controller import Controller, Tick
    from rplan.runtime.tick import Decider
    from rplan.runtime.why import why, why_not

__all__ = [
    "Circuit",
    "Compiled",
    "Controller",
    "Decider",
    "Diagnostic",
    "Engine",
    "Plan",
    "PlanError",
    "Source",
    "Tick",
    "compile_plan",
    "load",
    "why",
    "why_not",
]

_HOMES = {
    "Circuit": "circuit.circuit",
    "Compiled": "driver",
    "Controller": "runtime.controller",
    "Decider": "runtime.tick",
    "Diagnostic": "lang.diagnostic",
    "Engine": "circuit.engine",
    "Plan": "lang.plan",
    "PlanError": "lang.diagnostic",
    "Source": "lang.source",
    "Tick": "runtime.controller",
    "compile_plan": "driver",
    "load": "driver",
    "why": "runtime.why",
    "why_not": "runtime.why",
}


def __getattr__(name: str) -> object:
    if name not in _HOMES:
        raise AttributeError(f"module 'rplan' has no attribute {name!r}")
    return getattr(import_module(f"rplan.{_HOMES[name]}"), name)
