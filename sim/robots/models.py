"""Robots that a scenario may name: bodies and what they carry.

Takes: nothing. Gives: `MODELS`, by name. Leaves alone: what a scenario changes of them.

Where a figure has no source beside it, it is chosen here to be of the right size for such a robot.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from sim.raycast import Circle, box
from sim.robots.build import Ackermann, Build, Differential, SkidSteer, Synchro
from sim.sensors.build import (
    BumperBuild,
    CompassBuild,
    CurrentBuild,
    GpsBuild,
    ImuBuild,
    InclinometerBuild,
    InfraredBuild,
    Installed,
    LidarBuild,
    Mount,
    OdometryBuild,
    SonarBuild,
    StereoBuild,
)


@dataclass(frozen=True, slots=True)
class Model:
    """A robot as it is delivered: its body, and its sensors in the order in which they are built in."""

    build: Build
    sensors: tuple[Installed, ...]


def _denning() -> Model:
    """Denning MRV: the round synchro drive with 24 + 6 sonars, beacon reader and verging cameras on a pan-tilt head.

    Speeds after Bonasso, Antonisse and Slack 1992; radius and accelerations chosen here.
    """
    sensors = (
        Installed("sonar", SonarBuild()),
        Installed("infrared", InfraredBuild()),
        Installed("stereo", StereoBuild()),
        Installed("odometry", OdometryBuild()),
    )
    return Model(Build(Circle(0.35), Synchro(0.2, 0.8, 0.5, 2.0), mass=120.0, height=1.2), sensors)


def _packbot() -> Model:
    """iRobot PackBot with a navigation payload, after Yamauchi 2004 and the reports that followed.

    The hull is the box of 0.69 x 0.52 m over tracks and flippers, not a disc: what is beside a tread must be able to
    catch it. 1 m/s of its 2 m/s; it cruises at 0.5. Lidar: 361 readings at 5 Hz, 20 m. Odometry: tracks that scrub
    (slip 1.3), 2 % of the distance, 0.004 rad per root second. Currents: 0.2 s low-pass.
    """
    drive = SkidSteer(max_speed=1.0, max_turn_rate=2.0, track=0.4, slip=1.3, climbs=0.08, climbs_deployed=0.20)
    lidar = LidarBuild(math.tau, beams=361, min_range=0.05, max_range=20.0, sd=0.02)
    sensors = (
        Installed("lidar", lidar, Mount(height=0.35), period=0.2),
        Installed("compass", CompassBuild()),
        Installed("odometry", OdometryBuild(scale_sd=0.02, turn_sd=0.004)),
        Installed("imu", ImuBuild()),
        Installed("inclinometer", InclinometerBuild()),
        Installed("gps", GpsBuild(), period=1.0),
        Installed("currents", CurrentBuild()),
        Installed("bumper", BumperBuild()),
    )
    return Model(Build(box(0.69, 0.52), drive, mass=24.0, height=0.4), sensors)


def _ravon() -> Model:
    """RAVON, the off-road vehicle of Kaiserslautern (Armbrust et al. 2009), 2.35 x 1.4 m at 1 m/s.

    It has "the dimensions and weight of a city car" and a planar laser scanner at its front bumper.
    """
    drive = Ackermann(max_speed=1.0, wheelbase=1.4, max_steering=0.5, steering_rate=1.0, acceleration=0.5)
    lidar = LidarBuild(math.pi, beams=361, min_range=0.1, max_range=30.0, sd=0.02)
    sensors = (
        Installed("lidar", lidar, Mount(x=1.175, height=0.5), period=0.1),
        Installed("odometry", OdometryBuild(scale_sd=0.02, turn_sd=0.004)),
        Installed("compass", CompassBuild()),
        Installed("imu", ImuBuild()),
        Installed("inclinometer", InclinometerBuild()),
        Installed("gps", GpsBuild(), period=1.0),
        Installed("bumper", BumperBuild()),
    )
    return Model(Build(box(2.35, 1.4), drive, mass=750.0, height=1.8), sensors)


def _xrhex() -> Model:
    """X-RHex with a Hokuyo UBG-04LX-F01 on its back, taken for a unicycle.

    Lidar after Bayer 2012 and the sensor's data sheet: 240 degrees, a scan each 28 ms, less than 4 m, 1 % of the range;
    667 beams. Speed: 0.32 m/s for each unit of its setspeed, 1.5 of them.
    """
    drive = Differential(max_speed=0.8, max_turn_rate=1.5, acceleration=2.0, turn_acceleration=8.0, track=0.3)
    lidar = LidarBuild(math.radians(240), beams=667, min_range=0.02, max_range=4.0, sd=0.0, relative_sd=0.01)
    sensors = (
        Installed("lidar", lidar, Mount(height=0.25), period=0.028),
        Installed("odometry", OdometryBuild(scale_sd=0.05, turn_sd=0.01)),
        Installed("imu", ImuBuild()),
    )
    return Model(Build(Circle(0.25), drive, mass=9.5, height=0.3), sensors)


def _jackal() -> Model:
    """Clearpath Jackal: 0.508 x 0.430 m, 2 m/s, as in the navigation benchmark BARN (Perille et al. 2020).

    Its lidar there has 720 beams over 270 degrees, 0.1 to 30 m. A turn scrubs little on its four wheels; it is taken
    for a differential drive.
    """
    drive = Differential(max_speed=2.0, max_turn_rate=4.0, acceleration=3.0, turn_acceleration=8.0, track=0.376)
    lidar = LidarBuild(math.radians(270), beams=720, min_range=0.1, max_range=30.0, sd=0.01)
    sensors = (
        Installed("lidar", lidar, Mount(x=0.12, height=0.33), period=0.025),
        Installed("odometry", OdometryBuild(scale_sd=0.01, turn_sd=0.005)),
        Installed("imu", ImuBuild()),
        Installed("bumper", BumperBuild()),
    )
    return Model(Build(box(0.508, 0.430), drive, mass=17.0, height=0.4), sensors)


def _pioneer() -> Model:
    """Pioneer 3-DX, 0.455 x 0.381 m, 1.2 m/s, with a half-turn lidar of 8 m in place of its sonars."""
    drive = Differential(max_speed=1.2, max_turn_rate=4.0, acceleration=1.0, turn_acceleration=5.0, track=0.33)
    lidar = LidarBuild(math.pi, beams=181, min_range=0.05, max_range=8.0, sd=0.01)
    sensors = (
        Installed("lidar", lidar, Mount(x=0.1, height=0.3), period=0.1),
        Installed("odometry", OdometryBuild(scale_sd=0.01, turn_sd=0.004)),
        Installed("bumper", BumperBuild()),
    )
    return Model(Build(box(0.455, 0.381), drive, mass=9.0, height=0.35), sensors)


def _turtlebot() -> Model:
    """TurtleBot3 Waffle Pi taken for a disc: 0.26 m/s, 1.82 rad/s, 1.8 kg and a lidar of 360 beams and 3.5 m.

    The figures are those of its maker's manual (ROBOTIS e-Manual).
    """
    drive = Differential(max_speed=0.26, max_turn_rate=1.82, acceleration=1.0, turn_acceleration=4.0, track=0.287)
    lidar = LidarBuild(math.tau, beams=360, min_range=0.12, max_range=3.5, sd=0.01)
    sensors = (
        Installed("lidar", lidar, Mount(height=0.12), period=0.2),
        Installed("odometry", OdometryBuild(scale_sd=0.01, turn_sd=0.004)),
        Installed("imu", ImuBuild()),
    )
    return Model(Build(Circle(0.18), drive, mass=1.8, height=0.141), sensors)


def _micromouse() -> Model:
    """A mouse for mazes of 0.18 m cells: a disc of 0.05 m with eight range beams of 1 m; all chosen here."""
    drive = Differential(max_speed=0.5, max_turn_rate=6.0, acceleration=2.0, turn_acceleration=40.0, track=0.07)
    lidar = LidarBuild(math.tau, beams=8, min_range=0.005, max_range=1.0, sd=0.002)
    sensors = (
        Installed("lidar", lidar, Mount(height=0.02), period=0.1),
        Installed("odometry", OdometryBuild(scale_sd=0.005, turn_sd=0.002)),
    )
    return Model(Build(Circle(0.05), drive, mass=0.2, height=0.05), sensors)


MODELS: Mapping[str, Model] = MappingProxyType(
    {
        "denning": _denning(),
        "packbot": _packbot(),
        "ravon": _ravon(),
        "xrhex": _xrhex(),
        "jackal": _jackal(),
        "pioneer": _pioneer(),
        "turtlebot": _turtlebot(),
        "micromouse": _micromouse(),
    }
)
"""By the name that a scenario gives."""
