"""`Goals`: the reduced goal of a plan, every name resolved, every type right.

Takes: nothing. Gives: the closed union `Goal` after all rules have been put in place, and what stands around it.
Leaves alone: which way is taken; see rplan/ways.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from rplan.goals.condition import Condition, Term, percept_terms, print_condition
from rplan.goals.condition import atoms as atoms_of
from rplan.goals.signature import FunctionSignature
from rplan.lang.plan import Type
from rplan.lang.source import Span


@dataclass(frozen=True, slots=True)
class Do:
    """Set `output` to `value` this tick; rule is the head of the rule that says so."""

    output: str
    value: Term
    rule: str
    span: Span


@dataclass(frozen=True, slots=True)
class Anything:
    """Set nothing."""

    rule: str
    span: Span


@dataclass(frozen=True, slots=True)
class Impossible:
    """No way at all: where operators do not lead to a goal (L20)."""

    span: Span


@dataclass(frozen=True, slots=True)
class If:
    condition: Condition
    then: Goal
    otherwise: Goal
    rule: str
    span: Span
    generated: bool = False
    """No text asks for it: it comes from operators."""


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
class Reduced:
    """A subgoal with the body of its rule put in its place; span is the subgoal's, rule_span the rule's.

    head: canonical text of the subgoal with its arguments.
    """

    head: str
    goal: Goal
    span: Span
    rule_span: Span


Goal = Do | Anything | Impossible | If | And | Or | PrioAnd | Reduced


@dataclass(frozen=True, slots=True)
class Output:
    """An output channel. idle stands where a tick leaves it open; hold keeps the last value, at first `initial`.

    required: leaving it open is an error.
    """

    name: str
    type: Type | None
    idle: Term | None
    hold: bool
    initial: Term | None
    span: Span
    required: bool = False


@dataclass(frozen=True, slots=True)
class RuleInfo:
    """A rule of the text, for those who show it; head with variables as the text has them."""

    head: str
    doc: str
    span: Span


@dataclass(frozen=True, slots=True)
class BoundLibrary:
    """A library in use with every parameter's value (numbers in SI)."""

    name: str
    settings: Mapping[str, float | bool | str]
    span: Span


@dataclass(frozen=True, slots=True)
class Property:
    """`always` must hold in every tick in which `provided` holds; both may ask `OutputIs` and the past."""

    name: str
    doc: str
    always: Condition
    provided: Condition
    span: Span


@dataclass(frozen=True, slots=True)
class Assumption:
    """What may be taken for granted of the percepts in every tick."""

    condition: Condition
    span: Span


@dataclass(frozen=True, slots=True)
class TrialStep:
    """So many ticks with the same percepts, in each of which the same is expected.

    given: canonical text of a percept -> its value (numbers in SI) from here on. expected: output -> canonical text of
    its value, None where the way must leave it open; outputs that are not named may be anything. hole: whether the tick
    must be a hole.
    """

    times: int
    given: tuple[tuple[str, bool | float], ...]
    expected: tuple[tuple[str, str | None], ...]
    hole: bool
    span: Span


@dataclass(frozen=True, slots=True)
class Trial:
    """A test of the plan alone; percepts that no step has given yet are false or 0."""

    name: str
    doc: str
    steps: tuple[TrialStep, ...]
    span: Span


@dataclass(frozen=True, slots=True)
class Goals:
    """A checked plan. outputs in the order in which channels are filled (L25); functions: every name that is known.

    definitions: what the named conditions stand for that ask their own past.
    """

    name: str
    doc: str
    period: float
    top: Goal
    outputs: tuple[Output, ...]
    rules: tuple[RuleInfo, ...]
    libraries: tuple[BoundLibrary, ...]
    functions: Mapping[str, FunctionSignature]
    span: Span
    definitions: Mapping[str, Condition] = field(default_factory=dict)
    properties: tuple[Property, ...] = ()
    assumptions: tuple[Assumption, ...] = ()
    tests: tuple[Trial, ...] = ()

    def driving(self) -> Iterator[Condition]:
        """The conditions that are asked where the plan drives."""
        yield from conditions(self.top)
        yield from self.definitions.values()

    def conditions(self) -> Iterator[Condition]:
        """Every condition that is asked, those that drive first."""
        yield from self.driving()
        for one in self.properties:
            yield from (one.always, one.provided)
        yield from (one.condition for one in self.assumptions)

    def percepts(self, *, driving: bool = False) -> tuple[Term, ...]:
        """The functions that stand in conditions, once each, in textual order of the reduced goal.

        driving: only those that the plan reads where it drives, not what properties alone ask.
        """
        seen: dict[str, Term] = {}
        for condition in self.driving() if driving else self.conditions():
            for atom in atoms_of(condition):
                for term in percept_terms(atom):
                    seen.setdefault(term.text, term)
        return tuple(seen.values())


def children(goal: Goal) -> tuple[Goal, ...]:
    """The goals directly inside a goal, in textual order."""
    match goal:
        case Do() | Anything() | Impossible():
            return ()
        case If(then=then, otherwise=otherwise):
            return (then, otherwise)
        case And(goals) | Or(goals) | PrioAnd(goals):
            return goals
        case Reduced(goal=inner):
            return (inner,)


def walk(goal: Goal) -> Iterator[Goal]:
    """The goal and all inside it, in textual order."""
    stack = [goal]
    while stack:
        here = stack.pop()
        yield here
        stack.extend(reversed(children(here)))


def conditions(goal: Goal) -> Iterator[Condition]:
    """Every condition of the goal in textual order."""
    return (node.condition for node in walk(goal) if isinstance(node, If))


def print_goal(goal: Goal) -> str:
    """The reduced goal as an S-expression, with `(rule HEAD …)` where a rule was put in place."""
    match goal:
        case Do(output=output, value=value):
            return f"(do {output} {value.text})"
        case Anything():
            return "(do anything)"
        case Impossible():
            return "(or)"
        case If(condition=condition, then=then, otherwise=otherwise):
            return f"(if {print_condition(condition)} {print_goal(then)} {print_goal(otherwise)})"
        case And(goals):
            return f"(and {' '.join(map(print_goal, goals))})"
        case Or(goals):
            return f"(or {' '.join(map(print_goal, goals))})"
        case PrioAnd(goals):
            return f"(prio-and {' '.join(map(print_goal, goals))})"
        case Reduced(head=head, goal=inner):
            return f"(rule {head} {print_goal(inner)})"
