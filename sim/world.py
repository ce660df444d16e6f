"""The world: the pymunk space, everything in it, and the only stepping code.

Takes: a scenario, a seed and, tick by tick, a `Command`. Gives: a `Reading` of what the robot senses, and the truth for
those who judge, record and draw. Leaves alone: who decides, and when a run is over.

A tick is `period` long, in sub-steps of `SUBSTEP` at most. There is no gravity: the plane is seen from above, and what
is pushed is slowed down by the damping of the space. Everything happens in a fixed order and chance comes from the seed
alone, so the same scenario and seed give the same run. A world is never saved in mid-run; it is made again.

Where nothing can touch anything within the tick, bodies glide: each moves as the sub-steps of the space would move it,
but without the space. Whether that is so follows from the state alone: how far the robot is from everything
(`_room`), what moves, and how fast.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import pymunk

from behaviours.interface import Command, Currents, Drive, FlipperState, Pose, Reading, Vec2, wrap
from sim.frames import bearing
from sim.noise import chance, named_chance
from sim.raycast import Circle, Polygon, Scene
from sim.robots.battery import Cells
from sim.robots.build import SkidSteer
from sim.robots.head import BAD, LIGHT, PanTilt
from sim.robots.robot import Robot
from sim.scenarios.layout import lay_out
from sim.scenarios.scenario import Change, Event, Jam, Put, Scenario, Vanish
from sim.sensors.build import Installed, StereoBuild
from sim.sensors.suite import Suite
from sim.sensors.truth import Beacon, Truth
from sim.things.donor import Errand, HandOver
from sim.things.keyframed import Keyframed
from sim.things.roller import Roller
from sim.things.shifter import Shifter
from sim.things.surroundings import Disc, Surroundings
from sim.things.thing import OTHER, ROBOT, Keyframes, Roll, Shift, Thing, Travel
from sim.things.traveller import Traveller

PERIOD = 0.1  # [s] of a tick, unless a plan asks for another
SHORTEST, LONGEST = 0.001, 1.0  # [s] that a tick may take
SUBSTEP = 0.02  # [s] at most
DAMPING = 0.01  # share of its speed that a pushed thing has left after a second
SLOP = 0.0005  # [m] that touching hulls may overlap
ITERATIONS = 20
FAR = 10.0  # [m] beyond which clearance is not looked for
TOUCH_SPEED = 0.01  # [m/s]
STEEP = math.radians(30)  # a head that looks down by more may jam
UNLOAD = 1.0  # [s] of standing at home until an object counts as brought
MARGIN = 0.02  # [m] that must be left for bodies to glide
AT_REST = 1e-3  # [m/s, rad/s] below which a pushed thing lies still
OUTLINE_STEP = 0.02  # [m] between the places of a hull that is not round from which clearance is measured


@dataclass(frozen=True, slots=True)
class Touch:
    """Hulls meet: which thing, when [s].

    driven_into: the robot moved into the thing (faster than 1 cm/s, and faster than the thing into it); otherwise
    the thing struck the robot.
    """

    thing: str
    time: float
    driven_into: bool


Mover = Traveller | Roller | Shifter | Keyframed


class World:
    """One world in motion: `sense` once a tick (asked again it gives the same Reading), then `step`.

    period [s]: the length of a tick.
    """

    def __init__(self, scenario: Scenario, seed: int, period: float = PERIOD) -> None:
        self.scenario, self.seed, self.period, self.tick = scenario, seed, period, 0
        layout = lay_out(scenario, chance(seed).layout)
        self.start = layout.start
        self._substeps = max(1, math.ceil(period / SUBSTEP - 1e-9))
        self._space = _space()
        self.things = tuple(Thing(index, placed, self._space) for index, placed in enumerate(layout.things))
        self.robot = Robot(self._space, layout.start, scenario.robot.build, scenario.ground)
        self.head = PanTilt()
        self.donors = self.things[: len(scenario.donors)]
        gives = [HandOver(spec.reach, spec.hand_over, spec.trips) for spec in scenario.donors]
        self.errand = Errand(gives, UNLOAD if scenario.unload is None else scenario.unload, scenario.unload is not None)
        self.battery = None if scenario.robot.battery is None else Cells(scenario.robot.battery)
        self._chargers = tuple(thing for thing in self.things if thing.placed.charges > 0)
        self._jams = _Jams(scenario.robot.sensors, seed)
        self._things = _Moving(self.things)
        self._events = sorted(scenario.events, key=lambda event: event.time)
        self._scene = _scene(self.things)
        self._scene_tick = 0
        self._hull = _outline_points(self.robot)
        self._room = 0.0  # [m] that the robot's hull is certainly away from everything
        self._contacts = _Contacts(self)
        self._truth = self._first_truth()
        self._suite = Suite(scenario.robot.sensors, scenario.faults, scenario.robot.build, layout.start, seed)
        self._reading: Reading | None = None

    # --- the loop ---------------------------------------------------------------------------------

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return _time(self.tick, self.period)

    def sense(self) -> Reading:
        """What the robot senses now."""
        if self._reading is None:
            self._reading = self._suite.sense(self._truth, self.errand.on_board)
            self._jams.after(self._reading, self.head)
        return self._reading

    def step(self, command: Command) -> None:
        """One tick with this command. Raises ValueError where a number in it is not finite."""
        if not command.is_finite():
            raise ValueError(f"a command must be finite, got {command}")
        self.sense()  # whether or not anybody asked: sensors measure when they are due
        flat = self.battery is not None and self.battery.empty
        self.robot.command(replace(command, drive=None) if flat else command)
        if command.head is not None:
            self.head.command(command.head)
        self._prepare()
        self._contacts.clear()
        if self._is_free():
            self._glide()
        else:
            self._step_space()
        self.tick += 1
        self._settle()

    def _prepare(self) -> None:
        while self._events and self._events[0].time <= self.time + 1e-9:
            self._happen(self._events.pop(0))
        if self._things.movers:
            around = self._surroundings()
            for mover in self._things.movers:
                mover.prepare(around)

    def _happen(self, event: Event) -> None:
        match event.what:
            case Vanish(name):
                self._named(name).remove()
            case Put(name, pose):
                self._named(name).put(pose.x, pose.y, pose.theta)
            case Change(weather):
                self._truth.weather = weather
            case Jam(0):
                self.head.free()
            case Jam(how):
                self.head.stick(how)
        self._room, self._scene_tick = 0.0, -1

    def _named(self, name: str) -> Thing:
        return next(thing for thing in self.things if thing.placed.id == name)

    def _surroundings(self) -> Surroundings:
        pose, radius = self.robot.pose, self.robot.build.radius
        way = math.hypot(pose.x - self.start.x, pose.y - self.start.y)
        return Surroundings(self.time, self.period, Disc(-1, pose.x, pose.y, radius), way, self._things.discs)

    # --- motion -----------------------------------------------------------------------------------

    def _is_free(self) -> bool:
        """Whether nothing can touch anything within the tick."""
        if self._things.stir():
            return False
        most = max(abs(self.robot.speed), self.robot.build.max_speed)
        need = most * (self.period + self.period / self._substeps) + self._things.fastest() * self.period + MARGIN
        if self._room < need:
            self._room = self._distance_around()
        return self._room >= need and not self._things.near_pushable(self.period)

    def _distance_around(self) -> float:
        """Distance [m] from the circle round the hull to the nearest thing, at most `FAR`."""
        robot = self.robot
        self._things.tell()
        found = self._space.point_query_nearest((robot.pose.x, robot.pose.y), FAR, robot.shapes[0].filter)
        return FAR - robot.build.radius if found is None else found.distance - robot.build.radius

    def _glide(self) -> None:
        dt = self.period / self._substeps
        for _ in range(self._substeps):
            self.robot.glide(dt)
        self._things.glide(self.period)

    def _step_space(self) -> None:
        self.robot.tell()
        self._things.tell()
        for _ in range(self._substeps):
            self._space.step(self.period / self._substeps)
        self._things.ask()
        self._room = 0.0

    def _settle(self) -> None:
        robot, before = self.robot, self.robot.pose
        robot.settle(self.period, self._contacts.climbing)
        self.head.move(self.period)
        moved = math.hypot(robot.pose.x - before.x, robot.pose.y - before.y)
        self._room -= moved + self._things.fastest() * self.period
        if self.battery is not None:
            self.battery.update(robot.standing, self._at_charger(), self.period)
        self._update_truth()
        if self.donors:
            self.errand.update(self.time, self.donor_gaps, robot.standing, self.home_distance, self.period)
        self._suite.update(self._truth)
        self._reading = None

    # --- what is so -------------------------------------------------------------------------------

    def _first_truth(self) -> Truth:
        robot, weather, ground = self.robot, self.scenario.weather, self.scenario.ground
        still = Currents(0.0, True, 0.0, 0.0)
        return Truth(
            tick=0,
            time=0.0,
            dt=self.period,
            pose=robot.pose,
            speed=0.0,
            turn_rate=0.0,
            acceleration=(0.0, 0.0),
            wheels=Drive(0.0, 0.0),
            aside=0.0,
            still_for=0.0,
            head=self.head.state,
            head_still_for=0.0,
            load=still,
            flippers=FlipperState(0.0, False),
            touched=(),
            beacons=self._beacons(),
            battery=self._battery(),
            weather=weather,
            ground=ground,
            scene=self.scene,
        )

    def _update_truth(self) -> None:
        truth, robot = self._truth, self.robot
        truth.tick, truth.time = self.tick, self.time
        truth.pose, truth.speed, truth.turn_rate = robot.pose, robot.speed, robot.turn_rate
        truth.acceleration, truth.wheels, truth.aside = robot.acceleration, robot.wheels, robot.aside
        truth.load, truth.flippers = robot.load, robot.flippers
        still = robot.standing and abs(robot.turn_rate) < 0.01
        truth.still_for = truth.still_for + self.period if still else 0.0
        truth.head, truth.head_still_for = self.head.state, self.head.still_for
        truth.touched = self._contacts.bearings
        if self.donors:
            truth.beacons = self._beacons()
        if self.battery is not None:
            truth.battery = self._battery()

    def _beacons(self) -> tuple[Beacon, ...]:
        return tuple(Beacon(thing.placed.id, (thing.x, thing.y), thing.index) for thing in self.donors)

    def _battery(self) -> tuple[float, bool] | None:
        return None if self.battery is None else (self.battery.level, self.battery.charging)

    def _at_charger(self) -> bool:
        return any(self._gap(thing) <= thing.placed.charges for thing in self._chargers)

    def scene(self) -> Scene:
        """The outlines of all things where they are now."""
        if self._scene_tick != self.tick:
            for thing in self._things.mobile:
                self._scene.place(thing.index, thing.pose)
            self._scene_tick = self.tick
        return self._scene

    # --- the truth --------------------------------------------------------------------------------

    @property
    def touches(self) -> tuple[Touch, ...]:
        """What touches the robot at the end of the tick or did within it."""
        return self._contacts.touches

    @property
    def begun(self) -> tuple[Touch, ...]:
        """Contacts that began in the last tick."""
        return self._contacts.begun

    def can_climb(self, thing: Thing) -> bool:
        """Whether it is a curb that the robot's drive climbs, with flippers if need be: ground, and no obstacle."""
        drive = self.robot.build.drive
        is_low = isinstance(drive, SkidSteer) and thing.placed.height <= drive.climbs_deployed
        return thing.placed.kind == "curb" and is_low

    @property
    def donor_gaps(self) -> list[float]:
        """Distances [m] between the hulls of the robot and of each donor."""
        return [self._gap(thing) for thing in self.donors]

    def _gap(self, thing: Thing) -> float:
        pose = self.robot.pose
        return math.hypot(thing.x - pose.x, thing.y - pose.y) - self.robot.build.radius - thing.reach

    @property
    def home_distance(self) -> float:
        """Distance [m] of the robot from where it started, centre to centre."""
        return math.hypot(self.robot.pose.x - self.start.x, self.robot.pose.y - self.start.y)

    def clearance(self, below: float = math.inf) -> float:
        """Distance [m] from the hull to the nearest thing, at most `FAR`; negative where they overlap.

        For a hull that is not round, to a centimetre. below [m]: where it is certainly more, `below` may be given.
        """
        if self._room >= below:
            return below
        self._room = self._distance_around()
        if self._hull is None or self._room > below:
            return min(FAR, self._room)
        return self._clearance_of_points(self._hull)

    def _clearance_of_points(self, hull: Sequence[Vec2]) -> float:
        """A place is no nearer to things than the last one less the way between them, so most are passed over."""
        robot = self.robot
        reach = self._room + 2 * robot.build.radius
        robot.tell()
        shapes = robot.shapes[0].filter

        def gap(point: Vec2) -> float:
            found = self._space.point_query_nearest(robot.body.local_to_world(point), reach, shapes)
            return reach if found is None else found.distance

        least, at = min([FAR, *(gap(point) for point in hull[:: len(hull) // 8 or 1])]), 0
        while at < len(hull):
            here = gap(hull[at])
            least = min(least, here)
            at += max(1, math.floor((here - least) / OUTLINE_STEP))
        return least


class _Jams:
    """Fixations that jam the head, by chance."""

    def __init__(self, sensors: tuple[Installed, ...], seed: int) -> None:
        self._chance_of = max([s.build.stuck for s in sensors if isinstance(s.build, StereoBuild)], default=0.0)
        self._chance = named_chance(seed, "jams")

    def after(self, reading: Reading, head: PanTilt) -> None:
        """A fixation has been made, perhaps."""
        stereo = reading.stereo
        steep = stereo is not None and stereo.fresh and stereo.tilt > STEEP
        if self._chance_of and steep and self._chance.random() < self._chance_of:
            head.stick(int(self._chance.choice((LIGHT, BAD), p=(0.7, 0.3))))


class _Contacts:
    """What touches the robot; curbs that it climbs do not count."""

    def __init__(self, world: World) -> None:
        self._world = world
        self._by_shape = {shape: thing for thing in world.things for shape in thing.shapes}
        self._touching: dict[int, Touch] = {}
        self._last: dict[int, Touch] = {}
        self._bearings: dict[int, list[float]] = {}
        self.begun: tuple[Touch, ...] = ()
        self.climbing = False
        world._space.on_collision(ROBOT, OTHER, begin=self._begin, pre_solve=self._touch)

    def clear(self) -> None:
        """Before a tick."""
        if self._touching or self.begun or self.climbing:
            self.begun, self._touching, self._bearings, self.climbing = (), {}, {}, False

    @property
    def touches(self) -> tuple[Touch, ...]:
        """In the order in which they were found."""
        return tuple(self._touching.values())

    @property
    def bearings(self) -> tuple[float, ...]:
        """Of the contacts [rad, robot frame]."""
        return tuple(bearing for bearings in self._bearings.values() for bearing in bearings)

    def _begin(self, arbiter: pymunk.Arbiter, _space: pymunk.Space, _data: object) -> None:
        thing, normal = self._by_shape[arbiter.shapes[1]], arbiter.normal
        if self._is_climbed(thing):
            return
        towards = normal.dot(self._world.robot.asked)
        against = -thing.body.velocity.dot(normal)
        touch = Touch(thing.placed.id, self._world.time, towards > max(TOUCH_SPEED, against))
        self._last[thing.index] = touch
        self.begun += (touch,)

    def _touch(self, arbiter: pymunk.Arbiter, _space: pymunk.Space, _data: object) -> None:
        """Each sub-step while hulls touch; `separate` would be called from the deallocation of the space as well."""
        thing = self._by_shape[arbiter.shapes[1]]
        if self._is_climbed(thing):
            arbiter.process_collision = False
            self.climbing = True
            return
        if thing.index not in self._last:
            self._begin(arbiter, _space, _data)
        self._touching[thing.index] = self._last[thing.index]
        body = self._world.robot.body
        here = Pose(body.position.x, body.position.y, wrap(body.angle))
        self._bearings[thing.index] = [bearing(here, place) for place in _places(arbiter)]

    def _is_climbed(self, thing: Thing) -> bool:
        return thing.placed.height <= self._world.robot.climbs()


class _Moving:
    """The things that are ever elsewhere, and what moves them."""

    def __init__(self, things: tuple[Thing, ...]) -> None:
        self.mobile = tuple(thing for thing in things if thing.placed.moves)
        self.movers = tuple(mover for thing in things for mover in _movers(thing))
        self._rollers = tuple(mover for mover in self.movers if isinstance(mover, Roller))
        self._pushable = tuple(thing for thing in self.mobile if thing.placed.mass > 0)
        self._driven = tuple(thing for thing in self.mobile if thing.placed.mass == 0)

    def discs(self) -> tuple[Disc, ...]:
        """All that can move, as discs."""
        return tuple(Disc(t.index, t.x, t.y, t.reach) for t in self.mobile if t.present)

    def stir(self) -> bool:
        """Whether anything that can be pushed moves, or is about to."""
        return any(roller.rolling for roller in self._rollers) or any(
            thing.speed > AT_REST or abs(thing.turn) > AT_REST for thing in self._pushable
        )

    def fastest(self) -> float:
        """Speed [m/s] of the fastest driven thing."""
        return max([thing.speed for thing in self._driven], default=0.0)

    def near_pushable(self, period: float) -> bool:
        """Whether a driven thing may touch one that can be pushed within a tick."""
        if not self._pushable:
            return False
        return any(self._nears(thing, period) for thing in self._driven if thing.present and thing.speed > 0)

    def _nears(self, thing: Thing, period: float) -> bool:
        need = thing.speed * period + MARGIN + thing.reach
        return any(math.hypot(thing.x - other.x, thing.y - other.y) < need + other.reach for other in self._pushable)

    def glide(self, period: float) -> None:
        """Driven things move on."""
        for thing in self._driven:
            if thing.vx or thing.vy or thing.turn:
                thing.glide(period)

    def tell(self) -> None:
        """The bodies what is so."""
        for thing in self.mobile:
            thing.tell()

    def ask(self) -> None:
        """The bodies what is so."""
        for thing in self.mobile:
            thing.ask()


def _time(tick: int, period: float) -> float:
    """Without the rounding of a running sum: ticks of 0.1 s give whole tenths."""
    rate = round(1 / period)
    return tick / rate if rate * period == 1.0 else tick * period


def _space() -> pymunk.Space:
    space = pymunk.Space()
    space.damping, space.iterations, space.collision_slop = DAMPING, ITERATIONS, SLOP
    return space


def _scene(things: tuple[Thing, ...]) -> Scene:
    placed = [thing.placed for thing in things]
    scene = Scene([p.outline for p in placed], [p.pose for p in placed], [p.height for p in placed])
    for thing in things:
        if thing.placed.moves:
            scene.place(thing.index, thing.pose)
    return scene


def _outline_points(robot: Robot) -> tuple[Vec2, ...] | None:
    """Places on the hull, `OUTLINE_STEP` apart; None for a round one."""
    match robot.build.hull:
        case Polygon(vertices):
            points = []
            for a, b in zip(vertices, (*vertices[1:], vertices[0]), strict=True):
                steps = math.ceil(math.dist(a, b) / OUTLINE_STEP)
                points += [(a[0] + (b[0] - a[0]) * k / steps, a[1] + (b[1] - a[1]) * k / steps) for k in range(steps)]
            return tuple(points)
        case Circle() | _:
            return None


def _places(arbiter: pymunk.Arbiter) -> list[Vec2]:
    """Where hulls meet: the points of contact and, where they meet along a side, its middle."""
    places = [(point.point_a.x, point.point_a.y) for point in arbiter.contact_point_set.points]
    if len(places) > 1:
        (ax, ay), (bx, by) = places[0], places[-1]
        places.append(((ax + bx) / 2, (ay + by) / 2))
    return places


def _movers(thing: Thing) -> tuple[Mover, ...]:
    match thing.placed.motion:
        case Travel() as travel:
            return (Traveller(thing, travel),)
        case Roll() as roll:
            return (Roller(thing, roll),)
        case Shift() as shift:
            return (Shifter(thing, shift),)
        case Keyframes() as keyframes:
            return (Keyframed(thing, keyframes),)
        case None:
            return ()
