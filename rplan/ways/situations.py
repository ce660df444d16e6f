"""Situations of a plan as z3 sees them: ticks in a row, percepts as booleans and real numbers.

Takes: `Ways`. Gives: `Unrolling`, the ticks of a plan in one solver, `Witness`es and what they say of atoms and guards.
Leaves alone: how far to unroll; see reach.py.

`(< d 0.2m)` implies `(< d 0.5m)`, for numbers are exact: 0.2 is one fifth. A guard is defined in a tick when it is
first asked for, so that a question costs no more than the guards that it depends on.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import reduce as fold
from itertools import groupby

import z3

from rplan.goals.condition import Atom, Comparison, Percept, Term, compare, percept_terms, quantity
from rplan.lang.units import canonical_number
from rplan.ways.reduce import Ways

BUDGET = 50_000_000
"""For one question to z3 [its own resource units, the same on every machine]; past it nothing is decided."""

Witness = Mapping[str, bool | float]
"""Canonical text of a percept -> its value (numbers in SI), in textual order."""
Trace = tuple[Witness, ...]
"""One witness a tick, from the first tick on."""
Question = tuple[tuple[int, bool], ...]
"""Guards and the values that all of them have in one tick."""


@dataclass(frozen=True, slots=True)
class Undecided:
    """The budget did not suffice."""


class Unrolling:
    """Ticks of a plan in a row. first: they begin with the first tick; else with any values of the registers."""

    def __init__(self, ways: Ways, *, first: bool) -> None:
        self.ways = ways
        self.context = z3.Context()
        self.solver = z3.SimpleSolver(ctx=self.context)
        self.solver.set("rlimit", BUDGET)
        self._first = first
        self._literals: dict[tuple[int, int], z3.BoolRef] = {}
        self._symbols: dict[tuple[int, str], z3.ExprRef] = {}
        self._numbers = number_percepts(ways)

    def ask(self, tick: int, question: Question) -> list[z3.BoolRef]:
        """The literals of a question in a tick."""
        literals = (self.literal(tick, guard) for guard, _ in question)
        return [one if value else negated(one) for one, (_, value) in zip(literals, question, strict=True)]

    def assumed(self, ticks: int) -> list[z3.BoolRef]:
        """The assumptions of the plan in the first `ticks` ticks."""
        return [self.literal(tick, guard) for tick in range(ticks) for guard in self.ways.assumed]

    def check(self, literals: Sequence[z3.BoolRef]) -> bool | Undecided:
        """Whether they can all be."""
        answer = self.solver.check(*literals)
        return Undecided() if answer == z3.unknown else bool(answer == z3.sat)

    def model(self) -> z3.ModelRef:
        return self.solver.model()

    def literal(self, tick: int, guard: int) -> z3.BoolRef:
        """A guard in a tick; defines it and all that it depends on."""
        stack = [(tick, guard)]
        while stack:
            here = stack[-1]
            if here in self._literals:
                stack.pop()
                continue
            missing = [one for one in self._operands(*here) if one not in self._literals]
            if missing:
                stack.extend(missing)
            else:
                self._literals[here] = self._defined(*here)
        return self._literals[tick, guard]

    def register(self, tick: int, number: int) -> z3.BoolRef:
        """What a register holds in a tick."""
        one = self.ways.registers[number]
        if tick > 0:
            return self.literal(tick - 1, one.next)
        return self.literal(0, int(one.initial)) if self._first else z3.Bool(f"register {number}", self.context)

    def _operands(self, tick: int, guard: int) -> Iterator[tuple[int, int]]:
        kind, a, b = self.ways.guards.nodes[guard]
        match kind:
            case "not" | "and" | "or":
                yield from ((tick, one) for one in dict.fromkeys((a, b)))
            case "register" if tick > 0:
                yield tick - 1, self.ways.registers[a].next
            case _:
                return

    def _defined(self, tick: int, guard: int) -> z3.BoolRef:
        kind, a, b = self.ways.guards.nodes[guard]
        match kind:
            case "register":
                return self.register(tick, a)
            case "not":
                return negated(self._literals[tick, a])
            case "atom" if isinstance(self.ways.atoms[a], Percept):
                return self.symbol(tick, self.ways.atoms[a].text)
            case "constant":
                meaning = z3.BoolVal(bool(a), self.context)
            case "atom":
                meaning = self._comparison(tick, self.ways.atoms[a])
            case "and":
                meaning = z3.And(self._literals[tick, a], self._literals[tick, b])
            case "or":
                meaning = z3.Or(self._literals[tick, a], self._literals[tick, b])
        node = z3.Bool(f"guard {guard} @ {tick}", self.context)
        self.solver.add(node == meaning)
        return node

    # --- percepts ---

    def comparison(self, tick: int, atom: int) -> z3.BoolRef:
        """A literal for an atom that compares numbers, whether or not a guard asks it."""
        name = z3.Bool(f"atom {atom} @ {tick}", self.context)
        self.solver.add(name == self._comparison(tick, self.ways.atoms[atom]))
        return name

    def symbol(self, tick: int, text: str) -> z3.ExprRef:
        """A percept in a tick."""
        if (tick, text) not in self._symbols:
            kind = z3.Real if text in self._numbers else z3.Bool
            self._symbols[tick, text] = kind(f"{text} @ {tick}", self.context)
        return self._symbols[tick, text]

    def symbols(self) -> Mapping[tuple[int, str], z3.ExprRef]:
        """Every percept that has been asked for, by tick and text."""
        return self._symbols

    def _comparison(self, tick: int, atom: Atom) -> z3.BoolRef:
        assert isinstance(atom, Comparison)
        left, right = self._number(tick, atom.left), self._number(tick, atom.right)
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

    def _number(self, tick: int, term: Term) -> z3.ArithRef:
        match term.kind:
            case "call":
                return self.symbol(tick, term.text)
            case "arithmetic":
                return _operate(term.name, [self._number(tick, operand) for operand in term.arguments])
            case _:
                assert isinstance(term.value, float)
                return z3.RealVal(str(exact(term.value)), self.context)


def negated(literal: z3.BoolRef) -> z3.BoolRef:
    """Its opposite, without two negations in a row."""
    return literal.arg(0) if z3.is_not(literal) else z3.Not(literal)


def _operate(operator: str, numbers: Sequence[z3.ArithRef]) -> z3.ArithRef:
    """As `rplan.goals.condition.operate`, of real numbers."""
    first, *others = numbers
    match operator:
        case "+":
            return fold(lambda a, b: a + b, others, first)
        case "-":
            return fold(lambda a, b: a - b, others, first) if others else -first
        case "*":
            return fold(lambda a, b: a * b, others, first)
        case "/":
            return first / others[0]
        case "min":
            return fold(lambda a, b: z3.If(a <= b, a, b), others, first)
        case "max":
            return fold(lambda a, b: z3.If(a >= b, a, b), others, first)
        case _:
            return z3.If(first >= 0, first, -first)


def exact(value: float) -> Fraction:
    """The number as the text says it (0.2 is one fifth)."""
    return Fraction(repr(value))


def number_percepts(ways: Ways) -> dict[str, None]:
    """The percepts that are numbers, in textual order."""
    comparisons = (atom for atom in ways.atoms if isinstance(atom, Comparison))
    return dict.fromkeys(term.text for atom in comparisons for term in percept_terms(atom))


def nothing(ways: Ways) -> dict[str, bool | float]:
    """The situation in which no percept is true and every number is 0."""
    numbers = number_percepts(ways)
    return {term.text: 0.0 if term.text in numbers else False for term in ways.goals.percepts()}


# --- what a witness says ---


def atom_value(atom: Atom, witness: Witness) -> bool:
    """Whether an atom holds in a situation, in floating point as when the plan runs."""
    if isinstance(atom, Percept):
        return bool(witness[atom.text])
    return compare(atom.operator, quantity(atom.left, witness.__getitem__), quantity(atom.right, witness.__getitem__))


@dataclass(frozen=True, slots=True)
class Seen:
    """The last tick of a trace: its atoms, registers and the values of all guards."""

    atoms: tuple[bool, ...]
    registers: tuple[bool, ...]
    guards: list[bool]


def replay(ways: Ways, trace: Trace) -> Seen:
    """What the guards of a plan make of a trace of at least one tick."""
    registers = tuple(one.initial for one in ways.registers)
    for number, witness in enumerate(trace):
        atoms = tuple(atom_value(atom, witness) for atom in ways.atoms)
        values = ways.guards.evaluate(atoms, registers)
        if number < len(trace) - 1:
            registers = tuple(values[one.next] for one in ways.registers)
    return Seen(atoms, registers, values)


def describe(trace: Trace, ways: Ways) -> str:
    """A trace in words: what holds, tick by tick where there are several; equal ticks in a row are said once."""
    units = _units(ways)
    return _by_tick([_say(witness, units) for witness in trace])


def brief(trace: Trace, ways: Ways) -> str:
    """A trace as percepts are given by hand, tick by tick where there are several: what is not named is false or 0."""
    units = _units(ways)
    return _by_tick([_given(witness, units) for witness in trace])


def _units(ways: Ways) -> Mapping[str, str]:
    return {term.text: term.type.unit for term in ways.goals.percepts() if term.type is not None}


def _by_tick(said: Sequence[str]) -> str:
    if len(said) == 1:
        return said[0]
    lines, tick = [], 0
    for text, same in groupby(said):
        last = tick + sum(1 for _ in same) - 1
        lines.append(f"tick {tick}: {text}" if last == tick else f"ticks {tick} to {last}: {text}")
        tick = last + 1
    return "; ".join(lines)


def _say(witness: Witness, units: Mapping[str, str]) -> str:
    parts = [
        (text if value else f"not {text}")
        if isinstance(value, bool)
        else f"{text} = {canonical_number(value, units.get(text, ''))}"
        for text, value in witness.items()
    ]
    return " and ".join(parts) if parts else "always"


def _given(witness: Witness, units: Mapping[str, str]) -> str:
    parts = [
        _key(text) if isinstance(value, bool) else f"{_key(text)}={canonical_number(value, units.get(text, ''))}"
        for text, value in witness.items()
        if value
    ]
    return ", ".join(parts) or "nothing"


def lines(trace: Trace) -> tuple[str, ...]:
    """A trace as `rplan tick` reads it, one JSON object a tick; a call without arguments is its name (L22)."""
    return tuple(json.dumps({_key(text): value for text, value in tick.items()}, ensure_ascii=False) for tick in trace)


def _key(text: str) -> str:
    inner = text[1:-1]
    return text if any(letter in inner for letter in ' ()"') else inner


def cone(ways: Ways, guards: Iterable[int]) -> list[int]:
    """Every node that the guards depend on in any tick, in order."""
    known: dict[int, None] = {}
    stack = [*guards]
    while stack:
        here = stack.pop()
        if here in known:
            continue
        known[here] = None
        kind, a, b = ways.guards.nodes[here]
        if kind in ("not", "and", "or"):
            stack += (a, b)
        elif kind == "register":
            stack.append(ways.registers[a].next)
    return sorted(known)


def registers_in(ways: Ways, guards: Iterable[int]) -> tuple[int, ...]:
    """The registers that the guards depend on in any tick."""
    if not ways.registers:
        return ()
    nodes = (ways.guards.nodes[guard] for guard in cone(ways, guards))
    return tuple(sorted(a for kind, a, _ in nodes if kind == "register"))
