"""Navigation templates: from circles and a goal to a heading.

Takes: circles, the robot's pose and the goal in one frame, and the plan of before. Gives: a qualitative plan (groups
with spins) and the heading, speed and turn rate that follow from it. Leaves alone: how circles come about, time.

Source: a reconstruction from the sentences of Bonasso, Antonisse and Slack 1992; the equations of Slack's own papers
were not at hand. A spin is clockwise where the obstacle is passed on the robot's right.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from behaviours.cores.circles import Circle
from behaviours.cores.geometry import bearing, distance
from behaviours.interface import Pose, wrap

Spin = Literal["cw", "ccw"]
MANY = 24
"""Circles from which on grouping is done with arrays."""
Memory = Mapping[int, tuple[Spin, float]]
"""Circle -> the spin of its last group, and the stamp [s] until which that spin is locked."""


@dataclass(frozen=True, slots=True)
class NatSettings:
    """Lengths [m], speeds [m/s], gain [1/s], turn rate [rad/s]; fractions without unit.

    minds [rad]: echoes within so much of the heading slow the robot down.
    """

    robot_width: float = 0.7
    clearance: float = 0.25
    group_margin: float = 0.22
    group_hysteresis: float = 0.3
    spin_hysteresis: float = 0.5
    squeeze: float = 0.3
    look_ahead: float = 3.0
    narrow_margin: float = 0.15
    max_speed: float = 0.2
    stop_distance: float = 0.2
    slow_distance: float = 1.5
    least_speed: float = 0.2
    steering_gain: float = 1.5
    max_turn_rate: float = 0.8
    minds: float = math.pi


@dataclass(frozen=True, slots=True)
class Group:
    """Circles between which the robot does not fit, and the side on which it passes them.

    left, right: headings [rad, relative to the goal direction] that just clear the group on its left and on its right.
    distance [m] to its nearest edge; heeded: it bounds the heading; it does not where a nearer group contradicts it.
    """

    idents: tuple[int, ...]
    spin: Spin
    left: float
    right: float
    distance: float
    locked_until: float
    heeded: bool


@dataclass(frozen=True, slots=True)
class NatPlan:
    """A plan to go to the goal: groups by distance, the admissible headings, the heading [rad, frame of the goal].

    grouping: circle -> number of its group, of all circles; the numbers mean nothing else.
    """

    goal: Pose
    circles: tuple[Circle, ...]
    grouping: Mapping[int, int]
    groups: tuple[Group, ...]
    interval: tuple[float, float]
    heading: float

    def spins(self) -> dict[int, tuple[Spin, float]]:
        """What the next plan inherits."""
        return {ident: (g.spin, g.locked_until) for g in self.groups for ident in g.idents}


def opposite(spin: Spin) -> Spin:
    """The other way round."""
    return "ccw" if spin == "cw" else "cw"


def make_plan(
    circles: Sequence[Circle],
    robot: Pose,
    goal: Pose,
    before: Mapping[int, int],
    memory: Memory,
    now: float,
    settings: NatSettings,
) -> NatPlan:
    """The plan from the robot to the goal.

    before, memory: grouping and spins of the plan before, empty at first. now [s]: what locks are held against.
    """
    found, spans = _groups(circles, robot, goal, before, settings)
    grouping = {circles[i].ident: at for at, members in enumerate(found) for i in members}
    groups = [_assess(span, memory, now, settings) for span in spans if span]
    groups.sort(key=lambda g: g.distance)
    heeded, interval = _bound(groups, settings)
    heading = wrap(bearing(robot, goal) + max(interval[0], min(0.0, interval[1])))
    return NatPlan(goal, tuple(circles), grouping, heeded, interval, heading)


def _groups(
    circles: Sequence[Circle], robot: Pose, goal: Pose, before: Mapping[int, int], settings: NatSettings
) -> tuple[list[list[int]], list[list[Span]]]:
    """The circles of each group, and what they take from the headings.

    A group that closes a ring around the robot has no way out by definition, but the robot came in somewhere: then only
    narrower gaps join circles.
    """
    narrow = replace(settings, group_margin=settings.narrow_margin, group_hysteresis=0.0)
    found: list[list[int]] = []
    spans: list[list[Span]] = []
    for attempt in (settings, replace(settings, group_hysteresis=0.0), narrow):
        joined = link(circles, before, attempt)
        found = components(len(circles), joined)
        spans = [_spans(members, circles, joined, robot, goal, attempt) for members in found]
        if not any(map(_encloses, spans)):
            break
    return found, spans


def _encloses(spans: Sequence[Span]) -> bool:
    return bool(spans) and max(s[1] for s in spans) - min(s[2] for s in spans) >= math.tau


# --- grouping -------------------------------------------------------------------------------------


def link(circles: Sequence[Circle], before: Mapping[int, int], settings: NatSettings) -> tuple[tuple[int, ...], ...]:
    """For each circle the places of those between which and it the robot does not fit.

    before: circle -> its group in the plan before. What was one group stays one up to a wider gap; circles come and go
    from sweep to sweep, so a new one counts with those that it overlaps.
    """
    apart = settings.robot_width + 2 * settings.group_margin
    if len(circles) > MANY:
        return _link_many(circles, before, apart, settings.group_hysteresis)
    gaps = [[math.hypot(a.x - b.x, a.y - b.y) - a.radius - b.radius for b in circles] for a in circles]
    grouped = _grouped_before(circles, gaps, before)
    count = range(len(circles))
    return tuple(
        tuple(
            j
            for j in count
            if j != i and gaps[i][j] < apart + (settings.group_hysteresis if grouped[i] & grouped[j] else 0.0)
        )
        for i in count
    )


def _link_many(
    circles: Sequence[Circle], before: Mapping[int, int], apart: float, hysteresis: float
) -> tuple[tuple[int, ...], ...]:
    """As `link`, for so many circles that arrays are quicker; a circle counts with its own group of before alone."""
    x, y, radius = (np.array([getattr(c, name) for c in circles]) for name in ("x", "y", "radius"))
    grouped = np.array([before.get(c.ident, -1) for c in circles])
    gaps = np.hypot(x[:, None] - x, y[:, None] - y) - radius[:, None] - radius
    same = (grouped[:, None] == grouped) & (grouped >= 0)
    near = gaps < apart + hysteresis * same
    np.fill_diagonal(near, False)
    return tuple(tuple(np.flatnonzero(row).tolist()) for row in near)


def _grouped_before(
    circles: Sequence[Circle], gaps: Sequence[Sequence[float]], before: Mapping[int, int]
) -> list[frozenset[int]]:
    """For each circle the groups in which it, or what it overlaps, was before."""
    count = range(len(circles))
    overlapping = [[j for j in count if gaps[i][j] <= 0.0] for i in count]
    return [frozenset(before[circles[j].ident] for j in those if circles[j].ident in before) for those in overlapping]


def components(count: int, neighbours: Sequence[Sequence[int]]) -> list[list[int]]:
    """The places of the circles, group by group, in the order of their first circle."""
    seen = [False] * count
    found = []
    for first in range(count):
        if not seen[first]:
            seen[first] = True
            reached = [first]
            for i in reached:
                fresh = [j for j in neighbours[i] if not seen[j]]
                for j in fresh:
                    seen[j] = True
                reached += fresh
            found.append(reached)
    return found


# --- spins ----------------------------------------------------------------------------------------

Span = tuple[int, float, float, float]
"""A circle's name, the headings [rad, relative to the goal] that clear it left and right, its edge's distance [m]."""


def _spans(
    members: Sequence[int],
    circles: Sequence[Circle],
    neighbours: Sequence[Sequence[int]],
    robot: Pose,
    goal: Pose,
    settings: NatSettings,
) -> list[Span]:
    """What each circle of a group takes from the headings; circles farther than the goal take nothing.

    Bearings are chained from neighbour to neighbour, so that a group that reaches around the robot has no jump in it.
    """
    towards, reach = bearing(robot, goal), distance(robot, goal)
    direct = {i: wrap(math.atan2(circles[i].y - robot.y, circles[i].x - robot.x) - towards) for i in members}
    first = min(members, key=lambda i: (abs(direct[i]), i))
    chained = {first: direct[first]}
    queue = [first]
    for i in queue:
        for j in neighbours[i]:
            if j not in chained:
                chained[j] = chained[i] + wrap(direct[j] - direct[i])
                queue.append(j)
    spans = []
    for i in queue:
        c = circles[i]
        away = math.hypot(c.x - robot.x, c.y - robot.y)
        if away <= reach:
            half = half_angle(away, c.radius + settings.robot_width / 2 + settings.clearance)
            spans.append((c.ident, chained[i] + half, chained[i] - half, away - c.radius))
    return spans


def half_angle(away: float, radius: float) -> float:
    """Half the angle [rad] under which a disc is seen from `away` [m]; within it beyond a right angle, to push out."""
    if away <= radius:
        return math.pi / 2 + math.pi / 4 * (radius - away) / radius
    return math.asin(radius / away)


def _assess(spans: Sequence[Span], memory: Memory, now: float, settings: NatSettings) -> Group:
    """The group with its spin: locked, else of the majority unless the other side is much better, else the nearer."""
    left, right = max(s[1] for s in spans), min(s[2] for s in spans)
    inherited = [memory[s[0]] for s in spans if s[0] in memory]
    locked = [(spin, until) for spin, until in inherited if until > now]
    if locked:
        until = max(lock[1] for lock in locked)
        latest = [lock[0] for lock in locked if lock[1] == until]
        spin = max(latest, key=latest.count)
    else:
        spin, until = _choose([spin for spin, _ in inherited], left, right, settings), 0.0
    return Group(tuple(s[0] for s in spans), spin, left, right, min(s[3] for s in spans), until, False)


def _choose(inherited: Sequence[Spin], left: float, right: float, settings: NatSettings) -> Spin:
    votes = inherited.count("cw") - inherited.count("ccw")
    if votes == 0:
        return "cw" if abs(left) <= abs(right) else "ccw"
    spin: Spin = "cw" if votes > 0 else "ccw"
    deviation = {"cw": max(left, 0.0), "ccw": max(-right, 0.0)}
    much_better = deviation[opposite(spin)] < settings.spin_hysteresis * deviation[spin]
    return opposite(spin) if much_better else spin


def _bound(groups: Sequence[Group], settings: NatSettings) -> tuple[tuple[Group, ...], tuple[float, float]]:
    """The groups with `heeded` filled in, and the headings that they leave, the nearest group first.

    Where two groups overlap by less than `squeeze`, the way is the middle between them.
    """
    lo, hi = -math.tau, math.tau
    judged = []
    for g in groups:
        bound = (g.left, hi) if g.spin == "cw" else (lo, g.right)
        overlap = max(lo, bound[0]) - min(hi, bound[1])
        heeded = g.distance < settings.look_ahead and overlap <= settings.squeeze
        if heeded:
            lo, hi = max(lo, bound[0]), min(hi, bound[1])
            if overlap > 0.0:
                lo = hi = (lo + hi) / 2
        judged.append(replace(g, heeded=heeded))
    return tuple(judged), (lo, hi)


def contradicted(plan: NatPlan, settings: NatSettings) -> Group | None:
    """The nearest group within the look-ahead that is not heeded; else the nearest that is; None without any."""
    near = [g for g in plan.groups if g.distance < settings.look_ahead]
    return min(near, key=lambda g: (g.heeded, g.distance), default=None)


# --- drive ----------------------------------------------------------------------------------------


def drive(error: float, nearest: float, settings: NatSettings) -> tuple[float, float]:
    """Speed [m/s] and turn rate [rad/s]: slower near obstacles and off the heading.

    error [rad]: wanted minus present heading; nearest [m]: range of the nearest echo.
    """
    span = settings.slow_distance - settings.stop_distance
    share = min(1.0, max(settings.least_speed, (nearest - settings.stop_distance) / span))
    limit = settings.max_turn_rate
    rate = min(limit, max(-limit, settings.steering_gain * error))
    return settings.max_speed * share * max(0.0, math.cos(error)) ** 2, rate
