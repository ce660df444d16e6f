"""Speed and turn rate towards a direction, such that no command carries the hull into what was seen.

Takes: a direction and points in the robot frame, the motion now. Gives: a command, or none where nothing is safe.
Leaves alone: how the direction was chosen.

First the turn straight to the direction is tried at falling speeds, down to turning on the spot; where the hull would
touch, a fan of slow arcs, backwards too where it is known what stands there, and the one that turns the robot most
towards the direction and brings it furthest is taken.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from behaviours.cores.hull_paths import Hull, Motors, least_distance, paths
from behaviours.interface import Drive, Floats, wrap

SHARES = (1.0, 0.75, 0.5, 0.3, 0.15, 0.0)
"""Of the speed, tried one after the other."""
FAN = np.array([(v, w) for v in (0.6, 0.35, 0.15, -0.15, -0.35) for w in np.linspace(-1.0, 1.0, 9)])
"""Shares of cruise and of the greatest turn rate."""
TURN_STEP = 0.1
"""[rad] at which a turn on the spot is looked at."""
SLACK = 0.001
"""[m]: where the hull is nearer to something than the margin, it must not come nearer by more than this."""


@dataclass(frozen=True, slots=True)
class PilotSettings:
    """Speeds [m/s, rad/s], lengths [m], angles [rad].

    margin: kept between the hull and what was seen. roomy: with so much room ahead the speed is full. tight: share of
    it with none. gain [1/s]: of the turn. on_the_spot: directions further aside are turned to while standing. slip:
    turn of the tracks per turn of the hull.
    """

    cruise: float = 0.5
    max_turn_rate: float = 1.0
    gain: float = 2.0
    margin: float = 0.06
    roomy: float = 0.5
    tight: float = 0.3
    on_the_spot: float = math.radians(60.0)
    slip: float = 1.3
    hull: Hull = field(default_factory=Hull)
    motors: Motors = field(default_factory=Motors)


@dataclass(frozen=True, slots=True)
class Surrounds:
    """points (n, 2) [m, robot frame]; open_behind: what stands behind the robot is known."""

    points: Floats
    open_behind: bool = True


def towards(direction: float, now: Drive, seen: Surrounds, settings: PilotSettings) -> Drive | None:
    """The motion of the hull towards a direction [rad, robot frame]; None where every one is dangerous."""
    points = reachable_points(seen.points, now, settings)
    gap = _gap(points, settings)
    turn = _clip(settings.gain * direction, settings.max_turn_rate)
    speed = 0.0 if abs(direction) > settings.on_the_spot else wanted_speed(direction, seen.points, settings)
    tried = np.array([(speed * share, turn) for share in (SHARES if speed > 0 else (0.0,))])
    if speed > 0 and _free(tried[:1], now, points, gap, settings)[0]:
        return Drive(speed, turn)
    free = _free(tried, now, points, gap, settings)
    free[-1] &= turns_free(direction, points, settings)
    if free.any():
        first = int(np.argmax(free))
        if tried[first, 0] > 0 or abs(turn) > 0.1:
            return Drive(float(tried[first, 0]), float(tried[first, 1]))
    return _fanned(direction, now, seen, points, gap, settings)


def safe(wanted: Drive, now: Drive, points: Floats, settings: PilotSettings) -> bool:
    """Whether the hull stays free while a command is held for a while and then braked for."""
    points = reachable_points(points, now, settings)
    gap = _gap(points, settings)
    return bool(_free(np.array([(wanted.speed, wanted.turn_rate)]), now, points, gap, settings)[0])


def _gap(points: Floats, settings: PilotSettings) -> float:
    """[m] from the hull as it stands to the points."""
    return float(settings.hull.distance(points[:, 0], points[:, 1]).min(initial=math.inf)) if len(points) else math.inf


def may_turn(points: Floats, settings: PilotSettings) -> bool:
    """Whether the circle that the hull sweeps on the spot is free."""
    return float(np.hypot(points[:, 0], points[:, 1]).min(initial=math.inf)) > settings.hull.reach + settings.margin


def turns_free(direction: float, points: Floats, settings: PilotSettings) -> bool:
    """Whether the hull may turn on the spot as far as the direction [rad, robot frame]."""
    near = points[np.hypot(points[:, 0], points[:, 1]) < settings.hull.reach + settings.margin]
    if not len(near):
        return True
    angles = np.linspace(0.0, direction, 2 + int(abs(direction) / TURN_STEP))[1:]
    made = np.stack([np.zeros_like(angles), np.zeros_like(angles), angles], axis=1)[None]
    return bool(least_distance(made, near, settings.hull)[0] >= settings.margin)


def wanted_speed(direction: float, points: Floats, settings: PilotSettings) -> float:
    """[m/s]: less when the direction lies aside, and less the nearer something is before the hull or beside it."""
    x, y, far = points[:, 0], points[:, 1], settings.hull.reach + settings.margin + settings.roomy
    ahead = points[(x > 0.0) & (x < far) & (np.abs(y) < far)]
    room = float(settings.hull.distance(ahead[:, 0], ahead[:, 1]).min(initial=math.inf)) - settings.margin
    share = settings.tight + (1.0 - settings.tight) * max(0.0, min(1.0, room / settings.roomy))
    return settings.cruise * max(0.0, math.cos(direction)) * share


def reachable_points(points: Floats, now: Drive, settings: PilotSettings) -> Floats:
    """Those that any command may bring the hull near to."""
    fastest, motors = max(abs(now.speed), settings.cruise), settings.motors
    far = settings.hull.reach + settings.margin + fastest * (motors.hold + motors.step)
    far += fastest**2 / (2 * motors.acceleration) + fastest * motors.step
    near: Floats = points[np.hypot(points[:, 0], points[:, 1]) < far]
    return near


def _free(
    wanted: Floats, now: Drive, points: Floats, gap: float, settings: PilotSettings
) -> np.typing.NDArray[np.bool_]:
    """Which commands keep the margin, or at least come no nearer than the hull is already."""
    free: np.typing.NDArray[np.bool_] = _gaps(wanted, now, points, settings) >= min(settings.margin, gap - SLACK)
    return free


def _gaps(wanted: Floats, now: Drive, points: Floats, settings: PilotSettings) -> Floats:
    if not len(points):
        return np.full(len(wanted), math.inf)
    return least_distance(paths(now, wanted, settings.motors), points, settings.hull)


def _fanned(
    direction: float, now: Drive, seen: Surrounds, points: Floats, gap: float, settings: PilotSettings
) -> Drive | None:
    fan = FAN if seen.open_behind else FAN[FAN[:, 0] > 0]
    wanted = fan * (settings.cruise, settings.max_turn_rate)
    gaps = _gaps(wanted, now, points, settings)
    free = gaps >= min(settings.margin, gap - SLACK)
    if not free.any():
        return None
    shares, turned = fan[:, 0], wanted[:, 1]
    left = np.array([abs(wrap(direction - float(turn))) for turn in turned])
    score = shares * np.cos(direction - turned / 2) - left - 0.2 * (shares < 0)
    score += np.minimum(gaps, 2 * settings.margin) / max(settings.margin, SLACK)
    best = int(np.argmax(np.where(free, score, -math.inf)))
    return Drive(float(wanted[best, 0]), float(wanted[best, 1]))


def _clip(value: float, limit: float) -> float:
    return max(-limit, min(limit, value))
