"""What there is to see in a plan before it runs: decision table, goal tree, circuit, percepts of each rule.

Takes: a compiled plan. Gives: `Inspection`, plain values that text, SVG and page are made of. Leaves alone: how they
look (inspect_text.py, inspect_svg.py, inspect_page.py).

The table is read off the tree of tests that the outputs of the circuit make (rplan/circuit/decisions.py): its rows
exclude each other and leave nothing out. Where that tree gets too large to be read, rows are the places of the goal
that set something, in the order of the text, each with the conditions on the way to it; what stands above goes first.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

from rplan.apps.drawing.inspect_words import register_words
from rplan.circuit.build import HOLE
from rplan.circuit.cell import Op
from rplan.circuit.circuit import Circuit
from rplan.circuit.decisions import Leaf, Tree, decisions
from rplan.circuit.passes.merge import Variable
from rplan.circuit.stats import Stats, stats
from rplan.driver import Compiled
from rplan.goals.condition import AllOf, AnyOf, Condition, Memory, Not, percept_terms, print_condition
from rplan.goals.condition import atoms as atoms_of
from rplan.goals.goal import And, Anything, Do, Goal, If, Impossible, Or, PrioAnd, Reduced, walk
from rplan.lang.source import Span
from rplan.ways.guards import FALSE
from rplan.ways.way import TakenWay, taken_way

MOST_ROWS, MOST_CONDITIONS = 200, 64
"""Of a table that can be read whose rows exclude each other."""
MERGED = 24
"""Rows of no more conditions than these are put together where they differ in one alone."""

Cube = tuple[tuple[str, bool], ...]
"""Conditions with the value that each must have, in the order in which they are asked."""


@dataclass(frozen=True, slots=True)
class Row:
    """Where `when` holds the outputs are set so. rules: who sets them; given_up: which goals are given up for it."""

    when: Cube
    sets: tuple[str, ...]
    hole: bool
    rules: tuple[str, ...]
    given_up: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Table:
    """conditions: those that some row asks, in the order of the plan.

    exclusive: in every situation one row holds; otherwise several may, and a row gives way to those above it with which
    it does not go together.
    """

    conditions: tuple[str, ...]
    rows: tuple[Row, ...]
    exclusive: bool


@dataclass(frozen=True, slots=True)
class Branch:
    """A place of the goal tree. says: what stands there; under: "", "then" or "else" of the `if` above, or its rank.

    line: in the plan's own text, None in an included one.
    """

    kind: Literal["rule", "do", "anything", "impossible", "if", "and", "or", "prio-and"]
    says: str
    under: str
    place: str
    line: int | None
    inside: tuple[Branch, ...]


@dataclass(frozen=True, slots=True)
class Reads:
    """What a rule asks in its own conditions, not in those of its subgoals; memory: those that ask the past.

    place: of the rule, "" of the top goal; line: as in `Branch`.
    """

    rule: str
    percepts: tuple[str, ...]
    memory: tuple[str, ...]
    line: int | None
    place: str


@dataclass(frozen=True, slots=True)
class Inspection:
    """A plan, laid open. period [s]."""

    name: str
    doc: str
    text: str
    period: float
    table: Table
    goals: Branch
    circuit: Circuit
    stats: Stats
    percepts: tuple[Reads, ...]


def inspect(compiled: Compiled) -> Inspection:
    """Everything that is to be shown of a plan."""
    file = compiled.source.name
    return Inspection(
        name=compiled.goals.name,
        doc=compiled.goals.doc,
        text=compiled.source.text,
        period=compiled.goals.period,
        table=table(compiled),
        goals=_branch(compiled.goals.top, "", file),
        circuit=compiled.circuit,
        stats=stats(compiled.circuit),
        percepts=tuple(_reads(compiled)),
    )


# --- the decision table ----------------------------------------------------------------------------


def table(compiled: Compiled) -> Table:
    """Which outputs are set where."""
    tree = decisions(compiled.circuit)
    names = _names(compiled.circuit)
    if tree is None or len(names) > MOST_CONDITIONS or _leaves(tree, {}) > MOST_ROWS:
        return _ranked(compiled)
    cubes = [(tuple((names[v], value) for v, value in path), leaf) for path, leaf in _paths(tree, ())]
    asked = {name for cube, _ in cubes for name, _ in cube}
    conditions = tuple(name for name in dict.fromkeys(names.values()) if name in asked)
    if len(conditions) <= MERGED:
        cubes = _merged(cubes)
    rows = [_row(compiled, cube, leaf) for cube, leaf in cubes]
    return Table(conditions, tuple(sorted(rows, key=lambda row: row.hole)), True)


def _leaves(tree: Tree, known: dict[int, int]) -> int:
    if isinstance(tree, Leaf):
        return 1
    if id(tree) not in known:
        known[id(tree)] = _leaves(tree.high, known) + _leaves(tree.low, known)
    return known[id(tree)]


def _names(circuit: Circuit) -> dict[Variable, str]:
    inputs: dict[Variable, str] = {(Op.INPUT, n): port.name for n, port in enumerate(circuit.inputs)}
    return inputs | {
        (Op.REGISTER, n): f"register {register_words(one.name)}" for n, one in enumerate(circuit.registers)
    }


def _paths(
    tree: Tree, before: tuple[tuple[Variable, bool], ...]
) -> Iterator[tuple[tuple[tuple[Variable, bool], ...], Leaf]]:
    if isinstance(tree, Leaf):
        yield before, tree
        return
    yield from _paths(tree.high, (*before, (tree.variable, True)))
    yield from _paths(tree.low, (*before, (tree.variable, False)))


def _merged(cubes: Sequence[tuple[Cube, Leaf]]) -> list[tuple[Cube, Leaf]]:
    """Two rows that set the same and differ in the value of one condition become one, as long as there are such."""
    left = list(cubes)
    while True:
        found = next(
            (
                (i, j, one)
                for i in range(len(left))
                for j in range(i + 1, len(left))
                if left[i][1].outputs == left[j][1].outputs and (one := _differ(left[i][0], left[j][0])) is not None
            ),
            None,
        )
        if found is None:
            return left
        i, j, name = found
        left[i] = tuple(literal for literal in left[i][0] if literal[0] != name), left[i][1]
        del left[j]


def _differ(a: Cube, b: Cube) -> str | None:
    """The one condition in whose value they differ; None where there is more or none."""
    if len(a) != len(b):
        return None
    other = dict(b)
    apart = [name for name, value in a if other.get(name) is not value]
    return apart[0] if len(apart) == 1 and apart[0] in other else None


def _row(compiled: Compiled, cube: Cube, leaf: Leaf) -> Row:
    ports = [port.name for port, _ in compiled.circuit.outputs]
    when = dict(cube)
    inputs = [when.get(port.name, False) for port in compiled.circuit.inputs]
    registers = [when.get(f"register {register_words(one.name)}", False) for one in compiled.circuit.registers]
    way = taken_way(compiled.ways, inputs, registers)
    sets = tuple(name for name, bit in zip(ports, leaf.outputs, strict=True) if bit and name != HOLE)
    return Row(cube, sets, leaf.outputs[ports.index(HOLE)], *_by(way))


def _by(way: TakenWay) -> tuple[tuple[str, ...], tuple[str, ...]]:
    return tuple(dict.fromkeys(act.rule for act in way.acts)), tuple(given.member for given in way.given_up)


def _ranked(compiled: Compiled) -> Table:
    """A row for every place of the goal that sets something and can be served, with the conditions on the way to it."""
    ways = compiled.ways
    rows: dict[tuple[Cube, int], list[Do]] = {}
    for node in ways.layout.nodes:
        if isinstance(node.goal, Do) and ways.reached[node.number] != FALSE:
            above = node.number if node.parent < 0 else node.parent
            rows.setdefault((_way_to(compiled, node.number), above), []).append(node.goal)
    made = tuple(_ranked_row(cube, dos) for (cube, _), dos in rows.items())
    conditions = tuple(dict.fromkeys(name for row in made for name, _ in row.when))
    return Table(conditions, made, False)


def _ranked_row(cube: Cube, dos: Sequence[Do]) -> Row:
    sets = tuple(f"{do.output}={do.value.text}" for do in dos)
    return Row(cube, sets, False, tuple(dict.fromkeys(do.rule for do in dos if do.rule)), ())


def _way_to(compiled: Compiled, number: int) -> Cube:
    """The conditions above a place of the goal, outermost first."""
    layout, found = compiled.ways.layout, list[tuple[str, bool]]()
    here = layout.nodes[number]
    while here.parent >= 0:
        above = layout.nodes[here.parent]
        if isinstance(above.goal, If):
            first = layout.inside[above.number][0] == here.number
            found.append((print_condition(above.goal.condition), first))
        here = above
    return tuple(dict.fromkeys(reversed(found)))


# --- the goal tree ---------------------------------------------------------------------------------


def _branch(goal: Goal, under: str, file: str) -> Branch:
    def made(kind: Kind, says: str, span: Span, *inside: Branch) -> Branch:
        return Branch(kind, says, under, str(span), span.line if span.file == file else None, inside)

    match goal:
        case Do(output=output, value=value, span=span):
            return made("do", f"{output} := {value.text}", span)
        case Anything(span=span):
            return made("anything", "anything", span)
        case Impossible(span=span):
            return made("impossible", "no way", span)
        case If(condition=condition, then=then, otherwise=otherwise, span=span):
            branches = _branch(then, "then", file), _branch(otherwise, "else", file)
            return made("if", print_condition(condition), span, *branches)
        case And(goals, span):
            return made("and", "all of", span, *(_branch(one, "", file) for one in goals))
        case Or(goals, span):
            return made("or", "one of", span, *(_branch(one, "", file) for one in goals))
        case PrioAnd(goals, span):
            ranked = (_branch(one, str(rank), file) for rank, one in enumerate(goals, start=1))
            return made("prio-and", "by priority", span, *ranked)
        case Reduced(head=head, goal=inner, span=span):
            return made("rule", head, span, _branch(inner, "", file))


Kind = Literal["rule", "do", "anything", "impossible", "if", "and", "or", "prio-and"]


# --- percepts --------------------------------------------------------------------------------------


def _reads(compiled: Compiled) -> Iterator[Reads]:
    """For each rule that is used, and last for the top goal, what it asks."""
    asked: dict[str, list[Condition]] = {}
    lines: dict[str, int | None] = {}
    places: dict[str, str] = {}
    for goal in walk(compiled.goals.top):
        if isinstance(goal, Reduced):
            asked.setdefault(goal.head, [])
            here = goal.rule_span.file == compiled.source.name
            lines.setdefault(goal.head, goal.rule_span.line if here else None)
            places.setdefault(goal.head, str(goal.rule_span))
        elif isinstance(goal, If):
            asked.setdefault(goal.rule or TOP, []).append(goal.condition)
    for rule, conditions in asked.items():
        terms = [term.text for c in conditions for atom in atoms_of(c) for term in percept_terms(atom)]
        memory = [one.text for c in conditions for one in _memories(c)]
        percepts, past = tuple(dict.fromkeys(terms)), tuple(dict.fromkeys(memory))
        yield Reads(rule, percepts, past, lines.get(rule), places.get(rule, ""))


TOP = "the top goal"


def _memories(condition: Condition) -> Iterator[Memory]:
    match condition:
        case Memory(conditions=parts):
            yield condition
        case AllOf(parts) | AnyOf(parts):
            pass
        case Not(inner):
            parts = (inner,)
        case _:
            return
    for part in parts:
        yield from _memories(part)
