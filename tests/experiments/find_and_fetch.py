"""Find and fetch over many seeds: `python tests/experiments/find_and_fetch.py --seeds 0..19 --jobs 2`.

Takes: a range of seeds and how many processes. Gives: one row a seed, then counts and medians; as a Markdown table in a
file if one is named; exit code 0 whatever came of it. Leaves alone: judging; it prints what was measured.
"""

from __future__ import annotations

import argparse
import statistics
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path

from rplan.apps.simulation import Run, load_world, simulate
from rplan.apps.wiring import compile_file

FOLDER = Path(__file__).parents[2] / "plans" / "find_and_fetch"
HEAD = ("seed", "done", "one way [s]", "round trip [s]", "total [s]", "contacts driven into", "clearance [m]", "reason")


def drive(seed: int, plan: Path, scenario: Path) -> Run:
    """One run; plan and scenario are read anew, since a process shares nothing."""
    return simulate(compile_file(plan), load_world(scenario), seed)


def row(run: Run) -> tuple[str, ...]:
    """A run in words, in the order of `HEAD`."""
    verdict = run.verdict
    return (
        str(run.seed),
        "yes" if verdict.done else "no",
        *(seconds(value) for value in (verdict.one_way, verdict.round_trip, verdict.duration)),
        str(verdict.driven_into),
        f"{verdict.smallest_clearance:.3f}",
        verdict.reason,
    )


def seconds(value: float | None) -> str:
    """To a tenth, a dash for what did not happen."""
    return "-" if value is None else f"{value:.1f}"


def median(values: Sequence[float | None]) -> str:
    """Over the runs in which it happened."""
    there = [value for value in values if value is not None]
    return seconds(statistics.median(there)) if there else "-"


def summary(runs: Sequence[Run]) -> list[str]:
    """Counts, and medians over the runs that were done."""
    done = [run.verdict for run in runs if run.verdict.done]
    clear = [run for run in runs if run.verdict.driven_into == 0]
    least = min(run.verdict.smallest_clearance for run in runs)
    return [
        f"done: {len(done)} of {len(runs)}; nothing driven into: {len(clear)} of {len(runs)}",
        f"medians of those done: one way {median([v.one_way for v in done])} s, "
        f"round trip {median([v.round_trip for v in done])} s, total {median([v.duration for v in done])} s",
        f"smallest clearance of all: {least:.3f} m",
    ]


def markdown(rows: Sequence[Sequence[str]]) -> str:
    """A table with `HEAD` above it."""
    lines = [HEAD, ["---"] * len(HEAD), *rows]
    return "".join("| " + " | ".join(line) + " |\n" for line in lines)


def seeds(text: str) -> range:
    """`0..19`, both included, or one number."""
    first, _, last = text.partition("..")
    return range(int(first), int(last or first) + 1)


def main() -> None:
    """Run, print, write."""
    arguments = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    arguments.add_argument("--seeds", type=seeds, default=range(20))
    arguments.add_argument("--jobs", type=int, default=2)
    arguments.add_argument("--plan", type=Path, default=FOLDER / "find_and_fetch.rplan")
    arguments.add_argument("--scenario", type=Path, default=FOLDER / "parking_lot.yaml")
    arguments.add_argument("--markdown", type=Path)
    given = arguments.parse_args()
    print("  ".join(HEAD), flush=True)
    runs: list[Run] = []
    with ProcessPoolExecutor(given.jobs) as pool:
        for run in pool.map(partial(drive, plan=given.plan, scenario=given.scenario), given.seeds):
            runs.append(run)
            print("  ".join(text.rjust(len(name)) for text, name in zip(row(run), HEAD, strict=True)), flush=True)
    said = summary(runs)
    print("\n".join(said))
    if given.markdown is not None:
        given.markdown.write_text(
            markdown([row(run) for run in runs]) + "\n" + "\n".join(f"- {line}" for line in said) + "\n",
            encoding="utf-8",
        )


if __name__ == "__main__":
    main()
