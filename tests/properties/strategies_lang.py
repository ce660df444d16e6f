"""Random syntax: plans, goals, conditions and values over a few names, well-formed and untyped.

Takes: nothing. Gives: Hypothesis strategies, and `without_places` to compare up to spans. Leaves alone: names and types
(a plan from here may ask for rules that it does not have).
"""

from __future__ import annotations

import dataclasses
from typing import Any

from hypothesis import strategies as st

from rplan.lang.plan import (
    AllOf,
    And,
    AnyOf,
    Anything,
    Call,
    Compare,
    Condition,
    Declaration,
    Do,
    Expression,
    Goal,
    Header,
    If,
    NamedCondition,
    Not,
    Number,
    Or,
    OutputDeclaration,
    Plan,
    PrioAnd,
    Rule,
    Setting,
    Subgoal,
    TopGoal,
    Truth,
    Type,
    Use,
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


def subgoals() -> st.SearchStrategy[Subgoal]:
    return st.builds(Subgoal, st.sampled_from(("ach", "maint")), st.sampled_from(GOALS), _nowhere)


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
    )


def rules() -> st.SearchStrategy[Rule]:
    kind = st.sampled_from(("ach", "maint"))
    return st.builds(Rule, kind, st.sampled_from(GOALS), _docs, goals(), _nowhere, _nowhere)


def plans() -> st.SearchStrategy[Plan]:
    """Whole plans with every span NOWHERE; `parse` takes their printed text."""
    period = st.floats(0.001, 10.0)
    named = st.builds(NamedCondition, st.sampled_from(PERCEPTS), _docs, conditions(), _nowhere)
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
