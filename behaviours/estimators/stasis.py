"""Whether the robot is stuck: it is told to move, and does not.

Takes: every reading; last tick's commands from the channels; for `modern` where the robot believes to be and what it
sees. Gives: the level, and the motions of an escape; to the recent path, for `modern`, where it was held. Leaves alone:
driving.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from behaviours.cores.geometry import moved
from behaviours.cores.stasis import (
    STILL,
    Cycle,
    CycleSettings,
    EscapeSettings,
    FreePath,
    Level,
    LevelSettings,
    Patience,
    PatienceSettings,
    before,
    draw,
    profile,
    stood_still,
)
from behaviours.estimators.localisation import Localisation
from behaviours.estimators.recent_path import RecentPath
from behaviours.estimators.surroundings import Surroundings
from behaviours.interface import Channels, Command, Drive, Floats, Odometry, Pose, Reading, Report

SCANS = 3
"""Motion is judged by scans so many apart."""


@dataclass(frozen=True, slots=True)
class StasisSettings:
    """seed: of chance; slipping [m]: see `stood_still`; lifting [s]: see `_is_being_lifted`;
    reach [m]: of what holds the robot, from its middle.

    modern: the way in is driven backwards first, motion is judged by scans, cycles and vain escapes are noticed.
    """

    level: LevelSettings = field(default_factory=LevelSettings)
    escape: EscapeSettings = field(default_factory=EscapeSettings)
    cycle: CycleSettings = field(default_factory=CycleSettings)
    patience: PatienceSettings = field(default_factory=PatienceSettings)
    modern: bool = False
    slipping: float = 0.05
    lifting: float = 3.0
    reach: float = 0.45
    seed: int = 1


class Stasis:
    """level: of stasis; patience: how often in vain. around: None where there is no lidar to judge motion by."""

    def __init__(
        self, settings: StasisSettings, place: Localisation, around: Surroundings | None, path: RecentPath
    ) -> None:
        self.settings = settings
        self.level = Level(settings.level)
        self.patience = Patience(settings.patience)
        self._place, self._around, self._path = place, around, path
        self._cycle = Cycle(settings.cycle)
        self._free = FreePath(length=20)
        self._chance = np.random.default_rng(settings.seed)
        self._stamp: float | None = None
        self._scans: list[tuple[Floats, Pose]] = []
        self._slips = False
        self._flippers_out: float | None = None

    @property
    def is_stuck(self) -> bool:
        """The robot is to escape."""
        return self.level.stuck

    @property
    def needs_operator(self) -> bool:
        """Escapes have been in vain too often; only with `modern`."""
        return self.settings.modern and self.patience.is_over

    def update(self, reading: Reading, reports: Mapping[str, Report], channels: Channels) -> None:
        dt = 0.0 if self._stamp is None else reading.stamp - self._stamp
        self._stamp = reading.stamp
        told, made = commanded(channels), _made(reading.odometry)
        moves = self.level.moves(made)
        if self.settings.modern:
            self._look()
            moves = moves and not self._slips
            if moves and not self.level.stuck:
                self._free.add(made)
        self.level.take(STILL if self._is_being_lifted(channels, reading.stamp) else told, moves, dt)
        if self.settings.modern:
            self._watch_for_cycles(reading.stamp)
        begun = self.patience.take(self.level.stuck, self._place.pose)
        if self.settings.modern and begun:
            self.level.fill()
            if self.level.told_to_move(told) and not moves:
                self._path.held_by(before(told, self.settings.reach))

    def way_back(self) -> tuple[Drive, ...]:
        """Motions, one a tick, that undo the last free ones; none but at the first try at a place, with `modern`."""
        if not self.settings.modern or self.patience.episodes > 1:
            return ()
        return self._free.backwards(self.settings.escape)

    def draw(self) -> Drive:
        """A random motion."""
        return draw(self.settings.escape, self._chance)

    def _is_being_lifted(self, channels: Channels, stamp: float) -> bool:
        """Whether the flippers were sent out only just: until they have lifted the hull, being held is no stasis."""
        if not any(isinstance(value, Command) and _sends_out(value) for value in channels.values()):
            self._flippers_out = None
            return False
        self._flippers_out = stamp if self._flippers_out is None else self._flippers_out
        return stamp - self._flippers_out < self.settings.lifting

    def _watch_for_cycles(self, stamp: float) -> None:
        if self._cycle.take(stamp, self._place.pose):
            self._cycle.clear()
            self.level.fill()

    def _look(self) -> None:
        """Compare the scan with an earlier one, as it is and as odometry would have it by now.

        By odometry alone, for the compass is noisier than what the robot turns between two scans.
        """
        if self._around is None or not self._around.fresh:
            return
        points, pose = self._around.points, self._place.odometry
        self._scans = [*self._scans[-SCANS:], (points, pose)]
        seen, then = self._scans[0]
        if len(self._scans) <= SCANS:
            return
        expected = moved(seen, then, pose)
        self._slips = stood_still(profile(seen), profile(expected), profile(points), self.settings.slipping)


def commanded(channels: Channels) -> Drive:
    """What the drive was told in the last tick: the last word of all channels of commands, and to stand without any."""
    told: Drive | None = None
    for value in channels.values():
        if isinstance(value, Command) and value.drive is not None:
            told = value.drive
    return told or STILL


def _sends_out(told: Command) -> bool:
    return told.flippers is not None and told.flippers.deployed


def _made(odometry: Odometry) -> Drive:
    return Drive(odometry.speed, odometry.turn_rate)
