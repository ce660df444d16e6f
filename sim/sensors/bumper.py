"""Contact switches round the hull.

Takes: the bearings of true contacts. Gives: `Bumper`. Leaves alone: how hard the contact is.

Each switch covers an equal share of the directions seen from the origin of the robot frame; the first is ahead.
"""

from __future__ import annotations

import math

import numpy as np

from behaviours.interface import Bumper
from sim.sensors.build import BumperBuild
from sim.sensors.truth import Truth


class ContactSwitches:
    """The switches of one robot."""

    def __init__(self, build: BumperBuild) -> None:
        self._segments = build.segments
        turns = np.arange(build.segments) / build.segments
        self._bearings = np.where(turns > 0.5, turns - 1.0, turns) * math.tau
        self._none = np.zeros(build.segments, dtype=np.bool_)
        self._bearings.setflags(write=False)
        self._none.setflags(write=False)

    def measure(self, truth: Truth) -> tuple[Bumper]:
        """Which are pressed."""
        pressed = self._none
        if truth.touched:
            pressed = self._none.copy()
            pressed[[round(bearing / math.tau * self._segments) % self._segments for bearing in truth.touched]] = True
            pressed.setflags(write=False)
        return (Bumper(truth.time, True, self._bearings, pressed),)
