"""Dead reckoning with a compass: distances of odometry laid along headings, and a filter for the heading.

Takes: poses of odometry, readings of a compass and of a gyroscope, as numbers. Gives: signed distances, places, and
the belief of a heading. Leaves alone: which sensors there are, what is done when one fails, and frames.

Yamauchi 2005 prints x'_t = D_t cos(theta_t), y'_t = D_t sin(theta_t) for the place. As printed it never leaves the
origin by more than a step; here the steps are added up, and a step backwards counts as negative.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from behaviours.interface import Floats, Pose, Vec2, wrap

THETA, DRIFT, IRON, RATIO = range(4)
"""Parts of the state: the heading [rad], what the gyroscope says at rest [rad/s], what iron adds to the compass [rad],
and the true turn for each radian of the odometry's."""

STILL = 1e-9
"""Odometry that moves by less [m, rad] in a tick stands."""


def signed_distance(before: Pose, after: Pose) -> float:
    """Distance [m] between two poses of odometry, negative where the robot went backwards."""
    middle = before.theta + wrap(after.theta - before.theta) / 2
    dx, dy = after.x - before.x, after.y - before.y
    return math.copysign(math.hypot(dx, dy), dx * math.cos(middle) + dy * math.sin(middle))


def step(place: Vec2, way: float, heading: float) -> Vec2:
    """The place after `way` [m] along `heading` [rad]."""
    return place[0] + way * math.cos(heading), place[1] + way * math.sin(heading)


def turned(pose: Pose, angle: float) -> Pose:
    """The pose in a frame with the same origin that is turned by -angle [rad]."""
    c, s = math.cos(angle), math.sin(angle)
    return Pose(c * pose.x - s * pose.y, s * pose.x + c * pose.y, wrap(pose.theta + angle))


# --- the heading, filtered --------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class HeadingModel:
    """How good the sensors are.

    compass_noise: sd [rad] of one reading. iron: sd [rad] of what iron and cables add; it changes over iron_length [m]
    of way. gyro_noise: sd [rad/s] of one reading; gyro_drift: sd [rad/s] of what it says at rest. slip: sd of the turn
    of odometry, by share. gate: a compass that is off by more standard deviations than this is not believed.
    """

    compass_noise: float = math.radians(1.0)
    iron: float = math.radians(2.0)
    iron_length: float = 20.0
    gyro_noise: float = 0.002
    gyro_drift: float = 0.0005
    slip: float = 0.3
    gate: float = 4.0


@dataclass(frozen=True, slots=True, eq=False)
class Belief:
    """mean (4,) and covariance (4, 4) of the state; `THETA` … `RATIO` say where what is. The heading is not wrapped."""

    mean: Floats = field(default_factory=lambda: np.array([0.0, 0.0, 0.0, 1.0]))
    cov: Floats = field(default_factory=lambda: np.eye(4))


def first_belief(heading: float, model: HeadingModel, *, by_compass: bool) -> Belief:
    """Before any motion: by a compass, whose iron is not known; or the heading defines the frame."""
    iron, noise = model.iron**2, model.compass_noise**2
    cov = np.diag([0.0, model.gyro_drift**2, iron, model.slip**2])
    if by_compass:
        cov[THETA, THETA], cov[THETA, IRON], cov[IRON, THETA] = iron + noise, -iron, -iron
    return Belief(np.array([heading, 0.0, 0.0, 1.0]), cov)


def moved(belief: Belief, turn: float, way: float, gyro: float | None, dt: float, model: HeadingModel) -> Belief:
    """After a tick of dt [s]: odometry turned by `turn` [rad] and went `way` [m]; gyro: its turn rate [rad/s]."""
    forward, noise = np.eye(4), np.zeros((4, 4))
    mean = belief.mean.copy()
    if gyro is None:
        mean[THETA] += mean[RATIO] * turn
        forward[THETA, RATIO] = turn
        noise[THETA, THETA] = (0.1 * turn) ** 2 + 1e-5 * dt
    else:
        mean[THETA] += (gyro - mean[DRIFT]) * dt
        forward[THETA, DRIFT] = -dt
        noise[THETA, THETA] = (model.gyro_noise * dt) ** 2
    kept = math.exp(-abs(way) / model.iron_length)
    mean[IRON] *= kept
    forward[IRON, IRON] = kept
    noise[IRON, IRON] = model.iron**2 * (1.0 - kept * kept)
    after = Belief(mean, forward @ belief.cov @ forward.T + noise)
    return after if gyro is None else _gyro_and_tracks(after, turn, way, gyro, dt, model)


def _gyro_and_tracks(belief: Belief, turn: float, way: float, gyro: float, dt: float, model: HeadingModel) -> Belief:
    """At rest the gyroscope shows its drift; in a turn it shows how much of it the tracks only scrub."""
    if abs(turn) < STILL and abs(way) < STILL:
        return _corrected(belief, np.array([0.0, 1.0, 0.0, 0.0]), gyro - belief.mean[DRIFT], model.gyro_noise**2, 4.0)
    if abs(turn) < 0.05 * dt:
        return belief
    off = gyro * dt - belief.mean[RATIO] * turn - belief.mean[DRIFT] * dt
    var = (model.gyro_noise * dt) ** 2 + (0.1 * turn) ** 2 + 1e-5 * dt
    return _corrected(belief, np.array([0.0, dt, 0.0, turn]), off, var, math.inf)


def compared(belief: Belief, compass: float, model: HeadingModel) -> Belief:
    """After a reading of the compass [rad]; the same belief where it lies beyond the gate."""
    off = wrap(compass - belief.mean[THETA] - belief.mean[IRON])
    return _corrected(belief, np.array([1.0, 0.0, 1.0, 0.0]), off, model.compass_noise**2, model.gate)


def _corrected(belief: Belief, row: Floats, off: float, var: float, gate: float) -> Belief:
    across = belief.cov @ row
    spread = float(row @ across) + var
    if off * off > gate * gate * spread:
        return belief
    gain = across / spread
    cov = belief.cov - np.outer(gain, across)
    return Belief(belief.mean + gain * off, (cov + cov.T) / 2)
