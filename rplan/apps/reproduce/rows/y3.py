"""Y3: along walls with many bends and a gap."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from behaviours.interface import Vec2
from rplan.apps.reproduce.courses import draw_clouds
from rplan.apps.reproduce.figures import case_of, count, judged_share, seed_of, share, spread
from rplan.apps.reproduce.row import Case, Finding, Measures, Plot, Preset, Row, Seen
from rplan.apps.sweep.work import Change

PLAN, WORLD, LIBRARY = "follow_wall", "follow_wall/worlds/bends", "wall-by-ransac"
WALLS, BENDS, LEGS = 10, 7, (2.0, 3.5)
LEAST_BEND, MOST_BEND, MOST_TURNED = math.radians(20), math.radians(55), math.radians(80)
GAP, HALF, STAND_OFF = 0.3, 0.1, 1.0  # [m]
HULL = 0.25  # [m]
NEAREST = 0.5  # [m] from the middle of the robot to the wall
WIDE_VIEW = (Change(LIBRARY, "view-angle", math.radians(45)), Change(LIBRARY, "width", 2.5))
WIDE_BAND = (*WIDE_VIEW, Change(LIBRARY, "track-band", 0.35))
NARROW_BAND, TUNED, WITHOUT = "band of 8 cm", "tuned", "wall loss off"
LOST = "the wall was lost at a bend"
NEAR = "the robot came nearer than half a metre"


@dataclass(frozen=True, slots=True)
class Bent:
    """A wall to the right of a robot that starts at the origin: the pieces of its middle line, where its way ends."""

    pieces: tuple[tuple[Vec2, Vec2], ...]
    goal: Vec2


def wall(number: int) -> Bent:
    """Seven bends of 20 to 55 degrees either way, and a gap of 0.3 m in the middle of one leg."""
    chance = np.random.default_rng((2012, number))
    at, heading = (-4.0, -STAND_OFF - HALF), 0.0
    lengths = [float(chance.uniform(*LEGS)) for _ in range(BENDS + 1)]
    lengths[0] += 6.0
    broken = int(chance.integers(1, BENDS + 1))
    pieces: list[tuple[Vec2, Vec2]] = []
    for leg, length in enumerate(lengths):
        if leg:
            heading += _bend(heading, float(chance.uniform(LEAST_BEND, MOST_BEND)), bool(chance.integers(2)))
        half = (length - GAP) / 2
        parts = ((0.0, half), (length - half, length)) if leg == broken else ((0.0, length),)
        pieces += [(_along(at, heading, begin), _along(at, heading, end)) for begin, end in parts]
        at = _along(at, heading, length)
    x, y = _along(at, heading, -1.0)
    goal = x - math.sin(heading) * (STAND_OFF + HALF), y + math.cos(heading) * (STAND_OFF + HALF)
    return Bent(tuple(pieces), goal)


def _bend(heading: float, bend: float, left: bool) -> float:
    """Either way, but never back: no part of the wall comes near another."""
    bend = bend if left else -bend
    return bend if abs(heading + bend) <= MOST_TURNED else -bend


def _along(at: Vec2, heading: float, far: float) -> Vec2:
    return round(at[0] + far * math.cos(heading), 3), round(at[1] + far * math.sin(heading), 3)


def settings_of(bent: Bent) -> tuple[tuple[str, str], ...]:
    """The wall as keys of a scenario."""
    things = ", ".join(f"{{kind: wall, from: {list(a)}, to: {list(b)}}}" for a, b in bent.pieces)
    xs, ys = ([point[k] for piece in bent.pieces for point in piece] for k in (0, 1))
    bounds = [min(xs) - 1, min(ys) - 2, max(xs) + 2, max(ys) + 3]
    return (
        ("things", f"[{things}]"),
        ("goal.at", str([round(value, 2) for value in bent.goal])),
        ("bounds", str([round(value, 1) for value in bounds])),
    )


KINDS: tuple[tuple[str, tuple[Change, ...], tuple[Preset, ...]], ...] = (
    ("", WIDE_BAND, ("paper", "modern")),
    (WITHOUT, (*WIDE_BAND, Change(LIBRARY, "wall-loss", "off")), ("paper",)),
    (NARROW_BAND, WIDE_VIEW, ("paper",)),
    (TUNED, (*WIDE_BAND, Change(LIBRARY, "preset", "tuned")), ("paper",)),
)


def cases(seeds: int) -> tuple[Case, ...]:
    """Ten walls, fewer where fewer seeds are asked for; each with a seed of its own."""
    return tuple(
        Case(_name(kind, number), PLAN, WORLD, (number,), settings_of(wall(number)), changes, presets)
        for kind, changes, presets in KINDS
        for number in range(min(seeds, WALLS))
    )


def _name(kind: str, number: int) -> str:
    return f"{kind or 'bends'}: wall {number}"


def measure(seen: Seen) -> Measures:
    """Whether the robot got along the whole wall, and how near [m] it came to it."""
    verdict = seen.verdict
    return {
        "complete": verdict.done,
        "nearest": verdict.smallest_clearance + HULL,
        "time": verdict.times.arrival,
        "contacts": len(verdict.contacts),
    }


def judge(preset: Preset, measures: Sequence[Measures]) -> tuple[Finding, ...]:
    """All walls, none nearer than half a metre."""
    found: list[Finding] = []
    for kind, _, presets in KINDS:
        some = [one for one in measures if case_of(one).startswith(f"{kind or 'bends'}:")]
        if some and preset in presets:
            found.append(_kind(kind, some))
    return tuple(found)


def _kind(kind: str, some: Sequence[Measures]) -> Finding:
    good = [one for one in some if _good(one)]
    bad = next((one for one in some if one not in good), some[0])
    went = count(some, "complete")
    ours = f"{share(went, len(some))} to the end; {spread(some, 'nearest', 'm', 1.0, 2)} from the wall at the nearest"
    what = "ten walls" + (f", {kind}" if kind else "")
    if kind:
        return Finding(what, "not printed", ours, "met", "", case_of(bad), seed_of(bad))
    judgement = judged_share(len(good), len(some), 1.0)
    because = "" if judgement == "met" else LOST if went < len(some) else NEAR
    return Finding(what, "follows it to the end", ours, judgement, because, case_of(bad), seed_of(bad))


def _good(one: Measures) -> bool:
    nearest = one.get("nearest")
    return bool(one.get("complete")) and one.get("contacts") == 0 and isinstance(nearest, float) and nearest >= NEAREST


ROW = Row(
    name="Y3",
    paper="wall-following",
    title="Along a wall with a high degree of variance",
    set_up=(
        "Ten walls of eight legs, 2 to 3.5 m, with seven bends of 20 to 55 degrees either way and a gap of 0.3 m; the "
        "view at 45 degrees and 2.5 m wide, k = 3, a stand-off of 1 m, setspeed 1.5; points on the wall within 35 cm."
    ),
    printed=(
        "“The wall had several corners in both directions and a small gap as well. … this experiment illustrates that "
        "the wall loss algorithm does not render the controller useless in environments which are less structured than "
        "straight walls.”"
    ),
    note="The paper has one wall and shows no plan of it; these were drawn by chance. The band is not printed.",
    cases=cases,
    measure=measure,
    judge=judge,
    presets=("paper", "modern"),
    picture="bends: wall 0",
    plots=(Plot("nearest", "nearest to the wall [m]"), Plot("time", "time to the end [s]")),
    courses=("bends: wall 0",),
    draw=draw_clouds,
)
