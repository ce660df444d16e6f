"""Which situations a plan does not cover, decided exactly, each with a witness.

Takes: `Ways`. Gives: diagnostics for holes, for outputs that must not stay open, and for rules that never act.
Leaves alone: what happens in a hole at run time.

Decided with z3 over booleans and real numbers: `(< d 0.2m)` implies `(< d 0.5m)`. A witness has the fewest true
percepts; among those, percepts in textual order are false rather than true, and numbers are the
simplest that fit (L26).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise

import z3

from rplan.goals.condition import Comparison, Percept, Term, compare
from rplan.goals.goal import Do, If
from rplan.lang.diagnostic import Diagnostic, Related
from rplan.lang.source import Span
from rplan.lang.units import canonical_number
from rplan.ways.exhaust import has_comparisons, samples
from rplan.ways.reduce import Ways

TIMEOUT_MS = 20_000
"""For one question to z3 [ms of wall clock]; past it the answer is that it is not decided."""

Witness = Mapping[str, bool | float]
"""Canonical text of a percept -> its value (numbers in SI), in textual order."""


@dataclass(frozen=True, slots=True)
class Undecided:
    """z3 gave up."""


class Situations:
    """The situations of a plan as z3 sees them."""

    def __init__(self, ways: Ways) -> None:
        self.ways = ways
        self.percepts = ways.goals.percepts()
        self._context = z3.Context()
        self._symbols = {term.text: self._symbol(term) for term in self.percepts}
        self._solver = z3.Solver(ctx=self._context)
        self._solver.set("timeout", TIMEOUT_MS)
        self._nodes = self._define()
        self._samples = [] if has_comparisons(ways) else samples(ways)[0]

    def _symbol(self, term: Term) -> z3.ExprRef:
        number = any(
            term.text in (atom.left.text, atom.right.text) for atom in self.ways.atoms if isinstance(atom, Comparison)
        )
        return (z3.Real if number else z3.Bool)(term.text, self._context)

    def _number(self, term: Term) -> z3.ArithRef:
        if term.kind == "call":
            return self._symbols[term.text]
        assert isinstance(term.value, float)
        return z3.RealVal(str(_exact(term.value)), self._context)

    def _atom(self, number: int) -> z3.BoolRef:
        atom = self.ways.atoms[number]
        if isinstance(atom, Percept):
            return self._symbols[atom.text]
        left, right = self._number(atom.left), self._number(atom.right)
        match atom.operator:
            case "<":
                return left < right
            case "<=":
                return left <= right
            case ">":
                return left > right
            case ">=":
                return left >= right
            case "=":
                return left == right
            case "/=":
                return left != right

    def _define(self) -> list[z3.BoolRef]:
        """One literal for each guard, defined by those of its operands."""
        nodes: list[z3.BoolRef] = []
        for number, (kind, a, b) in enumerate(self.ways.guards.nodes):
            node = z3.Bool(f"guard {number}", self._context)
            match kind:
                case "constant":
                    meaning = z3.BoolVal(bool(a), self._context)
                case "atom":
                    meaning = self._atom(a)
                case "not":
                    meaning = z3.Not(nodes[a])
                case "and":
                    meaning = z3.And(nodes[a], nodes[b])
                case "or":
                    meaning = z3.Or(nodes[a], nodes[b])
            self._solver.add(node == meaning)
            nodes.append(node)
        return nodes

    def possible(self, guard: int) -> bool | Undecided:
        """Whether a guard can hold. A sample that shows it spares the proof."""
        if self._samples and self._samples[guard]:
            return True
        answer = self._solver.check(self._nodes[guard])
        return Undecided() if answer == z3.unknown else bool(answer == z3.sat)

    def witness(self, guard: int) -> Witness | Undecided | None:
        """The simplest situation in which the guard holds; None if there is none."""
        answer = self._solver.check(self._nodes[guard])
        if answer != z3.sat:
            return Undecided() if answer == z3.unknown else None
        self._solver.push()
        self._solver.add(self._nodes[guard])
        witness = self._simplest(self._solver)
        self._solver.pop()
        return witness

    def _simplest(self, solver: z3.Solver) -> Witness:
        self._fewest_true(solver)
        values: dict[str, bool | float] = {}
        for term in self.percepts:
            symbol = self._symbols[term.text]
            if z3.is_bool(symbol):
                values[term.text] = self._settle(solver, [z3.Not(symbol), symbol]) == 1
            else:
                values[term.text] = self._simplest_number(solver, term, symbol)
        return values

    def _fewest_true(self, solver: z3.Solver) -> None:
        flags = [(symbol, 1) for symbol in self._symbols.values() if z3.is_bool(symbol)]
        for most in range(len(flags)):
            if self._settle(solver, [z3.PbLe(flags, most)]) == 0:
                return

    def _settle(self, solver: z3.Solver, options: list[z3.BoolRef]) -> int | None:
        """Adds the first option that is possible and gives its number."""
        for number, option in enumerate(options):
            if solver.check(option) == z3.sat:
                solver.add(option)
                return number
        return None

    def _simplest_number(self, solver: z3.Solver, term: Term, symbol: z3.ArithRef) -> float:
        candidates = self._candidates(term)
        found = self._settle(solver, [symbol == z3.RealVal(str(value), self._context) for value in candidates])
        if found is not None:
            return float(candidates[found])
        solver.check()
        value = solver.model().eval(symbol, model_completion=True)
        fraction = value.approx(12).as_fraction() if z3.is_algebraic_value(value) else value.as_fraction()
        solver.add(symbol == value)
        return float(fraction)

    def _candidates(self, term: Term) -> list[Fraction]:
        """Zero, what it is compared with, and values between and beyond, the nearest to zero first."""
        bounds = {Fraction(0)}
        for atom in self.ways.atoms:
            if isinstance(atom, Comparison) and term.text in (atom.left.text, atom.right.text):
                bounds |= {_exact(side.value) for side in (atom.left, atom.right) if isinstance(side.value, float)}
        ordered = sorted(bounds)
        between = [(a + b) / 2 for a, b in pairwise(ordered)]
        return sorted({*ordered, *between, ordered[0] - 1, ordered[-1] + 1}, key=lambda value: (abs(value), -value))

    def taken_ways(self, limit: int) -> Iterator[Witness]:
        """A situation for each way that can be taken, at most `limit`; in the order in which z3 comes upon them."""
        guards = [self._nodes[guard] for guard in dict.fromkeys(self.ways.signature())]
        self._solver.push()
        self._solver.add(z3.Not(self._nodes[self.ways.hole]))
        for _ in range(limit):
            if self._solver.check() != z3.sat:
                break
            model = self._solver.model()
            yield self._read(model)
            seen = [z3.is_true(model.eval(guard, model_completion=True)) for guard in guards]
            self._solver.add(z3.Or([z3.Not(g) if value else g for g, value in zip(guards, seen, strict=True)]))
        self._solver.pop()

    def _read(self, model: z3.ModelRef) -> Witness:
        values: dict[str, bool | float] = {}
        for term in self.percepts:
            value = model.eval(self._symbols[term.text], model_completion=True)
            if z3.is_bool(value):
                values[term.text] = z3.is_true(value)
            else:
                values[term.text] = float(value.as_fraction())
        return values


def _exact(value: float) -> Fraction:
    """The number as the text says it (0.2 is one fifth)."""
    return Fraction(repr(value))


def find(ways: Ways, *, allow_holes: bool = False) -> tuple[Diagnostic, ...]:
    """What is to be said of the situations of a plan."""
    situations = Situations(ways)
    return (*_holes(situations, allow_holes), *_dead(situations))


def describe(witness: Witness, ways: Ways) -> str:
    """A witness in words."""
    units = {term.text: term.type.unit for term in ways.goals.percepts() if term.type is not None}
    parts = [
        (text if value else f"not {text}")
        if isinstance(value, bool)
        else f"{text} = {canonical_number(value, units.get(text, ''))}"
        for text, value in witness.items()
    ]
    return " and ".join(parts) if parts else "always"


def _holes(situations: Situations, allow_holes: bool) -> Iterator[Diagnostic]:
    ways = situations.ways
    witness = situations.witness(ways.hole)
    if isinstance(witness, Undecided):
        yield Diagnostic("not-decided", "warning", "whether the plan has a hole could not be decided", ways.goals.span)
    elif witness is not None:
        clash = _clashing(ways, witness)
        yield Diagnostic(
            "hole",
            "warning" if allow_holes else "error",
            f"there is a situation in which no way is open: {_words(clash)}",
            clash[0].span if clash else ways.goals.top.span,
            tuple(Related(f"and here to {do.value.text}", do.span) for do in clash[1:]),
            "let one of them be given up (`prio-and`), or add conditions that keep them apart",
            describe(witness, ways),
        )


def _words(clash: list[Do]) -> str:
    if not clash:
        return "no alternative of what must be done goes together with the rest"
    first, second = clash
    return f"`{first.output}` must be set to {first.value.text} and to {second.value.text}"


def _clashing(ways: Ways, witness: Witness) -> list[Do]:
    """Two acts that must both be and set one output to two values in this situation."""
    values = ways.guards.evaluate([atom_value(atom, witness) for atom in ways.atoms])
    must: dict[str, Do] = {}
    passed = [True] * len(ways.layout.nodes)
    for node in ways.layout.nodes:
        if node.parent >= 0:
            passed[node.number] = passed[node.parent] and _branch(ways, node.number, values)
        goal = node.goal
        if isinstance(goal, Do) and passed[node.number] and node.owner == 0 and not node.under:
            other = must.setdefault(goal.output, goal)
            if other.value.text != goal.value.text:
                return [other, goal]
    return []


def _branch(ways: Ways, number: int, values: list[bool]) -> bool:
    parent = ways.layout.nodes[number].parent
    inside = ways.layout.inside[parent]
    if not isinstance(ways.layout.nodes[parent].goal, If):
        return True
    return values[ways.asked[parent]] == (inside[0] == number)


def atom_value(atom: Percept | Comparison, witness: Witness) -> bool:
    """Whether an atom holds in a situation."""
    if isinstance(atom, Percept):
        return bool(witness[atom.text])
    left, right = (
        witness[term.text] if term.kind == "call" else float(term.value or 0.0) for term in (atom.left, atom.right)
    )
    return compare(atom.operator, left, right)


def _dead(situations: Situations) -> Iterator[Diagnostic]:
    """Acts that are never taken, one finding a place in the text."""
    ways = situations.ways
    guards: dict[tuple[str, Span], list[int]] = {}
    acts: dict[tuple[str, Span], Do] = {}
    for node in ways.layout.nodes:
        if isinstance(node.goal, Do):
            key = (node.goal.value.text, node.goal.span)
            guards.setdefault(key, []).append(ways.reached[node.number])
            acts.setdefault(key, node.goal)
    for key, do in acts.items():
        if all(situations.possible(guard) is False for guard in guards[key]):
            yield Diagnostic(
                "dead", "warning",
                f"`(do {do.output} {do.value.text})` is never done, whatever the situation",
                do.span,
            )  # fmt: skip
