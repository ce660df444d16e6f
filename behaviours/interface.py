"""The words between a world and a brain: `Reading` in, `Command` out.

Takes: nothing. Gives: frozen values in SI units, and the protocols of what a robot can do.
Leaves alone: how readings come about (a simulator, a robot, a log) and who decides (a plan, a hand-written policy).

Frames. The *robot frame* has its origin in the middle of the hull, x forward along the drive heading,
y left, angles counter-clockwise positive and wrapped to (-pi, pi]. A synchro-drive base carries its
sensor rings and its head on the steered turret, so that the robot frame turns with the steering.
The *odometry frame* is the robot frame of the first reading. Poses named `p_OR` are the robot in it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Vec2 = tuple[float, float]


def wrap(angle: float) -> float:
    """The same angle [rad] in (-pi, pi]."""
    wrapped = math.remainder(angle, math.tau)
    return math.pi if wrapped == -math.pi else wrapped


@dataclass(frozen=True, slots=True)
class Pose:
    """A place and a heading in the plane: x, y [m], theta [rad]."""

    x: float
    y: float
    theta: float = 0.0


# --- what is sensed -------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Ranges:
    """One sweep of a ring of range sensors on the hull.

    bearings: (n,) [rad] robot frame. ranges: (n,) [m] from the hull along the bearing; `max_range`
    where nothing was heard. mount_radius: distance [m] of the transducers from the robot's origin, so an
    echo lies at (mount_radius + range) along its bearing. stamp [s]; fresh: measured since the last reading.
    """

    stamp: float
    fresh: bool
    bearings: Floats
    ranges: Floats
    max_range: float
    mount_radius: float


@dataclass(frozen=True, slots=True)
class Odometry:
    """Dead reckoning: pose in the odometry frame, speed [m/s] along x, turn_rate [rad/s]."""

    pose: Pose
    speed: float
    turn_rate: float
    stamp: float = 0.0
    fresh: bool = True


@dataclass(frozen=True, slots=True)
class HeadState:
    """The pan-tilt head: pan [rad, robot frame, left positive], tilt [rad, downward positive]; settled: not moving."""

    pan: float
    tilt: float
    settled: bool
    stamp: float = 0.0
    fresh: bool = True


@dataclass(frozen=True, slots=True)
class IrReading:
    """One fixation of the infra-red beacon reader, made with the head at `pan` [rad, robot frame].

    detected: the beacon's dedicated frequency was heard. offset [rad]: bearing of the beacon relative to the
    optical axis, left positive (NaN if not detected). strength: signal to noise ratio. beacon: whose it was, if it
    was heard.
    """

    stamp: float
    fresh: bool
    pan: float
    detected: bool
    offset: float
    strength: float
    beacon: str = ""


@dataclass(frozen=True, slots=True)
class StereoReading:
    """One vergence range: slant distance [m] from the cameras along (pan, tilt) [rad]; NaN if verging failed."""

    stamp: float
    fresh: bool
    pan: float
    tilt: float
    range: float
    camera_height: float


@dataclass(frozen=True, slots=True)
class Scan:
    """One sweep of a lidar.

    mount: pose of the sensor in the robot frame. bearings: (n,) [rad] in the frame of the sensor. ranges: (n,) [m]
    from the sensor along the bearing; `max_range` where nothing was met, NaN where the beam failed.
    """

    stamp: float
    fresh: bool
    mount: Pose
    bearings: Floats
    ranges: Floats
    min_range: float
    max_range: float


@dataclass(frozen=True, slots=True)
class Compass:
    """heading [rad] of the robot in the world, wrapped; NaN if the sensor failed."""

    stamp: float
    fresh: bool
    heading: float


@dataclass(frozen=True, slots=True)
class Imu:
    """turn_rate [rad/s]; acceleration [m/s^2] along x and y of the robot frame, gravity taken out."""

    stamp: float
    fresh: bool
    turn_rate: float
    acceleration: Vec2


@dataclass(frozen=True, slots=True)
class Inclination:
    """How the ground tilts the robot: pitch [rad], nose up positive; roll [rad], left side up positive."""

    stamp: float
    fresh: bool
    pitch: float
    roll: float


@dataclass(frozen=True, slots=True)
class Fix:
    """A fix of satellite navigation: x, y [m] in the world; NaN without reception."""

    stamp: float
    fresh: bool
    x: float
    y: float


@dataclass(frozen=True, slots=True)
class Currents:
    """What the two drive motors draw [A]."""

    stamp: float
    fresh: bool
    left: float
    right: float


@dataclass(frozen=True, slots=True)
class Bumper:
    """Contact switches round the hull: bearings (n,) [rad] of their middles, robot frame; pressed (n,) bool."""

    stamp: float
    fresh: bool
    bearings: Floats
    pressed: NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class FlipperState:
    """The flippers of a tracked robot: angle [rad], 0 at home, downward positive; deployed: they bear on the ground."""

    angle: float
    deployed: bool
    stamp: float = 0.0
    fresh: bool = True


@dataclass(frozen=True, slots=True)
class Battery:
    """level: 0 (empty, the drive stands still) to 1; charging: it fills at a charger."""

    stamp: float
    fresh: bool
    level: float
    charging: bool


Sensed = (
    Ranges
    | Odometry
    | HeadState
    | IrReading
    | StereoReading
    | Scan
    | Compass
    | Imu
    | Inclination
    | Fix
    | Currents
    | Bumper
    | FlipperState
    | Battery
)
"""What one sensor says; each carries `stamp` [s], when it was measured, and `fresh`: it arrived since the last tick."""

NO_OTHERS: Mapping[str, Sensed] = MappingProxyType({})


@dataclass(frozen=True, slots=True)
class Reading:
    """All that the robot senses at one instant; a sensor that it does not carry is None.

    stamp [s] since the start; tick: how many readings came before. object_on_board: the signal of the donor
    that the object lies on the platform. others: by name, the sensors of a kind of which the robot carries several,
    from the second on.
    """

    stamp: float
    tick: int
    odometry: Odometry
    sonar: Ranges | None = None
    skirt: Ranges | None = None
    head: HeadState | None = None
    ir: IrReading | None = None
    stereo: StereoReading | None = None
    object_on_board: bool = False
    lidar: Scan | None = None
    compass: Compass | None = None
    imu: Imu | None = None
    inclination: Inclination | None = None
    gps: Fix | None = None
    currents: Currents | None = None
    bumper: Bumper | None = None
    flippers: FlipperState | None = None
    battery: Battery | None = None
    others: Mapping[str, Sensed] = field(default_factory=lambda: NO_OTHERS)


# --- what is commanded ----------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Drive:
    """speed [m/s] along the drive heading (negative: backwards), turn_rate [rad/s] of the heading, left positive."""

    speed: float
    turn_rate: float


@dataclass(frozen=True, slots=True)
class Head:
    """Where the head shall look: pan [rad, robot frame, left positive], tilt [rad, downward positive]."""

    pan: float
    tilt: float


@dataclass(frozen=True, slots=True)
class Flippers:
    """deployed: down on the ground, or home."""

    deployed: bool


@dataclass(frozen=True, slots=True)
class Command:
    """What the actuators shall do until the next command.

    None leaves an actuator to its safe state (drive: stop; head, flippers: stay).
    """

    drive: Drive | None = None
    head: Head | None = None
    flippers: Flippers | None = None

    def is_finite(self) -> bool:
        """True when every number in it is finite."""
        numbers = [] if self.drive is None else [self.drive.speed, self.drive.turn_rate]
        numbers += [] if self.head is None else [self.head.pan, self.head.tilt]
        return all(map(math.isfinite, numbers))

    def merged(self, other: Command) -> Command:
        """Both together; where both drive one actuator, `other`'s word counts."""
        merged = self if other.drive is None else replace(self, drive=other.drive)
        merged = merged if other.head is None else replace(merged, head=other.head)
        return merged if other.flippers is None else replace(merged, flippers=other.flippers)


STOP = Command(drive=Drive(0.0, 0.0))
"""The safe command: stand still, leave the head where it is."""

ACTUATORS = ("drive", "head", "flippers")


# --- what a robot can do --------------------------------------------------------------------------

Channels = Mapping[str, object]
"""Output channel -> value: this tick's in the channels before, last tick's in the others; an unset channel is None."""


@dataclass(frozen=True, slots=True)
class Report:
    """What a competence says of its step, for estimators, recordings and people.

    status: "running", "done" or "failed". details: plain JSON values (numbers, strings, lists, dicts).
    """

    status: str = "running"
    details: Mapping[str, object] = field(default_factory=dict)


class Competence(Protocol):
    """A way of driving the robot. It forgets everything between stop and start."""

    def start(self, reading: Reading, channels: Channels) -> None:
        """Begin; called before the first step after a stop."""
        ...

    def step(self, reading: Reading, channels: Channels) -> tuple[Command, Report]:
        """One tick of it."""
        ...

    def stop(self) -> None:
        """It has lost its turn."""
        ...


class Estimator(Protocol):
    """What lasts: it takes every reading, whoever drives."""

    def update(self, reading: Reading, reports: Mapping[str, Report], channels: Channels) -> None:
        """Take the new reading and, by competence name, the reports of the last tick; channels are last tick's."""
        ...


# --- what a library of behaviours offers to plans ---------------------------------------------------


@dataclass(frozen=True, slots=True)
class Parameter:
    """A parameter of a library.

    type: "number", "bool" or "symbol"; unit: SI unit of a number ("m", "s", "rad", "m/s", "" …).
    """

    name: str
    type: str
    unit: str
    default: float | bool | str
    doc: str


@dataclass(frozen=True, slots=True)
class Function:
    """A word that a library gives to plans.

    type: "bool", "number", "pose" or "command"; unit: SI unit of a number. actuators: what a command drives;
    reads: the output channels whose value it takes.
    """

    name: str
    type: str
    doc: str
    unit: str = ""
    actuators: tuple[str, ...] = ()
    reads: tuple[str, ...] = ()


View = Mapping[str, object]
"""Something that people may look at, as plain JSON values; `kind` says what it is, `frame` in which frame it lies.

Frames: "robot"; "odom", which lies where the robot started, x ahead; "map", which lies there too, its axes those of the
world. Kinds, lengths in metres and angles in radians:

- `pose`: `at` [x, y, theta], what is believed; a picture of a run joins those of all ticks to a path;
- `points`: `at` [[x, y], …]; `lines`: `at` [[x, y, x, y], …]; `heading`: `at`, a direction from the robot;
- `sectors`: `open`, a text of 0 and 1 of equal sectors, the first from bearing `first` on, counter-clockwise;
- `grid`: a patch of a map: `cell`, corner `x`, `y`, `columns`, `rows`, `data`: base64 of zlib of one byte a cell, rows
  upwards, 0 … 100 the probability [%] that it is occupied, 255 unknown, 254 as before.
"""


@dataclass(frozen=True, slots=True)
class Offer:
    """A library brought to life for one robot: callables by function name.

    percepts are sampled once a tick after the estimators; values are evaluated when a channel is filled. views: by
    name, asked once a tick after all competences; None where there is nothing new to see.
    """

    percepts: Mapping[str, Callable[[], bool | float]] = field(default_factory=dict)
    values: Mapping[str, Callable[[Channels], object]] = field(default_factory=dict)
    competences: Mapping[str, Competence] = field(default_factory=dict)
    views: Mapping[str, Callable[[], View | None]] = field(default_factory=dict)


Shared = TypeVar("Shared", bound=Estimator)


class Workshop:
    """Where libraries of one robot meet: estimators that several of them need are made once.

    Estimators are updated in the order in which they were first asked for, so one that reads another asks for
    that one first.
    """

    def __init__(self) -> None:
        self._made: dict[type[Estimator], Estimator] = {}

    def share(self, kind: type[Shared], make: Callable[[], Shared]) -> Shared:
        """The one estimator of this kind; made by `make` when it is asked for first."""
        if kind not in self._made:
            self._made[kind] = make()
        made = self._made[kind]
        assert isinstance(made, kind)
        return made

    @property
    def estimators(self) -> tuple[Estimator, ...]:
        """All of them, in the order of their updates."""
        return tuple(self._made.values())


Values = Mapping[str, float | bool | str]


@dataclass(frozen=True, slots=True)
class Library:
    """A named set of behaviours: the words it offers, its parameters, and how it comes to life.

    works_unasked: a plan may use it for what it does of itself, and ask none of its words.
    """

    name: str
    doc: str
    functions: tuple[Function, ...]
    parameters: tuple[Parameter, ...]
    build: Callable[[Values, Workshop], Offer]
    works_unasked: bool = False
