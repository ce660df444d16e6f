"""Why a tick did what it did.

Takes: `Ways`, the values of its atoms and registers in one tick. Gives: `Why`: the way taken, the smallest set of
literals that alone make for its outputs, what of the past matters, every goal that lost. Leaves alone: what would have
made it otherwise; see why_not.py.

A set of literals is enough if, with the registers as they were, no tick that can be (numbers exact, assumptions kept)
has these literals and other outputs. The smallest one hits every set of literals whose change together changes the
outputs: hitting sets and such changes are found by turns, until a hitting set is enough. That is the implicit hitting
set method (Moreno-Centeno and Karp 2013, Ignatiev et al. 2015).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import z3

from rplan.goals.condition import Percept
from rplan.goals.goal import Reduced
from rplan.lang.source import Span
from rplan.ways.exhaust import evaluate_many
from rplan.ways.kept import Kept, Literal, kept, kept_by
from rplan.ways.lost import Lost, lost
from rplan.ways.reduce import Ways
from rplan.ways.situations import Unrolling, negated
from rplan.ways.way import TakenWay, taken_way

MOST_CHECKS = 2_000
"""Questions to z3 before any set from which nothing can be left out is taken."""


@dataclass(frozen=True, slots=True)
class Served:
    """A rule that the way serves. span: where the rule stands."""

    head: str
    span: Span


@dataclass(frozen=True, slots=True)
class Why:
    """served: the rules of the way in textual order, each once.

    literals: enough for these outputs, in the order of the plan's inputs; smallest: and no fewer are enough. Where it
    is false, none of them can be left out. kept: the conditions with memory that matter besides, as they stood before
    the tick; none of them can be left out.
    """

    way: TakenWay
    served: tuple[Served, ...]
    literals: tuple[Literal, ...]
    smallest: bool
    kept: tuple[Kept, ...]
    lost: tuple[Lost, ...]


class Reasons:
    """Asks about many ticks of one plan."""

    def __init__(self, ways: Ways) -> None:
        self.ways = ways
        self.unrolling = Unrolling(ways, first=False)
        self.solver = self.unrolling.solver
        self._atoms = [atom_literal(self.unrolling, number) for number in range(ways.asking)]
        guards = (ways.hole, *(guard for values in ways.sets.values() for guard in values.values()))
        self._outputs = [self.unrolling.literal(0, guard) for guard in guards]
        self._guards = guards
        self._registers = [self.unrolling.register(0, number) for number in range(ways.driving)]
        self._assumed = self.unrolling.assumed(1)

    def why(self, atoms: Sequence[bool], registers: Sequence[bool]) -> Why:
        """Why the plan does what it does where its driving atoms and registers have these values."""
        way = taken_way(self.ways, atoms, registers)
        literals, smallest, texts = self._enough(atoms, registers)
        return Why(
            way,
            self._served(way),
            self._said(literals, atoms),
            smallest,
            tuple(kept(self.ways, text, registers) for text in texts),
            lost(self.ways, way, atoms, registers),
        )

    def literals(self, atoms: Sequence[bool], registers: Sequence[bool]) -> tuple[Literal, ...]:
        """The literals of `why` alone: what of the past matters takes a question for each condition with memory."""
        return self._said(self._enough(atoms, registers, past_too=False)[0], atoms)

    def _said(self, literals: Sequence[int], atoms: Sequence[bool]) -> tuple[Literal, ...]:
        return tuple(Literal(self.ways.atoms[number].text, atoms[number]) for number in literals)

    def _served(self, way: TakenWay) -> tuple[Served, ...]:
        places: dict[str, Span] = {}
        for node in self.ways.layout.nodes:
            if isinstance(node.goal, Reduced):
                places.setdefault(node.goal.head, node.goal.rule_span)
        return tuple(Served(head, places[head]) for head in way.rules)

    def _enough(
        self, atoms: Sequence[bool], registers: Sequence[bool], past_too: bool = True
    ) -> tuple[list[int], bool, list[str]]:
        every = (*atoms, *(False for _ in self.ways.atoms[len(atoms) :]))
        held = (*registers, *(False for _ in self.ways.registers[len(registers) :]))
        values = self.ways.guards.evaluate(every, held)
        wanted = [_as(one, value) for one, value in zip(self._atoms, atoms, strict=True)]
        past = [_as(one, value) for one, value in zip(self._registers, registers, strict=True)]
        other = z3.Or([_as(one, not values[guard]) for one, guard in zip(self._outputs, self._guards, strict=True)])
        assumed = self._assumed
        if self.solver.check(*wanted, *past, *assumed) != z3.sat:
            assumed = []
        if self.solver.check(*wanted, *past) != z3.sat:
            return [*range(len(atoms))], False, [*kept_by(self.ways)]
        self.solver.push()
        self.solver.add(*assumed, other)
        near = _Nearer(self.ways, atoms, held, [values[guard] for guard in self._guards], self._guards)
        try:
            literals, smallest = _Smallest(self.solver, wanted, past, near).search()
            texts = self._texts([wanted[number] for number in literals], past) if past_too else []
            return literals, smallest, texts
        finally:
            self.solver.pop()

    def _texts(self, literals: list[z3.BoolRef], past: list[z3.BoolRef]) -> list[str]:
        """The conditions with memory that cannot be left out; of two that stand for each other the first stays."""
        left = dict(kept_by(self.ways))
        for text in reversed([*left]):
            without = [past[number] for other, numbers in left.items() if other != text for number in numbers]
            if self.solver.check(*literals, *without) == z3.unsat:
                del left[text]
        return [*left]


class _Nearer:
    """Makes a tick with other outputs more like the one that was, by trying; z3 is left what that does not find."""

    def __init__(
        self, ways: Ways, atoms: Sequence[bool], registers: Sequence[bool], outputs: list[bool], guards: Sequence[int]
    ) -> None:
        self._ways, self._atoms, self._registers = ways, atoms, registers
        self._outputs = list(zip(guards, outputs, strict=True))
        every = () if ways.assumed else range(ways.asking)
        self._free = [number for number in every if isinstance(ways.atoms[number], Percept)]

    def __call__(self, agreeing: list[int]) -> list[int]:
        """The literals that hold, and more that can hold with them; only percepts, and no assumption stands by."""
        known = {*agreeing}
        left = [number for number in self._free if number not in known]
        size = len(left)
        while size > 0:
            chunks = [left[start : start + size] for start in range(0, len(left), size)]
            chosen = self._other(known, chunks)
            if chosen is None:
                size //= 2
                continue
            known |= {*chosen}
            left = [number for number in left if number not in known]
            size = min(size, len(left))
        return sorted(known)

    def _other(self, known: set[int], chunks: list[list[int]]) -> list[int] | None:
        """The first chunk with which the outputs are others still."""
        every = (1 << len(chunks)) - 1
        columns = [0] * len(self._ways.atoms)
        for number, value in enumerate(self._atoms):
            columns[number] = every if value == (number in known) else 0
        for place, chunk in enumerate(chunks):
            for number in chunk:
                columns[number] ^= 1 << place
        registers = [every if value else 0 for value in self._registers]
        values = evaluate_many(self._ways.guards, columns, len(chunks), registers)
        other = 0
        for guard, value in self._outputs:
            other |= values[guard] ^ (every if value else 0)
        return chunks[(other & -other).bit_length() - 1] if other else None


class _Smallest:
    """The smallest set of literals that leaves nothing to a solver, the first in order of those as small."""

    def __init__(self, solver: z3.Solver, wanted: list[z3.BoolRef], always: list[z3.BoolRef], near: _Nearer) -> None:
        self._solver, self._wanted, self._always, self._near = solver, wanted, always, near
        self._hitting = z3.SimpleSolver(ctx=solver.ctx)
        self._chosen = [z3.Bool(f"chosen {number}", solver.ctx) for number in range(len(wanted))]
        self._most = 0
        self._checks = 0
        self._limits: dict[int, z3.BoolRef] = {}

    def search(self) -> tuple[list[int], bool]:
        try:
            return self._search(), True
        except _TooLongError:
            return self._irreducible(), False

    def _search(self) -> list[int]:
        found = self._with([])
        while found is None:
            self._most += 1
            found = self._with([])
        sure: list[z3.BoolRef] = []
        for number, one in enumerate(self._chosen if found else []):
            better = found if number in found else self._with([*sure, one])
            found = better or found
            sure.append(one if better is not None else negated(one))
            if number == found[-1]:
                break
        return found

    def _with(self, sure: list[z3.BoolRef]) -> list[int] | None:
        """A set of at most so many literals that is enough; None if there is none."""
        limit = self._at_most(self._most)
        while self._hitting.check(limit, *sure) == z3.sat:
            model = self._hitting.model()
            tried = [n for n, one in enumerate(self._chosen) if z3.is_true(model.eval(one))]
            change = self._change(tried)
            if change is None:
                return tried
            self._hitting.add(z3.Or([self._chosen[number] for number in change]))
        return None

    def _at_most(self, most: int) -> z3.BoolRef:
        """A literal that says that no more are chosen."""
        if most not in self._limits:
            name = z3.Bool(f"at most {most}", self._solver.ctx)
            if self._chosen:
                self._hitting.add(z3.Implies(name, z3.PbLe([(one, 1) for one in self._chosen], most)))
            self._limits[most] = name
        return self._limits[most]

    def _change(self, fixed: list[int]) -> list[int] | None:
        """Literals whose change makes it otherwise with these fixed, none of them for nothing; None: nothing does."""
        better = agreeing = self._otherwise(fixed, [])
        if agreeing is None:
            return None
        while better is not None:
            agreeing = self._near(better)
            better = self._otherwise(agreeing, self._others(agreeing))
        return self._others(agreeing)

    def _others(self, numbers: list[int]) -> list[int]:
        known = {*numbers}
        return [number for number in range(len(self._wanted)) if number not in known]

    def _otherwise(self, fixed: list[int], some: list[int]) -> list[int] | None:
        """The literals of some tick with other outputs, in which these hold and, where there are any, one of `some`."""
        self._checks += 1
        if self._checks > MOST_CHECKS:
            raise _TooLongError
        self._solver.push()
        if some:
            self._solver.add(z3.Or([self._wanted[number] for number in some]))
        answer = self._solver.check(*self._always, *(self._wanted[number] for number in fixed))
        model = self._solver.model() if answer == z3.sat else None
        self._solver.pop()
        if answer == z3.unknown:
            raise _TooLongError
        if model is None:
            return None
        return [n for n, one in enumerate(self._wanted) if z3.is_true(model.eval(one, model_completion=True))]

    def _irreducible(self) -> list[int]:
        """Every literal whose loss is not shown to be none is kept."""
        left = [*range(len(self._wanted))]
        for number in reversed(range(len(self._wanted))):
            without = [self._wanted[one] for one in left if one != number]
            if self._solver.check(*self._always, *without) == z3.unsat:
                left.remove(number)
        return left


class _TooLongError(Exception):
    """Too many rounds, or one that is too hard."""


def atom_literal(unrolling: Unrolling, number: int) -> z3.BoolRef:
    """The literal of an atom in the tick that is asked about."""
    atom = unrolling.ways.atoms[number]
    return unrolling.symbol(0, atom.text) if isinstance(atom, Percept) else unrolling.comparison(0, number)


def _as(literal: z3.BoolRef, value: bool) -> z3.BoolRef:
    return literal if value else negated(literal)
