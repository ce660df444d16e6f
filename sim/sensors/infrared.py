"""The reader of the donor's infra-red beacon, on the head.

Takes: where the head looks, where the beacon is, what stands between, the weather, chance. Gives: `IrReading`, by
default once a second while the head is still. Leaves alone: reflections.

Signal over noise is 3.2 (25 ft / r)^2 cos^2(a) within 30 degrees of the optical axis, and the beacon is heard above
3: so 25 ft is the edge. Noise of that ratio: sd 0.2; of the bearing: sd 0.3 degrees. With these a sweep in steps of two
degrees that needs three readings on either side finds a beacon at 24 ft in every run and at 28 ft in none (one reading
on the axis is heard there with a chance of 1 %); a bearing noise of 0.5 degrees would make one sweep in twenty fall
back by a step somewhere, and so fail a reader that asks for monotone angles.
The sun raises the noise tenfold when it stands within 25 degrees of the beacon, unless somebody stands behind the
donor. Wind rocks the beacon: a jitter of its bearing, and gusts.
"""

from __future__ import annotations

import math

from numpy.random import Generator

from behaviours.interface import IrReading, Pose, Vec2, wrap
from sim.frames import FOOT, bearing
from sim.raycast import Scene, cast, crossings, ray
from sim.sensors.build import InfraredBuild
from sim.sensors.truth import Beacon, Truth

SIGNAL, EDGE, HEARD = 3.2, 25 * FOOT, 3.0
HALF_FIELD = math.radians(30)
SUN_NOISE, SUN_NEAR = 10.0, math.radians(25)
SHADE_WITHIN, SHADE_HEIGHT = 3.0, 1.5  # [m]: somebody this tall, this close behind the beacon, keeps the sun off
BEAM_HEIGHT = 0.8  # [m]
NEAREST = 0.1  # [m] from where the signal grows no more
NEVER = IrReading(0.0, False, 0.0, False, math.nan, 0.0)


class BeaconReader:
    """The reader of one robot. Without a donor it hears nothing."""

    def __init__(self, build: InfraredBuild, chance: Generator) -> None:
        self._build, self._chance = build, chance

    def measure(self, truth: Truth) -> tuple[IrReading]:
        """One fixation."""
        stamp, pan = truth.time, truth.head.pan
        noise, jitter, offset_noise, gust = self._chance.standard_normal(4).tolist()
        gusty = float(self._chance.random()) < truth.weather.gusts
        rocked = truth.weather.jitter * jitter + truth.weather.gust * gust * gusty
        heard = [self._heard(truth, beacon, pan, rocked) for beacon in truth.beacons]
        if not heard:
            return (IrReading(stamp, True, pan, False, math.nan, max(0.0, self._build.sd * noise)),)
        signal, offset, name = max(heard, key=lambda beacon: beacon[0])
        strength = max(0.0, signal + self._build.sd * noise)
        detected = signal > 0 and strength > HEARD
        measured = offset + self._build.offset_sd * offset_noise if detected else math.nan
        return (IrReading(stamp, True, pan, detected, measured, strength, name if detected else ""),)

    def _heard(self, truth: Truth, beacon: Beacon, pan: float, rocked: float) -> tuple[float, float, str]:
        """Signal over noise (0 where it is out of sight), offset [rad] from the optical axis, and whose it is."""
        offset = wrap(bearing(truth.pose, beacon.at) - pan + rocked)
        visible = abs(offset) < HALF_FIELD and _in_sight(truth.pose, beacon, truth.scene())
        signal = _signal(truth.pose, beacon.at, offset) / _background(truth, beacon) if visible else 0.0
        return signal, offset, beacon.name


def _signal(pose: Pose, beacon: Vec2, offset: float) -> float:
    distance = max(math.dist((pose.x, pose.y), beacon), NEAREST)
    return SIGNAL * (EDGE / distance) ** 2 * math.cos(offset) ** 2


def _background(truth: Truth, beacon: Beacon) -> float:
    """Noise, relative to a day without sun."""
    pose, sun = truth.pose, truth.weather.sun
    if sun is None or abs(bearing(Pose(pose.x, pose.y, sun), beacon.at)) > SUN_NEAR:
        return 1.0
    behind = crossings(ray(beacon.at, sun, SHADE_HEIGHT), SHADE_WITHIN, truth.scene()).thing
    return 1.0 if (behind != beacon.thing).any() else SUN_NOISE


def _in_sight(pose: Pose, beacon: Beacon, scene: Scene) -> bool:
    """Whether the donor is the first thing on the way to its beacon."""
    x, y = beacon.at
    angle = math.atan2(y - pose.y, x - pose.x)
    _, things = cast(ray((pose.x, pose.y), angle, BEAM_HEIGHT), math.dist((pose.x, pose.y), (x, y)), scene)
    return int(things[0]) in (beacon.thing, -1)
