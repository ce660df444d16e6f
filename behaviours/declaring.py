"""What libraries are declared with: words, parameters from settings, and settings from what a plan gives.

Takes: settings classes, and the values of a plan. Gives: `Function`s and `Parameter`s, settings with values put in, and
estimators that libraries agree on.
Leaves alone: which libraries there are (`catalogue.py`, `libraries/`).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

from behaviours.interface import Estimator, Function, Parameter, Values, Workshop

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

Settings = TypeVar("Settings", bound="DataclassInstance")


class WithSettings(Estimator, Protocol):
    """An estimator that says what it was made with."""

    @property
    def settings(self) -> object: ...


Agreed = TypeVar("Agreed", bound=WithSettings)
Row = tuple[str, str, str]
"""field of the settings, SI unit, doc"""


def parameters(defaults: DataclassInstance, *rows: Row) -> tuple[Parameter, ...]:
    """Number parameters with the defaults of a settings class: `safety_radius` becomes `safety-radius`."""
    return tuple(
        Parameter(field.replace("_", "-"), "number", unit, float(getattr(defaults, field)), doc)
        for field, unit, doc in rows
    )


def settings_of(defaults: Settings, parameters: tuple[Parameter, ...], values: Values) -> Settings:
    """The settings with the values of a plan put in; a count must be whole, every number finite and not negative."""
    changes: dict[str, Any] = {}
    for parameter in parameters:
        field = parameter.name.replace("-", "_")
        value = float(values.get(parameter.name, parameter.default))
        if not 0.0 <= value < float("inf"):
            raise ValueError(f"{parameter.name} must be finite and not negative, not {value}")
        whole = isinstance(getattr(defaults, field), int)
        if whole and not (value.is_integer() and value >= 1.0):
            raise ValueError(f"{parameter.name} must be a whole number from 1 up, not {value}")
        changes[field] = int(value) if whole else value
    return replace(defaults, **changes)


def boolean(name: str, doc: str) -> Function:
    """A percept that is true or false."""
    return Function(name, "bool", doc)


def command(name: str, doc: str, *actuators: str, reads: tuple[str, ...] = ()) -> Function:
    """A competence; reads: the channels whose value it takes."""
    return Function(name, "command", doc, actuators=actuators, reads=reads)


def chosen(parameter: Parameter, values: Values, *known: str) -> str:
    """The symbol that a plan gives, one of the known."""
    value = str(values.get(parameter.name, parameter.default))
    if value not in known:
        raise ValueError(f"{parameter.name} must be {' or '.join(known)}, not {value}")
    return value


def positive(name: str, value: float) -> float:
    """The value. Raises ValueError unless it is finite and more than 0."""
    if not 0.0 < value < math.inf:
        raise ValueError(f"{name} must be finite and more than 0, not {value}")
    return value


def number(name: str, unit: str, doc: str) -> Function:
    """A percept or value that is a number; unit: of SI."""
    return Function(name, "number", doc, unit=unit)


def preset(doc: str) -> Parameter:
    """The parameter that sets all switches of a library, `paper` or `modern`."""
    return Parameter("preset", "symbol", "", "paper", doc)


def switch(name: str, doc: str) -> Parameter:
    """A part of a library that the preset turns on and off, unless the plan says it."""
    return Parameter(name, "symbol", "", "preset", f"{doc} `on`, `off`, or as the `preset` has it.")


def is_on(values: Values, preset: Parameter, switch: Parameter) -> bool:
    """Whether a switch is on, by itself or by the preset of its library."""
    modern = chosen(preset, values, "paper", "modern") == "modern"
    return {"preset": modern, "on": True, "off": False}[chosen(switch, values, "preset", "on", "off")]


def agreed(workshop: Workshop, kind: type[Agreed], make: Callable[[], Agreed], settings: object, name: str) -> Agreed:
    """The shared estimator with these settings. Raises ValueError where another library made it with others already."""
    shared = workshop.share(kind, make)
    if shared.settings != settings:
        raise ValueError(f"use {name} before the libraries that build on it: they took it with other parameters")
    return shared
