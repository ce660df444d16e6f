"""What can be in some tick of a plan, and when first; decided, never guessed.

Takes: `Ways` and questions (guards and their values in one tick). Gives: whether and in which tick a question can
first be answered, and the simplest trace that does (L26). Leaves alone: what is asked; see checks/, prove.py and
differ.py.

Samples show what is easily possible. Where few registers and atoms bear on the question every combination is tried
(exhaust.py). Else z3 unrolls tick by tick and tries, tick by tick, to show by induction over paths without a
repeated state that it never can be (registers are finite, so that ends); past a limit of ticks z3's Spacer has a go.
What none of them settles within its budget is `Undecided`.
"""

from __future__ import annotations

from collections.abc import Iterable
from itertools import combinations

import z3

from rplan.ways.exhaust import Automaton, automaton
from rplan.ways.reduce import Ways
from rplan.ways.sample import Samples
from rplan.ways.simplest import simplest
from rplan.ways.situations import (
    BUDGET,
    Question,
    Trace,
    Undecided,
    Unrolling,
    cone,
    negated,
    nothing,
    registers_in,
)

EASY = 2
"""Most questions are answered before this tick; only from it on is it asked whether there is an answer at all."""
MOST_TICKS = 40
"""So far z3 unrolls before it turns to Spacer."""
DEEPEST = 400
"""So far z3 unrolls where Spacer says that there is something to be found."""


class Reach:
    """Answers questions about one plan; what it learns for one it uses for the next."""

    def __init__(self, ways: Ways) -> None:
        self.ways = ways
        self._samples: Samples | None = None
        self._from_start = Unrolling(ways, first=True)
        self._anywhere: dict[tuple[int, ...], Unrolling] = {}
        self._automata: dict[tuple[tuple[int, ...], tuple[int, ...]], Automaton | None] = {}
        self._known: dict[Question, int | Undecided | None] = {}

    def possible(self, *question: tuple[int, bool]) -> bool | Undecided:
        """Whether this can be in some tick. A sample that shows it spares the proof."""
        if self._samples is None:
            self._samples = Samples(self.ways)
        if question not in self._known and self._samples.show(question):
            return True
        tick = self.first_tick(*question)
        return tick if isinstance(tick, Undecided) else tick is not None

    def trace(self, *question: tuple[int, bool]) -> Trace | Undecided | None:
        """The simplest trace whose last tick answers the question; None if there is none."""
        tick = self.first_tick(*question)
        if tick is None or isinstance(tick, Undecided):
            return tick
        return self._counted_out(question, tick) or simplest(self.ways, question, tick)

    def _counted_out(self, question: Question, tick: int) -> Trace | None:
        """The simplest trace where every combination can be tried."""
        guards = [*(guard for guard, _ in question), *self.ways.assumed]
        registers = registers_in(self.ways, guards)
        found = self._automaton(registers, guards) if registers else None
        order = {term.text: place for place, term in enumerate(self.ways.goals.percepts())}
        ranked = sorted(range(len(self.ways.atoms)), key=lambda number: order.get(self.ways.atoms[number].text, -1))
        atoms = None if found is None else found.simplest(question, tick, ranked)
        if atoms is None:
            return None
        named = ({self.ways.atoms[number].text: value for number, value in here.items()} for here in atoms)
        return tuple(nothing(self.ways) | here for here in named)

    def first_tick(self, *question: tuple[int, bool]) -> int | Undecided | None:
        """The first tick in which the question can be answered; None if there is none."""
        if question not in self._known:
            self._known[question] = self._decide(question)
        return self._known[question]

    def _decide(self, question: Question) -> int | Undecided | None:
        guards = [*(guard for guard, _ in question), *self.ways.assumed]
        registers = registers_in(self.ways, guards)
        if not registers:
            return self._now(question)
        found = self._automaton(registers, guards)
        if found is not None:
            return found.first_tick(question)
        return self._unroll(question, registers)

    def _now(self, question: Question) -> int | Undecided | None:
        """Without memory every tick is like the first."""
        start = self._from_start
        answer = start.check([*start.ask(0, question), *start.assumed(1)])
        return answer if isinstance(answer, Undecided) else 0 if answer else None

    def _automaton(self, registers: tuple[int, ...], guards: Iterable[int]) -> Automaton | None:
        nodes = [self.ways.guards.nodes[guard] for guard in cone(self.ways, guards)]
        atoms = tuple(sorted(a for kind, a, _ in nodes if kind == "atom"))
        if (registers, atoms) not in self._automata:
            self._automata[registers, atoms] = automaton(self.ways, registers, atoms)
        return self._automata[registers, atoms]

    # --- unrolling, induction, Spacer ---

    def _unroll(self, question: Question, registers: tuple[int, ...]) -> int | Undecided | None:
        limit, tick = MOST_TICKS, 0
        while tick < limit:
            answer = self._in_tick(question, tick)
            if isinstance(answer, Undecided):
                return answer
            if answer:
                return tick
            if tick >= EASY and limit == MOST_TICKS and self._never(question, registers, tick):
                return None
            tick += 1
            if tick == MOST_TICKS and limit == MOST_TICKS:
                answer = spacer(self.ways, question, registers)
                if answer is False:
                    return None
                limit = DEEPEST if answer is True else limit
        return Undecided()

    def _in_tick(self, question: Question, tick: int) -> bool | Undecided:
        start = self._from_start
        return start.check([*start.ask(tick, question), *start.assumed(tick + 1)])

    def _never(self, question: Question, registers: tuple[int, ...], tick: int) -> bool:
        """Whether no path of different states, wherever it begins, comes to it after `tick` ticks without it."""
        path = self._anywhere.setdefault(registers, Unrolling(self.ways, first=False))
        wanted = [*path.ask(tick, question), *path.assumed(tick + 1), *_different(path, registers, tick + 1)]
        for before in range(tick):
            literals = path.ask(before, question)
            wanted.append(negated(literals[0]) if len(literals) == 1 else _named(path, before, question, literals))
        return path.check(wanted) is False


def _named(path: Unrolling, tick: int, question: Question, literals: list[z3.BoolRef]) -> z3.BoolRef:
    """A literal that says that not all of a question holds in a tick."""
    name = z3.Bool(f"not {question} @ {tick}", path.context)
    path.solver.add(z3.Implies(name, z3.Or([negated(one) for one in literals])))
    return name


def _different(path: Unrolling, registers: tuple[int, ...], ticks: int) -> list[z3.BoolRef]:
    """Literals that say that no two of these ticks begin in one state."""
    literals = []
    for a, b in combinations(range(ticks), 2):
        name = z3.Bool(f"different {a} {b}", path.context)
        if b == ticks - 1:
            pairs = [z3.Xor(path.register(a, number), path.register(b, number)) for number in registers]
            path.solver.add(z3.Implies(name, z3.Or(pairs)))
        literals.append(name)
    return literals


def spacer(ways: Ways, question: Question, registers: tuple[int, ...]) -> bool | Undecided:
    """Whether a question can be answered in some tick, by z3's Spacer."""
    path = Unrolling(ways, first=False)
    wanted, assumed = path.ask(0, question), path.assumed(1)
    now = [path.register(0, number) for number in registers]
    following = [path.literal(0, ways.registers[number].next) for number in registers]
    after = [z3.Bool(f"after {number}", path.context) for number in registers]
    kinds = [z3.BoolSort(path.context)] * len(registers)
    reached = z3.Function("reached", *kinds, z3.BoolSort(path.context))
    found = z3.Bool("found", path.context)
    engine = z3.Fixedpoint(ctx=path.context)
    engine.set(engine="spacer", rlimit=BUDGET)
    engine.register_relation(reached, found.decl())
    definitions = path.solver.assertions()
    free = _constants([*definitions, *now, *wanted, *following, *assumed, *after])
    engine.declare_var(*free)
    engine.rule(reached(*(z3.BoolVal(ways.registers[number].initial, path.context) for number in registers)))
    here = [reached(*now), *definitions, *assumed]
    engine.rule(reached(*after), [*here, *(a == b for a, b in zip(after, following, strict=True))])
    engine.rule(found, [*here, *wanted])
    try:
        answer = engine.query(found)
    except z3.Z3Exception:  # so it says at times that its budget is spent
        return Undecided()
    return Undecided() if answer == z3.unknown else bool(answer == z3.sat)


def _constants(expressions: Iterable[z3.ExprRef]) -> list[z3.ExprRef]:
    """The free constants in expressions, once each."""
    seen: dict[int, z3.ExprRef] = {}
    found = []
    stack = [*expressions]
    while stack:
        here = stack.pop()
        if here.get_id() in seen:
            continue
        seen[here.get_id()] = here
        if z3.is_const(here) and here.decl().kind() == z3.Z3_OP_UNINTERPRETED:
            found.append(here)
        stack += here.children()
    return found
