"""Goals regressed over operators (L20).

Takes: a condition to achieve, the operators of a plan, the symbols that variables range over. Gives: clauses, nearest
layer first: where the condition of a clause holds and none before it does, its act comes one step nearer. Leaves alone:
rules, which beat operators, and situations that no clause covers: those are holes.

Layer 0 is the condition itself. Layer k+1 is where some operator's precondition holds and leads into layer k: the
condition of layer k with what the operator adds made true, what it deletes made false, and the rest as it is. Since a
clause counts only where no earlier one does, "layer k" may be read as "layer k or an earlier one".

Conditions are kept as sets of cubes, so that a layer that adds nothing is seen at once.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

from rplan.goals.scope import Findings
from rplan.goals.substitute import Substitution
from rplan.lang import plan as p
from rplan.lang.printer import canonical
from rplan.lang.source import Span

MOST_CUBES = 4_096
MOST_INSTANCES = 10_000

Cube = frozenset[tuple[str, bool]]
"""Canonical text of a condition without `not`, `and` and `or` -> whether it must hold."""
Cubes = tuple[Cube, ...]


class RegressionError(Exception):
    """The goal cannot be regressed; the message says why."""


@dataclass(frozen=True, slots=True)
class Clause:
    """Where `condition` holds and no earlier clause does, `act` is to be done; None: nothing, the goal is achieved."""

    condition: p.Condition
    act: p.Do | None


@dataclass(frozen=True, slots=True)
class _Instance:
    """An operator with symbols in the place of its variables."""

    act: p.Do
    precondition: Cubes
    effects: Mapping[str, bool]


def regress(
    condition: p.Condition, operators: Sequence[p.Operator], symbols: Sequence[str], depth: int, span: Span
) -> tuple[Clause, ...]:
    """The clauses to achieve a condition, down to a fixed point or to `depth` layers. Raises RegressionError."""
    atoms: dict[str, p.Condition] = {}
    reached = _cubes(condition, True, atoms)
    instances = [instance for operator in operators for instance in _instances(operator, symbols, atoms)]
    _without_memory(atoms, instances)
    clauses = [Clause(_condition(reached, atoms, span), None)]
    for _ in range(depth):
        layer = reached
        for instance in instances:
            before = _absorbed(_joined(instance.precondition, _through(reached, instance.effects)))
            new = [cube for cube in before if not _covered(cube, layer)]
            if new:
                clauses.append(Clause(_condition(tuple(new), atoms, instance.act.span), instance.act))
                layer = _absorbed((*layer, *new))
        if layer == reached:
            break
        reached = layer
    return tuple(clauses)


def _instances(operator: p.Operator, symbols: Sequence[str], atoms: dict[str, p.Condition]) -> Iterator[_Instance]:
    """The operator for every choice of symbols, in the order in which the plan names them."""
    if len(symbols) ** len(operator.parameters) > MOST_INSTANCES:
        raise RegressionError(f"the operator `{operator.name}` has more than {MOST_INSTANCES:,} instances")
    for chosen in product(symbols, repeat=len(operator.parameters)):
        bound: dict[str, p.Argument] = {
            name: p.Call(symbol, (), operator.head_span)
            for name, symbol in zip(operator.parameters, chosen, strict=True)
        }
        put = Substitution(bound, Findings())
        yield _Instance(
            p.Do(operator.output, put.value(operator.value), operator.span),
            _cubes(put.condition(operator.precondition), True, atoms),
            {canonical(put.call(fact)): False for fact in operator.deletes}
            | {canonical(put.call(fact)): True for fact in operator.adds},
        )


def _without_memory(atoms: Mapping[str, p.Condition], instances: Sequence[_Instance]) -> None:
    """What asks the past of a fact that operators change cannot be regressed: facts are percepts without memory."""
    changed = {fact for instance in instances for fact in instance.effects}
    for text, atom in atoms.items():
        if isinstance(atom, p.Memory) and any(fact in text for fact in changed):
            raise RegressionError(f"`{text}` asks the past of a fact that an operator changes")


# --- cubes ------------------------------------------------------------------------------------------


def _cubes(condition: p.Condition, wanted: bool, atoms: dict[str, p.Condition]) -> Cubes:
    """The condition, or its negation, as cubes; what stands in them is put into `atoms`."""
    match condition:
        case p.Truth(value):
            return (frozenset(),) if value == wanted else ()
        case p.Not(inner):
            return _cubes(inner, not wanted, atoms)
        case p.AllOf(parts) | p.AnyOf(parts):
            inside = [_cubes(part, wanted, atoms) for part in parts]
            if isinstance(condition, p.AnyOf) == wanted:
                return _absorbed(tuple(cube for cubes in inside for cube in cubes))
            joined: Cubes = (frozenset(),)
            for cubes in inside:
                joined = _joined(joined, cubes)
            return joined
        case _:
            text = canonical(condition)
            atoms.setdefault(text, condition)
            return (frozenset([(text, wanted)]),)


def _joined(a: Cubes, b: Cubes) -> Cubes:
    """Both at once."""
    if len(a) * len(b) > MOST_CUBES * 8:
        raise RegressionError("the conditions that lead to it are too many")
    return _absorbed(tuple(x | y for x in a for y in b if not any((text, not value) in y for text, value in x)))


def _absorbed(cubes: Cubes) -> Cubes:
    """Without those that another one covers; those that say least first, else in their order."""
    kept: list[Cube] = []
    for cube in sorted(dict.fromkeys(cubes), key=len):
        if not _covered(cube, kept):
            kept.append(cube)
    if len(kept) > MOST_CUBES:
        raise RegressionError("the conditions that lead to it are too many")
    return tuple(kept)


def _covered(cube: Cube, cubes: Sequence[Cube]) -> bool:
    return any(other <= cube for other in cubes)


def _through(cubes: Cubes, effects: Mapping[str, bool]) -> Cubes:
    """Where the cubes hold once the effects have come about."""
    return tuple(
        frozenset((text, value) for text, value in cube if text not in effects)
        for cube in cubes
        if all(effects.get(text, value) == value for text, value in cube)
    )


def _condition(cubes: Cubes, atoms: Mapping[str, p.Condition], span: Span) -> p.Condition:
    order = {text: number for number, text in enumerate(atoms)}
    parts = [_conjunction(sorted(cube, key=lambda literal: order[literal[0]]), atoms, span) for cube in cubes]
    match parts:
        case []:
            return p.Truth(False, span)
        case [only]:
            return only
        case _:
            return p.AnyOf(tuple(parts), span)


def _conjunction(literals: Sequence[tuple[str, bool]], atoms: Mapping[str, p.Condition], span: Span) -> p.Condition:
    parts = [atoms[text] if value else p.Not(atoms[text], span) for text, value in literals]
    match parts:
        case []:
            return p.Truth(True, span)
        case [only]:
            return only
        case _:
            return p.AllOf(tuple(parts), span)
