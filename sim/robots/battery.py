"""The battery of a robot.

Takes: whether it drives and whether a charger is near. Gives: its level. Leaves alone: what an empty one stops (the
world holds the drive still).
"""

from __future__ import annotations

from dataclasses import dataclass

from behaviours.interface import Battery

IDLE_SHARE = 0.2  # of what driving takes, while it stands


@dataclass(frozen=True, slots=True)
class BatteryBuild:
    """lasts [s] of driving; charges_in [s] from empty to full; level at the start, 0 to 1."""

    lasts: float = 3600.0
    charges_in: float = 600.0
    level: float = 1.0


class Cells:
    """The level now, 0 to 1."""

    def __init__(self, build: BatteryBuild) -> None:
        self._build, self.level, self.charging = build, build.level, False

    @property
    def empty(self) -> bool:
        """Whether it drives nothing any more."""
        return self.level <= 0.0

    def update(self, standing: bool, charger: bool, dt: float) -> None:
        """One tick; charger: one is in reach."""
        self.charging = standing and charger
        if self.charging:
            self.level = min(1.0, self.level + dt / self._build.charges_in)
        else:
            self.level = max(0.0, self.level - dt / self._build.lasts * (IDLE_SHARE if standing else 1.0))

    def reading(self, stamp: float) -> Battery:
        """As the robot senses it."""
        return Battery(stamp, True, self.level, self.charging)
