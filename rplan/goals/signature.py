"""What names mean before a plan says anything: the words that libraries offer and that every plan has.

Takes: nothing. Gives: `FunctionSignature`, `ParameterSignature`, `LibrarySignature`. Leaves alone: how a word comes
to life; the runtime binds callables to the same names.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from rplan.lang.plan import Type

BOOL = Type("bool")
SYMBOL = Type("symbol")
COMMAND = Type("command")


@dataclass(frozen=True, slots=True)
class FunctionSignature:
    """A function of the run-time world; type None where no text tells it.

    actuators: what a command drives; reads: the output channels whose values it takes; origin: the library, or "plan".
    """

    name: str
    parameters: tuple[Type, ...]
    type: Type | None
    doc: str = ""
    actuators: tuple[str, ...] = ()
    reads: tuple[str, ...] = ()
    origin: str = "plan"


@dataclass(frozen=True, slots=True)
class ParameterSignature:
    """A parameter of a library with its default (numbers in SI)."""

    name: str
    type: Type
    default: float | bool | str
    doc: str = ""


@dataclass(frozen=True, slots=True)
class LibrarySignature:
    """What a library offers to plans; works_unasked: also where none of its functions is used."""

    name: str
    functions: tuple[FunctionSignature, ...]
    parameters: tuple[ParameterSignature, ...]
    doc: str = ""
    works_unasked: bool = False


Libraries = Mapping[str, LibrarySignature]

COMPETENCE_FAILED = FunctionSignature(
    "competence-failed",
    (SYMBOL,),
    BOOL,
    "The competence raised, gave no finite command or overran its deadline in the last tick.",
    origin="rplan",
)
"""The percept that every plan has (L25)."""
