"""The outputs of a circuit as a tree of tests.

Takes: a circuit. Gives: `Tree`: which input or register to ask next, at the ends the outputs; None where that gets too
large. Leaves alone: registers, whose next values are no decision; see rplan/backends/python.py.

Outputs become reduced ordered decision diagrams (Bryant 1986) over inputs and registers, and the tree asks along all of
them together, so no path asks twice. Three orders are tried: that of the plan, that of the cells, and the latter
backwards; the smallest tree stays.
"""

from __future__ import annotations

from dataclasses import dataclass

from rplan.circuit.cell import Op
from rplan.circuit.circuit import Circuit
from rplan.circuit.evaluate import Bits
from rplan.circuit.passes.merge import Variable, variables

MOST_NODES = 4096
"""Tests and ends of a tree, at most."""
MOST_GATES = 4096
MOST_VARIABLES = 400
"""Both are limits for trying at all; recursion goes as deep as there are variables."""
MOST_DIAGRAM = 1 << 14
"""Nodes of all diagrams of one order; to come to them takes less than 0.1 s."""


@dataclass(frozen=True, slots=True)
class Leaf:
    """What is set at the end of a path."""

    outputs: Bits


@dataclass(frozen=True, slots=True)
class Test:
    """variable: (Op.INPUT or Op.REGISTER, its index). nodes: tests and ends below, and this. depth: tests on the
    longest path."""

    variable: Variable
    high: Tree
    low: Tree
    nodes: int
    depth: int


Tree = Leaf | Test


def decisions(circuit: Circuit, most: int = MOST_NODES) -> Tree | None:
    """The tree of a circuit's outputs; None if it has more than `most` nodes or takes too long to find out."""
    if sum(1 for cell in circuit.cells if cell.operands) > MOST_GATES:
        return None
    read = variables(circuit)
    if len(read) > MOST_VARIABLES:
        return None
    declared = sorted(read, key=lambda name: (name[0] is Op.REGISTER, name[1]))
    trees = [
        tree for names in (declared, read, read[::-1]) if (tree := _tree_in_order(circuit, names, most)) is not None
    ]
    return min(trees, key=nodes_of, default=None)


def _tree_in_order(circuit: Circuit, names: list[Variable], most: int) -> Tree | None:
    diagrams = _Diagrams()
    try:
        roots = _roots(circuit, {name: level for level, name in enumerate(names)}, diagrams)
        return _Trees(diagrams, names, most).tree(roots)
    except _TooLargeError:
        return None


class _TooLargeError(Exception):
    """Given up."""


FALSE, TRUE = 0, 1


class _Diagrams:
    """Nodes (level, low, high) by number, each once; 0 is false and 1 is true, below all levels."""

    def __init__(self) -> None:
        bottom = MOST_VARIABLES + 1
        self.nodes: list[tuple[int, int, int]] = [(bottom, 0, 0), (bottom, 1, 1)]
        self.index: dict[tuple[int, int, int], int] = {}
        self.conjunctions: dict[tuple[int, int], int] = {}
        self.negations: dict[int, int] = {FALSE: TRUE, TRUE: FALSE}

    def node(self, level: int, low: int, high: int) -> int:
        if low == high:
            return low
        key = level, low, high
        found = self.index.get(key)
        if found is None:
            if len(self.nodes) >= MOST_DIAGRAM:
                raise _TooLargeError
            found = self.index[key] = len(self.nodes)
            self.nodes.append(key)
        return found

    def negation(self, a: int) -> int:
        if a not in self.negations:
            level, low, high = self.nodes[a]
            self.negations[a] = b = self.node(level, self.negation(low), self.negation(high))
            self.negations[b] = a
        return self.negations[a]

    def both(self, a: int, b: int) -> int:
        if a > b:
            a, b = b, a
        if a in (FALSE, b):
            return a
        if a == TRUE:
            return b
        found = self.conjunctions.get((a, b))
        if found is None:
            level = min(self.nodes[a][0], self.nodes[b][0])
            (a0, a1), (b0, b1) = self.branches(a, level), self.branches(b, level)
            found = self.conjunctions[a, b] = self.node(level, self.both(a0, b0), self.both(a1, b1))
        return found

    def branches(self, a: int, level: int) -> tuple[int, int]:
        """(low, high) of a diagram at a level that is not below its top."""
        top, low, high = self.nodes[a]
        return (low, high) if top == level else (a, a)


def _roots(circuit: Circuit, levels: dict[Variable, int], diagrams: _Diagrams) -> tuple[int, ...]:
    """The diagrams of the outputs."""
    nets: list[int] = []
    for cell in circuit.cells:
        read = [nets[operand] for operand in cell.operands]
        match cell.op:
            case Op.CONSTANT:
                nets.append(TRUE if cell.index else FALSE)
            case Op.INPUT | Op.REGISTER:
                nets.append(diagrams.node(levels[cell.op, cell.index], FALSE, TRUE))
            case Op.NOT:
                nets.append(diagrams.negation(read[0]))
            case Op.AND:
                nets.append(diagrams.both(*read))
            case Op.OR:
                nets.append(diagrams.negation(diagrams.both(*map(diagrams.negation, read))))
    return tuple(nets[net] for _, net in circuit.outputs)


class _Trees:
    """Trees of several diagrams together, equal ones once."""

    def __init__(self, diagrams: _Diagrams, names: list[Variable], most: int) -> None:
        self.diagrams = diagrams
        self.names = names
        self.most = most
        self.known: dict[tuple[int, ...], Tree] = {}

    def tree(self, roots: tuple[int, ...]) -> Tree:
        if roots not in self.known:
            self.known[roots] = self._tree(roots)
        return self.known[roots]

    def _tree(self, roots: tuple[int, ...]) -> Tree:
        level = min((self.diagrams.nodes[root][0] for root in roots), default=MOST_VARIABLES + 1)
        if level > MOST_VARIABLES:
            return Leaf(tuple(root == TRUE for root in roots))
        if len(self.known) > self.most:
            raise _TooLargeError
        pairs = [self.diagrams.branches(root, level) for root in roots]
        low, high = self.tree(tuple(a for a, _ in pairs)), self.tree(tuple(b for _, b in pairs))
        nodes = 1 + nodes_of(low) + nodes_of(high)
        if nodes > self.most:
            raise _TooLargeError
        return Test(self.names[level], high, low, nodes, 1 + max(depth_of(low), depth_of(high)))


def nodes_of(tree: Tree) -> int:
    """Tests and ends."""
    return tree.nodes if isinstance(tree, Test) else 1


def depth_of(tree: Tree) -> int:
    """Tests on the longest path."""
    return tree.depth if isinstance(tree, Test) else 0
