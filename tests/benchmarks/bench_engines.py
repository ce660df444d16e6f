"""What engines and the compiler cost: `python tests/benchmarks/bench_engines.py`. Run by hand; it asserts nothing.

Takes: Figure 1 and made-up plans of 10 to 10,000 rules. Gives: nanoseconds a robot and tick for every engine, the cost
of encoding percepts, and a table of how circuits and compile times grow, with the machine and versions. Leaves alone:
whether that is fast enough. Every figure is the median of several batches.
"""

from __future__ import annotations

import os
import platform
import resource
import statistics
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from importlib.metadata import version
from itertools import pairwise, product
from pathlib import Path

import numpy as np

from rplan.apps.wiring import compile_file
from rplan.backends.c import CEngine, emit_c, identifier, library
from rplan.backends.interpreter import Interpreter
from rplan.backends.packed import PackedEngine, pack
from rplan.backends.python import PythonEngine, generate
from rplan.circuit import passes
from rplan.circuit.build import build
from rplan.circuit.circuit import Circuit
from rplan.circuit.engine import Engine
from rplan.circuit.stats import stats
from rplan.driver import NO_LIBRARIES, compile_plan, load
from rplan.goals.expand import expand
from rplan.lang.depth import deep_recursion
from rplan.lang.source import Source
from rplan.runtime.encode import encoder
from rplan.ways.reduce import reduce

FIGURE = Path(__file__).parents[2] / "plans" / "figure_1" / "text.rplan"
BATCHES = 9
ROBOTS = 1_000_000
STEPS = 9
"""Rules below each task of a made-up plan; with that of the task itself ten."""


def seconds(work: Callable[[], object]) -> float:
    """The median of several batches."""
    batches = []
    for _ in range(BATCHES):
        begin = time.perf_counter()
        work()
        batches.append(time.perf_counter() - begin)
    return statistics.median(batches)


def engines() -> Iterator[tuple[str, float]]:
    """Nanoseconds a robot and tick over all 4,096 situations of Figure 1; the packed engine over a million robots."""
    compiled = compile_file(FIGURE, allow_holes=True)
    bits = list(product((False, True), repeat=len(compiled.circuit.inputs)))
    names = [term.text for term in compiled.goals.percepts()]
    percepts = [dict(zip(names, values, strict=True)) for values in bits]

    def each(one: Callable[[Sequence[bool]], object]) -> float:
        return seconds(lambda: [one(inputs) for inputs in bits]) / len(bits) * 1e9

    tree: dict[str, Callable[[Sequence[bool]], object]] = {}
    exec(generate(compiled.circuit).source, tree)
    scope: dict[str, Callable[[Sequence[bool]], object]] = {}
    exec(generate(compiled.circuit, most=0).source, scope)
    with tempfile.TemporaryDirectory() as folder:
        single: list[tuple[str, Engine]] = [
            ("interpreter", Interpreter(compiled.circuit)),
            ("python", PythonEngine(compiled.circuit)),
            ("c (through cffi, a tuple in and out)", CEngine(compiled.circuit, Path(folder))),
        ]
        for name, engine in single:
            yield name, each(engine.tick)
    yield "c, called from C", called_from_c(compiled.circuit, bits)
    yield "python, the tree alone", each(tree["tick"])
    yield "python, expressions instead of the tree", each(scope["tick"])
    robots = pack(np.random.default_rng(0).random((len(compiled.circuit.inputs), ROBOTS)) < 0.5)
    packed = PackedEngine(compiled.circuit, ROBOTS)
    yield f"packed, {ROBOTS:,} robots, inputs packed", seconds(lambda: packed.tick(robots)) / ROBOTS * 1e9
    encode = encoder(compiled.goals, compiled.ways.atoms)
    yield "encode, percepts to inputs", seconds(lambda: [encode(values) for values in percepts]) / len(bits) * 1e9


def called_from_c(circuit: Circuit, bits: Sequence[Sequence[bool]]) -> float:
    """Nanoseconds a tick where the loop over all situations is C too."""
    from cffi import FFI

    name, ffi = identifier(circuit.name), FFI()
    signature = "void repeat(long times, long situations, const unsigned char inputs[], unsigned char outputs[])"
    loop = (
        f"{signature} {{ struct {name}_state state; long n, s; {name}_init(&state);\n"
        "for (n = 0; n < times; n++) for (s = 0; s < situations; s++)\n"
        f"{name}_tick(&state, inputs + s * {len(circuit.inputs)}, outputs); }}\n"
    )
    ffi.cdef(signature + ";")
    with tempfile.TemporaryDirectory() as folder:
        repeat = ffi.dlopen(str(library(emit_c(circuit) + loop, Path(folder)))).repeat
        inputs, outputs = bytes(bit for row in bits for bit in row), ffi.new(f"unsigned char[{len(circuit.outputs)}]")
        return seconds(lambda: repeat(100, len(bits), inputs, outputs)) / 100 / len(bits) * 1e9


def synthetic(rules: int) -> str:
    """A plan of so many rules: tasks in the order of their priority, each with a chain of nine steps."""
    tasks = max(1, rules // (STEPS + 1))
    lines = ["(plan synthetic)"]
    lines += [f"(declare (asked-{task}) bool)" for task in range(tasks)]
    lines += [f"(declare (ready-{task}-{step}) bool)" for task in range(tasks) for step in range(STEPS)]
    for task in range(tasks):
        lines.append(f"(defgoalr (ach task-{task}) (if (asked-{task}) (ach step-{task}-0) (do anything)))")
        for step in range(STEPS):
            later = f"(ach step-{task}-{step + 1})" if step < STEPS - 1 else "(do anything)"
            act = f"(do channel-{step % 4} (act-{task % 20}))"
            lines.append(f"(defgoalr (ach step-{task}-{step}) (if (ready-{task}-{step}) {act} {later}))")
    return "\n".join([*lines, f"(goalem (prio-and {' '.join(f'(ach task-{task})' for task in range(tasks))}))"])


def growth(rules: int) -> list[str]:
    """One line of the table: rules, gates, depth, seconds of each stage and of the whole, memory."""
    source = Source("synthetic.rplan", synthetic(rules))
    begin = time.perf_counter()
    compile_plan(source, allow_holes=True)
    whole = time.perf_counter() - begin
    marks = [time.perf_counter()]

    def mark() -> None:
        marks.append(time.perf_counter())

    with deep_recursion():
        plan = load(source).plan
        mark()
        goals, _ = expand(plan, NO_LIBRARIES)
        mark()
        ways = reduce(goals)
        mark()
        built = build(ways)
        mark()
        circuit = passes.run(built)
        mark()
        generated = generate(circuit)
        mark()
    costs = stats(circuit)
    took = [f"{after - before:.2f}" for before, after in pairwise(marks)]
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    row = [f"{rules:,}", f"{costs.inputs:,}", f"{costs.gates:,}", f"{costs.depth:,}", *took, f"{whole:.2f}"]
    return [*row, f"{memory:,.0f}", f"  {generated.form}"]


COLUMNS = [
    "rules",
    "inputs",
    "gates",
    "depth",
    "read",
    "expand",
    "reduce",
    "build",
    "passes",
    "python",
    "compile",
    "MiB",
    "form",
]


def main(sizes: Sequence[int]) -> None:
    """Print both tables."""
    print(f"{processor()}, {os.cpu_count()} cores, {platform.system()}, Python {platform.python_version()}")
    print(", ".join(f"{name} {version(name)}" for name in ("rplan", "numpy", "cffi")))
    print("\nFigure 1, ns a robot and tick")
    for name, nanoseconds in engines():
        print(f"{name:<48}{nanoseconds:>12.2f}", flush=True)
    print("\nMade-up plans; seconds. compile: the whole of compile_plan, with what it checks; MiB: at most so far")
    print("".join(f"{name:>9}" for name in COLUMNS))
    for rules in sizes:
        print("".join(f"{value:>9}" for value in growth(rules)), flush=True)


def processor() -> str:
    """Its name, as far as the system tells it."""
    told = Path("/proc/cpuinfo")
    lines = told.read_text(encoding="utf-8").splitlines() if told.exists() else []
    return next((line.partition(":")[2].strip() for line in lines if line.startswith("model name")), platform.machine())


if __name__ == "__main__":
    main([int(size) for size in sys.argv[1:]] or [10, 100, 1_000, 10_000])
