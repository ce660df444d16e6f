"""What faults make of readings, and which of them a kind of sensor can have.

Takes: readings, faults, what is installed. Gives: readings that are biased or blank; words for faults that cannot be.
Leaves alone: when a fault acts, readings that are lost or repeated (`sensor.py`).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from behaviours.interface import (
    Battery,
    Bumper,
    Compass,
    Currents,
    Fix,
    FlipperState,
    Floats,
    HeadState,
    Imu,
    Inclination,
    IrReading,
    Odometry,
    Pose,
    Ranges,
    Scan,
    Sensed,
    StereoReading,
    wrap,
)
from sim.sensors.build import FAULTS, BumperBuild, Fault, Installed

NAN = math.nan


def biased(reading: Sensed, amount: float) -> Sensed:
    """The reading with `amount`, in its unit, added to what it is about; nothing is added where nothing was met."""
    match reading:
        case Ranges(ranges=ranges, max_range=far):
            return replace(reading, ranges=_shifted(ranges, amount, 0.0, far))
        case Scan(ranges=ranges, min_range=near, max_range=far):
            return replace(reading, ranges=_shifted(ranges, amount, near, far))
        case Odometry(pose=pose):
            return replace(reading, pose=Pose(pose.x, pose.y, wrap(pose.theta + amount)))
        case IrReading(offset=offset):
            return replace(reading, offset=wrap(offset + amount))
        case StereoReading(range=slant):
            return replace(reading, range=slant + amount)
        case Compass(heading=heading):
            return replace(reading, heading=wrap(heading + amount))
        case Imu(turn_rate=turn_rate):
            return replace(reading, turn_rate=turn_rate + amount)
        case Inclination(pitch=pitch, roll=roll):
            return replace(reading, pitch=pitch + amount, roll=roll + amount)
        case Fix(x=x, y=y):
            return replace(reading, x=x + amount, y=y + amount)
        case Currents(left=left, right=right):
            return replace(reading, left=left + amount, right=right + amount)
        case HeadState() | Bumper() | FlipperState() | Battery():
            return reading


def _shifted(ranges: Floats, amount: float, near: float, far: float) -> Floats:
    shifted = np.where(ranges < far, np.clip(ranges + amount, near, far), ranges)
    shifted.setflags(write=False)
    return shifted


def blanked(reading: Sensed) -> Sensed:
    """The reading with NaN for its numbers; a beacon is not heard."""
    match reading:
        case Ranges(ranges=ranges) | Scan(ranges=ranges):
            return replace(reading, ranges=_blank(ranges.size))
        case Odometry():
            return replace(reading, pose=Pose(NAN, NAN, NAN), speed=NAN, turn_rate=NAN)
        case IrReading():
            return replace(reading, detected=False, offset=NAN, strength=NAN)
        case StereoReading():
            return replace(reading, range=NAN)
        case Compass():
            return replace(reading, heading=NAN)
        case Imu():
            return replace(reading, turn_rate=NAN, acceleration=(NAN, NAN))
        case Inclination():
            return replace(reading, pitch=NAN, roll=NAN)
        case Fix():
            return replace(reading, x=NAN, y=NAN)
        case Currents():
            return replace(reading, left=NAN, right=NAN)
        case HeadState() | Bumper() | FlipperState() | Battery():
            return reading


def _blank(size: int) -> Floats:
    blank = np.full(size, NAN)
    blank.setflags(write=False)
    return blank


def wrong_fault(fault: Fault, installed: Sequence[Installed]) -> str:
    """What is wrong with asking for this fault on a robot that carries these; empty where it can be."""
    kinds = {sensor.name: sensor.build for sensor in installed}
    if fault.kind not in FAULTS:
        return f"there is no fault '{fault.kind}'; there are {', '.join(FAULTS)}"
    if fault.sensor not in kinds:
        return f"the robot has no sensor '{fault.sensor}'; it has {', '.join(kinds) or 'none'}"
    if isinstance(kinds[fault.sensor], BumperBuild) and fault.kind in ("bias", "nan"):
        return f"'{fault.sensor}' is a bumper, which has no numbers; it can have dropout and stuck"
    if fault.kind == "dropout" and not 0 <= fault.amount <= 1:
        return f"the amount of a dropout is a chance from 0 to 1, got {fault.amount:g}"
    return ""
