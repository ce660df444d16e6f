"""Random plans and ticks, and what the reference meaning says of every explanation of them.

Takes: a numpy generator. Gives: plans as text with memory, numbers and assumptions; `differs`, what `why` or `why-not`
says otherwise than trying every combination of percepts does. Leaves alone: how many; see test_why.py here and
tests/experiments/explanations_agree.py.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations, product

import numpy as np
from experiments.engines_agree import Author, reduced

from rplan.circuit import passes
from rplan.circuit.build import build
from rplan.circuit.evaluate import Bits, evaluate, first_registers
from rplan.goals.condition import Comparison, percept_terms
from rplan.runtime.encode import encoder
from rplan.ways.meaning import Situation, holds, taken
from rplan.ways.reduce import Ways
from rplan.ways.why import Reasons, Why
from rplan.ways.why_not import Changes, Wanted, WhyNot

ATOMS = (
    "alpha",
    "beta",
    "gamma",
    "(< near 1m)",
    "(>= near 2.5m)",
    "(< near far)",
    "(= far 1m)",
    "(> (+ near far) 3.9m)",
)
REAL = (0.25, 1.0, 1.75, 2.5, 3.25)
"""Numbers that a tick may have."""
EVERY = tuple(n / 4 - 1 for n in range(25))
"""Numbers below, between and beyond those and all bounds."""

Values = dict[str, bool | float]
Acts = frozenset[tuple[str, str]] | None
"""What a way sets; None: no way is open."""


class Asker(Author):
    """Writes plans with numbers and assumptions as well."""

    def condition(self, depth: int) -> str:
        if depth == 0 or self.chance.random() < 0.3:
            return self.pick(*ATOMS)
        return super().condition(depth)

    def plan(self) -> str:
        assumed = self.pick("", "", f"(assume (or {self.pick(*ATOMS)} (not {self.pick(*ATOMS)})))\n")
        declared = "(declare (near) (number m))\n(declare (far) (number m))\n"
        return f"{declared}{assumed}(goalem {self.goal(3)})\n"


@dataclass(frozen=True, slots=True)
class Tick:
    """A tick of a random run: values of its percepts, atoms, registers, and the ticks before."""

    values: Values
    atoms: Bits
    registers: Bits
    before: Situation | None


class Trial:
    """One plan, and every combination of percepts after some past."""

    def __init__(self, plan: str | Ways) -> None:
        self.ways = reduced(plan) if isinstance(plan, str) else plan
        self.circuit = passes.run(build(self.ways))
        self.names = [port.name for port, _ in self.circuit.outputs]
        self.asked = self.ways.atoms[: self.ways.asking]
        numbers = [t.text for atom in self.asked if isinstance(atom, Comparison) for t in percept_terms(atom)]
        self._encode = encoder(self.ways.goals, self.asked)
        self.percepts = {term.text: term.text in numbers for term in self.ways.goals.percepts(driving=True)}

    def random(self, chance: np.random.Generator, ticks: int) -> Iterator[Tick]:
        registers = first_registers(self.circuit)
        before: Situation | None = None
        for _ in range(ticks):
            values: Values = {
                text: REAL[int(chance.integers(len(REAL)))] if number else bool(chance.integers(2))
                for text, number in self.percepts.items()
            }
            atoms = self.atoms(values)
            yield Tick(values, atoms, registers, before)
            before = self.situation(atoms, before)
            _, registers = evaluate(self.circuit, registers, atoms)

    def atoms(self, values: Values) -> Bits:
        return self._encode(values)

    def situation(self, atoms: Bits, before: Situation | None) -> Situation:
        known = {atom.text: value for atom, value in zip(self.asked, atoms, strict=True)}
        return Situation(known.__getitem__, before, self.ways.goals.definitions)

    def acts(self, atoms: Bits, before: Situation | None) -> Acts:
        """What the reference meaning does."""
        way = taken(self.ways.goals.top, self.situation(atoms, before))
        return None if way is None else frozenset(way.acts)

    def done(self, atoms: Bits, registers: Bits) -> Acts:
        """What the circuit does."""
        bits, _ = evaluate(self.circuit, registers, atoms)
        said = [name for name, bit in zip(self.names, bits, strict=True) if bit]
        return None if "hole" in said else frozenset((a, b) for a, _, b in (name.partition("=") for name in said))

    def assumed(self, atoms: Bits) -> bool:
        """Whether the assumptions hold, as far as they ask what the plan asks."""
        return all(holds(one.condition, self.situation(atoms, None)) for one in self.ways.goals.assumptions)

    @cached_property
    def every(self) -> list[tuple[Values, Bits]]:
        """Every combination of percepts that can make a difference."""
        domains = [EVERY if number else (False, True) for number in self.percepts.values()]
        found = (dict(zip(self.percepts, values, strict=True)) for values in product(*domains))
        return [(values, self.atoms(values)) for values in found]


def usable(trial: Trial) -> bool:
    """Whether assumptions ask nothing but what the plan asks, and few combinations are to be tried."""
    return len(trial.ways.atoms) == trial.ways.asking and trial.ways.driving <= 6 and len(trial.asked) > 0


def differs(trial: Trial, tick: Tick) -> str:
    """What an explanation of this tick says otherwise than the reference; "" if nothing."""
    every = trial.every
    real = {atoms: trial.acts(atoms, tick.before) for atoms in dict.fromkeys(atoms for _, atoms in every)}
    can_be = {atoms: acts for atoms, acts in real.items() if trial.assumed(atoms)}
    why = Reasons(trial.ways).why(tick.atoms, tick.registers)
    said = wrong_why(trial, tick, why, can_be if trial.assumed(tick.atoms) else real)
    for wanted in wishes(trial.ways):
        known = Changes(trial.ways, wanted).why_not(tick.atoms, tick.registers, tick.values)
        said = said or wrong_change(
            trial, tick, wanted, known, smallest_of(trial, [tick.values], every, can_be, wanted)
        )
        like = [values for values, atoms in every if atoms == tick.atoms]
        unknown = Changes(trial.ways, wanted).why_not(tick.atoms, tick.registers)
        said = said or wrong_change(trial, tick, wanted, unknown, smallest_of(trial, like, every, can_be, wanted))
    return said


def wishes(ways: Ways) -> list[Wanted]:
    """Every value of every output, each open, and two together."""
    single: list[Wanted] = [{output: value} for output, values in ways.sets.items() for value in (*values, None)]
    both = [{output: next(iter(values)) for output, values in ways.sets.items()}] if len(ways.sets) > 1 else []
    return [*single, *both]


# --- why ------------------------------------------------------------------------------------------------


def wrong_why(trial: Trial, tick: Tick, why: Why, can_be: Mapping[Bits, Acts]) -> str:
    acts = can_be[tick.atoms]
    numbers = tuple(n for n, atom in enumerate(trial.asked) if atom.text in {one.text for one in why.literals})
    others = [atoms for atoms, other in can_be.items() if other != acts]
    best = next(
        chosen
        for size in range(len(tick.atoms) + 1)
        for chosen in combinations(range(len(tick.atoms)), size)
        if all(any(atoms[n] != tick.atoms[n] for n in chosen) for atoms in others)
    )
    if not why.smallest or numbers != best:
        return f"why: literals {numbers} instead of {best} (smallest: {why.smallest})"
    if any(literal.value != tick.atoms[n] for literal, n in zip(why.literals, numbers, strict=True)):
        return f"why: {why.literals} are not as they were"
    said = None if why.way.hole else frozenset((act.output, act.value) for act in why.way.acts)
    return "" if said == acts else f"why: {said} instead of {acts}"


# --- why not --------------------------------------------------------------------------------------------


def fits(acts: Acts, wanted: Wanted) -> bool:
    return acts is not None and all(dict(acts).get(output) == value for output, value in wanted.items())


def smallest_of(
    trial: Trial, real: list[Values], every: list[tuple[Values, Bits]], can_be: Mapping[Bits, Acts], wanted: Wanted
) -> tuple[int, ...] | None:
    """The percepts of the smallest change, by number, whichever the real values were; None where there is none."""
    names = [*trial.percepts]
    doing = [values for values, atoms in every if fits(can_be.get(atoms), wanted)]
    for size in range(len(names) + 1):
        for change in combinations(range(len(names)), size):
            left = [name for n, name in enumerate(names) if n not in change]
            if {tuple(was[name] for name in left) for was in real} & {tuple(to[name] for name in left) for to in doing}:
                return change
    return None


def wrong_change(trial: Trial, tick: Tick, wanted: Wanted, found: WhyNot, best: tuple[int, ...] | None) -> str:
    where = f"why-not {dict(wanted)}: {found.verdict}"
    if fits(trial.done(tick.atoms, tick.registers), wanted):
        return "" if found.verdict == "already" else where
    if (best is not None) != (found.verdict == "percepts"):
        return f"{where}, but {best}"
    if found.verdict == "never":
        return f"{where}, but it can be" if reachable(trial, wanted) else ""
    if found.verdict == "undecided" or found.way is None:
        return where
    if found.verdict == "kept" and found.registers not in states(trial):
        return f"{where}, {found.past} cannot have been"
    if not fits(trial.done(found.atoms, found.registers), wanted) or not trial.assumed(found.atoms):
        return f"{where}, {found.changes} does not make it happen"
    changed = tuple(n for n, text in enumerate(trial.percepts) if text in {one.percept for one in found.changes})
    if found.verdict == "percepts" and changed != best:
        return f"{where}, {changed} instead of {best}"
    return fed(trial, tick, wanted, found) if found.verdict == "percepts" else ""


def fed(trial: Trial, tick: Tick, wanted: Wanted, found: WhyNot) -> str:
    """The values of a change, where they were known, given to the circuit."""
    if any(one.was is None for one in found.changes):
        return ""
    to = tick.values | {one.percept: one.becomes for one in found.changes if one.becomes is not None}
    fine = fits(trial.done(trial.atoms(to), tick.registers), wanted)
    return "" if fine else f"why-not {dict(wanted)}: {to} does not make it happen"


def reachable(trial: Trial, wanted: Wanted) -> bool:
    """Whether some tick of some run does it, by trying all."""
    return any(fits(trial.done(atoms, state), wanted) for state in states(trial) for atoms in possible(trial))


def possible(trial: Trial) -> list[Bits]:
    """The atoms of every tick that can be."""
    return [atoms for atoms in dict.fromkeys(atoms for _, atoms in trial.every) if trial.assumed(atoms)]


def states(trial: Trial) -> dict[Bits, None]:
    """The registers that can be before some tick."""
    inputs, first = possible(trial), first_registers(trial.circuit)
    seen, waiting = {first: None}, [first]
    while waiting:
        state = waiting.pop()
        for atoms in inputs:
            _, after = evaluate(trial.circuit, state, atoms)
            if after not in seen:
                seen[after] = None
                waiting.append(after)
    return seen
