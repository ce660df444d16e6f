"""What would have made a tick do otherwise.

Takes: `Ways`, the values of its atoms and registers in one tick, what the outputs should have been. Gives: `WhyNot`:
the fewest percepts whose change makes it so, registers as they were; where no percepts can, what would have to have
been kept; or that nothing can. Leaves alone: why the tick did what it did; see why.py.

A percept that is a number counts once, whatever comparisons ask of it. Only ticks that can be are looked at: numbers
are exact, assumptions kept. Of changes that are as small the one counts that has the earlier percepts in textual order.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import Literal as Word

import z3

from rplan.goals.condition import Comparison, percept_terms
from rplan.ways.guards import Node
from rplan.ways.kept import Kept, Literal, kept, kept_by
from rplan.ways.reach import Reach
from rplan.ways.reduce import Ways
from rplan.ways.simplest import bounds, value_of
from rplan.ways.situations import Unrolling, atom_value, exact, negated
from rplan.ways.way import TakenWay, taken_way
from rplan.ways.why import atom_literal

Wanted = Mapping[str, str | None]
"""Output -> canonical text of the value that it should have been set to; None: left open."""
Values = Mapping[str, bool | float]
"""Canonical text of a percept -> its value (numbers in SI)."""
Verdict = Word["already", "percepts", "kept", "never", "undecided"]

HERE, AS_IT_WAS = 0, 1
"""Ticks of the unrolling: the one that is asked about, and one whose numbers are what they really were."""
MOST_PASTS = 16
"""Pasts that are tried until one is found that can have been."""


class WantedError(ValueError):
    """What is wanted is nothing that the plan can do at any time; the words say why."""


@dataclass(frozen=True, slots=True)
class Change:
    """A percept that would have to have another value.

    was, becomes: the values; None where a number is not known or no float says it. comparisons: those that this turns,
    with what they become.
    """

    percept: str
    was: bool | float | None
    becomes: bool | float | None
    comparisons: tuple[Literal, ...]


@dataclass(frozen=True, slots=True)
class PastChange:
    """A condition with memory, what was kept of it and what would have to have been."""

    was: Kept
    becomes: Kept


@dataclass(frozen=True, slots=True)
class WhyNot:
    """verdict: `already`, it happens; `percepts`, `changes` make it happen; `kept`, no percepts can, but with `past`
    they could; `never`, no tick of the plan does it; `undecided`, it was too hard to say.

    past: empty for `kept` where no past was found that can have been. atoms, registers: the tick that does it, and way
    its way; None where there is none.
    """

    verdict: Verdict
    changes: tuple[Change, ...] = ()
    past: tuple[PastChange, ...] = ()
    atoms: tuple[bool, ...] = ()
    registers: tuple[bool, ...] = ()
    way: TakenWay | None = None


def checked(ways: Ways, wanted: Wanted) -> Wanted:
    """The same; `WantedError` where an output or value is none of the plan's."""
    for output, value in wanted.items():
        declared = {one.name: one for one in ways.goals.outputs}
        if output not in declared:
            raise WantedError(f"there is no output {output} (there are: {', '.join(declared) or 'none'})")
        idle = declared[output].idle
        values = [*ways.sets.get(output, {}), *([idle.text] if idle is not None else [])]
        if value is not None and value not in values:
            known = ", ".join(dict.fromkeys(values)) or "nothing"
            raise WantedError(f"the plan never sets {output} to {value} (what it can be: {known})")
    return wanted


class Changes:
    """Asks what would have made ticks of one plan do otherwise."""

    def __init__(self, ways: Ways, wanted: Wanted) -> None:
        self.ways = ways
        self.wanted = checked(ways, wanted)
        self.unrolling = Unrolling(ways, first=False)
        self._atoms = [atom_literal(self.unrolling, number) for number in range(ways.asking)]
        self._registers = [self.unrolling.register(HERE, number) for number in range(ways.driving)]
        self._percepts = [term.text for term in ways.goals.percepts(driving=True)]
        self._wish = [negated(self.unrolling.literal(HERE, ways.hole)), *self._wishes()]
        self._solver = self.unrolling.solver
        self._solver.add(*self._wish, *self.unrolling.assumed(1))

    def _wishes(self) -> list[z3.BoolRef]:
        return [z3.Or(*(self._all_of(one) for one in self._choices(*pair))) for pair in self.wanted.items()]

    def _choices(self, output: str, value: str | None) -> list[tuple[tuple[int, bool], ...]]:
        """The guards with values of which one line has to be; an idle value stands where the output is open."""
        sets = self.ways.sets.get(output, {})
        idle = next((one.idle for one in self.ways.goals.outputs if one.name == output), None)
        is_open = tuple((guard, False) for guard in sets.values())
        choices = [((sets[value], True),)] if value is not None and value in sets else []
        return [*choices, is_open] if value is None or (idle is not None and idle.text == value) else [*choices]

    def _all_of(self, question: tuple[tuple[int, bool], ...]) -> z3.BoolRef:
        return z3.And(*self.unrolling.ask(HERE, question), z3.BoolVal(True, self.unrolling.context))

    def happens(self, atoms: Sequence[bool], registers: Sequence[bool]) -> bool:
        """Whether the plan does what is wanted where its driving atoms and registers have these values."""
        every = (*atoms, *(False for _ in self.ways.atoms[len(atoms) :]))
        held = (*registers, *(False for _ in self.ways.registers[len(registers) :]))
        values = self.ways.guards.evaluate(every, held)
        asked = (self._choices(*pair) for pair in self.wanted.items())
        fits = (any(all(values[guard] == value for guard, value in one) for one in choices) for choices in asked)
        return not values[self.ways.hole] and all(fits)

    def why_not(self, atoms: Sequence[bool], registers: Sequence[bool], values: Values | None = None) -> WhyNot:
        """What would have made it happen where the driving atoms and registers have these values.

        values: of the percepts; without them numbers are known only as far as the atoms say.
        """
        atoms, registers = tuple(atoms), tuple(registers)
        if self.happens(atoms, registers):
            return WhyNot("already", (), (), atoms, registers, taken_way(self.ways, atoms, registers))
        self._solver.push()
        try:
            return _Search(self, atoms, registers, values).search()
        except _TooHardError:
            return WhyNot("undecided")
        finally:
            self._solver.pop(self._solver.num_scopes())


class _Search:
    """Looks from one tick."""

    def __init__(self, asked: Changes, atoms: tuple[bool, ...], registers: tuple[bool, ...], values: Values | None):
        self.asked, self.ways, self.unrolling = asked, asked.ways, asked.unrolling
        self.solver = asked._solver
        self.atoms, self.registers, self.values = atoms, registers, values
        self.past = self._past_as(registers)
        self.was = self._as_they_were()
        self.changed = {text: self._changed(text) for text in asked._percepts}
        self.turned: dict[str, z3.BoolRef] = {}

    def search(self) -> WhyNot:
        self.solver.push()
        self.solver.add(*self.past)
        if self._possible():
            self._settle(self.changed)
            found = self._found("percepts", self.registers)
            self.solver.pop()
            return found
        self.solver.pop()
        return self._with_another_past() if self.registers else WhyNot("never")

    # --- percepts ---

    def _as_they_were(self) -> dict[str, bool | z3.ArithRef]:
        """What the percepts were: a truth value, or a number of which it may be known only what atoms say."""
        was: dict[str, bool | z3.ArithRef] = {}
        for number, (atom, value) in enumerate(zip(self.ways.atoms, self.atoms, strict=False)):
            if not isinstance(atom, Comparison):
                was[atom.text] = value
                continue
            for term in percept_terms(atom):
                was[term.text] = self.unrolling.symbol(AS_IT_WAS, term.text)
            if self.values is None:
                self.solver.add(_as(self.unrolling.comparison(AS_IT_WAS, number), value))
        for text, one in was.items():
            if self.values is not None and not isinstance(one, bool):
                self.solver.add(one == z3.RealVal(str(exact(float(self.values[text]))), self.unrolling.context))
        return was

    def _changed(self, text: str) -> z3.BoolRef:
        symbol, was = self.unrolling.symbol(HERE, text), self.was[text]
        if isinstance(was, bool):
            return negated(symbol) if was else symbol
        name = z3.Bool(f"changed {text}", self.unrolling.context)
        self.solver.add(name == (symbol != was))
        return name

    def _possible(self, *wanted: z3.BoolRef) -> bool:
        answer = self.solver.check(*wanted)
        if answer == z3.unknown:
            raise _TooHardError
        return bool(answer == z3.sat)

    def _settle(self, flags: Mapping[str, z3.BoolRef]) -> None:
        """As few of these as can be, the first in order of those as few."""
        every = [(one, 1) for one in flags.values()]
        least = next(n for n in range(len(every) + 1) if self._fits(every, n))
        if every:
            self.solver.add(z3.PbLe(every, least))
        for one, _ in every:
            self.solver.add(one if self._possible(one) else negated(one))

    def _fits(self, flags: list[tuple[z3.BoolRef, int]], most: int) -> bool:
        if not flags:
            return True
        self.solver.push()
        self.solver.add(z3.PbLe(flags, most))
        fits = self._possible()
        self.solver.pop()
        return fits

    def _found(self, verdict: Verdict, registers: tuple[bool, ...], past: tuple[PastChange, ...] = ()) -> WhyNot:
        """The change, with the simplest numbers that do it."""
        self._possible()
        model = self.solver.model()
        texts = [text for text, one in self.changed.items() if z3.is_true(model.eval(one, model_completion=True))]
        becomes = {text: self._settled(text, text in texts) for text in self.changed}
        self._possible()
        model = self.solver.model()
        exactly = tuple(z3.is_true(model.eval(one, model_completion=True)) for one in self.asked._atoms)
        atoms = tuple(atom_value(atom, becomes) for atom in self.ways.atoms[: self.ways.asking])
        known = self.asked.happens(atoms, registers)
        atoms = atoms if known else exactly
        changes = tuple(self._change(text, becomes[text], atoms, known) for text in texts)
        return WhyNot(verdict, changes, past, atoms, registers, taken_way(self.ways, atoms, registers))

    def _change(self, text: str, becomes: bool | float, atoms: tuple[bool, ...], known: bool) -> Change:
        was = self.was[text]
        if isinstance(was, bool):
            return Change(text, was, not was, ())
        turned = tuple(
            Literal(atom.text, now)
            for atom, before, now in zip(self.ways.atoms, self.atoms, atoms, strict=False)
            if before != now and isinstance(atom, Comparison) and any(t.text == text for t in percept_terms(atom))
        )
        before = None if self.values is None else float(self.values[text])
        return Change(text, before, becomes if known else None, turned)

    def _settled(self, text: str, changes: bool) -> bool | float:
        """The value of a percept, from here on fixed."""
        symbol, was = self.unrolling.symbol(HERE, text), self.was[text]
        if isinstance(was, bool):
            return was != changes
        if not changes and self.values is not None:
            return float(self.values[text])
        for value in self._candidates(text):
            equal = symbol == z3.RealVal(str(value), self.unrolling.context)
            if self._possible(equal):
                self.solver.add(equal)
                return float(value)
        self._possible()
        value = self.solver.model().eval(symbol, model_completion=True)
        self.solver.add(symbol == value)
        return float(value_of(value))

    def _candidates(self, text: str) -> list[Fraction]:
        """What it is compared with, values beside, between and beyond; the nearest to what it was first, or to zero."""
        ordered = sorted({Fraction(0), *bounds(self.ways, text)})
        between = [(a + b) / 2 for a, b in pairwise(ordered)]
        centre = Fraction(0) if self.values is None else exact(float(self.values[text]))
        beside = [value for bound in ordered if bound for value in _beside(bound)]
        every = {*ordered, *beside, *between, ordered[0] - 1, ordered[-1] + 1}
        return sorted(every, key=lambda value: (abs(value - centre), -value))

    # --- what is kept ---

    def _with_another_past(self) -> WhyNot:
        """Fewest conditions with memory, then fewest percepts; only a past that can have been."""
        if not self._possible():
            return WhyNot("never")
        reach = Reach(self.ways)
        if not self._ever(reach):
            return WhyNot("never")
        self._name_pasts()
        for _ in range(MOST_PASTS):
            self.solver.push()
            self._settle(self.turned)
            self._settle(self.changed)
            self._possible()
            model = self.solver.model()
            registers = tuple(z3.is_true(model.eval(one, model_completion=True)) for one in self.asked._registers)
            if self._can_have_been(reach, registers):
                self.solver.add(*self._past_as(registers))
                return self._found("kept", registers, self._past(registers))
            self.solver.pop()
            self.solver.add(z3.Or([negated(one) for one in self._past_as(registers)]))
            if not self._possible():
                break
        return WhyNot("kept")

    def _name_pasts(self) -> None:
        for text, numbers in kept_by(self.ways).items():
            name = z3.Bool(f"turned {text}", self.unrolling.context)
            self.solver.add(name == z3.Or([negated(self.past[number]) for number in numbers]))
            self.turned[text] = name

    def _past(self, registers: tuple[bool, ...]) -> tuple[PastChange, ...]:
        every = ((kept(self.ways, text, self.registers), kept(self.ways, text, registers)) for text in self.turned)
        return tuple(PastChange(was, becomes) for was, becomes in every if was != becomes)

    def _ever(self, reach: Reach) -> bool:
        """Whether some tick does it, or that is not decided."""
        return any(reach.first_tick(*question) is not None for question in self._questions())

    def _questions(self) -> list[tuple[tuple[int, bool], ...]]:
        questions: list[tuple[tuple[int, bool], ...]] = [((self.ways.hole, False),)]
        for pair in self.asked.wanted.items():
            questions = [(*one, *more) for one in questions for more in self.asked._choices(*pair)]
        return questions

    def _can_have_been(self, reach: Reach, registers: tuple[bool, ...]) -> bool:
        """Whether some tick does it with these registers, or that is not decided."""
        state = tuple((self._guard(number), value) for number, value in enumerate(registers))
        return any(reach.first_tick(*question, *state) is not None for question in self._questions())

    def _past_as(self, registers: tuple[bool, ...]) -> list[z3.BoolRef]:
        return [_as(one, value) for one, value in zip(self.asked._registers, registers, strict=True)]

    def _guard(self, register: int) -> int:
        node: Node = ("register", register, register)
        return self.ways.guards.index[node]


def _beside(bound: Fraction) -> tuple[Fraction, Fraction]:
    """The numbers of two digits next below and next above."""
    step = Fraction(10) ** (math.floor(math.log10(abs(bound))) - 1)
    return (math.ceil(bound / step) - 1) * step, (math.floor(bound / step) + 1) * step


class _TooHardError(Exception):
    """A question was too hard."""


def _as(literal: z3.BoolRef, value: bool) -> z3.BoolRef:
    return literal if value else negated(literal)
