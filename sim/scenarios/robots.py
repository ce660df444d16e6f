"""The robot of a scenario: a model with changes, or one of its own.

Takes: nothing. Gives: `robot`, what drives, sensors and batteries are told by. Leaves alone: how they work; see
sim/robots and sim/sensors.
"""

from __future__ import annotations

import math
from dataclasses import asdict, fields, replace
from typing import Any

import yaml

from behaviours.interface import Pose
from sim.raycast import Circle, Outline
from sim.robots.battery import BatteryBuild
from sim.robots.build import Ackermann, Build, Differential, DriveBuild, SkidSteer, Synchro
from sim.robots.models import MODELS
from sim.scenarios.measures import (
    angle,
    duration,
    fields_of,
    length,
    mass,
    moment,
    pose,
    positive,
    positive_number,
    shape,
    share,
    speed,
    spot,
    spread,
)
from sim.scenarios.scenario import Amount, RobotSpec, Spot
from sim.scenarios.schema import Key, Report, Spec, Wrong, by_kind, choice, listed, quantity, record, whole, word
from sim.scenarios.things import heading
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
    SensorBuild,
    SonarBuild,
    StereoBuild,
)

drives = {
    "max_speed": speed,
    "max_turn_rate": positive_number,
    "acceleration": positive_number,
    "turn_acceleration": positive_number,
}
DRIVES: dict[str, Spec[DriveBuild]] = {
    "synchro": fields_of(Synchro(), drives),
    "differential": fields_of(Differential(), {**drives, "track": positive}),
    "skid-steer": fields_of(
        SkidSteer(),
        {
            **drives,
            "track": positive,
            "slip": quantity("number", least=1, most=10),
            "climbs": length,
            "climbs_deployed": length,
            "slope_speed_loss": spread,
        },
    ),
    "ackermann": fields_of(
        Ackermann(),
        {
            "max_speed": speed,
            "wheelbase": positive,
            "max_steering": quantity("angle", above=0, most=1.5),
            "steering_rate": positive_number,
            "acceleration": positive_number,
        },
    ),
}
beams = whole(1, 100_000)
turn = quantity("angle", above=0, most=math.tau + 1e-9)
BUILDS: dict[str, tuple[SensorBuild, dict[str, Spec[Any]]]] = {
    "sonar": (SonarBuild(), {"sd": spread, "dropout": share}),
    "lidar": (
        LidarBuild(),
        {
            "field_of_view": turn,
            "beams": beams,
            "min_range": length,
            "max_range": positive,
            "sd": length,
            "relative_sd": spread,
            "angle_sd": quantity("angle", least=0),
            "dropout": share,
        },
    ),
    "infrared": (InfraredBuild(), {"period": duration, "sd": spread, "offset_sd": angle}),
    "stereo": (
        StereoBuild(),
        {"period": duration, "camera_height": positive, "linear": spread, "quadratic": spread, "stuck": share},
    ),
    "odometry": (OdometryBuild(), {"scale_sd": spread, "turn_sd": spread}),
    "compass": (
        CompassBuild(),
        {"sd": quantity("angle", least=0), "bias_rms": quantity("angle", least=0), "wavelength": positive},
    ),
    "imu": (ImuBuild(), {"turn_rate_sd": spread, "acceleration_sd": spread, "bias_sd": spread}),
    "inclinometer": (InclinometerBuild(), {"sd": quantity("angle", least=0)}),
    "gps": (GpsBuild(), {"sd": length, "drift_sd": length, "drift_time": duration}),
    "currents": (CurrentBuild(), {"sd": spread, "smoothing": moment}),
    "bumper": (BumperBuild(), {"segments": whole(1, 1000)}),
}
"""Kind -> a sample with the defaults, and what its fields hold."""


def _mount(at: Pose, height: float) -> Mount:
    return Mount(at.x, at.y, at.theta, height)


def _sensor(kind: str) -> Spec[Installed]:
    sample, specs = BUILDS[kind]
    own = {name: Key(spec, getattr(sample, name)) for name, spec in specs.items()}
    common = {
        "name": Key(word, kind),
        "at": Key(pose, Pose(0.0, 0.0)),
        "height": Key(length, Mount().height, doc="above the ground: what is lower is not seen"),
        "period": Key(duration, 0.0),
        "latency": Key(moment, 0.0),
    }

    def make(name: str, at: Pose, height: float, latency: float, period: float = 0.0, **build: Any) -> Installed:
        if "period" in own:
            build, period = {**build, "period": period}, 0.0
        _check_ranges(build)
        return Installed(name, type(sample)(**build), _mount(at, height), period, latency)

    return record(make, **(common | own))


def _check_ranges(build: dict[str, Any]) -> None:
    if "min_range" in build and build["min_range"] >= build["max_range"]:
        raise ValueError("min_range must be less than max_range")


def _sensors(report: Report, node: yaml.Node, path: str) -> tuple[Installed, ...] | Wrong:
    """Sensors whose names differ."""
    sensors = sensor_list(report, node, path)
    if isinstance(sensors, str):
        return sensors
    taken: list[str] = []
    for index, sensor in enumerate(sensors):
        if sensor.name in taken:
            report.wrong(node.value[index], f"{path}[{index}].name", f"the name {sensor.name!r} is taken")
        taken.append(sensor.name)
    return sensors


sensor_list: Spec[tuple[Installed, ...]] = listed(by_kind({kind: _sensor(kind) for kind in BUILDS}))


def _changes(specs: dict[str, Spec[Any]]) -> Spec[dict[str, Any]]:
    """Some fields of a sensor of the model."""

    def make(**given: Any) -> dict[str, Any]:
        return {name: value for name, value in given.items() if value is not None}

    return record(make, **{name: Key(spec, None) for name, spec in specs.items()})


LIMITS = ("max_speed", "max_turn_rate", "acceleration", "turn_acceleration")


def _robot(
    start: Spot,
    heading: Amount,
    model: str | None,
    shape: Outline | None,
    radius: float | None,
    mass: float | None,
    height: float | None,
    drive: DriveBuild | None,
    sensors: tuple[Installed, ...] | None,
    battery: BatteryBuild | None,
    **rest: Any,
) -> RobotSpec:
    if shape is not None and radius is not None:
        raise ValueError("give 'shape' or 'radius', not both")
    base = MODELS[model or "denning"]
    own = model is None and (shape is not None or drive is not None)
    hull = shape or (Circle(radius) if radius is not None else base.build.hull)
    build = Build(
        hull,
        _limited(drive or base.build.drive, {name: rest[name] for name in LIMITS if rest[name] is not None}),
        base.build.mass if mass is None else mass,
        base.build.height if height is None else height,
    )
    if isinstance(build.drive, Synchro) and not isinstance(hull, Circle):
        raise ValueError("a synchro drive has a round hull: it does not turn with the steering")
    carried = sensors if sensors is not None else () if own else base.sensors
    for kind in BUILDS:
        if rest[kind] is not None:
            carried = _changed(carried, kind, rest[kind])
    return RobotSpec(start, heading, build, carried, battery)


def _limited(drive: DriveBuild, limits: dict[str, Any]) -> DriveBuild:
    known = [field.name for field in fields(drive)]
    for name in limits:
        if name not in known:
            raise ValueError(f"this drive has no {name}; it has {', '.join(known)}")
    return replace(drive, **limits)


def _changed(sensors: tuple[Installed, ...], kind: str, changes: dict[str, Any]) -> tuple[Installed, ...]:
    sample = type(BUILDS[kind][0])
    places = [index for index, sensor in enumerate(sensors) if isinstance(sensor.build, sample)]
    if not places:
        raise ValueError(f"this robot carries no {kind}: name it under 'sensors'")
    changed = replace(sensors[places[0]], build=replace(sensors[places[0]].build, **changes))
    _check_ranges(asdict(changed.build))
    return (*sensors[: places[0]], changed, *sensors[places[0] + 1 :])


robot = record(
    _robot,
    start=Key(spot, doc="home is there"),
    heading=heading,
    model=Key(choice(*MODELS), None),
    shape=Key(shape, None),
    radius=Key(positive, None),
    mass=Key(mass, None),
    height=Key(positive, None),
    drive=Key(by_kind(DRIVES), None),
    sensors=Key(Spec(_sensors, sensor_list.schema), None),
    battery=Key(fields_of(BatteryBuild(), {"lasts": duration, "charges_in": duration, "level": share}), None),
    **{name: Key(drives[name], None) for name in LIMITS},
    **{kind: Key(_changes(BUILDS[kind][1]), None) for kind in BUILDS},
)
