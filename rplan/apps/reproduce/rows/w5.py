"""W5: over a curb, with the flippers and without."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from rplan.apps.reproduce.figures import case_of, count, judged, judged_share, of_case, seed_of, share, spread, worst
from rplan.apps.reproduce.row import Case, Finding, Measures, Moment, Plot, Preset, Row, Seen
from rplan.apps.sweep.work import Change

PLAN, WORLD = "perimeter", "perimeter/worlds/curb"
WITH, WITHOUT = "with the flippers", "without them"
OFF = (Change("flippers", "deploy-above", 1000.0),)
"""No motor ever draws so much."""
OVER = 3.075 + 0.345  # [m], x of the middle: the hull's rear has left the curb
HOME = 12.0  # [s] from then on
BECAUSE = "the robot turns on its way over the curb, and meets it again"


def cases(seeds: int) -> tuple[Case, ...]:
    """Every seed with and without."""
    every = tuple(range(seeds))
    return Case(WITH, PLAN, WORLD, every), Case(WITHOUT, PLAN, WORLD, every, (), OFF)


def crossed_at(moments: Sequence[Moment]) -> float | None:
    """When [s] the whole hull was over the curb; None if never."""
    return next((moment.time for moment in moments if moment.pose.x > OVER), None)


def deployments(moments: Sequence[Moment]) -> int:
    """How often the flippers came to bear on the ground."""
    return sum(_deployed(now) and not _deployed(last) for last, now in pairwise(moments))


def _deployed(moment: Moment) -> bool:
    flippers = moment.reading.flippers
    return flippers is not None and flippers.deployed


def _home(moment: Moment) -> bool:
    flippers = moment.reading.flippers
    return flippers is not None and flippers.angle == 0.0


def measure(seen: Seen) -> Measures:
    """Whether the curb was crossed, how often the flippers came out, and when [s] after it they were home."""
    over = crossed_at(seen.moments)
    home = next((m.time - over for m in seen.moments if over is not None and m.time >= over and _home(m)), None)
    return {
        "crossed": over is not None,
        "after": over,
        "deployed": deployments(seen.moments),
        "once": deployments(seen.moments) == 1,
        "home": home,
        "home_in_time": home is not None and home <= HOME,
        "stuck": any(bool(moment.percepts.get("(the-robot-is-stuck)")) for moment in seen.moments),
    }


def judge(_preset: Preset, measures: Sequence[Measures]) -> tuple[Finding, ...]:
    """Always over it with the flippers, deployed once; never without."""
    there, without = of_case(measures, WITH), of_case(measures, WITHOUT)
    return (*_with(there), *_without(without)) if there and without else ()


def _with(some: Sequence[Measures]) -> tuple[Finding, ...]:
    crossed, once, home = count(some, "crossed"), count(some, "once"), count(some, "home_in_time")
    judgement = worst((judged_share(crossed, len(some), 1.0), judged_share(once, len(some), 1.0)))
    shown = next((one for one in some if not one.get("once")), some[0])
    return (
        Finding(f"crossed {WITH}", "climbs over",
                f"{share(crossed, len(some))}, after {spread(some, 'after', 's')}; deployed once: {once}",
                judgement, "" if judgement == "met" else BECAUSE, case_of(shown), seed_of(shown)),
        Finding("home within 12 s of it", "out for a minimum of 10 seconds",
                f"{share(home, len(some))}, {spread(some, 'home', 's', digits=1)}",
                judged_share(home, len(some), 1.0), "" if home == len(some) else BECAUSE),
    )  # fmt: skip


def _without(some: Sequence[Measures]) -> tuple[Finding, ...]:
    crossed, stuck = count(some, "crossed"), count(some, "stuck")
    return (
        Finding(f"crossed {WITHOUT}", "its main tracks are unable to lift the robot",
                f"{share(crossed, len(some))}; stasis was noticed in {stuck}",
                judged(crossed, 0.0, 0.0), "" if crossed == 0 else BECAUSE, case_of(some[0]), seed_of(some[0])),
    )  # fmt: skip


ROW = Row(
    name="W5",
    paper="wayfarer",
    title="A curb",
    set_up=(
        "A corridor with a curb of 15 cm across it, below the plane of the lidar; tracks climb 8 cm, and 20 cm once "
        "the flippers have been out for a second of pushing. The perimeter plan drives, with flippers and without."
    ),
    printed=(
        "“When either the left or right drive motor current exceeds a threshold (15 amps), this behavior extends the "
        "flippers forward … The flippers remain deployed for a minimum of 10 seconds. When both drive motor currents "
        "drop below a second, lower threshold (2 amps), the flippers are retracted …”"
    ),
    note="How high tracks climb and what the motors draw is the simulator's; that the rule works with it is shown.",
    cases=cases,
    measure=measure,
    judge=judge,
    presets=("paper", "modern"),
    picture=WITH,
    plots=(Plot("home", "flippers home after the crossing [s]"),),
)
