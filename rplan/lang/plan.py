"""`Plan`: a well-formed plan whose names have not been looked up.

Takes: nothing. Gives: frozen syntax, one class a form, each with its place. Leaves alone: meaning, types and names.
`when` and `cond` do not appear: the parser turns them into nested `If`s (L13). `Variable`s stand in the bodies of
rules, conditions and operators that have parameters, and nowhere else.
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
class Variable:
    """`?name`, without the question mark: a parameter, in whose place an argument is put (L17)."""

    name: str
    span: Span


@dataclass(frozen=True, slots=True)
class Call:
    """A function of the run-time world with its arguments; a bare symbol is a call without arguments (L7).

    Arguments are values; only those of a named condition may be conditions or numbers that are worked out.
    """

    name: str
    arguments: tuple[Argument, ...]
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
ArithmeticOperator = Literal["+", "-", "*", "/", "min", "max", "abs"]
Past = Literal["delay", "once", "historically", "since", "latch", "rose", "fell", "held-for", "within", "at-least"]


@dataclass(frozen=True, slots=True)
class Arithmetic:
    """Numbers put together; `-` of one number is its negative."""

    operator: ArithmeticOperator
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


@dataclass(frozen=True, slots=True)
class OutputIs:
    """`(= OUTPUT VALUE)` or `(open OUTPUT)` (value None) in a property.

    Where `output` turns out to be no output, it is what it looks like: a comparison, or a call of `open`.
    """

    output: str
    value: Expression | None
    span: Span


Quantity = Number | Call | Arithmetic | Variable
Expression = Number | Truth | Call | Variable
Condition = Truth | Call | Not | AllOf | AnyOf | Compare | Memory | OutputIs | Variable
Argument = Expression | Quantity | Condition
"""What may be put in the place of a variable."""

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
    """`(ach NAME ARG…)` or `(maint NAME ARG…)`; `(ach (NAME ARG…))` says the same.

    A rule answers it, and where there is none, operators answer an `ach`: then `(NAME ARG…)` is the fact (L20).
    depth: of the regression, None where the text tells none.
    """

    kind: Literal["ach", "maint"]
    name: str
    arguments: tuple[Argument, ...]
    span: Span
    depth: int | None = None


@dataclass(frozen=True, slots=True)
class Achieve:
    """`(ach CONDITION)`, a condition that is no single fact: only operators answer it (L20)."""

    condition: Condition
    span: Span
    depth: int | None = None


Goal = Do | Anything | If | And | Or | PrioAnd | Subgoal | Achieve

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
    """`(defoutput NAME TYPE :idle VALUE)` or `… :hold :initial VALUE`; at most one of idle and hold.

    required: leaving it open is an error.
    """

    name: str
    type: Type
    idle: Expression | None
    hold: bool
    initial: Expression | None
    span: Span
    required: bool = False


@dataclass(frozen=True, slots=True)
class NamedCondition:
    """`(defcond (NAME ?ARG…) "doc" CONDITION)`; parameters: names without the question mark."""

    name: str
    parameters: tuple[str, ...]
    doc: str
    condition: Condition
    span: Span


@dataclass(frozen=True, slots=True)
class Rule:
    """`(defgoalr (ach NAME ARG…) "doc" GOAL)`; head_span is the place of `(ach NAME ARG…)`.

    parameters: a `Variable` fits every argument; anything else has no variable in it and fits its own canonical text.
    """

    kind: Literal["ach", "maint"]
    name: str
    parameters: tuple[Argument, ...]
    doc: str
    goal: Goal
    head_span: Span
    span: Span


@dataclass(frozen=True, slots=True)
class Operator:
    """`(defop (NAME ?ARG…) "doc" :do (OUTPUT VALUE) :pre CONDITION :add (FACT…) :del (FACT…))` (L20).

    parameters: names without the question mark. Facts are calls, with variables in them. pre is `true` where the text
    tells none.
    """

    name: str
    parameters: tuple[str, ...]
    doc: str
    output: str
    value: Expression
    precondition: Condition
    adds: tuple[Call, ...]
    deletes: tuple[Call, ...]
    head_span: Span
    span: Span


@dataclass(frozen=True, slots=True)
class TopGoal:
    goal: Goal
    span: Span


@dataclass(frozen=True, slots=True)
class Property:
    """`(defproperty NAME "doc" :always CONDITION :provided CONDITION)`; provided None: in every tick."""

    name: str
    doc: str
    always: Condition
    provided: Condition | None
    span: Span


@dataclass(frozen=True, slots=True)
class Assumption:
    """`(assume CONDITION)`."""

    condition: Condition
    span: Span


@dataclass(frozen=True, slots=True)
class Given:
    """`(PERCEPT VALUE)` of a test: the percept's value from this tick on."""

    percept: Call
    value: Number | Truth
    span: Span


@dataclass(frozen=True, slots=True)
class Expected:
    """`(OUTPUT VALUE)` or `(OUTPUT open)` (value None) of a test."""

    output: str
    value: Expression | None
    span: Span


@dataclass(frozen=True, slots=True)
class Step:
    """`(tick :times N :given (…) :expect (…) :hole true)`: N ticks, in each of which the same is expected."""

    times: int
    given: tuple[Given, ...]
    expected: tuple[Expected, ...]
    hole: bool
    span: Span


@dataclass(frozen=True, slots=True)
class PlanTest:
    """`(deftest NAME "doc" STEP…)`."""

    name: str
    doc: str
    steps: tuple[Step, ...]
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
    operators: tuple[Operator, ...] = ()
    properties: tuple[Property, ...] = ()
    assumptions: tuple[Assumption, ...] = ()
    tests: tuple[PlanTest, ...] = ()
