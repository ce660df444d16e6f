"""B4: canyons with the goal behind them."""

from __future__ import annotations

from collections.abc import Sequence

from rplan.apps.reproduce.figures import (
    case_of,
    count,
    judged_share,
    of_case,
    seed_of,
    share,
    spread,
    typical,
)
from rplan.apps.reproduce.row import Case, Finding, Judgement, Measures, Plot, Preset, Row, Seen
from rplan.apps.reproduce.watch import NAVIGATE, described

SIZES = ("3x2", "4x3", "5x4", "6x5")
TRAPPED = "4x3"
MOST_CIRCLES = 10
MODERN = 0.95
"""Share that gets out with the preset modern."""
OUT_ALONE = "spins that dither are locked for some seconds after each deadlock, which lets some runs find the way out"
KEPT_IN = "the circles that led the robot in are forgotten before it is out, and lead it in again"
NO_WAY = "ten minutes are over before the robot has followed the walls to the mouth"


def cases(seeds: int) -> tuple[Case, ...]:
    """Every size with every seed."""
    world = "find_and_fetch/worlds/canyon_"
    return tuple(Case(size, "go_to_goal", world + size, tuple(range(seeds))) for size in SIZES)


def measure(seen: Seen) -> Measures:
    """Whether and when [s] it got to the goal, how far it drove [m], and how often the memory of circles was full."""
    used = [len(details["circles"]) for moment in seen.moments if (details := described(moment, NAVIGATE))]
    return {
        "reached": seen.verdict.done,
        "time": seen.verdict.times.arrival,
        "distance": seen.verdict.distance,
        "most_circles": max(used, default=0),
        "full": sum(n >= MOST_CIRCLES for n in used) / len(used) if used else 0.0,
        "driven_into": seen.verdict.driven_into,
    }


def judge(preset: Preset, measures: Sequence[Measures]) -> tuple[Finding, ...]:
    """With the preset paper the small one lets go and the next one traps; with modern all let go."""
    return tuple(_size(preset, size, of_case(measures, size)) for size in SIZES if of_case(measures, size))


def _size(preset: Preset, size: str, some: Sequence[Measures]) -> Finding:
    out = count(some, "reached")
    shown = typical([m for m in some if m.get("reached")], "time") or some[0]
    ours = f"out: {share(out, len(some))}"
    if out:
        ours += f", after {spread(some, 'time', 's')}"
    ours += f"; {spread(some, 'most_circles', 'circles')} at most"
    what = f"canyon of {size.replace('x', ' x ')} m"
    judgement: Judgement
    match preset, size:
        case "paper", "3x2":
            judgement, printed, why = judged_share(out, len(some), 1.0), "gets out (up to ten circles)", KEPT_IN
        case "paper", _:
            judgement = judged_share(len(some) - out, len(some), 1.0)
            printed, why = "trapped (more than ten circles)", OUT_ALONE
        case _:
            judgement, printed, why = judged_share(out, len(some), MODERN), "gets out, 19 of 20 (future work)", NO_WAY
    return Finding(what, printed, ours, judgement, "" if judgement == "met" else why, case_of(shown), seed_of(shown))


ROW = Row(
    name="B4",
    paper="find-and-fetch",
    title="Box canyons",
    set_up="A canyon open towards the robot, the goal behind its back wall; ten minutes.",
    printed=(
        "“The robot can become trapped in a box of obstacles which number more than the allocated memory resources”, "
        "which are ten circles. “A solution … is to remember configurations of obstacles.”"
    ),
    cases=cases,
    measure=measure,
    judge=judge,
    presets=("paper", "modern"),
    picture=TRAPPED,
    plots=(Plot("time", "time to the goal [s]"), Plot("full", "ticks with ten circles or more [%]", 100.0)),
)
