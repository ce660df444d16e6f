"""What a plan promises: properties of its text, and that what it maintains above all is done when it is asked for.

Takes: `Ways`. Gives: `Promise`s, and for each whether it always holds, with the simplest trace that breaks it where
it does not. Leaves alone: promises over several plans; see differ.py.

A `(maint NAME)` that stands first in a `prio-and` that is never given up offers itself as a promise: in every tick
in which the conditions around its acts hold, its acts are done. Acts of it that it may give up or choose among are
not promised.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from rplan.goals.condition import Condition, print_condition
from rplan.goals.goal import Do, If, PrioAnd, Reduced
from rplan.lang.source import Span
from rplan.ways.guards import TRUE
from rplan.ways.layout import Node
from rplan.ways.reach import Reach
from rplan.ways.reduce import Ways
from rplan.ways.situations import Question, Trace, Undecided

Verdict = Literal["proven", "refuted", "unknown"]


@dataclass(frozen=True, slots=True)
class Promise:
    """broken: what breaks it, any of these in one tick. asked: where it says something at all."""

    name: str
    doc: str
    claim: str
    span: Span
    broken: tuple[Question, ...]
    asked: tuple[Question, ...]


@dataclass(frozen=True, slots=True)
class Proof:
    """trace: breaks it, where it is refuted. vacuous: proven, and what it asks for can never be."""

    promise: Promise
    verdict: Verdict
    trace: Trace = ()
    vacuous: bool = False


def promises(ways: Ways) -> tuple[Promise, ...]:
    """Every promise of a plan: its properties in their order, then what it maintains above all."""
    return (*_properties(ways), *_maintained(ways))


def prove(reach: Reach, promise: Promise) -> Proof:
    """Whether it holds in every tick that can be."""
    ticks = {question: reach.first_tick(*question) for question in promise.broken}
    first = min((tick for tick in ticks.values() if isinstance(tick, int)), default=None)
    if first is not None:
        question = next(one for one, tick in ticks.items() if tick == first)
        trace = reach.trace(*question)
        return Proof(promise, "refuted", trace) if isinstance(trace, tuple) else Proof(promise, "unknown")
    if any(isinstance(tick, Undecided) for tick in ticks.values()):
        return Proof(promise, "unknown")
    return Proof(promise, "proven", vacuous=all(reach.first_tick(*one) is None for one in promise.asked))


def _properties(ways: Ways) -> Iterator[Promise]:
    for one, claim in zip(ways.goals.properties, ways.claims, strict=True):
        words = f"always {print_condition(one.always)}"
        if claim.provided != TRUE:
            words += f", provided {print_condition(one.provided)}"
        broken = ((claim.provided, True), (claim.always, False))
        yield Promise(one.name, one.doc, words, one.span, (broken,), (((claim.provided, True),),))


def _maintained(ways: Ways) -> Iterator[Promise]:
    for node in ways.layout.nodes:
        if isinstance(node.goal, PrioAnd) and node.owner == 0 and not node.under:
            first = ways.layout.nodes[ways.layout.inside[node.number][0]]
            if isinstance(first.goal, Reduced) and first.goal.head.startswith("(maint "):
                yield from _kept(ways, first, first.goal)


def _kept(ways: Ways, top: Node, goal: Reduced) -> Iterator[Promise]:
    words, broken, asked = [], [], []
    for node in ways.layout.nodes:
        if isinstance(node.goal, Do) and node.owner == 0 and not node.under and _inside(ways, node, top):
            path = _path(ways, node)
            conditions = tuple((ways.asked[number], value) for number, value, _ in path)
            is_set = ways.sets[node.goal.output][node.goal.value.text]
            said = " and ".join(_said(condition, value) for _, value, condition in path)
            words.append(f"{node.goal.output} is {node.goal.value.text}" + (f" where {said}" if said else ""))
            broken.append((*conditions, (is_set, False)))
            asked.append(conditions or ((TRUE, True),))
    if broken:
        doc = next((rule.doc for rule in ways.goals.rules if rule.head == goal.head), "")
        yield Promise(goal.head, doc, f"always {', and '.join(words)}", goal.rule_span, tuple(broken), tuple(asked))


def _inside(ways: Ways, node: Node, top: Node) -> bool:
    while node.number > top.number:
        node = ways.layout.nodes[node.parent]
    return node.number == top.number


def _path(ways: Ways, node: Node) -> list[tuple[int, bool, Condition]]:
    """The `if`s around a node, the outermost first: number, branch, condition."""
    found: list[tuple[int, bool, Condition]] = []
    while node.parent >= 0:
        parent = ways.layout.nodes[node.parent]
        if isinstance(parent.goal, If):
            found.append((parent.number, ways.layout.inside[parent.number][0] == node.number, parent.goal.condition))
        node = parent
    return found[::-1]


def _said(condition: Condition, value: bool) -> str:
    return print_condition(condition) if value else f"(not {print_condition(condition)})"
