"""What is around the robot as circles, and what of it moves.

Takes: every fresh sweep of the ring, odometry. Gives: circles, velocities of those that move, moving points.
Leaves alone: the plan. Without `memory` and `tracking` it is the perception of Bonasso, Antonisse and Slack 1992.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from behaviours.cores.circles import Circle, Circles, CircleSettings, perceive
from behaviours.cores.collision import Moving
from behaviours.cores.cone import echoes_of
from behaviours.cores.evidence import Evidence, EvidenceSettings
from behaviours.cores.tracking import Track, Tracks, TrackSettings, follow
from behaviours.interface import Pose, Ranges, Vec2

NEAR_TRACK = 0.8
"""A circle whose edge is this near [m] to an echo of something that moves moves with it."""


@dataclass(frozen=True, slots=True)
class PerceptionSettings:
    """memory: what stands is kept in a grid; tracking: what moves is followed."""

    memory: bool = False
    tracking: bool = False
    evidence: EvidenceSettings = field(default_factory=EvidenceSettings)
    track: TrackSettings = field(default_factory=TrackSettings)


class Perception:
    """circles: all that is known now."""

    def __init__(self, circles: CircleSettings, settings: PerceptionSettings) -> None:
        self._circles, self.settings = circles, settings
        self._evidence = Evidence(settings.evidence) if settings.memory or settings.tracking else None
        self.memory = Circles()
        self.tracks = Tracks()
        self.circles: tuple[Circle, ...] = ()

    def take(self, ring: Ranges, pose: Pose, now: float) -> None:
        """One sweep at stamp now [s]."""
        echoes = echoes_of(ring, pose, self._circles.half_cone, self._circles.neighbours_near)
        if self._evidence is None:
            self.memory = perceive(self.memory, echoes, self._circles)
            self.circles = self.memory.circles
            return
        moving = self._evidence.sweep(ring, pose, echoes, now)
        fleeting = [echo for echo, moves in zip(echoes, moving, strict=True) if moves]
        if self.settings.tracking:
            self.tracks = follow(self.tracks, [point for _, point in fleeting], now, self.settings.track)
        if not self.settings.memory:
            self.memory = perceive(self.memory, echoes, self._circles)
            self.circles = self.memory.circles
            return
        standing = zip(echoes, moving, strict=True)
        self._evidence.hear([p for (reach, p), moves in standing if not moves and reach <= self._circles.far], now)
        self.memory = perceive(self.memory, fleeting, self._circles)
        self.circles = self.memory.circles + self._evidence.circles(pose, now)

    def moving(self) -> tuple[Track, ...]:
        """What is known to move."""
        return self.tracks.moving(self.settings.track)

    def moving_points(self, now: float) -> list[Moving]:
        """Every echo of what moves where it is at stamp now [s], with its velocity."""
        found: list[Moving] = []
        for track in self.moving():
            (vx, vy), dt = track.velocity, now - track.stamp
            found += [((x + vx * dt, y + vy * dt), (vx, vy)) for x, y in track.points]
        return found

    def velocities(self) -> Mapping[int, Vec2]:
        """Circle -> its velocity [m/s], of those that move."""
        tracks = self.moving()
        return {c.ident: t.velocity for c in self.memory.circles for t in tracks if _is_of(c, t)} if tracks else {}


def _is_of(circle: Circle, track: Track) -> bool:
    return any(math.hypot(circle.x - x, circle.y - y) - circle.radius <= NEAR_TRACK for x, y in track.points)
