"""What moves: clusters of echoes followed from sweep to sweep by their edges.

Takes: the echoes of one sweep that come from something that moves, and the tracks so far. Gives: the tracks after it,
with velocities. Leaves alone: which echoes those are.

A thing that comes into view or leaves it has one edge that moves with it and one that is where the view ends, so each
edge of the box about a cluster has an alpha-beta filter of its own, and the faster of two opposite edges is believed.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from behaviours.interface import Vec2

Edge = tuple[float, float]
"""Place [m], velocity [m/s]."""


@dataclass(frozen=True, slots=True)
class TrackSettings:
    """settle [s]: time constant of the filters of the edges; link, gate [m]: within a cluster, and to its track.

    jump [m]: an edge of a known track that is off by more than this has come into view or gone out of it, and says
    nothing of the velocity. patience [s]: a track without an echo is kept so long. moving, fastest [m/s]: slower is
    standing, faster is not believed; sightings: sweeps until a velocity is believed; gone [m]: so far its middle must
    have gone.
    """

    settle: float = 0.35
    link: float = 1.5
    gate: float = 1.2
    jump: float = 0.4
    patience: float = 0.7
    moving: float = 0.3
    fastest: float = 3.0
    sightings: int = 3
    gone: float = 0.5


@dataclass(frozen=True, slots=True)
class Track:
    """A moving thing: its echoes at `stamp` [s], the edges of the box about them, and in how many sweeps it was heard.

    first: the middle of the box when it was met.
    """

    ident: int
    stamp: float
    points: tuple[Vec2, ...]
    edges: tuple[Edge, Edge, Edge, Edge]
    first: Vec2
    sightings: int = 1

    @property
    def velocity(self) -> Vec2:
        """[m/s]: of the faster edge along the axis on which it moves more, of both edges along the other."""
        low_x, high_x, low_y, high_y = (edge[1] for edge in self.edges)
        x, y = max(low_x, high_x, key=abs), max(low_y, high_y, key=abs)
        return (x, (low_y + high_y) / 2) if abs(x) >= abs(y) else ((low_x + high_x) / 2, y)

    @property
    def gone(self) -> float:
        """How far the middle has gone along its velocity [m]."""
        (vx, vy), speed = self.velocity, self.speed
        x, y = (self.edges[0][0] + self.edges[1][0]) / 2, (self.edges[2][0] + self.edges[3][0]) / 2
        return ((x - self.first[0]) * vx + (y - self.first[1]) * vy) / speed if speed > 0.0 else 0.0

    @property
    def speed(self) -> float:
        """[m/s]"""
        return math.hypot(*self.velocity)


@dataclass(frozen=True, slots=True)
class Tracks:
    """All that is followed."""

    tracks: tuple[Track, ...] = ()
    next_ident: int = 0

    def moving(self, settings: TrackSettings) -> tuple[Track, ...]:
        """Those that are known to move."""
        return tuple(
            t
            for t in self.tracks
            if t.sightings >= settings.sightings and t.speed >= settings.moving and t.gone >= settings.gone
        )


def follow(tracks: Tracks, points: Sequence[Vec2], now: float, settings: TrackSettings) -> Tracks:
    """The tracks after a sweep with these echoes at stamp now [s]; several clusters may go on one track."""
    taken: list[list[Vec2]] = [[] for _ in tracks.tracks]
    after: list[Track] = []
    for cluster in cluster_of(points, settings.link):
        at = _nearest(tracks.tracks, cluster, now, settings)
        if at is None:
            after.append(_new(tracks.next_ident + len(after), cluster, now))
        else:
            taken[at] += cluster
    next_ident = tracks.next_ident + len(after)
    for track, seen in zip(tracks.tracks, taken, strict=True):
        if seen:
            after.append(_updated(track, seen, now, settings))
        elif now - track.stamp <= settings.patience:
            after.append(track)
    return Tracks(tuple(sorted(after, key=lambda track: track.ident)), next_ident)


def cluster_of(points: Sequence[Vec2], link: float) -> list[list[Vec2]]:
    """Points that are reached from each other by steps of no more than `link` [m]."""
    left = list(points)
    clusters = []
    while left:
        cluster = [left.pop(0)]
        for x, y in cluster:
            near = [p for p in left if math.hypot(p[0] - x, p[1] - y) <= link]
            left = [p for p in left if p not in near]
            cluster += near
        clusters.append(cluster)
    return clusters


def _box(points: Sequence[Vec2]) -> tuple[float, float, float, float]:
    xs, ys = [p[0] for p in points], [p[1] for p in points]
    return min(xs), max(xs), min(ys), max(ys)


def _new(ident: int, points: Sequence[Vec2], now: float) -> Track:
    a, b, c, d = _box(points)
    return Track(ident, now, tuple(points), ((a, 0.0), (b, 0.0), (c, 0.0), (d, 0.0)), ((a + b) / 2, (c + d) / 2))


def _nearest(tracks: Sequence[Track], points: Sequence[Vec2], now: float, settings: TrackSettings) -> int | None:
    """The place of the track that this cluster goes on, if there is one."""
    gaps = []
    for at, track in enumerate(tracks):
        (vx, vy), dt = track.velocity, now - track.stamp
        gap = min(math.hypot(p[0] - x - vx * dt, p[1] - y - vy * dt) for p in points for x, y in track.points)
        gaps.append((gap, at))
    best = min(gaps, default=(math.inf, 0))
    return best[1] if best[0] <= settings.gate else None


def _updated(track: Track, points: Sequence[Vec2], now: float, settings: TrackSettings) -> Track:
    dt = now - track.stamp
    if dt <= 0.0:
        return track
    gains = _gains(track.sightings + 1, dt, settings)
    jump = settings.jump if track.sightings >= settings.sightings else math.inf
    boxes = zip(track.edges, _box(points), strict=True)
    a, b, c, d = (_filtered(edge, seen, dt, gains, jump, settings.fastest) for edge, seen in boxes)
    return Track(track.ident, now, tuple(points), (a, b, c, d), track.first, track.sightings + 1)


def _gains(sightings: int, dt: float, settings: TrackSettings) -> tuple[float, float]:
    """alpha and beta: those of the best line through all sightings, until these are fewer than the filter remembers."""
    k = sightings
    alpha = max(1.0 - math.exp(-dt / settings.settle), 2.0 * (2 * k - 1) / (k * (k + 1)))
    return alpha, 6.0 / (k * (k + 1)) if alpha > 1.0 - math.exp(-dt / settings.settle) else alpha * alpha / (
        2.0 - alpha
    )


def _filtered(edge: Edge, seen: float, dt: float, gains: tuple[float, float], jump: float, fastest: float) -> Edge:
    place, speed = edge[0] + edge[1] * dt, edge[1]
    miss = seen - place
    if abs(miss) > jump:
        return seen, speed
    return place + gains[0] * miss, min(fastest, max(-fastest, speed + gains[1] * miss / dt))
