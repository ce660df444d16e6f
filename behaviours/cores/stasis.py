"""Noticing that a robot is stuck, and drawing a way out.

Takes: what was commanded, whether the robot moves, chance. Gives: a level that rises while it should move and does not,
and random motions. Leaves alone: how motion is judged (odometry, or `stood_still` on scans), and driving.

Source: Yamauchi 2005, "Wayfarer", section 4.3, which prints the ranges of the random motions and their two seconds. The
rates, the threshold and the cap are chosen here: a level that cannot rise above the threshold ends an escape in its
first moving tick, and the robot is back where it was stuck. `modern`: the way in is driven backwards first, an escape
from a place that was not left for good lasts longer, motion that repeats itself is stasis too (`repeats`), and the
robot does not try for ever.
"""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass

import numpy as np

from behaviours.interface import Drive, Floats, Pose

STILL = Drive(0.0, 0.0)


@dataclass(frozen=True, slots=True)
class LevelSettings:
    """up, down [1/s]: how the level rises and falls; threshold: stuck from here on; release: free below; cap.

    moving_speed [m/s], moving_turn_rate [rad/s]: faster is motion; told_speed, told_turn_rate: more is a command to
    move. They are larger than the former, so that a robot that does as it is told is never stuck.
    """

    up: float = 1.0
    down: float = 1.0
    threshold: float = 1.0
    release: float = 1.0
    cap: float = 3.0
    moving_speed: float = 0.02
    moving_turn_rate: float = 0.05
    told_speed: float = 0.04
    told_turn_rate: float = 0.1


class Level:
    """The stasis level. stuck: it has reached the threshold and not yet fallen below release."""

    def __init__(self, settings: LevelSettings) -> None:
        self._settings = settings
        self.value = 0.0
        self.stuck = False

    def moves(self, made: Drive) -> bool:
        """Whether this is motion."""
        s = self._settings
        return abs(made.speed) > s.moving_speed or abs(made.turn_rate) > s.moving_turn_rate

    def told_to_move(self, told: Drive) -> bool:
        """Whether this is a command to move."""
        s = self._settings
        return abs(told.speed) > s.told_speed or abs(told.turn_rate) > s.told_turn_rate

    def take(self, told: Drive, moves: bool, dt: float) -> None:
        """What was told for the last dt [s], and whether the robot moved. A robot that stands by command stays put."""
        s = self._settings
        if moves:
            self.value = max(0.0, self.value - s.down * dt)
        elif self.told_to_move(told):
            self.value = min(s.cap, self.value + s.up * dt)
        self._judge()

    def fill(self) -> None:
        """Stuck for another reason."""
        self.value = self._settings.cap
        self._judge()

    def clear(self) -> None:
        """Free, whatever came before."""
        self.value, self.stuck = 0.0, False

    def _judge(self) -> None:
        s, slack = self._settings, 1e-9
        free = self.value < s.release - slack or self.value <= slack
        self.stuck = self.value >= s.threshold - slack or (self.stuck and not free)


# --- the way out ------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class EscapeSettings:
    """speed [m/s], turn_rate [rad/s]: greatest, either way; each [s]: how long one is tried.

    least_speed, least_turn_rate: a motion below both is drawn again.
    """

    speed: float = 0.25
    turn_rate: float = 1.0
    each: float = 2.0
    least_speed: float = 0.05
    least_turn_rate: float = 0.2


def draw(settings: EscapeSettings, chance: np.random.Generator) -> Drive:
    """A random motion that is not too small to be one. Settings that allow none give the last of a hundred."""
    s, drawn = settings, STILL
    for _ in range(100):
        speed, turn_rate = chance.uniform(-s.speed, s.speed), chance.uniform(-s.turn_rate, s.turn_rate)
        drawn = Drive(float(speed), float(turn_rate))
        if abs(drawn.speed) >= s.least_speed or abs(drawn.turn_rate) >= s.least_turn_rate:
            break
    return drawn


class FreePath:
    """How the robot moved last, so that it can be driven backwards. length: ticks that are remembered."""

    def __init__(self, length: int) -> None:
        self._motions: deque[Drive] = deque(maxlen=length)

    def add(self, made: Drive) -> None:
        """A motion that was made for one tick."""
        self._motions.append(made)

    def backwards(self, settings: EscapeSettings) -> tuple[Drive, ...]:
        """The motions that undo it, the last one first, no faster than an escape."""
        return tuple(_undo(made, settings) for made in reversed(self._motions))


def _undo(made: Drive, s: EscapeSettings) -> Drive:
    share = max(abs(made.speed) / s.speed if s.speed else 1.0, abs(made.turn_rate) / s.turn_rate if s.turn_rate else 1)
    return Drive(-made.speed / max(1.0, share), -made.turn_rate / max(1.0, share))


def before(told: Drive, reach: float) -> Floats:
    """Points (3, 2) [m, robot frame] of what holds a robot that is told to move, `reach` [m] from its middle.

    On the side to which it was to move; none where it was only to turn.
    """
    if not told.speed:
        return np.zeros((0, 2))
    angles = np.array([-0.4, 0.0, 0.4]) + (0.0 if told.speed > 0 else math.pi)
    return reach * np.column_stack([np.cos(angles), np.sin(angles)])


# --- motion, judged by what is seen -------------------------------------------------------------------

BINS = 120


def profile(points: Floats) -> Floats:
    """The nearest range [m] in each of 120 equal sectors about the robot; infinite where there is none."""
    ranges = np.full(BINS, np.inf)
    sector = (np.arctan2(points[:, 1], points[:, 0]) / math.tau * BINS).astype(np.intp) % BINS
    np.minimum.at(ranges, sector, np.hypot(points[:, 0], points[:, 1]))
    return ranges


def misfit(a: Floats, b: Floats) -> float:
    """The median difference [m] of two profiles where both see something; NaN where that is too little."""
    both = np.isfinite(a) & np.isfinite(b)
    return float(np.median(np.abs(a[both] - b[both]))) if np.count_nonzero(both) >= BINS // 10 else math.nan


def stood_still(before: Floats, expected: Floats, now: Floats, margin: float) -> bool:
    """Whether what is seen now looks as before, and clearly not as it should after the motion that treads claim.

    All three are profiles; margin [m]. Where both fit, as in a long corridor, the treads are believed.
    """
    return misfit(before, now) + margin < misfit(expected, now)


# --- motion that repeats itself -----------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class CycleSettings:
    """window [s]: of the past that is looked at; sample [s]; shortest, longest [s]: periods that are looked for.

    likeness: autocorrelation from which a motion repeats itself; unlike: it must have been below in between.
    least [m]: motion that spreads less is none; arm [m]: what a turn counts as.
    """

    window: float = 30.0
    sample: float = 0.5
    shortest: float = 2.0
    longest: float = 15.0
    likeness: float = 0.85
    unlike: float = 0.0
    least: float = 0.1
    arm: float = 0.5


class Cycle:
    """The recent poses, and whether they repeat. period [s]: of the repetition that was found last."""

    def __init__(self, settings: CycleSettings) -> None:
        self._settings = settings
        self._poses: deque[tuple[float, float, float, float]] = deque(maxlen=round(settings.window / settings.sample))
        self._sampled = -math.inf
        self.period = math.nan

    def take(self, stamp: float, pose: Pose) -> bool:
        """Take a pose [map frame] at a stamp [s]; gives whether it completes a motion that repeats itself."""
        s = self._settings
        if stamp - self._sampled < s.sample - 1e-9:
            return False
        self._sampled = stamp
        turned = s.arm * math.cos(pose.theta), s.arm * math.sin(pose.theta)
        self._poses.append((pose.x, pose.y, *turned))
        if len(self._poses) < (self._poses.maxlen or 0):
            return False
        self.period = repeats(np.array(self._poses), s)
        return math.isfinite(self.period)

    def clear(self) -> None:
        """Begin anew."""
        self._poses.clear()


def repeats(poses: Floats, s: CycleSettings) -> float:
    """The period [s] with which a series of poses (n, k) repeats itself, NaN where it does not.

    1 - mean |x(t) - x(t - lag)|² / (2 var x) is 1 at the period of a cycle. It is high at short lags for every smooth
    motion, so that it must have been low at a shorter one.
    """
    spread = float(np.mean(np.sum((poses - poses.mean(axis=0)) ** 2, axis=1)))
    if spread < s.least**2:
        return math.nan
    was_unlike = False
    for lag in range(round(s.shortest / s.sample / 2), round(s.longest / s.sample) + 1):
        apart = float(np.mean(np.sum((poses[lag:] - poses[:-lag]) ** 2, axis=1)))
        like = 1.0 - apart / (2.0 * spread)
        was_unlike = was_unlike or like < s.unlike
        if was_unlike and like > s.likeness and lag * s.sample >= s.shortest:
            return lag * s.sample
    return math.nan


# --- giving up ----------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class PatienceSettings:
    """episodes: so many at one place, and an operator is needed; place [m]: how far off another place begins."""

    episodes: int = 5
    place: float = 1.0


class Patience:
    """Counts how often the robot got stuck at one place."""

    def __init__(self, settings: PatienceSettings) -> None:
        self._settings = settings
        self._place: Pose | None = None
        self.episodes = 0
        self._was_stuck = False

    @property
    def is_over(self) -> bool:
        """An operator is needed."""
        return self.episodes > self._settings.episodes

    def take(self, stuck: bool, pose: Pose) -> bool:
        """Whether the robot is stuck, and where it is; gives whether that is the first of an episode."""
        if (
            self._place is not None
            and math.hypot(pose.x - self._place.x, pose.y - self._place.y) > self._settings.place
        ):
            self._place, self.episodes = None, 0
        begun, self._was_stuck = stuck and not self._was_stuck, stuck
        if begun:
            self._place = self._place or pose
            self.episodes += 1
        return begun
