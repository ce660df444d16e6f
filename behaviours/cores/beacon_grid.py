"""Where a beacon may be that has not been heard, and where one is that has: Bayesian grids.

Takes: fixations (pose, pan, signal, offset) in one frame. Gives: log weights of places. Leaves alone: names, driving.

For beacons not yet heard the grid is square cells about home; a fixation without a beacon speaks against the cells from
which one would have been heard, and, where faint signals are listened to, for those that explain the signal. For a
beacon that has been heard the grid is bearing times range about the place where it was heard first.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from behaviours.cores.beacon import BeaconModel, chance_to_hear, expected
from behaviours.interface import Floats, Pose

HIDDEN = 0.1
"""Chance that something stands between, or that the sun is behind."""
FLOOR = math.log(0.02)
"""No place is given up for good: what hides a beacon from one place may hide it from the next."""


@dataclass(frozen=True, slots=True)
class Cells:
    """Places x, y (n,) [m] in one frame."""

    x: Floats
    y: Floats

    def seen_from(self, pose: Pose, pan: float = 0.0) -> tuple[Floats, Floats]:
        """Distances [m] and offsets [rad] from the axis of a head at `pan` [rad]."""
        dx, dy = self.x - pose.x, self.y - pose.y
        offset = np.arctan2(dy, dx) - pose.theta - pan
        return np.hypot(dx, dy), np.mod(offset + math.pi, math.tau) - math.pi


def disc(centre: Pose, radius: float, step: float) -> Cells:
    """Square cells of `step` [m] within `radius` [m]."""
    axis = np.arange(-radius, radius + step / 2, step)
    x, y = (side.ravel() for side in np.meshgrid(axis, axis))
    inside = np.hypot(x, y) <= radius
    return Cells(centre.x + x[inside], centre.y + y[inside])


def missed(cells: Cells, pose: Pose, pan: float, model: BeaconModel) -> Floats:
    """What a fixation in which nothing was heard adds to the log weights."""
    signal = expected(*cells.seen_from(pose, pan), model)
    return np.asarray(np.log(1.0 - (1.0 - HIDDEN) * chance_to_hear(signal, model)))


def faintly(cells: Cells, pose: Pose, pan: float, strength: float, model: BeaconModel) -> Floats:
    """What a signal below the reader's threshold adds to the log weights."""
    wanted = np.minimum(expected(*cells.seen_from(pose, pan), model), model.heard)
    fits = np.exp(-0.5 * ((strength - wanted) / (1.5 * model.sd)) ** 2)
    silent = math.exp(-0.5 * (strength / (1.5 * model.sd)) ** 2)
    return np.asarray(np.log((1.0 - HIDDEN) * fits + HIDDEN * silent + 1e-6))


def weights(logs: Floats) -> Floats:
    """Chances that sum to 1."""
    raised = np.exp(logs - logs.max())
    return np.asarray(raised / raised.sum())


@dataclass(frozen=True, slots=True)
class Estimate:
    """Where a beacon is: x, y [m], spread [m]: standard deviation along the worse axis."""

    x: float
    y: float
    spread: float


class BearingRange:
    """The grid of one beacon, about the place where it was heard first.

    span, step [rad]: of the bearings; farthest, reach_step [m]: of the ranges; bearing_sd [rad]: of an offset with the
    wind; strength_sd: share of a signal that is not to be trusted.
    """

    span, step = math.radians(6.0), math.radians(0.25)
    farthest, reach_step = 10.0, 0.1
    bearing_sd, strength_sd = math.radians(1.5), 0.15
    fading = 0.98

    def __init__(self, pose: Pose, axis: float) -> None:
        """axis [rad]: direction of the beacon in the frame of the pose."""
        bearings = axis + np.arange(-self.span, self.span + self.step / 2, self.step)
        ranges = np.arange(0.3, self.farthest, self.reach_step)
        b, r = (side.ravel() for side in np.meshgrid(bearings, ranges))
        self.cells = Cells(pose.x + r * np.cos(b), pose.y + r * np.sin(b))
        self.logs = np.zeros_like(r)

    def hear(self, pose: Pose, pan: float, offset: float, strength: float, model: BeaconModel) -> None:
        """Take a fixation in which it was heard. The past fades a little, since odometry drifts."""
        away, off_axis = self.cells.seen_from(pose, pan)
        error = (np.mod(off_axis - offset + math.pi, math.tau) - math.pi) / self.bearing_sd
        signal = expected(away, np.full_like(away, offset), model)
        bright = np.exp(-0.5 * ((strength - signal) / (model.sd + self.strength_sd * strength)) ** 2)
        sunlit = np.exp(-0.5 * ((strength - signal / model.sun) / (model.sd + self.strength_sd * strength)) ** 2)
        self.logs = (
            self.fading * self.logs - 0.5 * np.minimum(error**2, 16.0) + np.log(0.9 * bright + HIDDEN * sunlit + 1e-6)
        )

    def estimate(self) -> Estimate:
        """Mean and spread."""
        w = weights(self.logs)
        x, y = float(w @ self.cells.x), float(w @ self.cells.y)
        dx, dy = self.cells.x - x, self.cells.y - y
        xx, yy, xy = float(w @ (dx * dx)), float(w @ (dy * dy)), float(w @ (dx * dy))
        worse = (xx + yy) / 2 + math.hypot((xx - yy) / 2, xy)
        return Estimate(x, y, math.sqrt(max(worse, 0.0)))


def best_listening(
    cells: Cells, logs: Floats, candidates: Cells, robot: Pose, model: BeaconModel, speed: float, listening: float
) -> tuple[Pose, float] | None:
    """The candidate at which the chance to hear a beacon is greatest for the time that it takes, and that chance.

    speed [m/s] of driving there; listening [s] once there. None without candidates.
    """
    if not candidates.x.size:
        return None
    w = weights(logs)
    apart = np.hypot(candidates.x[:, None] - cells.x[None, :], candidates.y[:, None] - cells.y[None, :])
    chance = chance_to_hear(expected(apart, np.zeros_like(apart), model), model) @ w
    time = np.hypot(candidates.x - robot.x, candidates.y - robot.y) / speed + listening
    best = int(np.argmax(chance / time))
    return Pose(float(candidates.x[best]), float(candidates.y[best])), float(chance[best])
