"""What pytest pays for plans: `python tests/benchmarks/bench_plugin.py [FIGURE…]`. Run by hand; it asserts nothing.

Takes: plans of 500 rules of several shapes, written into a temporary folder, and a folder without plans. Gives: what it
takes to collect a plan, one item a rule, and to prove every rule of it, beyond a run of pytest that finds nothing; and
what a project without plans pays for the plugin. Leaves alone: whether that is fast enough. Runs that are compared
alternate, and each figure is the median of the pairs, so that a busy machine shows less. Python's byte code is kept,
as it is in daily use; what the very first run costs is not shown. FIGURE: `none` (no plan) or a shape; else all.

The plugin costs so little where there is no plan that two runs of the same command differ by more. So it is measured in
CPU time, what comes first rotates, and every round has a run without it twice: their difference is what is found where
there is nothing to find. A figure within it says that the cost is below it, and not what it is.
"""

from __future__ import annotations

import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from importlib.metadata import entry_points
from itertools import permutations
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[2]
RULES = 500
COLLECTED, PROVED, ROUNDS = 9, 3, 42
"""So many pairs, or rounds, of runs a figure."""
WITHOUT = ("-p", "no:rplan")
NONE = "none"


# --- plans ---


def head(name: str, percepts: int) -> list[str]:
    """A plan with one command for each rule, and so many percepts."""
    return [
        f'(plan {name} :period 0.1s) (declare (stop) command "") (defoutput action command :idle (stop))',
        *(f'(declare (go{n}) command "")' for n in range(RULES)),
        *(f'(declare (p{n}) bool "")' for n in range(percepts)),
    ]


def top(goals: Iterator[str] | list[str]) -> str:
    return f"(goalem (prio-and {' '.join(goals)}))"


def flat(asked: str = "(p{n})") -> Iterator[str]:
    """Every rule stands in one list of priorities, and asks a percept of its own."""
    yield from head("flat", RULES)
    for n in range(RULES):
        yield f"(defgoalr (ach r{n}) (when {asked.format(n=n)} (do action (go{n}))))"
    yield top([f"(ach r{n})" for n in range(RULES)])


def held() -> Iterator[str]:
    """As `flat`, but what a rule asks is remembered for a while."""
    return flat("(held-for 0.2s (p{n}))")


def nested() -> Iterator[str]:
    """Fifty goals in a list of priorities, each ten rules deep, with percepts that are shared and numbers."""
    yield from head("nested", RULES // 10)
    yield from (f'(declare (d{n}) (number m) "")' for n in range(RULES // 10))
    for n in range(RULES):
        rest = f"(ach r{n + 1})" if (n + 1) % 10 else "(do anything)"
        asked = f"(and (p{n % (RULES // 10)}) (> (d{n // 10}) {1 + n % 10}m))"
        yield f"(defgoalr (ach r{n}) (if {asked} (do action (go{n})) {rest}))"
    yield top([f"(ach r{n})" for n in range(0, RULES, 10)])


def tree() -> Iterator[str]:
    """One goal, and below it two for each."""
    yield from head("tree", RULES)
    for n in range(RULES):
        below = [f"(ach r{child})" for child in (2 * n + 1, 2 * n + 2) if child < RULES]
        then, otherwise = [*below, f"(do action (go{n}))", "(do anything)"][:2]
        yield f"(defgoalr (ach r{n}) (if (p{n}) {then} {otherwise}))"
    yield "(goalem (ach r0))"


SHAPES: dict[str, Callable[[], Iterator[str]]] = {"flat": flat, "held": held, "nested": nested, "tree": tree}


# --- runs ---


def plugin() -> tuple[str, ...]:
    """Nothing where it is installed."""
    installed = any(point.name == "rplan" for point in entry_points(group="pytest11"))
    return () if installed else ("-p", "rplan.apps.pytest_plugin")


class Ran(NamedTuple):
    """A run of pytest, from the start of Python to its end: seconds, of them of the processor, and its last line."""

    seconds: float
    processor: float
    said: str


def spent() -> float:
    """Seconds of the processor that all runs have taken so far."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def run(folder: Path, *arguments: str) -> Ran:
    """Run pytest in a folder."""
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    environment |= {"PYTHONPATH": str(ROOT), "PYTHONPYCACHEPREFIX": str(folder.parent / "bytecode")}
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", *arguments]
    begin, before = time.perf_counter(), spent()
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    seconds, processor = time.perf_counter() - begin, spent() - before
    if done.returncode not in (0, 5):
        sys.exit(f"{' '.join(command)}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
    return Ran(seconds, processor, done.stdout.strip().splitlines()[-1])


def beyond(folder: Path, times: int, *arguments: str) -> str:
    """Seconds that a run with plans takes beyond a start of pytest that collects nothing.

    Of the processor, and by the clock, which a busy machine makes longer.
    """
    empty, found, said = folder.parent / "empty", [], ""
    for warm in (True, *[False] * times):
        bare = run(empty, *WITHOUT, "--collect-only")
        whole = run(folder, *plugin(), "--rplan", *arguments)
        said = whole.said.partition(" in ")[0]
        found += [] if warm else [(whole.processor - bare.processor, whole.seconds - bare.seconds, bare.seconds)]
    own, clock, start = (statistics.median(column) for column in zip(*found, strict=True))
    return f"{own:6.2f} s CPU, {clock:.2f} s by the clock, beside {start:.2f} s of pytest ({times} pairs; {said})"


def interval(found: Sequence[float]) -> str:
    """The median, and between which of the values it lies with a chance of 95 % (order statistics of the sign test)."""
    ordered, count = sorted(found), len(found)
    cut = max(int((count - 1.96 * count**0.5) / 2), 0)
    return f"{statistics.median(found):+7.1f} ms  (95 %: {ordered[cut]:+.1f} to {ordered[-1 - cut]:+.1f} ms)"


def without_plans(folder: Path) -> Iterator[tuple[str, str]]:
    """What a project pays that has one test and no plan [ms of the processor]."""
    arms = {"without": WITHOUT, "with": plugin(), "again": WITHOUT}
    orders = list(permutations(arms))
    taken: dict[str, list[float]] = {name: [] for name in arms}
    for arguments in arms.values():
        run(folder, *arguments)
    for number in range(ROUNDS):
        for name in orders[number % len(orders)]:
            taken[name].append(run(folder, *arms[name]).processor * 1e3)
    for name, said in (("with", "the plugin where there is no plan"), ("again", "nothing: the same command twice")):
        pairs = list(zip(taken["without"], taken[name], strict=True))
        ratio = statistics.median(b / a for a, b in pairs)
        yield said, f"{interval([b - a for a, b in pairs])}, ratio {ratio:.3f}, {ROUNDS} rounds"


def main(asked: Sequence[str]) -> None:
    """Print the figures."""
    with tempfile.TemporaryDirectory() as scratch:
        for name in ("empty", NONE, *SHAPES):
            folder = Path(scratch) / name
            folder.mkdir()
            (folder / "pytest.ini").write_text("[pytest]\n", encoding="utf-8")
        (Path(scratch) / NONE / "test_one.py").write_text("def test_one():\n    pass\n", encoding="utf-8")
        for said, figure in without_plans(Path(scratch) / NONE) if NONE in asked else ():
            print(f"{said:<40}{figure}", flush=True)
        for name in (name for name in SHAPES if name in asked):
            folder = Path(scratch) / name
            (folder / f"{name}.rplan").write_text("\n".join(SHAPES[name]()), encoding="utf-8")
            print(f"{f'{RULES} rules, {name}: collect':<40}{beyond(folder, COLLECTED, '--collect-only')}", flush=True)
            print(f"{f'{RULES} rules, {name}: and prove':<40}{beyond(folder, PROVED)}", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:] or (NONE, *SHAPES))
