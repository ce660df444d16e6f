"""What all sensors have in common: when they measure, when that arrives, and what goes wrong on the way.

Takes: an `Instrument` (how one kind measures, and when it is due), a latency, faults, chance. Gives: `Sensor`, which is
asked once a tick. Leaves alone: what a kind measures (the files named after the kinds).

Time is counted in whole ticks. What is measured carries the stamp of that tick; it arrives `latency` later and is
`fresh` in the tick of its arrival alone; until the next one arrives it is repeated. A fault changes what is measured
while it lasts. The instrument measures on behind it, so that afterwards all is as if the fault had not been.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, replace

from numpy.random import Generator

from behaviours.interface import Pose, Sensed
from sim.sensors.build import Fault, Mount
from sim.sensors.faults import biased, blanked
from sim.sensors.truth import Truth

Measured = tuple[Sensed, ...]
"""What one sensor measures at one instant: one reading for each of the fields that it fills."""

ROUNDING = 1e-6  # of a tick, and [s], that sums of floating-point times may be off


@dataclass(frozen=True, slots=True)
class Instrument:
    """How one kind measures.

    fields: which fields of the `Reading` it fills. due: asked once a tick, whether to measure now. first: what it says
    before anything has arrived. update: called after each tick of the world, measured or not.
    """

    fields: tuple[str, ...]
    measure: Callable[[Truth], Measured]
    due: Callable[[Truth], bool]
    first: Measured | None = None
    update: Callable[[Truth], None] | None = None


class Every:
    """Due at the first tick and then each `period` [s], in whole ticks; each tick where the period is shorter."""

    def __init__(self, period: float) -> None:
        self._period, self._ticks = period, 0

    def __call__(self, truth: Truth) -> bool:
        if not self._ticks:
            self._ticks = max(1, round(self._period / truth.dt))
        return truth.tick % self._ticks == 0


class Fixation:
    """Due when the head has been settled for `period` [s], and again after each such time.

    base_too: the base must have stood still as well.
    """

    def __init__(self, period: float, base_too: bool = False) -> None:
        self._period, self._base_too, self._used = period, base_too, 0.0

    def __call__(self, truth: Truth) -> bool:
        still = min(truth.head_still_for, truth.still_for) if self._base_too else truth.head_still_for
        due = truth.head.settled and min(still, truth.time - self._used) >= self._period - ROUNDING
        if due:
            self._used = truth.time
        return due


class Sensor:
    """One sensor of a robot. `sense` is called once a tick."""

    def __init__(self, instrument: Instrument, latency: float, faults: tuple[Fault, ...], chance: Generator) -> None:
        """latency [s]; faults: its own; chance: which readings drop out."""
        self._due, self._measure = instrument.due, instrument.measure
        self._latency, self._faults, self._chance = latency, faults, chance
        self._latest = instrument.first
        self._fresh = False
        self._sound: Measured | None = None
        self._under_way: deque[tuple[int, Measured]] = deque()

    def sense(self, truth: Truth) -> Measured | None:
        """What it says now; None while nothing has arrived."""
        arrived = self._measure(truth) if self._due(truth) else None
        if arrived is not None and self._faults:
            arrived = self._faulty(truth.time, arrived)
        if self._latency:
            arrived = self._delayed(truth, arrived)
        if arrived is not None:
            self._latest, self._fresh = arrived, True
        elif self._fresh and self._latest is not None:
            self._latest, self._fresh = tuple([replace(reading, fresh=False) for reading in self._latest]), False
        return self._latest

    def _delayed(self, truth: Truth, measured: Measured | None) -> Measured | None:
        """Put what was measured on its way, and take what arrives now."""
        if measured is not None:
            self._under_way.append((truth.tick + math.ceil(self._latency / truth.dt - ROUNDING), measured))
        arrived = None
        while self._under_way and self._under_way[0][0] <= truth.tick:
            arrived = self._under_way.popleft()[1]
        return arrived

    def _faulty(self, time: float, measured: Measured) -> Measured | None:
        """What the faults of this time leave of it, in their order; None where it is lost."""
        left: Measured | None = measured
        stuck = False
        for fault in self._faults:
            if fault.start <= time + ROUNDING < fault.end:
                stuck = stuck or fault.kind == "stuck"
                left = self._spoilt(fault, time, left)
        if not stuck:
            self._sound = measured
        return left

    def _spoilt(self, fault: Fault, time: float, measured: Measured | None) -> Measured | None:
        match fault.kind:
            case "dropout":
                return None if self._chance.random() < fault.amount else measured
            case _ if measured is None:
                return None
            case "stuck":
                return self._repeated(time, measured)
            case "bias":
                return tuple([biased(reading, fault.amount) for reading in measured])
            case _:
                return tuple([blanked(reading) for reading in measured])

    def _repeated(self, time: float, measured: Measured) -> Measured:
        """What was measured last before it stuck, as if it were of now."""
        if self._sound is None:
            self._sound = measured
        return tuple([replace(reading, stamp=time, fresh=True) for reading in self._sound])


def mounted(p_WR: Pose, mount: Mount) -> Pose:
    """Where in the world a sensor is that sits there on a robot."""
    if mount.x == mount.y == mount.theta == 0.0:
        return p_WR
    c, s = math.cos(p_WR.theta), math.sin(p_WR.theta)
    return Pose(p_WR.x + c * mount.x - s * mount.y, p_WR.y + s * mount.x + c * mount.y, p_WR.theta + mount.theta)
