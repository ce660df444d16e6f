"""Percepts that are named in conditions and never read.

Takes: a `Reach`. Gives: notes. Leaves alone: what is declared and named nowhere; see rplan/goals/scope.py.
"""

from __future__ import annotations

from collections.abc import Iterator

from rplan.goals.condition import Condition, Term, percept_terms
from rplan.goals.condition import atoms as atoms_of
from rplan.goals.goal import If
from rplan.lang.diagnostic import Diagnostic
from rplan.ways.reach import Reach


def check_percepts(reach: Reach) -> Iterator[Diagnostic]:
    """Percepts whose every question stands where no situation comes."""
    ways = reach.ways
    read: dict[str, None] = {}
    asked = [node for node in ways.layout.nodes if isinstance(node.goal, If)]
    elsewhere = [*ways.goals.definitions.values(), *(one.condition for one in ways.goals.assumptions)]
    elsewhere += [one for each in ways.goals.properties for one in (each.always, each.provided)]
    for condition in elsewhere:
        read |= dict.fromkeys(term.text for term in _terms(condition))
    for node in asked:
        assert isinstance(node.goal, If)
        new = [term.text for term in _terms(node.goal.condition) if term.text not in read]
        if new and reach.possible((ways.reached[node.number], True)) is not False:
            read |= dict.fromkeys(new)
    for term in ways.goals.percepts():
        if term.text not in read:
            yield Diagnostic("never-read", "note", f"`{term.text}` is never asked in any situation", term.span)


def _terms(condition: Condition) -> Iterator[Term]:
    return (term for atom in atoms_of(condition) for term in percept_terms(atom))
