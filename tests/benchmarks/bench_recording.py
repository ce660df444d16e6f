"""What questions about a long recording cost: `python tests/benchmarks/bench_recording.py [RECORDING]`. By hand.

Takes: a recording of patrol; without one it makes one of an hour (some twenty seconds). Gives: a table with machine,
wall and processor seconds of `rplan why` and `why-not` at start, middle and end, from the shell and so with the start
of Python; the same of the file cut short; what numbers in ticks cost. Leaves alone: whether that is fast enough.
"""

from __future__ import annotations

import json
import os
import platform
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path
from resource import RUSAGE_CHILDREN, getrusage
from typing import Any, cast

from behaviours.interface import Command
from rplan.apps.simulation import load_world, simulate
from rplan.apps.wiring import PlanBrain, compile_file
from rplan.goals.condition import Percept
from rplan.runtime.controller import Tick
from rplan.runtime.trace import Trace
from sim.episode import Episode
from sim.recording import Recorder, backwards, json_text, read

ROOT = Path(__file__).parents[2]
PATROL = ROOT / "plans" / "patrol" / "patrol.rplan"
HOUR = 3600.0
TIMES = 5
Seconds = tuple[float, float]


def timed(work: Callable[..., object], *arguments: str | Path) -> Seconds:
    """Wall and processor seconds of the work with these arguments, the medians of five."""
    wall, processor = [], []
    for _ in range(TIMES):
        begin, spent = time.perf_counter(), _spent()
        work(*arguments)
        wall.append(time.perf_counter() - begin)
        processor.append(_spent() - spent)
    return statistics.median(wall), statistics.median(processor)


def _spent() -> float:
    children = getrusage(RUSAGE_CHILDREN)
    return time.process_time() + children.ru_utime + children.ru_stime


def command(*arguments: str | Path) -> None:
    """The command line in a process of its own; it must succeed."""
    python = [sys.executable, "-c", "from rplan.apps.cli import main; main()", *map(str, arguments)]
    subprocess.run(python, check=True, capture_output=True, env={**os.environ, "PYTHONPATH": str(ROOT)})


def world_file() -> Path:
    return next(iter(sorted(PATROL.parent.glob("*.yaml"))))


def hour(path: Path) -> Path:
    """An hour of patrol."""
    simulate(compile_file(PATROL), load_world(world_file()), 0, until=HOUR, record=path)
    return path


def questions(path: Path) -> Iterator[tuple[str, Seconds]]:
    """From the shell."""
    plan = PATROL.parent
    yield "rplan why --help", timed(command, "why", "--help")
    yield "rplan why of a plan alone", timed(command, "why", plan, "--given", "")
    end = json.loads(next(backwards(path).latest()))["t"] - 1
    for name, at in (("start", 0.0), ("middle", end / 2), ("end", end)):
        yield f"rplan why, {name} ({at:.0f} s)", timed(command, "why", path, "--at", str(at))
    wish = ("goal=(the-charger)", "--at", str(end / 2))
    yield "rplan why-not, middle", timed(command, "why-not", path, *wish)
    cut = path.with_name("cut.mcap")
    cut.write_bytes(path.read_bytes()[:-1000])
    yield "rplan why, end, file cut short", timed(command, "why", cut, "--at", str(end - 60))
    cut.unlink()


def passes(path: Path) -> Iterator[tuple[str, Seconds]]:
    """Whole passes through the file in this process."""
    yield "every tick backwards, as text", timed(lambda: sum(1 for _ in backwards(path).latest()))
    yield "every tick forwards, decoded", timed(lambda: sum(1 for _ in read(path).ticks))
    yield "every reading", timed(lambda: sum(1 for _ in read(path).readings))


def numbers(path: Path) -> Iterator[tuple[str, str]]:
    """What the numbers of the percepts add to the file, by writing the first ticks with them and without."""
    recording = read(path)
    every = [cast(Any, tick) for tick, _ in zip(recording.ticks, range(6000), strict=False)]
    ticks = [(one["t"], one["world"], one["plan"]) for one in every if one["plan"]]
    sizes = []
    for left_out in ("", "percepts"):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "run.mcap"
            with Recorder(file, recording.header) as recorder:
                for t, world, plan in ticks:
                    recorder.tick(t, world, json_text({key: plan[key] for key in plan if key != left_out}))
            sizes.append(file.stat().st_size)
    yield "bytes a tick without readings", f"{sizes[0] / len(ticks):.0f}"
    yield "of these by numbers of percepts", f"{(sizes[0] - sizes[1]) / len(ticks):.1f}"


def notes() -> Iterator[tuple[str, str]]:
    """What a tick costs to be put into text, with a number and without any."""
    compiled = compile_file(PATROL)
    bare = replace(compiled.ways, atoms=tuple(one for one in compiled.ways.atoms if isinstance(one, Percept)), asking=0)
    brain, episode = PlanBrain(compiled), Episode(load_world(world_file()).scenario, 0, compiled.goals.period)
    brain.reset()
    for _ in range(50):
        episode.tick(brain)
    tick = brain.tick
    assert tick is not None
    for name, trace in (("with its numbers", brain.trace), ("without", Trace(bare))):
        trace._known |= {(tick.decision.inputs, tick.decision.registers): brain.trace._way(tick.decision)}
        _, spent = timed(partial(_many, trace, tick))
        yield f"a tick as text, {name}", f"{spent * 100:.1f} us"


def _many(trace: Trace, tick: Tick[Command]) -> None:
    for _ in range(10_000):
        trace.note(tick)


def main() -> None:
    """Print the table."""
    print(f"{os.cpu_count()} cores, {platform.system()}, Python {platform.python_version()}")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(sys.argv[1]) if len(sys.argv) > 1 else hour(Path(folder) / "hour.mcap")
        print(f"{path.name}: {path.stat().st_size / 1e6:.1f} MB\n{'':<44}{'wall':>10}{'processor':>12}")
        for measure in (questions, passes):
            for name, (wall, processor) in measure(path):
                print(f"{name:<44}{wall:>8.2f} s{processor:>10.2f} s", flush=True)
        for name, value in (*numbers(path), *notes()):
            print(f"{name:<44}{value:>10}")


if __name__ == "__main__":
    main()
