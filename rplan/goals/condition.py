"""Conditions and values whose names are resolved.

Takes: nothing. Gives: `Term` (a value with its canonical text, L21), `Condition` (a closed union over atoms).
Leaves alone: what a percept is in the world; an atom is known by its canonical text alone.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from rplan.lang.plan import Comparator, Type
from rplan.lang.source import Span
from rplan.lang.units import canonical_number


@dataclass(frozen=True, slots=True)
class Term:
    """A value: a call of the run-time world, a number, a truth value or a bare symbol; type None if nothing tells it.

    value: the number (SI) or truth value of a literal, else None.
    """

    kind: Literal["call", "number", "truth", "symbol"]
    name: str
    arguments: tuple[Term, ...]
    value: float | bool | None
    type: Type | None
    span: Span

    @property
    def text(self) -> str:
        """Canonical text (L21): equal text is equal value."""
        match self.kind:
            case "number":
                assert isinstance(self.value, float)
                return canonical_number(self.value, self.type.unit if self.type else "")
            case "truth":
                return "true" if self.value else "false"
            case "symbol":
                return self.name
            case "call":
                return f"({' '.join((self.name, *(argument.text for argument in self.arguments)))})"


@dataclass(frozen=True, slots=True)
class Percept:
    """A bool function of the run-time world; text is its canonical call."""

    text: str
    term: Term


@dataclass(frozen=True, slots=True)
class Comparison:
    """Two numbers compared; text is `(< LEFT RIGHT)` in canonical text."""

    text: str
    operator: Comparator
    left: Term
    right: Term


Atom = Percept | Comparison


@dataclass(frozen=True, slots=True)
class Constant:
    value: bool


@dataclass(frozen=True, slots=True)
class Not:
    condition: Condition


@dataclass(frozen=True, slots=True)
class AllOf:
    conditions: tuple[Condition, ...]


@dataclass(frozen=True, slots=True)
class AnyOf:
    conditions: tuple[Condition, ...]


Condition = Constant | Percept | Comparison | Not | AllOf | AnyOf


def atoms(condition: Condition) -> Iterator[Atom]:
    """Every atom in it, in textual order, with repetitions."""
    match condition:
        case Constant():
            return
        case Percept() | Comparison():
            yield condition
        case Not(inner):
            yield from atoms(inner)
        case AllOf(parts) | AnyOf(parts):
            for part in parts:
                yield from atoms(part)


def percept_terms(atom: Atom) -> Iterator[Term]:
    """The calls of the run-time world that an atom reads, in textual order."""
    match atom:
        case Percept(term=term):
            yield term
        case Comparison(left=left, right=right):
            yield from (term for term in (left, right) if term.kind == "call")


def compare(operator: Comparator, left: float, right: float) -> bool:
    """The one meaning of a comparison of two numbers in SI."""
    match operator:
        case "<":
            return left < right
        case "<=":
            return left <= right
        case ">":
            return left > right
        case ">=":
            return left >= right
        case "=":
            return left == right
        case "/=":
            return left != right


def print_condition(condition: Condition) -> str:
    """The condition as an S-expression in canonical text."""
    match condition:
        case Constant(value):
            return "true" if value else "false"
        case Percept(text) | Comparison(text):
            return text
        case Not(inner):
            return f"(not {print_condition(inner)})"
        case AllOf(parts):
            return f"(and {' '.join(map(print_condition, parts))})"
        case AnyOf(parts):
            return f"(or {' '.join(map(print_condition, parts))})"
