"""The world: the pymunk space, everything in it, and the only stepping code.

Takes: a scenario, a seed and, tick by tick, a `Command`. Gives: a `Reading` of what the robot senses, and the truth for
those who judge, record and draw. Leaves alone: who decides, and when a run is over.

A tick is 0.1 s, five sub-steps of 0.02 s. There is no gravity: the plane is seen from above, and what is pushed is
slowed down by the damping of the space. Everything happens in a fixed order and chance comes from the seed alone, so
the same scenario and seed give the same run. A world is never saved in mid-run; it is made again.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import pymunk

from behaviours.interface import Command, Drive, Reading
from sim.noise import chance
from sim.raycast import Scene
from sim.robots.head import PanTilt
from sim.robots.synchro import SynchroDrive
from sim.scenarios.layout import lay_out
from sim.scenarios.scenario import Scenario
from sim.sensors.infrared import InfraredReader
from sim.sensors.odometry import DeadReckoning
from sim.sensors.sonar import Sonar
from sim.sensors.stereo import Stereo
from sim.things.donor import HandOver
from sim.things.roller import Roller
from sim.things.shifter import Shifter
from sim.things.surroundings import Disc, Surroundings
from sim.things.thing import OTHER, ROBOT, Roll, Shift, Thing, Travel
from sim.things.traveller import Traveller

TICKS_PER_SECOND, SUBSTEPS = 10, 5
TICK = 1 / TICKS_PER_SECOND  # [s]
DAMPING = 0.01  # share of its speed that a pushed thing has left after a second
SLOP = 0.0005  # [m] that touching hulls may overlap
ITERATIONS = 20
FAR = 10.0  # [m] beyond which clearance is not looked for
TOUCH_SPEED = 0.01  # [m/s]


@dataclass(frozen=True, slots=True)
class Touch:
    """Hulls meet: which thing, when [s].

    driven_into: the robot moved into the thing (faster than 1 cm/s, and faster than the thing into it); otherwise
    the thing struck the robot.
    """

    thing: str
    time: float
    driven_into: bool


Mover = Traveller | Roller | Shifter


class World:
    """One world in motion: `sense` once a tick (asked again it gives the same Reading), then `step`."""

    def __init__(self, scenario: Scenario, seed: int) -> None:
        self.scenario, self.seed, self.tick = scenario, seed, 0
        sources = chance(seed)
        layout = lay_out(scenario, sources.layout)
        self.start = layout.start
        self._space = _space()
        self.things = tuple(Thing(index, placed, self._space) for index, placed in enumerate(layout.things))
        self.donor = self.things[0]
        self.robot = SynchroDrive(self._space, layout.start, scenario.robot.build)
        self.head = PanTilt()
        self.hand_over = HandOver(scenario.donor.reach, scenario.donor.hand_over)
        self._by_shape = {thing.shape: thing for thing in self.things}
        self._moving = tuple(thing for thing in self.things if thing.placed.moves)
        self._movers = tuple(mover for thing in self.things for mover in _movers(thing))
        placed = [thing.placed for thing in self.things]
        self._scene = Scene([p.outline for p in placed], [p.pose for p in placed], [p.height for p in placed])
        self._scene_tick = -1
        spec = scenario.robot
        self._sonar = Sonar(spec.sonar, spec.build.radius, sources.sonar)
        self._infrared = InfraredReader(spec.infrared, scenario.weather, sources.infrared)
        self._stereo = Stereo(spec.stereo, sources.stereo)
        self._odometry = DeadReckoning(spec.odometry, layout.start, sources.odometry)
        self._base_still_for = 0.0
        self._touching: dict[int, Touch] = {}
        self._last_touch: dict[int, Touch] = {}
        self.touches: tuple[Touch, ...] = ()
        self.begun: tuple[Touch, ...] = ()
        self._reading: Reading | None = None
        self._space.on_collision(ROBOT, OTHER, begin=self._begin, pre_solve=self._touch)

    # --- the loop ---------------------------------------------------------------------------------

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self.tick / TICKS_PER_SECOND

    def sense(self) -> Reading:
        """What the robot senses now."""
        if self._reading is None:
            self._reading = self._sensed()
        return self._reading

    def step(self, command: Command) -> None:
        """One tick with this command. Raises ValueError where a number in it is not finite."""
        if not command.is_finite():
            raise ValueError(f"a command must be finite, got {command}")
        self._obey(command)
        self._prepare()
        self.begun, self._touching = (), {}
        for _ in range(SUBSTEPS):
            self._space.step(TICK / SUBSTEPS)
        self.tick += 1
        self._settle()

    def _obey(self, command: Command) -> None:
        self.robot.command(command.drive or Drive(0.0, 0.0))
        if command.head is not None:
            self.head.command(command.head)

    def _prepare(self) -> None:
        if self._movers:
            around = self._surroundings()
            for mover in self._movers:
                mover.prepare(around)

    def _settle(self) -> None:
        self.robot.read()
        self.head.move(TICK)
        self._odometry.update(self.robot.pose, TICK)
        still = self.robot.standing and abs(self.robot.turn_rate) < 0.01
        self._base_still_for = self._base_still_for + TICK if still else 0.0
        self.hand_over.update(self.donor_gap, self.robot.standing, TICK)
        self.touches = tuple(self._touching.values())
        self._reading = None

    def _surroundings(self) -> Surroundings:
        pose, radius = self.robot.pose, self.robot.build.radius
        way = math.hypot(pose.x - self.start.x, pose.y - self.start.y)
        others = tuple(Disc(t.index, *t.body.position, t.reach) for t in self._moving if t.present)
        return Surroundings(self.time, TICK, Disc(-1, pose.x, pose.y, radius), way, others)

    # --- sensing ----------------------------------------------------------------------------------

    def _sensed(self) -> Reading:
        stamp, pose, scene, head = self.time, self.robot.pose, self.scene(), self.head.state
        still_for = self.head.still_for
        beacon = self.donor.body.position
        waist, skirt = self._sonar.sense(self.tick, stamp, pose, scene)
        heard = self._infrared.sense(stamp, head, still_for, pose, (beacon.x, beacon.y), self.donor.index, scene)
        verged = self._stereo.sense(stamp, head, min(still_for, self._base_still_for), pose, scene)
        return Reading(
            stamp, self.tick, self._odometry.reading, waist, skirt, head, heard, verged, self.hand_over.on_board
        )

    def scene(self) -> Scene:
        """The outlines of all things where they are now."""
        if self._scene_tick != self.tick:
            for thing in self._moving:
                self._scene.place(thing.index, thing.pose)
            self._scene_tick = self.tick
        return self._scene

    # --- the truth --------------------------------------------------------------------------------

    @property
    def donor_gap(self) -> float:
        """Distance [m] between the hulls of robot and donor."""
        x, y = self.donor.body.position
        return math.hypot(x - self.robot.pose.x, y - self.robot.pose.y) - self.robot.build.radius - self.donor.reach

    @property
    def home_distance(self) -> float:
        """Distance [m] of the robot from where it started, centre to centre."""
        return math.hypot(self.robot.pose.x - self.start.x, self.robot.pose.y - self.start.y)

    def clearance(self) -> float:
        """Distance [m] from the hull to the nearest thing, at most `FAR`; negative where they overlap."""
        robot = self.robot
        found = self._space.point_query_nearest((robot.pose.x, robot.pose.y), FAR, robot.shape.filter)
        return FAR if found is None else min(FAR, found.distance - robot.build.radius)

    # --- contacts ---------------------------------------------------------------------------------

    def _begin(self, arbiter: pymunk.Arbiter, _space: pymunk.Space, _data: object) -> None:
        thing, normal = self._by_shape[arbiter.shapes[1]], arbiter.normal
        towards = self.robot.body.velocity.dot(normal)
        against = -thing.body.velocity.dot(normal)
        touch = Touch(thing.placed.id, self.time, towards > max(TOUCH_SPEED, against))
        self._last_touch[thing.index] = touch
        self.begun += (touch,)

    def _touch(self, arbiter: pymunk.Arbiter, _space: pymunk.Space, _data: object) -> None:
        """Each sub-step while hulls touch; `separate` would be called from the deallocation of the space as well."""
        index = self._by_shape[arbiter.shapes[1]].index
        self._touching[index] = self._last_touch[index]


def _space() -> pymunk.Space:
    space = pymunk.Space()
    space.damping, space.iterations, space.collision_slop = DAMPING, ITERATIONS, SLOP
    return space


def _movers(thing: Thing) -> tuple[Mover, ...]:
    match thing.placed.motion:
        case Travel() as travel:
            return (Traveller(thing, travel),)
        case Roll() as roll:
            return (Roller(thing, roll),)
        case Shift() as shift:
            return (Shifter(thing, shift),)
        case None:
            return ()
