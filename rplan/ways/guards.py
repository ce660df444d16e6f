"""Guards: boolean expressions over atoms and registers, each distinct one stored once.

Takes: atoms and registers by number. Gives: `Guards`, a growing table of nodes in which a node reads only smaller
ones; equal expressions get equal numbers. Leaves alone: what an atom asks of the world.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Literal

FALSE = 0
TRUE = 1

Kind = Literal["constant", "atom", "register", "not", "and", "or"]
Node = tuple[Kind, int, int]
"""constant: its value; atom, register: its number; not: its operand, twice; and, or: operands, the smaller first."""


@dataclass(slots=True)
class Guards:
    """The table. Nodes 0 and 1 are false and true."""

    nodes: list[Node] = field(default_factory=lambda: [("constant", 0, 0), ("constant", 1, 1)])
    index: dict[Node, int] = field(default_factory=dict)

    def atom(self, number: int) -> int:
        """The guard that asks atom `number`."""
        return self._node(("atom", number, number))

    def register(self, number: int) -> int:
        """The guard that reads register `number`."""
        return self._node(("register", number, number))

    def negation(self, a: int) -> int:
        """Not a."""
        if a <= TRUE:
            return TRUE - a
        kind, operand, _ = self.nodes[a]
        return operand if kind == "not" else self._node(("not", a, a))

    def both(self, a: int, b: int) -> int:
        """a and b."""
        if a == b or b == TRUE:
            return a
        if a == TRUE:
            return b
        if FALSE in (a, b) or self._opposite(a, b):
            return FALSE
        for x, y in ((a, b), (b, a)):
            kind, p, q = self.nodes[x]
            if kind == "and" and y in (p, q):
                return x
            if kind == "and" and (self._opposite(p, y) or self._opposite(q, y)):
                return FALSE
            if kind == "or" and y in (p, q):
                return y
            if kind == "or" and self._opposite(p, y):
                return self.both(q, y)
            if kind == "or" and self._opposite(q, y):
                return self.both(p, y)
        return self._node(("and", min(a, b), max(a, b)))

    def either(self, a: int, b: int) -> int:
        """a or b."""
        if a == b or b == FALSE:
            return a
        if a == FALSE:
            return b
        if TRUE in (a, b) or self._opposite(a, b):
            return TRUE
        for x, y in ((a, b), (b, a)):
            kind, p, q = self.nodes[x]
            if kind == "or" and y in (p, q):
                return x
            if kind == "or" and (self._opposite(p, y) or self._opposite(q, y)):
                return TRUE
            if kind == "and" and y in (p, q):
                return y
            if kind == "and" and self._opposite(p, y):
                return self.either(q, y)
            if kind == "and" and self._opposite(q, y):
                return self.either(p, y)
        return self._node(("or", min(a, b), max(a, b)))

    def all_of(self, guards: Iterable[int]) -> int:
        """The conjunction; true of none."""
        result = TRUE
        for guard in guards:
            result = self.both(result, guard)
        return result

    def any_of(self, guards: Iterable[int]) -> int:
        """The disjunction; false of none."""
        result = FALSE
        for guard in guards:
            result = self.either(result, guard)
        return result

    def but_not(self, a: int, b: int) -> int:
        """a and not b."""
        return self.both(a, self.negation(b))

    def _opposite(self, a: int, b: int) -> bool:
        return self.nodes[max(a, b)] == ("not", min(a, b), min(a, b))

    def _node(self, node: Node) -> int:
        number = self.index.get(node)
        if number is None:
            number = self.index[node] = len(self.nodes)
            self.nodes.append(node)
        return number

    def evaluate(self, atoms: Sequence[bool], registers: Sequence[bool] = ()) -> list[bool]:
        """The value of every node in one situation; atoms and registers by number."""
        values: list[bool] = []
        for kind, a, b in self.nodes:
            match kind:
                case "constant":
                    values.append(bool(a))
                case "atom":
                    values.append(atoms[a])
                case "register":
                    values.append(registers[a])
                case "not":
                    values.append(not values[a])
                case "and":
                    values.append(values[a] and values[b])
                case "or":
                    values.append(values[a] or values[b])
        return values
