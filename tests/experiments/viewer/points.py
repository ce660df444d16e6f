"""Points that are met or not, and the runs of `rplan` that they look at.

Takes: what was seen. Gives: a table of it, and `rplan` as a process. Leaves alone: what is looked at.
"""

from __future__ import annotations

import asyncio
import sys
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).parents[3]
RPLAN = (sys.executable, "-u", "-c", "from rplan.apps.cli import main; main()")


@dataclass(frozen=True, slots=True)
class Point:
    """Something that a page does, whether it was seen to, and what was seen."""

    part: str
    says: str
    met: bool
    seen: str


@dataclass(slots=True)
class Points:
    """All points, in the order in which they were tried."""

    every: list[Point] = field(default_factory=list)

    def add(self, part: str, says: str, met: bool, seen: object = "") -> None:
        """Note a point and print it."""
        self.every.append(Point(part, says, bool(met), str(seen)))
        print(f"| {part} | {says} | {'met' if met else 'NOT MET'} | {seen} |", flush=True)

    @property
    def missed(self) -> list[Point]:
        """What is not met."""
        return [point for point in self.every if not point.met]


async def rplan(*arguments: str) -> str:
    """What a command prints; RuntimeError with all of it where it fails."""
    pipe = asyncio.subprocess.PIPE
    process = await asyncio.create_subprocess_exec(*RPLAN, *arguments, cwd=ROOT, stdout=pipe, stderr=pipe)
    out, err = await process.communicate()
    if process.returncode:
        raise RuntimeError(f"rplan {' '.join(arguments)}: {out.decode()}{err.decode()}")
    return out.decode()


async def recorded(folder: Path, plan: str, seed: int, *more: str) -> tuple[Path, Path]:
    """A run of a plan: its recording and its page."""
    folder.mkdir(parents=True, exist_ok=True)
    run = folder / f"{Path(plan).stem}-{seed}.mcap"
    await rplan("simulate", plan, "--seed", str(seed), "--record", str(run), *more)
    await rplan("replay", str(run), "-o", str(run.with_suffix(".html")))
    return run, run.with_suffix(".html")
