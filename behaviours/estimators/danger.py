"""Whether anything is within the safety radius of the hull.

Takes: both sonar rings, or another ring. Gives: danger with a release margin, and the nearest range.
Leaves alone: what to do about it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from behaviours.cores.runaway import Echo, RunawaySettings, nearest
from behaviours.cores.sectors import RingOf, skirt, waist
from behaviours.interface import Channels, Ranges, Reading, Report


class Danger:
    """Danger begins within the safety radius and ends beyond it plus the release margin."""

    def __init__(self, settings: RunawaySettings, rings_of: Sequence[RingOf] = (waist, skirt)) -> None:
        self.settings = settings
        self._rings_of = rings_of
        self.echoes: tuple[Echo, ...] = ()
        self.nearest_range = 0.0
        self.is_near = False

    def update(self, reading: Reading, reports: Mapping[str, Report], channels: Channels) -> None:
        rings = [ring for ring in (ring_of(reading) for ring_of in self._rings_of) if ring is not None]
        if not self.echoes or any(ring.fresh for ring in rings):
            self.echoes = tuple(echo for ring in rings for echo in echoes_of(ring))
            far = max((ring.max_range for ring in rings), default=0.0)
            self.nearest_range = min(far, nearest(self.echoes))
        margin = self.settings.release if self.is_near else 0.0
        self.is_near = bool(self.echoes) and self.nearest_range < self.settings.safety_radius + margin


def echoes_of(ring: Ranges) -> tuple[Echo, ...]:
    """(range [m] from the hull, bearing [rad]) of every transducer."""
    return tuple(zip(ring.ranges.tolist(), ring.bearings.tolist(), strict=True))
