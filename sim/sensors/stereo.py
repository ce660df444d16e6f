"""Ranging by vergence: two cameras on the head turn until they see the same patch.

Takes: where the head looks, the scene, chance. Gives: `StereoReading`, fresh once the head has looked in one direction
and the base has stood still for the time of a fixation, and again after each such time.
Leaves alone: what the patch looks like; verging fails only where there is nothing within `FARTHEST`.

The ray starts above the robot's origin at camera height h with tilt t downwards. It meets the level ground at
h / tan t, the side of a thing where it is lower than the thing is high, or the top of a thing, whichever comes first;
the reading is the slant distance z. Noise: sd 0.003 z + 0.001 z^2, vergence being worse than proportional with range.
A fixation takes 9 s, so that a search of 32 fixations with its head movements lasts about five minutes.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.random import Generator

from behaviours.interface import HeadState, Pose, StereoReading
from sim.raycast import Scene, crossings, ray
from sim.sensors.build import StereoBuild
from sim.sensors.truth import Truth

FARTHEST = 30.0  # [m]
LEVEL = 1e-6  # [rad] of tilt below which the ray never comes down


class VergingCameras:
    """The verging cameras of one robot."""

    def __init__(self, build: StereoBuild, chance: Generator) -> None:
        self._build, self._chance = build, chance
        self.first = (StereoReading(0.0, False, 0.0, 0.0, math.nan, build.camera_height),)

    def measure(self, truth: Truth) -> tuple[StereoReading]:
        """One fixation."""
        head, height = truth.head, self._build.camera_height
        slant = self._noisy(slant_range(height, head, truth.pose, truth.scene()))
        return (StereoReading(truth.time, True, head.pan, head.tilt, slant, height),)

    def _noisy(self, slant: float) -> float:
        sd = self._build.linear * slant + self._build.quadratic * slant * slant
        return slant + sd * float(self._chance.standard_normal())


def slant_range(camera_height: float, head: HeadState, pose: Pose, scene: Scene) -> float:
    """True slant distance [m] from the cameras to the first thing or the ground along the gaze; NaN for neither."""
    falls, c = math.tan(head.tilt), math.cos(head.tilt)
    ground = camera_height / falls if head.tilt > LEVEL else math.inf
    met = crossings(ray((pose.x, pose.y), pose.theta + head.pan), min(FARTHEST, ground), scene)
    nearest = min([ground, *_first_touches(camera_height, falls, met.enter, met.exit, scene.height[met.thing])])
    return nearest / c if nearest <= FARTHEST else math.nan


def _first_touches(
    camera_height: float, falls: float, enter: np.ndarray, leave: np.ndarray, heights: np.ndarray
) -> list[float]:
    """Horizontal distances [m] at which the falling ray touches things: at their side, or on their top."""
    at_side = camera_height - falls * enter < heights
    on_top = ~at_side & (camera_height - falls * leave < heights)
    tops = (camera_height - heights[on_top]) / falls
    return [*map(float, enter[at_side]), *map(float, tops)]
