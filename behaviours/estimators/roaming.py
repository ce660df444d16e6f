"""Where to listen next, and when it is time to listen.

Takes: what was heard of beacons, the searches, the memory of donors, odometry. Gives: a place to drive to, and whether
to stop and listen. Leaves alone: the way there (navigation), and listening itself (ir-search).

A beacon that is wanted and was heard, but is not located, is approached; else the next place is where the chance to
hear one is greatest for the time that it takes, or the next stop of a spiral about home.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from behaviours.cores.beacon_grid import Cells, Estimate, best_listening, disc
from behaviours.cores.geometry import along, bearing, distance
from behaviours.estimators.beacons import Beacons
from behaviours.estimators.donor import DonorMemory
from behaviours.estimators.ir_search import START, IrSearch
from behaviours.interface import Channels, Pose, Reading, Report

SPACING = 9.0  # [m] between rings, and between stops on one


@dataclass(frozen=True, slots=True)
class RoamingSettings:
    """Lengths [m], times [s], speed [m/s].

    approach: how near a beacon is listened to again; near: a beacon that is heard closer than this on the way is worth
    a stop; apart: places where one listens are so far from each other; there: so near a place one is there.
    stops: of the candidates; avoid: about a place that could not be reached; stalled: without getting nearer.
    spiral: stops in rings about home, instead of by chance to hear.
    """

    approach: float = 4.0
    near: float = 6.5
    apart: float = 1.5
    there: float = 0.5
    stops: float = 2.0
    avoid: float = 2.5
    stalled: float = 45.0
    roaming_speed: float = 0.15
    listening: float = 40.0
    spiral: bool = False


class Roaming:
    """place: where to drive to listen; None while a search goes on or its result stands."""

    def __init__(self, settings: RoamingSettings, ir: IrSearch, donor: DonorMemory, beacons: Beacons) -> None:
        self.settings = settings
        self.place: Pose | None = None
        self.is_due = True
        self._ir, self._donor, self._beacons = ir, donor, beacons
        self._listened: tuple[Pose, ...] = ()
        self._avoided: tuple[Pose, ...] = ()
        self._searched = False
        self._nearest, self._since = math.inf, 0.0
        self._rings: tuple[Pose, ...] | None = None

    def update(self, reading: Reading, reports: Mapping[str, Report], channels: Channels) -> None:
        pose = reading.odometry.pose
        if self._rings is None:
            self._rings = rings(pose, self._beacons.settings.farthest)
        if START in reports:
            self.is_due, self.place = False, None
            self._listened = (*self._listened, pose)
        searching = self._ir.is_running()
        interrupted = self._searched and not searching and not self._ir.is_finished()
        self._searched = searching
        if searching or reading.object_on_board or self._ir.knows_direction() or self._donor.is_located():
            self.place = None
        elif interrupted:
            self.is_due = True
        elif not self.is_due:
            self._go_on(pose, reading.stamp)

    def _go_on(self, pose: Pose, stamp: float) -> None:
        if self.place is None:
            self._set_out(pose, stamp)
        elif distance(pose, self.place) <= self.settings.there or self._hears(pose):
            self.is_due = True
        elif self._is_stalled(pose, stamp):
            self._avoided = (*self._avoided, self.place)
            self.is_due = True

    def _set_out(self, pose: Pose, stamp: float) -> None:
        self.place = self._next(pose)
        self.is_due = self.place is None
        self._nearest, self._since = math.inf, stamp

    def _is_stalled(self, pose: Pose, stamp: float) -> bool:
        away = math.inf if self.place is None else distance(pose, self.place)
        if away < self._nearest - 0.3:
            self._nearest, self._since = away, stamp
        return stamp - self._since > self.settings.stalled

    def _hears(self, pose: Pose) -> bool:
        """Whether a wanted beacon was just heard, near enough, and not where it has been listened to already."""
        name, at = self._beacons.latest, self._beacons.estimate(self._beacons.latest)
        if at is None or not self._donor.wants(name):
            return False
        fresh = all(distance(pose, place) > self.settings.apart for place in self._listened)
        return fresh and math.hypot(at.x - pose.x, at.y - pose.y) <= self.settings.near

    def _next(self, pose: Pose) -> Pose | None:
        wanted = [self._beacons.estimate(name) for name in self._beacons.heard if self._donor.wants(name)]
        known = [at for at in wanted if at is not None]
        if known:
            nearest = min(known, key=lambda at: math.hypot(at.x - pose.x, at.y - pose.y))
            place = self._beside(nearest, pose)
            if place is not None:
                return place
        return self._next_stop() if self.settings.spiral else self._best(pose)

    def _beside(self, at: Estimate, pose: Pose) -> Pose | None:
        """The nearest place around a beacon from which it was not listened to yet, looking at it."""
        middle = Pose(at.x, at.y)
        around = [along(middle, bearing(middle, pose) + k * math.tau / 12, self.settings.approach) for k in range(12)]
        free = [place for place in around if self._is_new(place, self.settings.apart)]
        if not free:
            return None
        place = min(free, key=lambda place: distance(place, pose))
        return Pose(place.x, place.y, bearing(place, middle))

    def _best(self, pose: Pose) -> Pose | None:
        s, beacons = self.settings, self._beacons
        home = Pose(float(beacons.cells.x.mean()), float(beacons.cells.y.mean()))
        every = disc(home, beacons.settings.farthest, s.stops)
        new = np.array([self._is_new(Pose(float(x), float(y)), s.apart) for x, y in zip(every.x, every.y, strict=True)])
        candidates = Cells(every.x[new], every.y[new])
        model = beacons.settings.model
        best = best_listening(beacons.cells, beacons.logs(), candidates, pose, model, s.roaming_speed, s.listening)
        return None if best is None else Pose(best[0].x, best[0].y, bearing(pose, best[0]))

    def _next_stop(self) -> Pose | None:
        """The next stop of the spiral; from the last one it begins anew."""
        stops = [stop for stop in self._rings or () if self._is_new(stop, self.settings.apart)]
        if not stops:
            self._listened, self._avoided = (), ()
            return None
        return stops[0]

    def _is_new(self, place: Pose, apart: float) -> bool:
        return all(distance(place, other) > apart for other in self._listened) and all(
            distance(place, other) > self.settings.avoid for other in self._avoided
        )


def rings(home: Pose, farthest: float) -> tuple[Pose, ...]:
    """Stops on rings about home, `SPACING` from one another, from the inside out."""
    stops = []
    for ring in range(1, max(1, round(farthest / SPACING)) + 1):
        count = math.ceil(math.tau * ring)
        stops += [along(home, home.theta + k * math.tau / count, ring * SPACING) for k in range(count)]
    return tuple(stops)
