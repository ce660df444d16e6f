"""What robots are made of: hull, drive and limits, as frozen values.

Takes: nothing. Gives: `Build` and the closed union `DriveBuild`; what a scenario says of a robot becomes these.
Leaves alone: motion (`robot.py`) and sensors (`sim/sensors/build.py`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from sim.raycast import Circle, Outline, reach


@dataclass(frozen=True, slots=True)
class Synchro:
    """All wheels steer together; the round hull does not turn. Speeds [m/s, rad/s], accelerations [m/s^2, rad/s^2]."""

    max_speed: float = 0.2
    max_turn_rate: float = 0.8
    acceleration: float = 0.5
    turn_acceleration: float = 2.0


@dataclass(frozen=True, slots=True)
class Differential:
    """Two driven wheels, `track` [m] apart; also a unicycle. A wheel turns at max_speed [m/s] at most.

    A command that asks more of a wheel is scaled down as a whole, so that the curvature is kept.
    """

    max_speed: float = 0.5
    max_turn_rate: float = 2.0
    acceleration: float = 1.0
    turn_acceleration: float = 4.0
    track: float = 0.4


@dataclass(frozen=True, slots=True)
class SkidSteer:
    """Two tracks, `track` [m] apart, that scrub when they turn: the hull turns `1 / slip` of what the tracks do.

    climbs, climbs_deployed [m]: the highest curb that it gets over, with flippers home and after they have been
    deployed for a second of pushing. slope_speed_loss: share of its speed lost per radian uphill.
    """

    max_speed: float = 0.5
    max_turn_rate: float = 1.0
    acceleration: float = 1.0
    turn_acceleration: float = 4.0
    track: float = 0.4
    slip: float = 1.3
    climbs: float = 0.08
    climbs_deployed: float = 0.20
    slope_speed_loss: float = 0.5


@dataclass(frozen=True, slots=True)
class Ackermann:
    """Front wheels that steer, by max_steering [rad] at most and steering_rate [rad/s]; wheelbase [m].

    The middle of the hull is the middle between the axles. It cannot turn on the spot.
    """

    max_speed: float = 1.0
    wheelbase: float = 1.4
    max_steering: float = 0.5
    steering_rate: float = 1.0
    acceleration: float = 1.0


DriveBuild = Synchro | Differential | SkidSteer | Ackermann


@dataclass(frozen=True, slots=True)
class Build:
    """A robot's body: hull round the origin of the robot frame, how it drives, mass [kg], height [m]."""

    hull: Outline = field(default_factory=lambda: Circle(0.35))
    drive: DriveBuild = field(default_factory=Synchro)
    mass: float = 120.0
    height: float = 1.2

    @property
    def radius(self) -> float:
        """Radius [m] of the circle round the origin that encloses the hull."""
        return reach(self.hull)

    @property
    def max_speed(self) -> float:
        """[m/s]"""
        return self.drive.max_speed

    @property
    def max_turn_rate(self) -> float:
        """[rad/s]"""
        match self.drive:
            case Ackermann(max_speed=speed, wheelbase=base, max_steering=steering):
                return speed * math.tan(steering) / base
            case drive:
                return drive.max_turn_rate
