"""Goals → Ways, without enumerating ways (L19).

Takes: checked `Goals`. Gives: `Ways`: for each output and value the guard under which it is set, the guard of a hole,
and for each place in the goal the guard under which it is served. Leaves alone: which gates that becomes.

The members that can be given up are kept greedily in textual order: a member is kept if what it must have goes
together with all that must be and all that is kept already. Where `or`s offer alternatives, every choice of a group is
followed through; a choice drops out as soon as another one of its group gives up less, and of those that are left the
first counts. That is the order of L18; meaning.py says the same the long way.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

from rplan.goals.condition import (
    AllOf,
    AnyOf,
    Atom,
    Comparison,
    Condition,
    Constant,
    Memory,
    Named,
    Not,
    OutputIs,
    Percept,
)
from rplan.goals.condition import atoms as atoms_of
from rplan.goals.goal import And, Anything, Do, Goals, If, Impossible, Or, PrioAnd, Reduced
from rplan.ways.alternatives import LIMIT, Alternatives, Choice
from rplan.ways.guards import FALSE, TRUE, Guards
from rplan.ways.layout import Layout, Member, lay_out
from rplan.ways.memory import Register, Registers


@dataclass(frozen=True, slots=True)
class Claim:
    """A property as guards: `always` has to hold where `provided` does."""

    always: int
    provided: int


@dataclass(frozen=True, slots=True)
class Ways:
    """All ways of a plan, as guards.

    sets: output -> canonical text of a value -> guard, in textual order. hole: no way is open. reached: node number ->
    served by the way that is taken; given_up: member number -> given up by it. asked: node number -> condition of an
    `if` (true elsewhere). atoms, registers: what guards ask, by number.
    asking, driving: so many atoms and registers, the first ones, serve the goal; the others serve properties alone.
    claims: of the properties, in their order; assumed: what may be taken for granted.
    on_offer: (node number of an `or`, alternative) -> it goes, and no other way gives up less.
    """

    goals: Goals
    layout: Layout
    guards: Guards
    atoms: tuple[Atom, ...]
    asking: int
    registers: tuple[Register, ...]
    driving: int
    asked: tuple[int, ...]
    sets: dict[str, dict[str, int]]
    hole: int
    reached: tuple[int, ...]
    given_up: tuple[int, ...]
    claims: tuple[Claim, ...]
    assumed: tuple[int, ...]
    on_offer: dict[tuple[int, int], int] = field(default_factory=dict)

    def signature(self) -> tuple[int, ...]:
        """The guards that tell one way from another: what is done, and what is given up."""
        leaves = (node.number for node in self.layout.nodes if isinstance(node.goal, Do | Anything))
        return (*(self.reached[number] for number in leaves), *self.given_up[1:])


@dataclass(slots=True)
class _Claims:
    """What one choice has set so far: output -> guard that it is set, (output, value) -> guard that it is set so."""

    guards: Guards
    any: dict[str, int] = field(default_factory=dict)
    value: dict[tuple[str, str], int] = field(default_factory=dict)
    trail: list[tuple[str, str, int, int, int]] = field(default_factory=list)

    def clash(self, output: str, value: str, guard: int) -> int:
        """Where setting `output` to `value` under `guard` does not go together with what is set."""
        other = self.guards.but_not(self.any.get(output, FALSE), self.value.get((output, value), FALSE))
        return self.guards.both(guard, other)

    def claim(self, output: str, value: str, guard: int) -> None:
        """Set it."""
        before = self.any.get(output, FALSE), self.value.get((output, value), FALSE)
        self.trail.append((output, value, guard, *before))
        self.any[output] = self.guards.either(before[0], guard)
        self.value[(output, value)] = self.guards.either(before[1], guard)

    def undo(self, mark: int) -> list[tuple[str, str, int]]:
        """Take back everything since the trail had `mark` entries; gives what it was, in order."""
        undone = []
        while len(self.trail) > mark:
            output, value, guard, any_before, value_before = self.trail.pop()
            self.any[output] = any_before
            self.value[(output, value)] = value_before
            undone.append((output, value, guard))
        return undone[::-1]


@dataclass(slots=True)
class _Option:
    """One choice of a group: alive where it is open and none gives up less; kept: member number -> guard."""

    choice: Choice
    alive: int
    claims: _Claims
    kept: dict[int, int] = field(default_factory=dict)


class _Reducer:
    def __init__(self, goals: Goals, limit: int) -> None:
        self.goals = goals
        self.guards = Guards()
        self.atoms: dict[str, int] = {}
        self.atom_list: list[Atom] = []
        self.by_condition: dict[int, int] = {}
        self.registers = Registers(self.guards, self.guard_of)
        self.sets: dict[str, dict[str, int]] = {}
        self.layout = lay_out(goals.top)
        self._number_atoms(goals.driving())
        self.asking = len(self.atom_list)
        self._number_atoms(goals.conditions())
        alternatives = Alternatives(self.layout, self.guards, self.guard_of, limit)
        self.options = [
            [_Option(choice, choice.guard, _Claims(self.guards)) for choice in choices]
            for choices in alternatives.choices()
        ]
        self.touches, self.sizes = self._measure()
        self.kept: dict[int, int] = {0: TRUE}

    def _number_atoms(self, conditions: Iterable[Condition]) -> None:
        for condition in conditions:
            for atom in atoms_of(condition):
                if atom.text not in self.atoms:
                    self.atoms[atom.text] = len(self.atom_list)
                    self.atom_list.append(atom)

    def guard_of(self, condition: Condition) -> int:
        """The guard of a condition; the same object is translated once."""
        if id(condition) not in self.by_condition:
            self.by_condition[id(condition)] = self._guard(condition)
        return self.by_condition[id(condition)]

    def _guard(self, condition: Condition) -> int:
        match condition:
            case Constant(value):
                return TRUE if value else FALSE
            case Percept(text) | Comparison(text):
                return self.guards.atom(self.atoms[text])
            case Memory():
                return self.registers.value(condition)
            case OutputIs(output, value):
                return self._output_is(output, value)
            case Named(name):
                return self.guard_of(self.goals.definitions[name])
            case Not(inner):
                return self.guards.negation(self._guard(inner))
            case AllOf(parts):
                return self.guards.all_of(map(self._guard, parts))
            case AnyOf(parts):
                return self.guards.any_of(map(self._guard, parts))

    def _output_is(self, output: str, value: str | None) -> int:
        values = self.sets.get(output, {})
        if value is None:
            return self.guards.negation(self.guards.any_of(values.values()))
        return values.get(value, FALSE)

    def _measure(self) -> tuple[list[int], list[int]]:
        """For each node the groups that its leaves belong to, as bits, and how many nodes are in it."""
        touches = [0] * len(self.layout.nodes)
        sizes = [1] * len(self.layout.nodes)
        for node in reversed(self.layout.nodes):
            if isinstance(node.goal, Do):
                touches[node.number] |= 1 << self.layout.group_of[node.goal.output]
            elif isinstance(node.goal, Impossible):
                touches[node.number] |= 1 << (self.layout.group_under(node) or 0)
            if node.parent >= 0:
                touches[node.parent] |= touches[node.number]
                sizes[node.parent] += sizes[node.number]
        return touches, sizes

    # --- keeping members, in textual order ---

    def reduce(self) -> Ways:
        open_everywhere = TRUE
        for each in range(self.layout.groups):
            open_everywhere = self.guards.both(open_everywhere, self._must(each))
        for member in self.layout.members[1:]:
            group = self.layout.group_under(self.layout.nodes[member.node])
            if group is None:
                self._keep_for_all(member)
            else:
                self._keep_by_choice(member, group)
        return self._ways(self.guards.negation(open_everywhere))

    def _must(self, group: int) -> int:
        """Claim what must be; gives where some choice of the group can have it."""
        for option in self.options[group]:
            clash = self._claim(0, TRUE, group, option)
            option.alive = self.guards.but_not(option.alive, clash)
        return self.guards.any_of(option.alive for option in self.options[group])

    def _keep_for_all(self, member: Member) -> None:
        """A member outside every `or`: kept where in each group that it touches some choice can have it."""
        both, but_not = self.guards.both, self.guards.but_not
        present = both(both(self.kept[member.owner], self._way_to(member)), self.kept[member.before])
        clashes: list[tuple[_Option, int, list[tuple[str, str, int]]]] = []
        keep = present
        for group in self._groups(member):
            able = FALSE
            for option in self.options[group]:
                mark = len(option.claims.trail)
                clash = self._claim(member.node, TRUE, group, option)
                clashes.append((option, clash, option.claims.undo(mark)))
                able = self.guards.either(able, but_not(option.alive, clash))
            keep = both(keep, able)
        for option, clash, claims in clashes:
            option.alive = but_not(option.alive, both(keep, clash))
            for output, value, guard in claims:
                option.claims.claim(output, value, both(keep, guard))
        self.kept[member.number] = keep

    def _keep_by_choice(self, member: Member, group: int) -> None:
        """A member inside an `or`: each choice keeps it or not, and choices that need not give it up win."""
        both, but_not = self.guards.both, self.guards.but_not
        losing: list[int] = []
        for option in self.options[group]:
            if not option.choice.agrees(self.layout.nodes[member.node]):
                option.kept[member.number] = FALSE
                losing.append(FALSE)
                continue
            present = both(self._kept(member.owner, option), self._way_to(member))
            present = both(present, TRUE if member.before == 0 else self._kept(member.before, option))
            mark = len(option.claims.trail)
            clash = self._claim(member.node, TRUE, group, option)
            keep = but_not(present, clash)
            for output, value, guard in option.claims.undo(mark):
                option.claims.claim(output, value, both(keep, guard))
            option.kept[member.number] = keep
            losing.append(both(present, clash))
        pairs = list(zip(self.options[group], losing, strict=True))
        spared = self.guards.any_of(but_not(option.alive, loss) for option, loss in pairs)
        for option, loss in pairs:
            option.alive = but_not(option.alive, both(loss, spared))

    def _kept(self, member: int, option: _Option) -> int:
        return option.kept[member] if member in option.kept else self.kept[member]

    def _groups(self, member: Member) -> list[int]:
        return [group for group in range(self.layout.groups) if self.touches[member.node] >> group & 1]

    def _way_to(self, member: Member) -> int:
        """The `if`s between a member and its owner."""
        guard = TRUE
        owner = self.layout.members[member.owner].node if member.owner else 0
        here = member.node
        while here != owner:
            parent = self.layout.nodes[here].parent
            goal = self.layout.nodes[parent].goal
            if isinstance(goal, If):
                condition = self.guard_of(goal.condition)
                first = self.layout.inside[parent][0] == here
                guard = self.guards.both(guard, condition if first else self.guards.negation(condition))
            here = parent
        return guard

    def _claim(self, number: int, guard: int, group: int, option: _Option) -> int:
        """Claim what a node must have in one group under one choice; gives where that does not go together."""
        if not self.touches[number] >> group & 1 or guard == FALSE:
            return FALSE
        inside = self.layout.inside[number]
        match self.layout.nodes[number].goal:
            case Do(output=output, value=value):
                clash = option.claims.clash(output, value.text, guard)
                option.claims.claim(output, value.text, guard)
                return clash
            case Anything():
                return FALSE
            case Impossible():
                return guard
            case If(condition=condition):
                return self._claim_branches(inside, self.guard_of(condition), guard, group, option)
            case Reduced() | PrioAnd():
                return self._claim(inside[0], guard, group, option)
            case And():
                return self.guards.any_of(self._claim(child, guard, group, option) for child in inside)
            case Or():
                picked = dict(option.choice.picks).get(number)
                return FALSE if picked is None else self._claim(inside[picked], guard, group, option)

    def _claim_branches(self, inside: list[int], condition: int, guard: int, group: int, option: _Option) -> int:
        """Branches exclude each other, so neither sees the other's claims; the smaller one is put back afterwards."""
        branches = [
            (inside[0], self.guards.both(guard, condition)),
            (inside[1], self.guards.but_not(guard, condition)),
        ]
        branches.sort(key=lambda branch: self.sizes[branch[0]])
        mark = len(option.claims.trail)
        clash = self._claim(*branches[0], group, option)
        small = option.claims.undo(mark)
        clash = self.guards.either(clash, self._claim(*branches[1], group, option))
        for claim in small:
            option.claims.claim(*claim)
        return clash

    # --- what came of it ---

    def _ways(self, hole: int) -> Ways:
        selected = [self._selected(options) for options in self.options]
        reached = self._reached(hole, selected)
        given_up = [FALSE] * len(self.layout.members)
        for member in self.layout.members[1:]:
            parent = self.layout.nodes[member.node].parent
            given_up[member.number] = self.guards.but_not(reached[parent], reached[member.node])
        self.sets = self._sets(hole, selected)
        driving = len(self.registers.finished())
        claims = tuple(Claim(self.guard_of(p.always), self.guard_of(p.provided)) for p in self.goals.properties)
        assumed = tuple(self.guard_of(assumption.condition) for assumption in self.goals.assumptions)
        return Ways(
            goals=self.goals,
            layout=self.layout,
            guards=self.guards,
            atoms=tuple(self.atom_list),
            asking=self.asking,
            registers=self.registers.finished(),
            driving=driving,
            asked=tuple(
                self.guard_of(node.goal.condition) if isinstance(node.goal, If) else TRUE for node in self.layout.nodes
            ),
            sets=self.sets,
            hole=hole,
            reached=tuple(reached),
            given_up=tuple(given_up),
            claims=claims,
            assumed=assumed,
            on_offer=self._on_offer(),
        )

    def _on_offer(self) -> dict[tuple[int, int], int]:
        offered: dict[tuple[int, int], int] = {}
        for option in (option for options in self.options for option in options):
            for pick in option.choice.picks:
                offered[pick] = self.guards.either(offered.get(pick, FALSE), option.alive)
        return offered

    def _selected(self, options: list[_Option]) -> list[int]:
        """For each choice of a group: it is the first that is left."""
        before = FALSE
        selected = []
        for option in options:
            selected.append(self.guards.but_not(option.alive, before))
            before = self.guards.either(before, option.alive)
        return selected

    def _sets(self, hole: int, selected: list[list[int]]) -> dict[str, dict[str, int]]:
        sets: dict[str, dict[str, int]] = {output.name: {} for output in self.goals.outputs}
        for node in self.layout.nodes:
            if isinstance(node.goal, Do) and node.goal.value.text not in sets[node.goal.output]:
                group = self.layout.group_of[node.goal.output]
                key = (node.goal.output, node.goal.value.text)
                guard = self.guards.any_of(
                    self.guards.both(chosen, option.claims.value.get(key, FALSE))
                    for option, chosen in zip(self.options[group], selected[group], strict=True)
                )
                sets[key[0]][key[1]] = self.guards.but_not(guard, hole)
        return sets

    def _reached(self, hole: int, selected: list[list[int]]) -> list[int]:
        member_at = {member.node: member for member in self.layout.members[1:]}
        reached = [self.guards.negation(hole)]
        for node in self.layout.nodes[1:]:
            step = TRUE
            parent = self.layout.nodes[node.parent].goal
            if isinstance(parent, If):
                condition = self.guard_of(parent.condition)
                first = self.layout.inside[node.parent][0] == node.number
                step = condition if first else self.guards.negation(condition)
            elif isinstance(parent, Or):
                step = self._picked(node.under[-1], self.layout.group_of_or[node.parent], selected)
            elif node.number in member_at:
                step = self._member_kept(member_at[node.number], selected)
            reached.append(self.guards.both(reached[node.parent], step))
        return reached

    def _picked(self, pick: tuple[int, int], group: int, selected: list[list[int]]) -> int:
        return self.guards.any_of(
            chosen
            for option, chosen in zip(self.options[group], selected[group], strict=True)
            if pick in option.choice.picks
        )

    def _member_kept(self, member: Member, selected: list[list[int]]) -> int:
        group = self.layout.group_under(self.layout.nodes[member.node])
        if group is None:
            return self.kept[member.number]
        return self.guards.any_of(
            self.guards.both(chosen, option.kept[member.number])
            for option, chosen in zip(self.options[group], selected[group], strict=True)
        )


def reduce(goals: Goals, *, limit: int = LIMIT) -> Ways:
    """The ways of a plan; `PlanError` where alternatives multiply past `limit`."""
    return _Reducer(goals, limit).reduce()
