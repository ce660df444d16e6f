"""What sensors a robot carries, where, how good they are and what is wrong with them, as frozen values.

Takes: nothing. Gives: one `…Build` for each kind, `Installed` (a sensor on a robot) and `Fault`.
Leaves alone: how readings come about (the files named after the kinds).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

FAULTS = ("dropout", "stuck", "bias", "nan")


@dataclass(frozen=True, slots=True)
class Mount:
    """Where a sensor sits in the robot frame: x, y [m], theta [rad], and how high [m]; what is lower is not seen."""

    x: float = 0.0
    y: float = 0.0
    theta: float = 0.0
    height: float = 0.3


@dataclass(frozen=True, slots=True)
class Fault:
    """What goes wrong with the sensor of this name, from `start` to `end` [s].

    kind: "dropout" (each reading is lost with chance `amount`: it does not arrive), "stuck" (what was last measured
    is repeated, with new stamps), "bias" (`amount` is added, in the unit of the reading), "nan" (numbers are NaN).
    """

    sensor: str
    kind: str
    start: float = 0.0
    end: float = math.inf
    amount: float = 1.0


@dataclass(frozen=True, slots=True)
class SonarBuild:
    """sd: share of the range that is noise; dropout: chance that one reading hears nothing (specular reflection)."""

    sd: float = 0.01
    dropout: float = 0.02


@dataclass(frozen=True, slots=True)
class LidarBuild:
    """field_of_view [rad], its beams, ranges [m]; noise of the range: sd [m] + relative_sd * range; angle_sd [rad].

    A field of view of 2 pi spreads the beams evenly without one twice; a smaller one has a beam at either edge.
    dropout: chance that a beam fails (NaN).
    """

    field_of_view: float = math.tau
    beams: int = 360
    min_range: float = 0.05
    max_range: float = 10.0
    sd: float = 0.01
    relative_sd: float = 0.0
    angle_sd: float = 0.0
    dropout: float = 0.0


@dataclass(frozen=True, slots=True)
class InfraredBuild:
    """period [s] of fixations; sd of the signal-to-noise ratio; offset_sd [rad]."""

    period: float = 1.0
    sd: float = 0.2
    offset_sd: float = math.radians(0.3)


@dataclass(frozen=True, slots=True)
class StereoBuild:
    """period [s] of a fixation; camera_height [m]; linear, quadratic: the sd is linear * z + quadratic * z^2.

    stuck: chance that a fixation that looks down by more than 30 degrees jams the head.
    """

    period: float = 9.0
    camera_height: float = 1.2
    linear: float = 0.003
    quadratic: float = 0.001
    stuck: float = 0.0


@dataclass(frozen=True, slots=True)
class OdometryBuild:
    """scale_sd: of the distance, per run; turn_sd [rad/sqrt(s)]: of the heading while it turns.

    What tracks do beyond the hull (slip) is counted as if the hull had done it.
    """

    scale_sd: float = 0.005
    turn_sd: float = 0.002


@dataclass(frozen=True, slots=True)
class CompassBuild:
    """sd [rad] of each reading; a smooth bias field over the world: the sum of two sines.

    bias_rms [rad] of the field, wavelength [m]; 0 for none.
    """

    sd: float = math.radians(1.0)
    bias_rms: float = math.radians(2.1)
    wavelength: float = 38.0


@dataclass(frozen=True, slots=True)
class ImuBuild:
    """sd of turn rate [rad/s] and acceleration [m/s^2]; bias_sd of the turn rate [rad/s], constant for a run."""

    turn_rate_sd: float = 0.002
    acceleration_sd: float = 0.05
    bias_sd: float = 0.0005


@dataclass(frozen=True, slots=True)
class InclinometerBuild:
    """sd [rad] of pitch and roll."""

    sd: float = math.radians(0.3)


@dataclass(frozen=True, slots=True)
class GpsBuild:
    """sd [m] of each fix; drift_sd [m]: of an error that wanders with the time constant drift_time [s]."""

    sd: float = 0.5
    drift_sd: float = 1.5
    drift_time: float = 60.0


@dataclass(frozen=True, slots=True)
class CurrentBuild:
    """sd [A] of each reading; smoothing [s]: time constant of the low-pass that keeps inrush out."""

    sd: float = 0.1
    smoothing: float = 0.2


@dataclass(frozen=True, slots=True)
class BumperBuild:
    """How many switches share the hull's circumference, the first of them straight ahead."""

    segments: int = 8


SensorBuild = (
    SonarBuild
    | LidarBuild
    | InfraredBuild
    | StereoBuild
    | OdometryBuild
    | CompassBuild
    | ImuBuild
    | InclinometerBuild
    | GpsBuild
    | CurrentBuild
    | BumperBuild
)


@dataclass(frozen=True, slots=True)
class Installed:
    """A sensor on a robot. period [s]: 0 for the kind's own; latency [s] between measuring and arriving."""

    name: str
    build: SensorBuild
    mount: Mount = Mount()
    period: float = 0.0
    latency: float = 0.0
