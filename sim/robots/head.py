"""The pan-tilt head that carries the infra-red reader and the verging cameras.

Takes: a `Head` command. Gives: where it looks and since when it has been still. Leaves alone: the sensors on it.

A head may get stuck: it then follows no command until somebody jolts it free. A light jam gives way to the tilt being
sent to 0 for a second, a bad one to pan and tilt being sent to 0 for three; the worst only to a person.
"""

from __future__ import annotations

import math

from behaviours.interface import Head, HeadState
from sim.frames import approach

SLEW = math.radians(60)  # [rad/s], each axis
PAN_LIMIT = math.pi
TILT_LIMITS = (-math.pi / 6, math.pi / 2)
LIGHT, BAD, WORST = 1, 2, 3
JOLTS = {LIGHT: 1.0, BAD: 3.0, WORST: math.inf}  # [s]


class PanTilt:
    """The head. still_for [s]: how long it has looked in one direction. jam: 0, or how badly it is stuck."""

    def __init__(self) -> None:
        self.pan, self.tilt, self.still_for = 0.0, 0.0, 0.0
        self.jam = 0
        self._wanted = Head(0.0, 0.0)
        self._jolted_for = 0.0

    def command(self, head: Head) -> None:
        """Where to look from now on; clipped to the stops of the axes."""
        pan = max(-PAN_LIMIT, min(PAN_LIMIT, head.pan))
        self._wanted = Head(pan, max(TILT_LIMITS[0], min(TILT_LIMITS[1], head.tilt)))

    def stick(self, how: int) -> None:
        """Get stuck where it is: LIGHT, BAD or WORST."""
        if not self.jam:
            self.jam, self._jolted_for = how, 0.0

    def free(self) -> None:
        """Somebody frees it."""
        self.jam = 0

    def move(self, dt: float) -> None:
        """Turn for one tick."""
        if self.jam:
            self._jolt(dt)
            return
        pan, tilt = approach(self.pan, self._wanted.pan, SLEW * dt), approach(self.tilt, self._wanted.tilt, SLEW * dt)
        still = pan == self.pan and tilt == self.tilt
        self.pan, self.tilt = pan, tilt
        self.still_for = self.still_for + dt if still else 0.0

    def _jolt(self, dt: float) -> None:
        wanted = self._wanted
        jolts = wanted.tilt == 0.0 and (self.jam == LIGHT or wanted.pan == 0.0)
        self._jolted_for = self._jolted_for + dt if jolts else 0.0
        self.still_for = 0.0
        if self._jolted_for >= JOLTS[self.jam] - dt / 2:
            self.jam = 0

    @property
    def state(self) -> HeadState:
        """As the robot senses it; settled as soon as it is where it was sent, and free."""
        there = (self.pan, self.tilt) == (self._wanted.pan, self._wanted.tilt)
        return HeadState(self.pan, self.tilt, there and not self.jam)
