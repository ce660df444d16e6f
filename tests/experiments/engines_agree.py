"""Random plans with memory: every engine says in every tick what the reference meaning says.

Run by hand: `python tests/experiments/engines_agree.py --plans 10000 --ticks 40`. Plans come as text, through the whole
pipeline; chance is numpy's, from `--seed`. `--without-c` leaves out the engine that needs a C compiler for each plan.
Prints how many plans and ticks were compared, and stops with exit code 1 at the first that differs, with its text.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np

from rplan.backends.c import CEngine
from rplan.backends.interpreter import Interpreter
from rplan.backends.packed import PackedEngine, pack, unpack
from rplan.backends.python import PythonEngine
from rplan.circuit import passes
from rplan.circuit.build import build
from rplan.circuit.circuit import Circuit
from rplan.circuit.evaluate import Bits
from rplan.goals.expand import expand
from rplan.lang.parse import parse_text
from rplan.lang.source import Source
from rplan.ways.meaning import Situation, taken
from rplan.ways.reduce import Ways, reduce

ATOMS = ("alpha", "beta", "gamma", "(< near 1m)")
OUTPUTS = ("left", "right")
VALUES = ("(go)", "(stay)", "(turn)")
ONE = ("once", "historically", "rose", "fell")


class Author:
    """Writes random plans."""

    def __init__(self, chance: np.random.Generator) -> None:
        self.chance = chance

    def pick(self, *options: str) -> str:
        return options[int(self.chance.integers(len(options)))]

    def condition(self, depth: int) -> str:
        """A condition, often with memory."""
        if depth == 0 or self.chance.random() < 0.25:
            return self.pick(*ATOMS)
        inner = self.condition(depth - 1)
        other = self.condition(depth - 1)
        span = f"{int(self.chance.integers(1, 9)) / 10:g}s"
        count = int(self.chance.integers(1, 7))
        return self.pick(
            f"(not {inner})",
            f"(and {inner} {other})",
            f"(or {inner} {other})",
            f"({self.pick(*ONE)} {inner})",
            f"({self.pick('since', 'latch')} {inner} {other})",
            f"(delay {self.pick('true', 'false')} {inner})",
            f"({self.pick('held-for', 'within')} {span} {inner})",
            f"(at-least {count} {inner} :reset {other})",
        )

    def goal(self, depth: int) -> str:
        """A goal that often conflicts with its neighbours."""
        if depth == 0 or self.chance.random() < 0.2:
            return self.pick(f"(do {self.pick(*OUTPUTS)} {self.pick(*VALUES)})", "(do anything)")
        parts = " ".join(self.goal(depth - 1) for _ in range(int(self.chance.integers(1, 4))))
        return self.pick(
            f"(if {self.condition(2)} {self.goal(depth - 1)} {self.goal(depth - 1)})",
            f"(prio-and {parts})",
            f"(and {parts})",
            f"(or {parts})",
        )

    def plan(self) -> str:
        """A whole plan."""
        return f"(declare (near) (number m))\n(goalem {self.goal(3)})\n"


def reduced(text: str) -> Ways:
    """The ways of a plan; holes are part of the meaning."""
    goals, _ = expand(parse_text(Source("random.rplan", text))[0], {})
    return reduce(goals)


def packed(circuit: Circuit) -> Callable[[Bits], Bits]:
    """The packed engine, for 65 robots that are given the same."""
    engine = PackedEngine(circuit, 65)

    def tick(inputs: Bits) -> Bits:
        rows = np.array([[bit] * 65 for bit in inputs], np.bool_).reshape(len(inputs), 65)
        bits = unpack(engine.tick(pack(rows)), 65)
        assert (bits == bits[:, :1]).all()
        return tuple(map(bool, bits[:, 0]))

    return tick


def differs(ways: Ways, ticks: int, chance: np.random.Generator, folder: Path | None) -> str:
    """What an engine says otherwise than the reference; "" if nothing."""
    circuit = passes.run(build(ways))
    engines: dict[str, Callable[[Bits], Bits]] = {
        "interpreter": Interpreter(circuit).tick,
        "python": PythonEngine(circuit).tick,
        "packed": packed(circuit),
    }
    if folder is not None:
        engines["c"] = CEngine(circuit, folder).tick
    names = [port.name for port, _ in circuit.outputs]
    situation: Situation | None = None
    for number in range(ticks):
        bits = tuple(map(bool, chance.integers(0, 2, len(ways.atoms))))
        atoms = {atom.text: bit for atom, bit in zip(ways.atoms, bits, strict=True)}
        situation = Situation(atoms.__getitem__, situation, ways.goals.definitions)
        way = taken(ways.goals.top, situation)
        wanted = {"hole"} if way is None else {f"{output}={value}" for output, value in way.acts}
        for name, tick in engines.items():
            said = {port for port, bit in zip(names, tick(bits), strict=True) if bit}
            if said != wanted:
                return f"{name} in tick {number}: {sorted(said)} instead of {sorted(wanted)}"
    return ""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--plans", type=int, default=200)
    parser.add_argument("--ticks", type=int, default=40)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--without-c", action="store_true")
    wanted = parser.parse_args()
    chance = np.random.default_rng(wanted.seed)
    author = Author(chance)
    remembering = 0
    with tempfile.TemporaryDirectory() as folder:
        for number in range(wanted.plans):
            text = author.plan()
            ways = reduced(text)
            remembering += bool(ways.registers)
            said = differs(ways, wanted.ticks, chance, None if wanted.without_c else Path(folder))
            if said:
                print(f"plan {number} differs: {said}\n{text}")
                return 1
    engines = 3 if wanted.without_c else 4
    ticks = wanted.plans * wanted.ticks
    print(f"{wanted.plans:,} plans ({remembering:,} with memory) × {wanted.ticks} ticks = {ticks:,} ticks:")
    print(f"{engines} engines equal the reference meaning in every one")
    return 0


if __name__ == "__main__":
    sys.exit(main())
