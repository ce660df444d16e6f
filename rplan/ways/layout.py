"""A reduced goal laid out for the reduction: which node belongs to which member, under which alternatives.

Takes: a reduced goal. Gives: `Layout`: places in textual order, the owner of each, and the groups of outputs whose
alternatives have to be chosen together. Leaves alone: guards.

A node's *owner* is the innermost member of a `prio-and` that it is in and that can be given up (0: none, it must be).
Two outputs are in one *group* if an `or` can set both, directly or through others; only inside a group do
alternatives multiply (L19).
"""

from __future__ import annotations

from dataclasses import dataclass, field

from rplan.goals.goal import Do, Goal, Or, PrioAnd, children


@dataclass(frozen=True, slots=True)
class Member:
    """A member of a `prio-and` that can be given up; number 0 is the whole goal, which cannot.

    before: the member of the same `prio-and` that must be kept for it, 0 for the first one (always kept).
    """

    number: int
    goal: Goal
    owner: int
    before: int
    node: int


@dataclass(frozen=True, slots=True)
class Node:
    """A place in the goal. under: the alternatives it is in, as (node number of the `or`, alternative)."""

    number: int
    goal: Goal
    parent: int
    owner: int
    under: tuple[tuple[int, int], ...]


@dataclass(slots=True)
class Layout:
    """Every node in textual order. group_of: output -> group; group_of_or: node number of an `or` -> group."""

    nodes: list[Node] = field(default_factory=list)
    members: list[Member] = field(default_factory=list)
    inside: dict[int, list[int]] = field(default_factory=dict)
    group_of: dict[str, int] = field(default_factory=dict)
    group_of_or: dict[int, int] = field(default_factory=dict)
    groups: int = 0

    def group_under(self, node: Node) -> int | None:
        """The group of the alternatives that a node is in; None outside every `or`."""
        return self.group_of_or[node.under[0][0]] if node.under else None


def lay_out(goal: Goal) -> Layout:
    """The layout of a reduced goal."""
    layout = Layout()
    layout.members.append(Member(0, goal, 0, 0, 0))
    _visit(goal, -1, 0, (), layout)
    _group(layout)
    return layout


def _visit(goal: Goal, parent: int, owner: int, under: tuple[tuple[int, int], ...], layout: Layout) -> int:
    here = Node(len(layout.nodes), goal, parent, owner, under)
    layout.nodes.append(here)
    layout.inside[here.number] = []
    before = 0
    for number, child in enumerate(children(goal)):
        child_owner, child_under = owner, under
        if isinstance(goal, PrioAnd) and number > 0:
            member = Member(len(layout.members), child, owner, before, len(layout.nodes))
            layout.members.append(member)
            before = child_owner = member.number
        elif isinstance(goal, Or):
            child_under = (*under, (here.number, number))
        layout.inside[here.number].append(_visit(child, here.number, child_owner, child_under, layout))
    return here.number


def _group(layout: Layout) -> None:
    """Union-find over outputs and outermost `or`s; group 0 is all outputs that no `or` sets."""
    parent: dict[object, object] = {}

    def root(thing: object) -> object:
        parent.setdefault(thing, thing)
        while parent[thing] != thing:
            parent[thing] = parent[parent[thing]]
            thing = parent[thing]
        return thing

    for node in layout.nodes:
        if node.under and isinstance(node.goal, Do):
            parent[root(node.goal.output)] = root(node.under[0][0])
    numbers: dict[object, int] = {}
    for node in layout.nodes:
        if isinstance(node.goal, Or):
            outermost = node.under[0][0] if node.under else node.number
            layout.group_of_or[node.number] = numbers.setdefault(root(outermost), len(numbers) + 1)
    for node in layout.nodes:
        if isinstance(node.goal, Do):
            layout.group_of[node.goal.output] = numbers.get(root(node.goal.output), 0)
    layout.groups = len(numbers) + 1
