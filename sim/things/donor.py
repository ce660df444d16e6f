"""Donors: robots with a beacon that hand objects over to whoever stands by them; and what becomes of the objects.

Takes: how near the robot is to each donor and to home, and whether it stands. Gives: what lies on its platform, and
what has been brought home. Leaves alone: where donors are (things like any other) and how their beacons are heard.
"""

from __future__ import annotations

from collections.abc import Sequence

HOME = 1.0  # [m] from the start: what counts as home


class HandOver:
    """An object changes hands once the robot has stood within reach for `duration` [s] without a break.

    reach [m]: widest gap between the hulls that the donor's arm still bridges. objects: how many it still holds.
    """

    def __init__(self, reach: float, duration: float, objects: int = 1) -> None:
        self.reach, self.objects = reach, objects
        self._duration = duration
        self._stood = 0.0

    def update(self, gap: float, standing: bool, free: bool, dt: float) -> bool:
        """One tick: gap [m] between the hulls; free: the platform is. Whether an object changed hands."""
        there = standing and free and self.objects > 0 and gap <= self.reach
        self._stood = self._stood + dt if there else 0.0
        if not there or self._stood < self._duration - dt / 2:
            return False
        self.objects, self._stood = self.objects - 1, 0.0
        return True


class Errand:
    """All objects of a run. deliveries: moments [s] at which one had been brought home.

    unload [s]: how long the robot stands at home until its object counts as brought; it is then taken off if `takes`,
    or if there are more to fetch.
    """

    def __init__(self, donors: Sequence[HandOver], unload: float, takes: bool) -> None:
        self.donors = tuple(donors)
        self.on_board = False
        self.deliveries: tuple[float, ...] = ()
        self._unload, self._takes = unload, takes
        self._home_for, self._brought = 0.0, False

    @property
    def done(self) -> bool:
        """Whether every object has been brought home."""
        return bool(self.donors) and self.left == 0 and (not self.on_board or self._brought)

    @property
    def left(self) -> int:
        """Objects that donors still hold."""
        return sum(donor.objects for donor in self.donors)

    def in_reach(self, gaps: Sequence[float]) -> bool:
        """Whether a donor that holds an object reaches the robot; gaps [m] between the hulls."""
        return any(d.objects > 0 and gap <= d.reach for d, gap in zip(self.donors, gaps, strict=True))

    def update(self, time: float, gaps: Sequence[float], standing: bool, home: float, dt: float) -> None:
        """One tick, over at `time` [s]; home [m]: distance from the start."""
        for donor, gap in zip(self.donors, gaps, strict=True):
            if donor.update(gap, standing, not self.on_board, dt):
                self.on_board, self._brought, self._home_for = True, False, 0.0
                return
        self._bring(time, standing and home <= HOME, dt)

    def _bring(self, time: float, at_home: bool, dt: float) -> None:
        waits = self.on_board and not self._brought and at_home
        self._home_for = self._home_for + dt if waits else 0.0
        if waits and self._home_for >= self._unload - dt / 2:
            self.deliveries += (time,)
            self._brought = True
            self.on_board = not (self._takes or self.left > 0)
