"""How each kind of drive moves: pure functions over frozen values, the same for every way of stepping.

Takes: what a robot is made of (`DriveBuild`), what it is told, what it does now. Gives: what its drive can do of a
command (`reachable`), how far it comes towards that in one sub-step (`ramped`), how the hull moves with it (`hull`).
Leaves alone: place and heading, contacts, and the body in the space (`robot.py`).

Synchro and steered drives ramp speed and turn rate (or steering) apart from one another. Two wheels or tracks do so
too while neither comes to its limit; at the limit both change in proportion, so that no wheel is ever too fast and
neither acceleration is exceeded. A skid-steered hull turns `1 / slip` of what its tracks do, and goes uphill more
slowly. A steered robot is a bicycle: its rear axle goes along the heading, and the middle between the axles, half
a wheelbase ahead, moves aside by `turn_rate * wheelbase / 2` as well. Its speed is the one along the heading, so the
middle goes along heading + atan(tan(steering) / 2).
"""

from __future__ import annotations

import math
from typing import NamedTuple

from behaviours.interface import Drive
from sim.frames import approach
from sim.robots.build import Ackermann, Differential, DriveBuild, SkidSteer, Synchro

ROUNDING = 1e-12


class Motion(NamedTuple):
    """What a drive does: speed [m/s], turn_rate [rad/s] as its wheels or tracks have it, steering [rad]."""

    speed: float
    turn_rate: float
    steering: float = 0.0


class Twist(NamedTuple):
    """How a hull moves in the robot frame: forward and aside (left) [m/s], turn [rad/s]."""

    forward: float
    aside: float
    turn: float


REST = Motion(0.0, 0.0)


# --- what it can do of a command ------------------------------------------------------------------


def reachable(drive: DriveBuild, wanted: Drive, now: Motion) -> Motion:
    """The motion that the drive will settle to when it is told `wanted`, from the motion `now` on."""
    match drive:
        case Synchro():
            return Motion(_clip(wanted.speed, drive.max_speed), _clip(wanted.turn_rate, drive.max_turn_rate))
        case Differential() | SkidSteer():
            asked = max(_fastest_wheel(drive, wanted) / drive.max_speed, abs(wanted.turn_rate) / drive.max_turn_rate)
            return Motion(wanted.speed / max(1.0, asked), wanted.turn_rate / max(1.0, asked))
        case Ackermann():
            return _bicycle(drive, _clip(wanted.speed, drive.max_speed), _steering(drive, wanted, now))


def _clip(value: float, limit: float) -> float:
    return max(-limit, min(limit, value))


def _fastest_wheel(drive: Differential | SkidSteer, motion: Drive | Motion) -> float:
    return abs(motion.speed) + abs(motion.turn_rate) * drive.track / 2


def _steering(drive: Ackermann, wanted: Drive, now: Motion) -> float:
    """For the curvature turn_rate / speed; full lock for turning on the spot, as it is for standing."""
    if wanted.speed != 0:
        return _clip(math.atan(wanted.turn_rate / wanted.speed * drive.wheelbase), drive.max_steering)
    return math.copysign(drive.max_steering, wanted.turn_rate) if wanted.turn_rate else now.steering


def _bicycle(drive: Ackermann, speed: float, steering: float) -> Motion:
    return Motion(speed, speed * math.tan(steering) / drive.wheelbase, steering)


# --- how fast it gets there -----------------------------------------------------------------------


def ramped(drive: DriveBuild, now: Motion, goal: Motion, dt: float) -> Motion:
    """The motion `dt` [s] after `now` on the way to `goal`, which must be reachable."""
    match drive:
        case Synchro():
            return _each(drive, now, goal, dt)
        case Differential() | SkidSteer():
            each = _each(drive, now, goal, dt)
            return each if _fastest_wheel(drive, each) <= drive.max_speed + ROUNDING else _line(drive, now, goal, dt)
        case Ackermann():
            steering = approach(now.steering, goal.steering, drive.steering_rate * dt)
            return _bicycle(drive, approach(now.speed, goal.speed, drive.acceleration * dt), steering)


def _each(drive: Synchro | Differential | SkidSteer, now: Motion, goal: Motion, dt: float) -> Motion:
    speed = approach(now.speed, goal.speed, drive.acceleration * dt)
    return Motion(speed, approach(now.turn_rate, goal.turn_rate, drive.turn_acceleration * dt))


def _line(drive: Differential | SkidSteer, now: Motion, goal: Motion, dt: float) -> Motion:
    faster, turning = goal.speed - now.speed, goal.turn_rate - now.turn_rate
    steps = max(1.0, abs(faster) / (drive.acceleration * dt), abs(turning) / (drive.turn_acceleration * dt))
    return Motion(now.speed + faster / steps, now.turn_rate + turning / steps)


def unwound(now: Motion, goal: Motion, speed_share: float, turn_share: float) -> Motion:
    """Where braking starts: from what was made of the motion (shares of it), not from what was meant.

    Otherwise a robot that has been told to stop would push on for as long as its wheels would have turned in the air.
    """
    speed = _slowed(now.speed, goal.speed, speed_share)
    return now._replace(speed=speed, turn_rate=_slowed(now.turn_rate, goal.turn_rate, turn_share))


def _slowed(now: float, goal: float, share: float) -> float:
    if now * goal > 0 and abs(goal) >= abs(now):
        return now
    made = now * share
    return goal if made * goal > 0 and abs(made) < abs(goal) else made


# --- what the hull makes of it --------------------------------------------------------------------


def hull(drive: DriveBuild, motion: Motion, pitch: float) -> Twist:
    """How the hull moves on free ground that is tilted by pitch [rad, nose up]."""
    match drive:
        case Synchro() | Differential():
            return Twist(motion.speed, 0.0, motion.turn_rate)
        case SkidSteer():
            uphill = math.copysign(pitch, motion.speed * pitch)
            left = max(0.0, 1.0 - drive.slope_speed_loss * max(0.0, uphill))
            return Twist(motion.speed * left, 0.0, motion.turn_rate / drive.slip)
        case Ackermann():
            return Twist(motion.speed, motion.turn_rate * drive.wheelbase / 2, motion.turn_rate)


def wheels(drive: DriveBuild, forward: float, turn: float) -> Drive:
    """What wheels or tracks did when the hull made `forward` [m/s] and `turn` [rad/s]: tracks turn by `slip` more."""
    return Drive(forward, turn * drive.slip if isinstance(drive, SkidSteer) else turn)


def aside(drive: DriveBuild, turn: float) -> float:
    """Speed [m/s] to the left that wheels make of a turn [rad/s]: none but where the middle lies ahead of the axle."""
    return turn * drive.wheelbase / 2 if isinstance(drive, Ackermann) else 0.0
