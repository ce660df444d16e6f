"""Two rings of sonars on the hull: 24 at the waist and 6 at the skirt, cast together.

Takes: the true pose, the scene, chance. Gives: `Ranges` of either ring, fresh every third tick (3 Hz) and latched
in between. Each transducer sits on the hull and hears a cone of +-9 degrees, modelled by five rays: the nearest counts.
Leaves alone: cross-talk and side lobes.

Readings are clamped to [0.05, 5] m. A real transducer is deaf below some 0.15 m, but being too close is just what the
skirt and the waist have to report, so the deaf zone is left out; 0.05 m is where a repulsion that falls with the
square of the range stops growing. A thing that is lower than a ring is not heard by it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from behaviours.interface import Floats, Pose, Ranges
from sim.raycast import Rays, Scene, cast

WAIST, SKIRT = 24, 6
HEIGHT_WAIST, HEIGHT_SKIRT = 0.6, 0.2  # [m]
HALF_CONE = math.radians(9)
RAYS_PER_CONE = 5
NEAREST, FARTHEST = 0.05, 5.0  # [m]
SWEEP_TICKS = 3


@dataclass(frozen=True, slots=True)
class SonarBuild:
    """sd: share of the range that is noise; dropout: chance that one reading hears nothing (specular reflection)."""

    sd: float = 0.01
    dropout: float = 0.02


def _ring(count: int) -> Floats:
    """Bearings [rad] from straight ahead, in (-pi, pi]."""
    turns = np.arange(count) / count
    bearings = np.where(turns > 0.5, turns - 1.0, turns) * math.tau
    bearings.setflags(write=False)
    return bearings


class Sonar:
    """Both rings. `sense` is called once a tick and gives (waist, skirt)."""

    def __init__(self, build: SonarBuild, hull_radius: float, chance: np.random.Generator) -> None:
        self._build, self._radius, self._chance = build, hull_radius, chance
        self._bearings = np.concatenate([_ring(WAIST), _ring(SKIRT)])
        fan = np.linspace(-HALF_CONE, HALF_CONE, RAYS_PER_CONE)
        self._angles = (self._bearings[:, None] + fan).ravel()
        self._heights = np.repeat([HEIGHT_WAIST, HEIGHT_SKIRT], [WAIST * RAYS_PER_CONE, SKIRT * RAYS_PER_CONE])
        self._waist, self._skirt = self._ranges(0.0, _ring(WAIST)), self._ranges(0.0, _ring(SKIRT))

    def _ranges(self, stamp: float, bearings: Floats) -> Ranges:
        return Ranges(stamp, False, bearings, np.full(bearings.shape, FARTHEST), FARTHEST, self._radius)

    def sense(self, tick: int, stamp: float, pose: Pose, scene: Scene) -> tuple[Ranges, Ranges]:
        """The rings at this tick; the first tick has a sweep."""
        if tick % SWEEP_TICKS == 0:
            ranges = self._noisy(self._sweep(pose, scene))
            ranges.setflags(write=False)
            self._waist = replace(self._waist, stamp=stamp, fresh=True, ranges=ranges[:WAIST])
            self._skirt = replace(self._skirt, stamp=stamp, fresh=True, ranges=ranges[WAIST:])
        elif self._waist.fresh:
            self._waist, self._skirt = replace(self._waist, fresh=False), replace(self._skirt, fresh=False)
        return self._waist, self._skirt

    def _sweep(self, pose: Pose, scene: Scene) -> Floats:
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
