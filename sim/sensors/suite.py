"""All sensors of one robot: from the truth to one `Reading`.

Takes: what is installed, what is faulty, the robot's build and where it starts, the seed; then, tick by tick, the
truth. Gives: `Reading`. Leaves alone: when sensors measure and what (the files beside this one).

Each kind of sensor has its field in the `Reading`; the second of a kind, in the order of their installation, goes to
`others` under its name, its skirt of a second pair of sonar rings under NAME.skirt. Each sensor draws from a generator
of its own, told apart by its name: one more sensor changes nothing of what the others say.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from behaviours.interface import NO_OTHERS, Battery, FlipperState, HeadState, Pose, Reading, Sensed
from sim.noise import named_chance, sensor_chance
from sim.robots.build import Build, SkidSteer
from sim.sensors import compass, gps, inclinometer, lidar, sonar
from sim.sensors.build import (
    BumperBuild,
    CompassBuild,
    CurrentBuild,
    Fault,
    GpsBuild,
    ImuBuild,
    InclinometerBuild,
    InfraredBuild,
    Installed,
    LidarBuild,
    OdometryBuild,
    SonarBuild,
    StereoBuild,
)
from sim.sensors.bumper import ContactSwitches
from sim.sensors.currents import MotorCurrents
from sim.sensors.faults import wrong_fault
from sim.sensors.imu import InertialUnit
from sim.sensors.infrared import NEVER, BeaconReader
from sim.sensors.odometry import WheelOdometry
from sim.sensors.sensor import Every, Fixation, Instrument, Sensor
from sim.sensors.stereo import VergingCameras
from sim.sensors.truth import Truth

PERFECT_ODOMETRY = Installed("odometry", OdometryBuild(0.0, 0.0))
"""What a robot has whose builder thought of none: every `Reading` tells the odometry."""


class Suite:
    """The sensors. `update` is called after each tick of the world, `sense` once in each."""

    def __init__(
        self, installed: tuple[Installed, ...], faults: tuple[Fault, ...], build: Build, start: Pose, seed: int
    ) -> None:
        """Raises ValueError where two sensors have one name, or a fault is of none or cannot be."""
        _check(installed, faults)
        carried = _carried(installed)
        instruments = [instrument(sensor, build, start, seed) for sensor in carried]
        self._updates = [made.update for made in instruments if made.update is not None]
        self._sensors: list[tuple[Sensor, tuple[str, ...]]] = []
        self._others: list[tuple[Sensor, tuple[str, ...]]] = []
        taken: tuple[str, ...] = ()
        for spec, made in zip(carried, instruments, strict=True):
            mine = tuple(fault for fault in faults if fault.sensor == spec.name)
            sensor = Sensor(made, spec.latency, mine, named_chance(seed, "fault", spec.name))
            if made.fields[0] in taken:
                self._others.append((sensor, (spec.name, f"{spec.name}.skirt")))
            else:
                self._sensors.append((sensor, made.fields))
            taken += made.fields

        self._has_head = any(isinstance(spec.build, InfraredBuild | StereoBuild) for spec in carried)
        self._has_flippers = isinstance(build.drive, SkidSteer)

    def update(self, truth: Truth) -> None:
        """Let pass what adds up and what is filtered; once after each tick of the world."""
        for update in self._updates:
            update(truth)

    def sense(self, truth: Truth, object_on_board: bool) -> Reading:
        """What the robot senses at the end of this tick; once a tick."""
        said: dict[str, Any] = {}
        for sensor, fields in self._sensors:
            said.update(zip(fields, sensor.sense(truth) or (), strict=False))
        if self._has_head:
            head = truth.head
            said["head"] = HeadState(head.pan, head.tilt, head.settled, truth.time)
        if self._has_flippers:
            said["flippers"] = FlipperState(truth.flippers.angle, truth.flippers.deployed, truth.time)
        if truth.battery is not None:
            said["battery"] = Battery(truth.time, True, *truth.battery)
        return Reading(
            truth.time,
            truth.tick,
            object_on_board=object_on_board,
            others=self._said_by_others(truth) if self._others else NO_OTHERS,
            **said,
        )

    def _said_by_others(self, truth: Truth) -> Mapping[str, Sensed]:
        said: dict[str, Sensed] = {}
        for sensor, names in self._others:
            said.update(zip(names, sensor.sense(truth) or (), strict=False))
        return MappingProxyType(said)


def _carried(installed: tuple[Installed, ...]) -> tuple[Installed, ...]:
    odometry = any(isinstance(sensor.build, OdometryBuild) for sensor in installed)
    return installed if odometry else (PERFECT_ODOMETRY, *installed)


def _check(installed: tuple[Installed, ...], faults: tuple[Fault, ...]) -> None:
    names = [sensor.name for sensor in installed]
    for name in names:
        if names.count(name) > 1:
            raise ValueError(f"two sensors are called '{name}'")
    for fault in faults:
        if wrong := wrong_fault(fault, installed):
            raise ValueError(wrong)


def instrument(installed: Installed, robot: Build, start: Pose, seed: int) -> Instrument:
    """The sensor brought to life, at the beginning of a run."""
    chance, mount, asked = sensor_chance(seed, installed.name), installed.mount, installed.period
    match installed.build:
        case SonarBuild() as build:
            rings = sonar.SonarRings(build, robot.radius, robot.height, chance)
            return Instrument(("sonar", "skirt"), rings.measure, Every(asked or sonar.PERIOD), rings.first)
        case LidarBuild() as build:
            return Instrument(("lidar",), lidar.Lidar(build, mount, chance).measure, Every(asked or lidar.PERIOD))
        case InfraredBuild() as build:
            reader = BeaconReader(build, chance)
            return Instrument(("ir",), reader.measure, Fixation(asked or build.period), (NEVER,))
        case StereoBuild() as build:
            cameras = VergingCameras(build, chance)
            return Instrument(("stereo",), cameras.measure, Fixation(asked or build.period, True), cameras.first)
        case OdometryBuild() as build:
            wheels = WheelOdometry(build, start, chance)
            return Instrument(("odometry",), wheels.measure, Every(asked), wheels.first, wheels.update)
        case CompassBuild() as build:
            needle = compass.MagneticCompass(build, chance, named_chance(seed, "magnetic field"))
            return Instrument(("compass",), needle.measure, Every(asked or compass.PERIOD))
        case ImuBuild() as build:
            return Instrument(("imu",), InertialUnit(build, chance).measure, Every(asked))
        case InclinometerBuild() as build:
            level = inclinometer.Inclinometer(build, chance)
            return Instrument(("inclination",), level.measure, Every(asked or inclinometer.PERIOD))
        case GpsBuild() as build:
            return Instrument(("gps",), gps.Gps(build, mount, chance).measure, Every(asked or gps.PERIOD))
        case CurrentBuild() as build:
            motors = MotorCurrents(build, chance)
            return Instrument(("currents",), motors.measure, Every(asked), None, motors.update)
        case BumperBuild() as build:
            return Instrument(("bumper",), ContactSwitches(build).measure, Every(asked))
