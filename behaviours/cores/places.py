"""Places where the robot has been, the ways between them, and where it has not been yet.

Takes: poses, and circles about what stands, in one frame. Gives: a graph of places, the headings that lead out of them
to where no place is, and the cheapest way by such a heading to a goal. Leaves alone: when the way is wanted, driving.

A place knows how far the robot could drive straight in each of some headings. A heading whose end no other place sees
is a *frontier* (Yamauchi 1997); the cost of going on there is the time back to its place and the straight way to the
goal.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from behaviours.cores.circles import Circle
from behaviours.cores.geometry import distance
from behaviours.interface import Pose

HEADINGS = 24
HERE, GOAL = -1, -2
"""The robot and the goal in the graph of one search; places count from 0, frontiers on from the last place."""


@dataclass(frozen=True, slots=True)
class PlacesSettings:
    """Lengths [m], patience and linger [s], speed [m/s].

    apart: between places on the way. same: nearer than this it is the same place. sight: headings are clear up to it;
    least: shorter ones lead nowhere; half_width: of the lane that must be clear. turns: so often may a place be entered
    with the same goal. linger: who drives about longer without coming to a place makes no progress. patience: so long
    may the way to a frontier not get shorter. nearer: so much nearer to the goal than ever before, the robot goes for
    it again. most: places are kept.
    """

    apart: float = 1.0
    same: float = 0.6
    sight: float = 2.5
    least: float = 1.2
    half_width: float = 0.45
    turns: int = 2
    nearer: float = 0.5
    patience: float = 20.0
    linger: float = 40.0
    speed: float = 0.2
    most: int = 150


@dataclass(frozen=True, slots=True)
class Place:
    """reach: how far [m] it is clear from here in each of HEADINGS headings, from that of the frame on to the left."""

    x: float
    y: float
    reach: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class Frontier:
    """The end (x, y) of a clear heading of a place, seen from no other place."""

    place: int
    heading: int
    x: float
    y: float


Way = tuple[int, int]


@dataclass(frozen=True, slots=True)
class Atlas:
    """Places by number, the driven ways between them with their times [s], and the place the robot was last at."""

    places: Mapping[int, Place] = field(default_factory=dict)
    ways: Mapping[Way, float] = field(default_factory=dict)
    here: int | None = None


def as_way(a: int, b: int) -> Way:
    """The way between two places, whichever end comes first."""
    return (a, b) if a < b else (b, a)


def look_about(x: float, y: float, circles: Sequence[Circle], settings: PlacesSettings) -> tuple[float, ...]:
    """How far [m] a lane from (x, y) is clear in each of HEADINGS headings, up to the sight."""
    turns = np.arange(HEADINGS) * (math.tau / HEADINGS)
    return tuple(clear_for(x, y, turns.tolist(), circles, settings))


def clear_for(
    x: float, y: float, headings: Sequence[float], circles: Sequence[Circle], settings: PlacesSettings
) -> list[float]:
    """How far [m] a lane from (x, y) is clear in each of the headings [rad]."""
    if not circles:
        return [settings.sight] * len(headings)
    dx, dy = np.array([c.x for c in circles]) - x, np.array([c.y for c in circles]) - y
    turns = np.array(headings)[:, None]
    along = dx * np.cos(turns) + dy * np.sin(turns)
    room = settings.half_width + np.array([c.radius for c in circles])
    aside = np.abs(dy * np.cos(turns) - dx * np.sin(turns))
    ends = np.where((aside < room) & (along > 0.0), along - room, settings.sight)
    found: list[float] = np.clip(ends.min(axis=1), 0.0, settings.sight).tolist()
    return found


def sees(place: Place, x: float, y: float, settings: PlacesSettings) -> bool:
    """Whether the point lies near the place, and the way there was clear."""
    away = math.hypot(x - place.x, y - place.y)
    if away <= settings.same:
        return True
    heading = round(math.atan2(y - place.y, x - place.x) / (math.tau / HEADINGS)) % HEADINGS
    return away <= place.reach[heading]


def visit(atlas: Atlas, pose: Pose, circles: Sequence[Circle], spent: float, settings: PlacesSettings) -> Atlas:
    """The atlas with the robot at the pose; spent [s]: driven since it was at the last place."""
    near = _nearest(atlas, pose)
    if near is not None and _away(atlas.places[near], pose) <= settings.same:
        old = atlas.places[near]
        fresh = look_about(old.x, old.y, circles, settings) if _away(old, pose) <= settings.same / 2 else old.reach
        return _arrive(replace(atlas, places={**atlas.places, near: replace(old, reach=fresh)}), near, spent)
    if atlas.here is not None and _away(atlas.places[atlas.here], pose) < settings.apart:
        return atlas
    number = max(atlas.places, default=-1) + 1
    place = Place(pose.x, pose.y, look_about(pose.x, pose.y, circles, settings))
    return _arrive(_bounded(replace(atlas, places={**atlas.places, number: place}), settings.most), number, spent)


def _arrive(atlas: Atlas, number: int, spent: float) -> Atlas:
    if atlas.here is None or atlas.here == number:
        return replace(atlas, here=number)
    way = as_way(atlas.here, number)
    return replace(atlas, here=number, ways={**atlas.ways, way: min(spent, atlas.ways.get(way, math.inf))})


def _bounded(atlas: Atlas, most: int) -> Atlas:
    """Without the oldest place where there are too many."""
    if len(atlas.places) <= most:
        return atlas
    oldest = min(number for number in atlas.places if number != atlas.here)
    places = {number: place for number, place in atlas.places.items() if number != oldest}
    return replace(atlas, places=places, ways={w: t for w, t in atlas.ways.items() if oldest not in w})


def _nearest(atlas: Atlas, pose: Pose) -> int | None:
    return min(atlas.places, key=lambda number: (_away(atlas.places[number], pose), number), default=None)


def _away(place: Place, pose: Pose) -> float:
    return math.hypot(place.x - pose.x, place.y - pose.y)


def frontiers(atlas: Atlas, tried: Collection[Frontier], least: float, settings: PlacesSettings) -> list[Frontier]:
    """Where headings end that are clear for `least` [m], that no other place sees, and that are not like one tried."""
    found = []
    for number, place in atlas.places.items():
        for heading, reach in enumerate(place.reach):
            if reach >= least:
                turn = heading * math.tau / HEADINGS
                end = Frontier(number, heading, place.x + reach * math.cos(turn), place.y + reach * math.sin(turn))
                if not is_seen(atlas, end, settings) and not any(_is_like(end, other, settings) for other in tried):
                    found.append(end)
    return found


def is_closed(atlas: Atlas, frontier: Frontier, circles: Sequence[Circle], settings: PlacesSettings) -> bool:
    """Whether by what is known now the frontier cannot be driven to from its place."""
    place = atlas.places[frontier.place]
    away = math.hypot(frontier.x - place.x, frontier.y - place.y)
    (clear,) = clear_for(place.x, place.y, [frontier.heading * math.tau / HEADINGS], circles, settings)
    return clear < away - settings.same


def is_seen(atlas: Atlas, frontier: Frontier, settings: PlacesSettings) -> bool:
    """Whether a place other than its own sees the frontier."""
    others = (place for number, place in atlas.places.items() if number != frontier.place)
    return any(sees(place, frontier.x, frontier.y, settings) for place in others)


def _is_like(a: Frontier, b: Frontier, settings: PlacesSettings) -> bool:
    return math.hypot(a.x - b.x, a.y - b.y) <= settings.same


def way_out(
    atlas: Atlas, ends: Sequence[Frontier], blocked: Collection[Way], pose: Pose, goal: Pose, settings: PlacesSettings
) -> tuple[tuple[int, ...], Frontier] | None:
    """The places to pass and the frontier to go on at, by A*: least driven time and straight way to the goal beyond it.

    None where no frontier can be reached.
    """
    import networkx as nx  # it takes long to import, and few runs come here

    if atlas.here is None:
        return None
    graph: nx.Graph[int] = nx.Graph()
    spots = {number: (place.x, place.y) for number, place in atlas.places.items()}
    spots[HERE], spots[GOAL] = (pose.x, pose.y), (goal.x, goal.y)
    graph.add_edge(HERE, atlas.here, weight=_time(spots[HERE], spots[atlas.here], settings))
    for (a, b), time in atlas.ways.items():
        if (a, b) not in blocked:
            graph.add_edge(a, b, weight=max(time, _time(spots[a], spots[b], settings)))
    first = max(atlas.places) + 1
    for number, end in enumerate(ends, first):
        spots[number] = (end.x, end.y)
        graph.add_edge(end.place, number, weight=_time(spots[end.place], spots[number], settings))
        graph.add_edge(number, GOAL, weight=_time(spots[number], spots[GOAL], settings))
    try:
        path = nx.astar_path(graph, HERE, GOAL, lambda a, b: _time(spots[a], spots[b], settings))
    except (nx.NetworkXNoPath, nx.NodeNotFound):
        return None
    return tuple(path[1:-2]), ends[path[-2] - first]


def _time(a: tuple[float, float], b: tuple[float, float], settings: PlacesSettings) -> float:
    return math.dist(a, b) / settings.speed


def straight_to(pose: Pose, goal: Pose, circles: Sequence[Circle], settings: PlacesSettings) -> bool:
    """Whether the goal is in sight and the lane to it clear."""
    away = distance(pose, goal)
    heading = math.atan2(goal.y - pose.y, goal.x - pose.x)
    return away <= clear_for(pose.x, pose.y, [heading], circles, settings)[0]
