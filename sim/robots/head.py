"""The pan-tilt head that carries the infra-red reader and the verging cameras.

Takes: a `Head` command. Gives: where it looks and since when it has been still. Leaves alone: the sensors on it.
"""

from __future__ import annotations

import math

from behaviours.interface import Head, HeadState
from sim.frames import approach

SLEW = math.radians(60)  # [rad/s], each axis
PAN_LIMIT = math.pi
TILT_LIMITS = (-math.pi / 6, math.pi / 2)


class PanTilt:
    """The head. still_for [s]: how long it has looked in one direction."""

    def __init__(self) -> None:
        self.pan, self.tilt, self.still_for = 0.0, 0.0, 0.0
        self._wanted = Head(0.0, 0.0)

    def command(self, head: Head) -> None:
        """Where to look from now on; clipped to the stops of the axes."""
        pan = max(-PAN_LIMIT, min(PAN_LIMIT, head.pan))
        self._wanted = Head(pan, max(TILT_LIMITS[0], min(TILT_LIMITS[1], head.tilt)))

    def move(self, dt: float) -> None:
        """Turn for one tick."""
        pan, tilt = approach(self.pan, self._wanted.pan, SLEW * dt), approach(self.tilt, self._wanted.tilt, SLEW * dt)
        still = pan == self.pan and tilt == self.tilt
        self.pan, self.tilt = pan, tilt
        self.still_for = self.still_for + dt if still else 0.0

    @property
    def state(self) -> HeadState:
        """As the robot senses it; settled as soon as it is where it was sent."""
        return HeadState(self.pan, self.tilt, (self.pan, self.tilt) == (self._wanted.pan, self._wanted.tilt))
