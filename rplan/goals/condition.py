"""Conditions and values whose names are resolved.

Takes: nothing. Gives: `Term` (a value with its canonical text, L21), `Condition` (a closed union over atoms).
Leaves alone: what a percept is in the world; an atom is known by its canonical text alone.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

from rplan.lang.plan import Comparator, Past, Type
from rplan.lang.source import Span
from rplan.lang.units import canonical_number


@dataclass(frozen=True, slots=True)
class Term:
    """A value: a call of the run-time world, a number, a truth value, a bare symbol, or arithmetic over numbers.

    name: of the function or symbol, or the operator. value: the number (SI) or truth value of a literal, else None.
    type: None where nothing tells it.
    """

    kind: Literal["call", "number", "truth", "symbol", "arithmetic"]
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
            case "call" | "arithmetic":
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


@dataclass(frozen=True, slots=True)
class Memory:
    """A condition that asks the past (L9); text is canonical, and equal text is one register.

    conditions as in rplan.lang.plan.Memory. ticks: of `held-for` and `within`, the count of `at-least`, else 0.
    """

    text: str
    form: Past
    conditions: tuple[Condition, ...]
    initial: bool
    ticks: int


@dataclass(frozen=True, slots=True)
class Named:
    """A named condition inside its own definition, behind a `delay` (L10); see `Goals.definitions`."""

    name: str


@dataclass(frozen=True, slots=True)
class OutputIs:
    """A question that only properties ask: whether the way of this tick sets `output` to `value` (canonical text).

    value None asks whether the way leaves it open.
    """

    output: str
    value: str | None


Condition = Constant | Percept | Comparison | Not | AllOf | AnyOf | Memory | Named | OutputIs


def atoms(condition: Condition) -> Iterator[Atom]:
    """Every atom in it, in textual order, with repetitions."""
    match condition:
        case Constant() | Named() | OutputIs():
            return
        case Percept() | Comparison():
            yield condition
        case Not(inner):
            yield from atoms(inner)
        case AllOf(parts) | AnyOf(parts) | Memory(conditions=parts):
            for part in parts:
                yield from atoms(part)


def percept_terms(atom: Atom) -> Iterator[Term]:
    """The calls of the run-time world that an atom reads, in textual order."""
    match atom:
        case Percept(term=term):
            yield term
        case Comparison(left=left, right=right):
            yield from _calls(left)
            yield from _calls(right)


def _calls(term: Term) -> Iterator[Term]:
    match term.kind:
        case "call":
            yield term
        case "arithmetic":
            for operand in term.arguments:
                yield from _calls(operand)


def quantity(term: Term, value_of: Callable[[str], float]) -> float:
    """The number [SI] that a term is; value_of: canonical text of a percept -> its number."""
    match term.kind:
        case "call":
            return value_of(term.text)
        case "arithmetic":
            return operate(term.name, [quantity(operand, value_of) for operand in term.arguments])
        case _:
            assert isinstance(term.value, float)
            return term.value


def operate(operator: str, numbers: Sequence[float]) -> float:
    """The one meaning of an operator."""
    first, *others = numbers
    match operator:
        case "+":
            return sum(others, first)
        case "-":
            return first - sum(others) if others else -first
        case "*":
            return math.prod(others, start=first)
        case "/":
            return first / others[0]
        case "min":
            return min(numbers)
        case "max":
            return max(numbers)
        case "abs":
            return abs(first)
        case _:
            raise ValueError(operator)


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
        case Percept(text) | Comparison(text) | Memory(text):
            return text
        case Named(name):
            return f"({name})"
        case OutputIs(output, value):
            return f"(open {output})" if value is None else f"(= {output} {value})"
        case Not(inner):
            return f"(not {print_condition(inner)})"
        case AllOf(parts):
            return f"(and {' '.join(map(print_condition, parts))})"
        case AnyOf(parts):
            return f"(or {' '.join(map(print_condition, parts))})"
