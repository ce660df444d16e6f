"""Two rings of sonars on the hull: 24 at the waist and 6 at the skirt, cast together.

Takes: the true pose, the scene, chance. Gives: `Ranges` of either ring, by default every third tenth of a second.
Each transducer sits on the circle round the hull and hears a cone of +-9 degrees, modelled by five rays: the nearest
counts. Leaves alone: cross-talk and side lobes.

The waist is at half the height of the robot, the skirt at a sixth: at 0.6 m and 0.2 m on a robot of 1.2 m. A thing that
is lower than a ring is not heard by it.
Readings are clamped to [0.05, 5] m. A real transducer is deaf below some 0.15 m, but being too close is just what the
skirt and the waist have to report, so the deaf zone is left out; 0.05 m is where a repulsion that falls with the
square of the range stops growing.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.random import Generator

from behaviours.interface import Floats, Pose, Ranges
from sim.raycast import Rays, Scene, cast
from sim.sensors.build import SonarBuild
from sim.sensors.truth import Truth

WAIST, SKIRT = 24, 6
HEIGHT_WAIST, HEIGHT_SKIRT = 0.6, 0.2  # [m], on a robot that is as high as
HEIGHT = 1.2  # [m]
HALF_CONE = math.radians(9)
RAYS_PER_CONE = 5
NEAREST, FARTHEST = 0.05, 5.0  # [m]
PERIOD = 0.3  # [s]


def _ring(count: int) -> Floats:
    """Bearings [rad] from straight ahead, in (-pi, pi]."""
    turns = np.arange(count) / count
    bearings = np.where(turns > 0.5, turns - 1.0, turns) * math.tau
    bearings.setflags(write=False)
    return bearings


class SonarRings:
    """Both rings of one robot; what they measure is (waist, skirt)."""

    def __init__(self, build: SonarBuild, radius: float, height: float, chance: Generator) -> None:
        """radius [m] of the circle that the transducers sit on; height [m] of the robot."""
        self._build, self._radius, self._chance = build, radius, chance
        self._waist, self._skirt = _ring(WAIST), _ring(SKIRT)
        self._bearings = np.concatenate([self._waist, self._skirt])
        fan = np.linspace(-HALF_CONE, HALF_CONE, RAYS_PER_CONE)
        self._angles = (self._bearings[:, None] + fan).ravel()
        heights = np.array([HEIGHT_WAIST, HEIGHT_SKIRT]) * (height / HEIGHT)
        self._heights = np.repeat(heights, [WAIST * RAYS_PER_CONE, SKIRT * RAYS_PER_CONE])
        silence = np.full(WAIST + SKIRT, FARTHEST)
        silence.setflags(write=False)
        self.first = self._rings(0.0, False, silence)

    def _rings(self, stamp: float, fresh: bool, ranges: Floats) -> tuple[Ranges, Ranges]:
        waist, skirt = ranges[:WAIST], ranges[WAIST:]
        return (
            Ranges(stamp, fresh, self._waist, waist, FARTHEST, self._radius),
            Ranges(stamp, fresh, self._skirt, skirt, FARTHEST, self._radius),
        )

    def measure(self, truth: Truth) -> tuple[Ranges, Ranges]:
        """One sweep of both."""
        ranges = self._noisy(self.sweep(truth.pose, truth.scene()))
        ranges.setflags(write=False)
        return self._rings(truth.time, True, ranges)

    def sweep(self, pose: Pose, scene: Scene) -> Floats:
        """The true ranges [m], those of the waist first."""
        axes = self._bearings + pose.theta
        x = np.repeat(pose.x + self._radius * np.cos(axes), RAYS_PER_CONE)
        y = np.repeat(pose.y + self._radius * np.sin(axes), RAYS_PER_CONE)
        ranges, _ = cast(Rays(x, y, self._angles + pose.theta, self._heights), FARTHEST, scene)
        nearest: Floats = ranges.reshape(-1, RAYS_PER_CONE).min(axis=1)
        return nearest

    def _noisy(self, ranges: Floats) -> Floats:
        noise, luck = self._chance.standard_normal(ranges.shape), self._chance.random(ranges.shape)
        heard = (ranges < FARTHEST) & (luck >= self._build.dropout)
        return np.where(heard, np.clip(ranges * (1 + self._build.sd * noise), NEAREST, FARTHEST), FARTHEST)
