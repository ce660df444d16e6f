"""Situations in which two plans set their outputs differently.

Takes: the `Ways` of two plans. Gives: `Difference`s: cubes of conditions, each with the simplest trace, and what
either plan does there; or that there is none, proven. Leaves alone: competences; canonical text is all that is
compared.

Both plans run side by side from the first tick on. Percepts of the same canonical text are the same percept.
Compared are the outputs as the ways set them and whether there is a hole; where both leave an output open, what
stands in its place (`:idle`, `:hold`).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import z3

from rplan.goals.condition import Atom, Comparison, Percept, percept_terms
from rplan.goals.goal import And, Output
from rplan.ways.guards import FALSE, Guards
from rplan.ways.memory import Register
from rplan.ways.reach import Reach
from rplan.ways.reduce import Ways
from rplan.ways.situations import Trace, Undecided, Unrolling, negated, replay
from rplan.ways.way import TakenWay, taken_way

MOST_CUBES = 64
HOLE = "hole"


@dataclass(frozen=True, slots=True)
class Side:
    """What one plan does: canonical text of the value, or what stands in its place; the way with its rules."""

    value: str
    way: TakenWay


@dataclass(frozen=True, slots=True)
class Difference:
    """In every tick that can be and in which `cube` holds, the plans differ so in `output`.

    cube: text of a condition or register -> its value. trace: leads to one such tick.
    """

    output: str
    cube: Mapping[str, bool]
    trace: Trace
    first: Side
    second: Side


@dataclass(frozen=True, slots=True)
class Differences:
    """undecided: some question was too hard. cut_short: there are more."""

    found: tuple[Difference, ...]
    undecided: bool
    cut_short: bool

    @property
    def equal(self) -> bool:
        return not (self.found or self.undecided)


class ClashError(ValueError):
    """A percept is a truth value in one plan and a number in the other."""


def differences(first: Ways, second: Ways) -> Differences:
    """Every difference that can be, as few cubes as come of themselves."""
    return _Pair(first, second).differences()


class _Pair:
    """Two plans as one transition system."""

    def __init__(self, first: Ways, second: Ways) -> None:
        self.plans = (first, second)
        self.guards = Guards()
        self.atoms: dict[str, int] = {}
        self.atom_list: list[Atom] = []
        self.registers: list[tuple[Register, int]] = []
        _check_kinds(first, second)
        self.maps = [self._copied(plan, number) for number, plan in enumerate(self.plans)]
        self.joint = self._joined()

    def _copied(self, plan: Ways, number: int) -> list[int]:
        """Every guard of a plan in the common table."""
        offset = len(self.registers)
        self.registers += [(one, number) for one in plan.registers]
        found: list[int] = []
        for kind, a, b in plan.guards.nodes:
            match kind:
                case "constant":
                    found.append(a)
                case "atom":
                    found.append(self.guards.atom(self._atom(plan.atoms[a])))
                case "register":
                    found.append(self.guards.register(offset + a))
                case "not":
                    found.append(self.guards.negation(found[a]))
                case "and":
                    found.append(self.guards.both(found[a], found[b]))
                case "or":
                    found.append(self.guards.either(found[a], found[b]))
        return found

    def _atom(self, atom: Atom) -> int:
        if atom.text not in self.atoms:
            self.atoms[atom.text] = len(self.atom_list)
            self.atom_list.append(atom)
        return self.atoms[atom.text]

    def _joined(self) -> Ways:
        """A plan that has the guards, percepts and registers of both."""
        first, second = self.plans
        registers = [Register(one.name, one.initial, self.maps[number][one.next]) for one, number in self.registers]
        assumed = [self.maps[number][guard] for number, plan in enumerate(self.plans) for guard in plan.assumed]
        assumptions = (*first.goals.assumptions, *second.goals.assumptions)
        definitions = {f"{n} {name}": c for n, p in enumerate(self.plans) for name, c in p.goals.definitions.items()}
        properties = (*first.goals.properties, *second.goals.properties)
        goals = replace(
            first.goals,
            top=_both(first, second),
            definitions=definitions,
            properties=properties,
            assumptions=assumptions,
        )
        return replace(
            first, goals=goals, guards=self.guards, atoms=tuple(self.atom_list), registers=tuple(registers),
            assumed=tuple(assumed), hole=self.maps[0][first.hole], claims=(), driving=len(registers), on_offer={},
        )  # fmt: skip

    # --- what differs ---

    def differences(self) -> Differences:
        reach = Reach(self.joint)
        found: list[Difference] = []
        undecided = False
        for output, a, b, guard in self._questions():
            while guard != FALSE:
                if len(found) == MOST_CUBES:
                    return Differences(tuple(found), undecided, True)
                trace = reach.trace((guard, True))
                if trace is None or isinstance(trace, Undecided):
                    undecided = undecided or trace is not None
                    break
                cube = self._cube(guard, trace)
                found.append(Difference(output, self._named(cube), trace, *self._sides(trace, a, b)))
                guard = self.guards.but_not(guard, self.guards.all_of(self._literal(*one) for one in cube))
        return Differences(tuple(found), undecided, False)

    def _questions(self) -> Iterator[tuple[str, str, str, int]]:
        """Output, what either plan sets it to, and where."""
        first, second = (self._values(number) for number in (0, 1))
        for output in dict.fromkeys((*first, *second)):
            nothing = {"nothing": self.guards.negation(FALSE)}
            for a, where_a in first.get(output, nothing).items():
                for b, where_b in second.get(output, nothing).items():
                    if a != b:
                        yield output, a, b, self.guards.both(where_a, where_b)

    def _values(self, number: int) -> dict[str, dict[str, int]]:
        """For each output its values and where it has them; the last one is what stands where it is open."""
        plan, of = self.plans[number], self.maps[number]
        found: dict[str, dict[str, int]] = {
            HOLE: {"no way is open": of[plan.hole], "a way is open": self.guards.negation(of[plan.hole])}
        }
        for output in plan.goals.outputs:
            values = {text: of[guard] for text, guard in plan.sets.get(output.name, {}).items()}
            unset = self.guards.negation(self.guards.any_of(values.values()))
            found[output.name] = values | {_unset(output): unset}
        return found

    def _sides(self, trace: Trace, a: str, b: str) -> tuple[Side, Side]:
        first, second = (
            Side(value, taken_way(plan, seen.atoms, seen.registers))
            for plan, value in zip(self.plans, (a, b), strict=True)
            for seen in [replay(plan, trace)]
        )
        return first, second

    # --- cubes ---

    def _literal(self, kind: str, number: int, value: bool) -> int:
        guard = self.guards.atom(number) if kind == "atom" else self.guards.register(number)
        return guard if value else self.guards.negation(guard)

    def _cube(self, guard: int, trace: Trace) -> list[tuple[str, int, bool]]:
        """The literals of the last tick that alone bring the difference about; none of them can be spared."""
        seen = replay(self.joint, trace)
        cube = [("atom", n, value) for n, value in enumerate(seen.atoms)]
        cube += [("register", n, value) for n, value in enumerate(seen.registers)]
        unrolling = Unrolling(self.joint, first=False)
        wanted = [negated(unrolling.literal(0, guard)), *unrolling.assumed(1)]
        literals: dict[int, tuple[z3.BoolRef, tuple[str, int, bool]]] = {}
        for kind, number, value in cube:
            one = unrolling.literal(0, self._literal(kind, number, value))
            literals.setdefault(one.get_id(), (one, (kind, number, value)))
        if unrolling.check([*wanted, *(one for one, _ in literals.values())]) is not False:
            return cube
        core = {one.get_id() for one in unrolling.solver.unsat_core()}
        kept = [pair for name, pair in literals.items() if name in core]
        for pair in list(kept):
            fewer = [one for one in kept if one is not pair]
            if unrolling.check([*wanted, *(one for one, _ in fewer)]) is False:
                kept = fewer
        return [name for _, name in kept]

    def _named(self, cube: list[tuple[str, int, bool]]) -> dict[str, bool]:
        named = {}
        for kind, number, value in cube:
            if kind == "atom":
                named[self.atom_list[number].text] = value
            else:
                named[f"{self.registers[number][0].name} before"] = value
        return named


def _unset(output: Output) -> str:
    """What stands where an output is open."""
    if output.hold:
        return f"its last value (at first {output.initial.text if output.initial else 'nothing'})"
    return "nothing" if output.idle is None else f"nothing, so {output.idle.text}"


def _check_kinds(first: Ways, second: Ways) -> None:
    for a, b in ((first, second), (second, first)):
        truths = {atom.text for atom in a.atoms if isinstance(atom, Percept)}
        for atom in b.atoms:
            if isinstance(atom, Comparison):
                for term in percept_terms(atom):
                    if term.text in truths:
                        raise ClashError(f"`{term.text}` is a truth value in one plan and a number in the other")


def _both(first: Ways, second: Ways) -> And:
    return And((first.goals.top, second.goals.top), first.goals.top.span)
