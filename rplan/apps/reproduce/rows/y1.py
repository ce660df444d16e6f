"""Y1: beside a straight wall, from three starts."""

from __future__ import annotations

import math
from collections.abc import Sequence

from rplan.apps.reproduce.courses import draw_course
from rplan.apps.reproduce.figures import case_of, numbers, of_case, seed_of, share, spread
from rplan.apps.reproduce.figures import judged_share as judged
from rplan.apps.reproduce.row import Case, Finding, Measures, Plot, Preset, Row, Seen
from rplan.apps.sweep.work import Change

PLAN, WORLD = "follow_wall", "follow_wall/worlds/straight"
NARROW = "0.05 m, 80 deg"
STARTS: tuple[tuple[str, float, int], ...] = (
    (NARROW, 0.05, 80),
    ("0.30 m, 80 deg", 0.30, 80),
    ("1.5 m, 20 deg", 1.5, 20),
    ("1.5 m, -110 deg", 1.5, -110),
)
PRINTED = (NARROW, "1.5 m, 20 deg", "1.5 m, -110 deg")
TUNED = ", tuned"
WITHOUT_CURVATURE = (Change("wall-by-ransac", "curvature", "off"),)
AFTER, STAND_OFF = 12.0, 1.0  # [m]
NEAR, ALONG = 0.02, math.radians(1.0)
OVERDAMPED = (
    "with k = 3 equation (2), as it is stable, is overdamped and crosses the target only from the start that faces the "
    "wall; the delays of legs and computer, which are not printed, are not in the simulator"
)
DRIFTS = "the wall was lost, or the robot had not settled after 12 m"


def cases(seeds: int) -> tuple[Case, ...]:
    """The three of the paper, one of them again with the hull of X-RHex; each also critically damped."""
    tuned = (*WITHOUT_CURVATURE, Change("wall-by-ransac", "preset", "tuned"))
    return tuple(_case(start, seeds) for start in STARTS) + tuple(_case(start, seeds, tuned) for start in STARTS)


def _case(start: tuple[str, float, int], seeds: int, tuned: tuple[Change, ...] = ()) -> Case:
    name, offset, heading = start
    settings: tuple[tuple[str, str], ...] = (("robot.start", f"[0, {offset}]"), ("robot.heading", f"{heading} deg"))
    if name == NARROW:
        settings += (("robot.radius", "0.04"),)
    every = tuple(range(seeds))
    if tuned:
        return Case(name + TUNED, PLAN, WORLD, every, settings, tuned, ("paper",))
    return Case(name, PLAN, WORLD, every, settings, WITHOUT_CURVATURE)


def measure(seen: Seen) -> Measures:
    """Offset from the stand-off [m] and angle [deg] after 12 m of wall, how far the robot crossed the stand-off [m]."""
    there = next((moment for moment in seen.moments if moment.pose.x >= AFTER), None)
    offsets = [moment.pose.y - STAND_OFF for moment in seen.moments]
    side = 1.0 if offsets[0] > 0 else -1.0
    return {
        "end_offset": None if there is None else there.pose.y - STAND_OFF,
        "end_angle": None if there is None else math.degrees(there.pose.theta),
        "overshoot": max(0.0, *(-side * offset for offset in offsets)),
        "nearest": min(moment.pose.y for moment in seen.moments),
        "contacts": len(seen.verdict.contacts),
    }


def judge(preset: Preset, measures: Sequence[Measures]) -> tuple[Finding, ...]:
    """Each start by itself, and whether the paper's three overshoot."""
    names = [name + kind for kind in ("", TUNED) for name, _, _ in STARTS]
    found = [_start(name, some) for name in names if (some := of_case(measures, name))]
    printed = [one for one in measures if case_of(one) in PRINTED]
    return (*found, _overshot(printed)) if preset == "paper" and printed else tuple(found)


def _overshot(some: Sequence[Measures]) -> Finding:
    """By more than a fit may be wrong."""
    over = [one for one in some if max(numbers([one], "overshoot"), default=0.0) > NEAR]
    short = next((one for one in some if one not in over), some[0])
    names = [name for name in PRINTED if any(case_of(one) == name for one in over)]
    ours = f"in {share(len(over), len(some))}" + (f", all of them from {' and '.join(names)}" if names else "")
    judgement = judged(len(over), len(some), 1.0)
    because = "" if judgement == "met" else OVERDAMPED
    return Finding("overshoot of the target", "in each test", ours, judgement, because, case_of(short), seed_of(short))


def _start(name: str, some: Sequence[Measures]) -> Finding:
    good = [one for one in some if _settled(one)]
    bad = next((one for one in some if one not in good), some[0])
    ours = (
        f"{share(len(good), len(some))} within 2 cm and 1 degree; {_largest(some, 'end_offset', 100, 'cm')}, "
        f"{_largest(some, 'end_angle', 1, 'degrees')} at most; "
        f"{spread(some, 'overshoot', 'm', 1.0, 2)} past the stand-off"
    )
    judgement = judged(len(good), len(some), 1.0)
    because = "" if judgement == "met" else DRIFTS
    return Finding(
        f"start at {name}", "offset and angle approach zero", ours, judgement, because, case_of(bad), seed_of(bad)
    )


def _settled(one: Measures) -> bool:
    offset, angle = numbers([one], "end_offset"), numbers([one], "end_angle")
    settled = bool(offset and angle) and abs(offset[0]) <= NEAR and abs(math.radians(angle[0])) <= ALONG
    return settled and one.get("contacts") == 0


def _largest(some: Sequence[Measures], key: str, scale: float, unit: str) -> str:
    values = [abs(value) * scale for value in numbers(some, key)]
    return f"{max(values):.1f} {unit}" if values else "never there"


ROW = Row(
    name="Y1",
    paper="wall-following",
    title="Beside a straight wall",
    set_up=(
        "A straight wall, k = 3, 0.48 m/s, a stand-off of 1 m; three starts, offset and heading against the wall; "
        "what remains after 12 m of wall. Without curvature, as in the paper."
    ),
    printed=(
        "“The robot appears to overshoot its target in each test … However, the control parameters do appear to "
        "approach the zero value.”"
    ),
    note=(
        "The stand-off is not printed for these tests. A start at 0.05 m leaves no room for X-RHex beside a wall: that "
        "case has a hull of 4 cm, and the next one starts at 0.30 m with the hull of 25 cm. "
        "*tuned* damps critically."
    ),
    cases=cases,
    measure=measure,
    judge=judge,
    presets=("paper", "modern"),
    picture="1.5 m, -110 deg",
    plots=(Plot("end_offset", "offset from the stand-off after 12 m [cm]", 100.0), Plot("end_angle", "angle [deg]")),
    courses=tuple(name for name, _, _ in STARTS),
    draw=draw_course,
)
