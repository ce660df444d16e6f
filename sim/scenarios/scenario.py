"""Scenarios: a world, a robot, a task and what shall happen, as frozen values.

Takes: nothing. Gives: `Scenario` and its parts; `load` and `loads` read it from YAML (`format.py` says how).
Leaves alone: what the seed decides (`layout.py`) and the stepping of it.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from behaviours.interface import Pose, Vec2
from sim.raycast import Circle, Outline
from sim.robots.battery import BatteryBuild
from sim.robots.build import Build
from sim.sensors.build import Fault, Installed
from sim.sensors.weather import Weather
from sim.things.ground import Ground
from sim.things.thing import Motion, Shift

Box = tuple[float, float, float, float]


@dataclass(frozen=True, slots=True)
class Between:
    """A number that the seed draws, evenly between two."""

    low: float
    high: float

    def __post_init__(self) -> None:
        if self.low > self.high:
            raise ValueError("the first of the two numbers must not be the greater")


Amount = float | Between
Spot = tuple[Amount, Amount]
"""A place [m] either number of which the seed may draw."""


@dataclass(frozen=True, slots=True)
class RobotSpec:
    """start [m]; heading [rad, world]; sensors: names differ; battery: None for one that never ends."""

    start: Spot
    heading: Amount = 0.0
    build: Build = field(default_factory=Build)
    sensors: tuple[Installed, ...] = ()
    battery: BatteryBuild | None = None


@dataclass(frozen=True, slots=True)
class DonorSpec:
    """at [m]; reach [m] of its arm, hull to hull; hand_over [s]; move: it goes elsewhere once; trips: its objects."""

    at: Vec2
    radius: float = 0.25
    height: float = 0.9
    reach: float = 0.92
    hand_over: float = 15.0
    move: Shift | None = None
    trips: int = 1
    id: str = "donor"


@dataclass(frozen=True, slots=True)
class Goal:
    """A place [m] to be reached within so much [m]; no_contact: the first touch fails the run."""

    at: Vec2
    within: float = 1.0
    no_contact: bool = False


@dataclass(frozen=True, slots=True)
class Round:
    """Going round a place [m] so many times, either way, and back within so much [m] of the start.

    no_contact: the first touch fails the run; curbs are there to be climbed and do not count.
    """

    about: Vec2
    turns: int = 1
    within: float = 3.0
    no_contact: bool = False


@dataclass(frozen=True, slots=True)
class ThingSpec:
    """A thing; present: the chance that it is there; id: empty for its kind and a number.

    charges [m]: the gap between the hulls at which it charges a robot that stands; 0 for what is no charger.
    """

    kind: str
    outline: Outline
    height: float
    at: Spot
    heading: Amount = 0.0
    mass: float = 0.0
    motion: Motion | None = None
    present: float = 1.0
    id: str = ""
    charges: float = 0.0


Place = Vec2 | str


@dataclass(frozen=True, slots=True)
class KeepClear:
    """The straight strip between two places (points, "robot" or "donor") and `by` [m] to either side."""

    start: Place
    end: Place
    by: float


@dataclass(frozen=True, slots=True)
class Scatter:
    """Things that the seed puts somewhere: kinds to choose from, how many, region [m], least gap [m] between hulls."""

    kinds: tuple[str, ...]
    count: tuple[int, int]
    region: Box
    min_gap: float = 0.0
    keep_clear: tuple[KeepClear, ...] = ()


# --- what happens at set times ----------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Vanish:
    """The thing is taken out of the world."""

    thing: str


@dataclass(frozen=True, slots=True)
class Put:
    """The thing is put at a pose [m, rad]; one that had vanished is back."""

    thing: str
    pose: Pose


@dataclass(frozen=True, slots=True)
class Change:
    """Sun and wind are so from now on."""

    weather: Weather


@dataclass(frozen=True, slots=True)
class Jam:
    """The head gets stuck: 1 lightly, 2 badly, 3 so that only a person helps; 0: a person frees it."""

    how: int


@dataclass(frozen=True, slots=True)
class Event:
    """What happens at a moment [s]."""

    time: float
    what: Vanish | Put | Change | Jam


@dataclass(frozen=True, slots=True)
class Scenario:
    """A world to do a task in: fetch from the donors, reach the goal, or go round; with none it lasts until its limit.

    bounds [m]: xmin, ymin, xmax, ymax of what is shown; time_limit [s]. source: where it was imported from; left_out:
    what the import could not keep, in words. unload [s] of standing at home until an object is taken off; None: a
    second until it counts as brought, and the last one stays on board.
    """

    name: str
    bounds: Box
    robot: RobotSpec
    donors: tuple[DonorSpec, ...] = ()
    goal: Goal | None = None
    round: Round | None = None
    things: tuple[ThingSpec, ...] = ()
    scatter: tuple[Scatter, ...] = ()
    weather: Weather = field(default_factory=Weather)
    ground: Ground = field(default_factory=Ground)
    events: tuple[Event, ...] = ()
    faults: tuple[Fault, ...] = ()
    time_limit: float = 1800.0
    unload: float | None = None
    source: str = ""
    left_out: tuple[str, ...] = ()

    @property
    def donor(self) -> DonorSpec | None:
        """The first of the donors."""
        return self.donors[0] if self.donors else None


CAR_SIZE = (4.4, 1.8)
CAR_HEIGHT = 1.4
SCATTERED = {
    "trashcan": ThingSpec("trashcan", Circle(0.3), 0.9, (0.0, 0.0), mass=8.0),
    "post": ThingSpec("post", Circle(0.15), 1.0, (0.0, 0.0)),
    "person": ThingSpec("person", Circle(0.25), 1.75, (0.0, 0.0)),
}
"""What may be scattered, as it is without any wish; persons that are scattered stand."""
