"""What a tick of a plan costs: `python tests/benchmarks/bench_tick.py`. Run by hand; it asserts nothing.

Takes: the plans of the project. Gives: a table with the machine and versions. Leaves alone: whether that is fast
enough. Every figure is the median of nine batches, so that a busy machine shows less.
"""

from __future__ import annotations

import os
import platform
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from importlib.metadata import version
from itertools import product
from pathlib import Path

from rplan.apps.simulation import load_world, simulate
from rplan.apps.wiring import compile_file, decider
from rplan.backends.interpreter import Interpreter
from rplan.backends.python import PythonEngine
from rplan.runtime.encode import encoder
from rplan.runtime.trace import Trace

ROOT = Path(__file__).parents[2]
FIGURE = ROOT / "plans" / "figure_1" / "text.rplan"
FETCH = ROOT / "plans" / "find_and_fetch" / "find_and_fetch.rplan"
LOT = FETCH.parent / "parking_lot.yaml"
BATCHES = 9


def each(work: Callable[[], object], times: int) -> float:
    """Microseconds a call."""
    batches = []
    for _ in range(BATCHES):
        begin = time.perf_counter()
        for _ in range(times):
            work()
        batches.append((time.perf_counter() - begin) / times * 1e6)
    return statistics.median(batches)


def decisions() -> list[tuple[str, str]]:
    """The plan alone, on every one of the 4,096 situations of Figure 1."""
    compiled = compile_file(FIGURE, allow_holes=True)
    names = [term.text for term in compiled.goals.percepts()]
    bits = list(product((False, True), repeat=len(names)))
    percepts = [dict(zip(names, values, strict=True)) for values in bits]
    generated, reference = PythonEngine(compiled.circuit), Interpreter(compiled.circuit)
    encode, decide, trace = encoder(compiled.goals, compiled.ways.atoms), decider(compiled), Trace(compiled.ways)

    def over(one: Callable[[Sequence[bool]], object]) -> str:
        return f"{each(lambda: [one(inputs) for inputs in bits], 1) / len(bits):.2f} us"

    def over_percepts(one: Callable[[Mapping[str, bool]], object]) -> str:
        return f"{each(lambda: [one(values) for values in percepts], 1) / len(percepts):.2f} us"

    return [
        ("tick of the circuit, generated Python", over(generated.tick)),
        ("tick of the circuit, reference interpreter", over(reference.tick)),
        ("encode percepts", over_percepts(encode)),
        ("decide: encode, tick, decode, idle values", over_percepts(decide.tick)),
        ("decide and put it into a line of JSON", over_percepts(lambda v: trace.line(0, decide.tick(v)))),
    ]


def loops() -> list[tuple[str, str]]:
    """Find and fetch in the parking lot: percepts, plan, competences, 30 sonars, beacon reader, cameras, pymunk."""
    compiled, lot = compile_file(FETCH), load_world(LOT)

    def factor(record: Path | None) -> str:
        factors = [simulate(compiled, lot, 0, record=record).real_time_factor for _ in range(3)]
        return f"{statistics.median(factors):.0f} times real time"

    with tempfile.TemporaryDirectory() as folder:
        return [
            ("whole loop, find and fetch with seed 0", factor(None)),
            ("whole loop, recorded", factor(Path(folder) / "run.mcap")),
        ]


def starts() -> list[tuple[str, str]]:
    """From the shell."""

    def start(*arguments: str) -> str:
        command = [str(Path(sys.executable).parent / "rplan"), *arguments]
        milliseconds = each(lambda: subprocess.run(command, check=True, capture_output=True), 1) / 1e3
        return f"{milliseconds:.0f} ms"

    return [("rplan --help", start("--help")), ("rplan check plans/find_and_fetch", start("check", str(FETCH)))]


def main() -> None:
    """Print the table."""
    packages = ("rplan", "numpy", "pymunk", "z3-solver", "foxglove-sdk")
    print(f"{processor()}, {os.cpu_count()} cores, {platform.system()}, Python {platform.python_version()}")
    print(", ".join(f"{name} {version(name)}" for name in packages))
    for measure in (decisions, loops, starts):
        for name, value in measure():
            print(f"{name:<48}{value:>22}", flush=True)


def processor() -> str:
    """Its name, as far as the system tells it."""
    told = Path("/proc/cpuinfo")
    lines = told.read_text(encoding="utf-8").splitlines() if told.exists() else []
    return next((line.partition(":")[2].strip() for line in lines if line.startswith("model name")), platform.machine())


if __name__ == "__main__":
    main()
