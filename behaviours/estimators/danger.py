"""Whether anything is within the safety radius of the hull.

Takes: both sonar rings. Gives: danger with a release margin, and the nearest range. Leaves alone: what to do about it.
"""

from __future__ import annotations

from collections.abc import Mapping

from behaviours.cores.runaway import Echo, RunawaySettings, nearest
from behaviours.interface import Channels, Ranges, Reading, Report


class Danger:
    """Danger begins within the safety radius and ends beyond it plus the release margin."""

    def __init__(self, settings: RunawaySettings) -> None:
        self.settings = settings
        self.echoes: tuple[Echo, ...] = ()
        self.nearest_range = 0.0
        self.is_near = False

    def update(self, reading: Reading, reports: Mapping[str, Report], channels: Channels) -> None:
        rings = [ring for ring in (reading.sonar, reading.skirt) if ring is not None]
        if not self.echoes or any(ring.fresh for ring in rings):
            self.echoes = tuple(echo for ring in rings for echo in echoes_of(ring))
            far = max((ring.max_range for ring in rings), default=0.0)
            self.nearest_range = min(far, nearest(self.echoes))
        margin = self.settings.release if self.is_near else 0.0
        self.is_near = bool(self.echoes) and self.nearest_range < self.settings.safety_radius + margin


def echoes_of(ring: Ranges) -> tuple[Echo, ...]:
    """(range [m] from the hull, bearing [rad]) of every transducer."""
    return tuple(zip(ring.ranges.tolist(), ring.bearings.tolist(), strict=True))
