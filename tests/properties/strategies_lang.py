"""Random syntax: plans, goals, conditions and values over a few names, well-formed and untyped.

Takes: nothing. Gives: Hypothesis strategies, and `without_places` to compare up to spans. Leaves alone: names and types
(a plan from here may ask for rules that it does not have).
"""

from __future__ import annotations

import dataclasses
from typing import Any

from hypothesis import strategies as st

from rplan.lang.plan import (
    Achieve,
    AllOf,
    And,
    AnyOf,
    Anything,
    Argument,
    Arithmetic,
    Assumption,
    Call,
    Compare,
    Condition,
    Declaration,
    Do,
    Expected,
    Expression,
    Given,
    Goal,
    Header,
    If,
    NamedCondition,
    Not,
    Number,
    Operator,
    Or,
    OutputDeclaration,
    OutputIs,
    Plan,
    PlanTest,
    PrioAnd,
    Property,
    Rule,
    Setting,
    Step,
    Subgoal,
    TopGoal,
    Truth,
    Type,
    Use,
    Variable,
)
from rplan.lang.printer import print_plan
from rplan.lang.source import NOWHERE
from rplan.lang.units import SI_UNITS

PERCEPTS = ("bumped", "at-goal?", "lost", "the-way&back")
VALUES = ("stop", "go-on", "home", "a")
OUTPUTS = ("action", "goal", "rpt-failure?")
GOALS = ("move", "fetch-widget&go-home", "search")

_nowhere = st.just(NOWHERE)
_docs = st.text(alphabet='ab \n"\\();|#?é', max_size=8)


def _name(node: Any) -> str:
    return str(node.name)


def without_places(node: Any) -> Any:
    """The same syntax with every span made NOWHERE."""
    if isinstance(node, tuple):
        return tuple(without_places(part) for part in node)
    if not dataclasses.is_dataclass(node) or isinstance(node, type):
        return node
    changed = {
        field.name: NOWHERE if field.name in ("span", "head_span") else without_places(getattr(node, field.name))
        for field in dataclasses.fields(node)
    }
    return dataclasses.replace(node, **changed)


def numbers() -> st.SearchStrategy[Number]:
    finite = st.one_of(st.integers(-100, 100).map(float), st.floats(allow_nan=False, allow_infinity=False))
    return st.builds(Number, finite.map(lambda value: value + 0.0), st.sampled_from(("", *SI_UNITS)), _nowhere)


def truths() -> st.SearchStrategy[Truth]:
    return st.builds(Truth, st.booleans(), _nowhere)


def calls(names: tuple[str, ...] = VALUES) -> st.SearchStrategy[Call]:
    """Calls whose arguments are numbers, truths and calls in turn, mostly none."""
    heads = st.sampled_from(names)
    bare = st.builds(Call, heads, st.just(()), _nowhere)
    arguments: st.SearchStrategy[Expression] = st.recursive(
        st.one_of(bare, numbers(), truths()),
        lambda inner: st.builds(Call, heads, st.lists(inner, max_size=2).map(tuple), _nowhere),
        max_leaves=3,
    )
    return st.one_of(bare, st.builds(Call, heads, st.lists(arguments, max_size=2).map(tuple), _nowhere))


def values() -> st.SearchStrategy[Expression]:
    return st.one_of(calls(), numbers(), truths())


def _compares() -> st.SearchStrategy[Compare]:
    operand = st.one_of(numbers(), calls(PERCEPTS))
    return st.builds(Compare, st.sampled_from(("<", "<=", ">", ">=", "=", "/=")), operand, operand, _nowhere)


def conditions(max_leaves: int = 5) -> st.SearchStrategy[Condition]:
    def deeper(inner: st.SearchStrategy[Condition]) -> st.SearchStrategy[Condition]:
        members = st.lists(inner, min_size=1, max_size=3).map(tuple)
        return st.one_of(
            st.builds(Not, inner, _nowhere), st.builds(AllOf, members, _nowhere), st.builds(AnyOf, members, _nowhere)
        )

    return st.recursive(st.one_of(calls(PERCEPTS), truths(), _compares()), deeper, max_leaves=max_leaves)


def _arguments() -> st.SearchStrategy[tuple[Argument, ...]]:
    one: st.SearchStrategy[Argument] = st.one_of(values(), conditions(2), arithmetic())
    return st.one_of(st.just(()), st.lists(one, max_size=2).map(tuple))


def arithmetic() -> st.SearchStrategy[Arithmetic]:
    operands = st.lists(st.one_of(numbers(), calls(PERCEPTS)), min_size=1, max_size=2).map(tuple)
    return st.builds(Arithmetic, st.sampled_from(("+", "-", "*", "min", "max")), operands, _nowhere)


def subgoals() -> st.SearchStrategy[Subgoal | Achieve]:
    kinds, names = st.sampled_from(("ach", "maint")), st.sampled_from(GOALS)
    asked = st.builds(Achieve, st.builds(Not, calls(PERCEPTS), _nowhere), _nowhere, st.one_of(st.none(), _few))
    deep = st.builds(Subgoal, st.just("ach"), names, _arguments(), _nowhere, _few)
    return st.one_of(st.builds(Subgoal, kinds, names, _arguments(), _nowhere), deep, asked)


_few = st.integers(1, 9)


def goals(max_leaves: int = 6) -> st.SearchStrategy[Goal]:
    def deeper(inner: st.SearchStrategy[Goal]) -> st.SearchStrategy[Goal]:
        members = st.lists(inner, min_size=1, max_size=3).map(tuple)
        return st.one_of(
            st.builds(If, conditions(3), inner, inner, _nowhere),
            *[st.builds(joint, members, _nowhere) for joint in (And, Or, PrioAnd)],
        )

    does = st.builds(Do, st.sampled_from(OUTPUTS), values(), _nowhere)
    return st.recursive(st.one_of(does, subgoals(), st.builds(Anything, _nowhere)), deeper, max_leaves=max_leaves)


def types() -> st.SearchStrategy[Type]:
    plain = st.sampled_from(("bool", "number", "pose", "command", "symbol")).map(Type)
    return st.one_of(plain, st.sampled_from(SI_UNITS).map(lambda unit: Type("number", unit)))


def _uses() -> st.SearchStrategy[Use]:
    settings = st.lists(st.builds(Setting, st.sampled_from(VALUES), values(), _nowhere), max_size=3, unique_by=_name)
    return st.builds(Use, st.sampled_from(("lib", "natigation")), settings.map(tuple), _nowhere)


def _declarations() -> st.SearchStrategy[Declaration]:
    parameters = st.lists(st.tuples(st.sampled_from(VALUES), types()), max_size=2, unique_by=lambda pair: pair[0])
    return st.builds(Declaration, st.sampled_from(PERCEPTS), parameters.map(tuple), types(), _docs, _nowhere)


def _outputs() -> st.SearchStrategy[OutputDeclaration]:
    name = st.sampled_from(OUTPUTS)
    none, maybe = st.none(), st.one_of(st.none(), values())
    return st.one_of(
        st.builds(OutputDeclaration, name, types(), maybe, st.just(False), none, _nowhere),
        st.builds(OutputDeclaration, name, types(), none, st.just(True), maybe, _nowhere),
        st.builds(OutputDeclaration, name, types(), none, st.just(False), none, _nowhere, st.just(True)),
    )


def rules() -> st.SearchStrategy[Rule]:
    kind = st.sampled_from(("ach", "maint"))
    return st.one_of(
        st.builds(Rule, kind, st.sampled_from(GOALS), _arguments(), _docs, goals(), _nowhere, _nowhere),
        st.builds(Rule, kind, st.sampled_from(GOALS), st.just((X,)), _docs, st.just(OF_X), _nowhere, _nowhere),
    )


X = Variable("x", NOWHERE)
OF_X = If(
    AllOf((X, Call("near", (X,), NOWHERE), Compare("<", X, Number(2.0, "m", NOWHERE), NOWHERE)), NOWHERE),
    Do("goal", X, NOWHERE),
    Subgoal("ach", "search", (X, Call("a", (X,), NOWHERE)), NOWHERE),
    NOWHERE,
)


def _operators() -> st.SearchStrategy[Operator]:
    facts = st.lists(calls(PERCEPTS), max_size=2).map(tuple)
    moves = st.just(Call("go-on", (X,), NOWHERE))
    return st.builds(
        Operator, st.sampled_from(VALUES), st.just(("x",)), _docs, st.sampled_from(OUTPUTS), moves, conditions(2),
        facts, facts, _nowhere, _nowhere,
    )  # fmt: skip


def _properties() -> st.SearchStrategy[Property]:
    asked = st.builds(OutputIs, st.sampled_from(OUTPUTS), st.one_of(st.none(), values()), _nowhere)
    claims = st.one_of(conditions(2), asked, st.builds(Not, asked, _nowhere))
    return st.builds(Property, st.sampled_from(VALUES), _docs, claims, st.one_of(st.none(), claims), _nowhere)


def _tests() -> st.SearchStrategy[PlanTest]:
    given = st.builds(Given, calls(PERCEPTS), st.one_of(numbers(), truths()), _nowhere)
    value = st.one_of(st.none(), values())
    expected = st.builds(Expected, st.sampled_from(OUTPUTS), value, _nowhere)
    step = st.builds(
        Step, _few, st.lists(given, max_size=2).map(tuple), st.lists(expected, max_size=2).map(tuple), st.booleans(),
        _nowhere,
    )  # fmt: skip
    steps = st.lists(step, min_size=1, max_size=2).map(tuple)
    return st.builds(PlanTest, st.sampled_from(VALUES), _docs, steps, _nowhere)


def plans() -> st.SearchStrategy[Plan]:
    """Whole plans with every span NOWHERE; `parse` takes their printed text."""
    period = st.floats(0.001, 10.0)
    general = AllOf((X, Not(Call("bumped", (X,), NOWHERE), NOWHERE)), NOWHERE)
    named = st.one_of(
        st.builds(NamedCondition, st.sampled_from(PERCEPTS), st.just(()), _docs, conditions(), _nowhere),
        st.builds(NamedCondition, st.sampled_from(PERCEPTS), st.just(("x",)), _docs, st.just(general), _nowhere),
    )
    return st.builds(
        Plan,
        st.builds(Header, st.sampled_from(("patrol", "fetch")), _docs, period, _nowhere),
        st.lists(_uses(), max_size=2, unique_by=lambda use: use.library).map(tuple),
        st.lists(_declarations(), max_size=2, unique_by=_name).map(tuple),
        st.lists(_outputs(), max_size=3, unique_by=_name).map(tuple),
        st.lists(named, max_size=2, unique_by=_name).map(tuple),
        st.lists(rules(), max_size=3).map(tuple),
        st.one_of(st.none(), st.builds(TopGoal, goals(), _nowhere)),
        _nowhere,
        st.lists(_operators(), max_size=1).map(tuple),
        st.lists(_properties(), max_size=1).map(tuple),
        st.lists(st.builds(Assumption, conditions(2), _nowhere), max_size=1).map(tuple),
        st.lists(_tests(), max_size=1).map(tuple),
    )


def plan_texts() -> st.SearchStrategy[str]:
    """Texts of well-formed plans, laid out, one form of the top level after the other."""
    return plans().map(print_plan)


_PLAN_TEXTS = plan_texts()


@st.composite
def mutated_texts(draw: st.DrawFn) -> str:
    """Texts of plans with a few slips: something cut out, put in, or doubled."""
    text = draw(_PLAN_TEXTS)
    for _ in range(draw(st.integers(1, 4))):
        start = draw(st.integers(0, len(text)))
        end = min(len(text), start + draw(st.integers(0, 6)))
        slip = draw(
            st.sampled_from(("", "(", ")", '"', "#|", "|#", ";", "?x", ":k", " 3x ", "\\", "\n", " else ", "\x07"))
        )
        text = text[:start] + slip + draw(st.sampled_from(("", text[start:end]))) * 2 + text[end:]
    return text
