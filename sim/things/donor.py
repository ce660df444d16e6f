"""The donor: a robot with an infra-red beacon that hands its object over to whoever stands by it.

Takes: how near the robot is and whether it stands. Gives: whether the object lies on the robot's platform.
Leaves alone: where the donor is (a thing like any other) and how its beacon is heard.
"""

from __future__ import annotations


class HandOver:
    """The object changes hands once the robot has stood within reach for `duration` [s] without a break.

    reach [m]: widest gap between the hulls that the donor's arm still bridges.
    """

    def __init__(self, reach: float, duration: float) -> None:
        self.reach = reach
        self._duration = duration
        self._stood = 0.0
        self.on_board = False

    def update(self, gap: float, standing: bool, dt: float) -> None:
        """One tick: gap [m] between the hulls."""
        self._stood = self._stood + dt if standing and gap <= self.reach else 0.0
        self.on_board = self.on_board or self._stood >= self._duration - dt / 2
