"""When the flippers of a tracked robot shall be out: while the drive motors labour, and for a while after.

Takes: stamps, and what the two motors draw. Gives: whether the flippers are wanted out. Leaves alone: moving them.
Source: Yamauchi 2005, "Wayfarer", section 4.1 (15 A, 10 s, 2 A). Either motor deploys, only both together retract;
a motor that labours again starts the ten seconds anew. The low-pass against inrush is not printed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

SLACK = 1e-9
"""[s] that rounding may take from a time."""


@dataclass(frozen=True, slots=True)
class LabourSettings:
    """deploy_above, retract_below [A]: strictly; least [s]: for which they stay out at least; smoothing [s]."""

    deploy_above: float = 15.0
    retract_below: float = 2.0
    least: float = 10.0
    smoothing: float = 0.2


class Labour:
    """Home, or out since a stamp. out: the flippers are wanted out; left, right [A]: the smoothed currents."""

    def __init__(self, settings: LabourSettings) -> None:
        self._settings = settings
        self.out = False
        self.left = self.right = 0.0
        self._stamp: float | None = None
        self._laboured = -math.inf

    def take(self, stamp: float, left: float, right: float) -> None:
        """What the motors draw [A], either way round, at a stamp [s]."""
        s = self._settings
        share = self._share(stamp)
        self.left += share * (abs(left) - self.left)
        self.right += share * (abs(right) - self.right)
        self._stamp = stamp
        most = max(self.left, self.right)
        if most > s.deploy_above:
            self.out, self._laboured = True, stamp
        elif self.out and most < s.retract_below and stamp - self._laboured >= s.least - SLACK:
            self.out = False

    def _share(self, stamp: float) -> float:
        """How far the smoothed currents follow; the first ones are taken as they are."""
        if self._stamp is None or self._settings.smoothing <= 0.0:
            return 1.0
        return 1.0 - math.exp(-(stamp - self._stamp) / self._settings.smoothing)
