"""`Plan`: a well-formed plan whose names have not been looked up.

Takes: nothing. Gives: frozen syntax, one class a form, each with its place. Leaves alone: meaning, types and names.
`when` and `cond` do not appear: the parser turns them into nested `If`s (L13).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from rplan.lang.source import Span

# --- values and conditions ------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Number:
    """value in SI; unit: its SI unit ("m", "s", "rad", "A", "%", "m/s", "rad/s"), "" for a bare number."""

    value: float
    unit: str
    span: Span


@dataclass(frozen=True, slots=True)
class Truth:
    """`true` or `false`."""

    value: bool
    span: Span


@dataclass(frozen=True, slots=True)
class Call:
    """A function of the run-time world with its arguments; a bare symbol is a call without arguments (L7)."""

    name: str
    arguments: tuple[Expression, ...]
    span: Span


@dataclass(frozen=True, slots=True)
class Not:
    condition: Condition
    span: Span


@dataclass(frozen=True, slots=True)
class AllOf:
    conditions: tuple[Condition, ...]
    span: Span


@dataclass(frozen=True, slots=True)
class AnyOf:
    conditions: tuple[Condition, ...]
    span: Span


Comparator = Literal["<", "<=", ">", ">=", "=", "/="]
Operator = Literal["+", "-", "*", "/", "min", "max", "abs"]
Past = Literal["delay", "once", "historically", "since", "latch", "rose", "fell", "held-for", "within", "at-least"]


@dataclass(frozen=True, slots=True)
class Arithmetic:
    """Numbers put together; `-` of one number is its negative."""

    operator: Operator
    operands: tuple[Quantity, ...]
    span: Span


@dataclass(frozen=True, slots=True)
class Memory:
    """A condition that asks the past (L9).

    conditions in the order of the text: of `latch` SET and RESET, of `since` C and D, of `at-least` C and perhaps R.
    initial: of `delay`; duration: of `held-for` and `within`; count: of `at-least`.
    """

    form: Past
    conditions: tuple[Condition, ...]
    span: Span
    initial: bool = False
    duration: Number | None = None
    count: int = 0


@dataclass(frozen=True, slots=True)
class Compare:
    operator: Comparator
    left: Quantity
    right: Quantity
    span: Span


Quantity = Number | Call | Arithmetic
Expression = Number | Truth | Call
Condition = Truth | Call | Not | AllOf | AnyOf | Compare | Memory

# --- goals ----------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Do:
    """`(do OUTPUT VALUE)`; span is the whole form."""

    output: str
    value: Expression
    span: Span


@dataclass(frozen=True, slots=True)
class Anything:
    """`(do anything)`, also where `when` or `cond` end without an else."""

    span: Span


@dataclass(frozen=True, slots=True)
class If:
    condition: Condition
    then: Goal
    otherwise: Goal
    span: Span


@dataclass(frozen=True, slots=True)
class And:
    goals: tuple[Goal, ...]
    span: Span


@dataclass(frozen=True, slots=True)
class Or:
    goals: tuple[Goal, ...]
    span: Span


@dataclass(frozen=True, slots=True)
class PrioAnd:
    goals: tuple[Goal, ...]
    span: Span


@dataclass(frozen=True, slots=True)
class Subgoal:
    """`(ach NAME)` or `(maint NAME)`."""

    kind: Literal["ach", "maint"]
    name: str
    span: Span


Goal = Do | Anything | If | And | Or | PrioAnd | Subgoal

# --- top level ------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Type:
    """name: "bool", "number", "pose", "command" or "symbol"; unit: SI unit of a number."""

    name: str
    unit: str = ""

    def __str__(self) -> str:
        return f"(number {self.unit})" if self.name == "number" and self.unit else self.name


@dataclass(frozen=True, slots=True)
class Header:
    """`(plan NAME "doc" :period 0.1s)`; period [s]."""

    name: str
    doc: str
    period: float
    span: Span


@dataclass(frozen=True, slots=True)
class Setting:
    """One `:parameter value` of a `use`; a value that is a symbol (`paper`) is a Call without arguments."""

    name: str
    value: Expression
    span: Span


@dataclass(frozen=True, slots=True)
class Use:
    library: str
    settings: tuple[Setting, ...]
    span: Span


@dataclass(frozen=True, slots=True)
class Declaration:
    """`(declare (NAME (ARG TYPE)…) TYPE "doc")`; parameters: (name, type) in order."""

    name: str
    parameters: tuple[tuple[str, Type], ...]
    type: Type
    doc: str
    span: Span


@dataclass(frozen=True, slots=True)
class OutputDeclaration:
    """`(defoutput NAME TYPE :idle VALUE)` or `… :hold :initial VALUE`; at most one of idle and hold."""

    name: str
    type: Type
    idle: Expression | None
    hold: bool
    initial: Expression | None
    span: Span


@dataclass(frozen=True, slots=True)
class NamedCondition:
    name: str
    doc: str
    condition: Condition
    span: Span


@dataclass(frozen=True, slots=True)
class Rule:
    """`(defgoalr (ach NAME) "doc" GOAL)`; head_span is the place of `(ach NAME)`."""

    kind: Literal["ach", "maint"]
    name: str
    doc: str
    goal: Goal
    head_span: Span
    span: Span


@dataclass(frozen=True, slots=True)
class TopGoal:
    goal: Goal
    span: Span


@dataclass(frozen=True, slots=True)
class Plan:
    """A whole plan text, every list in textual order. span is the place of the first form, or the start of the text."""

    header: Header
    uses: tuple[Use, ...]
    declarations: tuple[Declaration, ...]
    outputs: tuple[OutputDeclaration, ...]
    conditions: tuple[NamedCondition, ...]
    rules: tuple[Rule, ...]
    top: TopGoal | None
    span: Span
