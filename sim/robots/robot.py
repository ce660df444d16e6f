"""The robot in the space: a hull with a drive under it.

Takes: commands, and the steps of the space or `glide`. Gives: the motion of its body, and the truth about it at the end
of each tick. Leaves alone: what stops it, what it senses, and when to glide (the world knows what is near).

Drive and hull meet obstacles through `velocity_func`, where the contact solver still corrects the velocity; a velocity
that is set before the step pushes the hull into walls. Round hulls do not turn on contact; the others do. Chipmunk
knows of no contact before hulls overlap, so a hull that would go deeper than a few millimetres into a thing within
the next sub-step first comes up to it (`_look_ahead`). Each sub-step drives along the chord of its arc.
"""

from __future__ import annotations

import math

import pymunk

from behaviours.interface import Command, Currents, Drive, Pose, Vec2, wrap
from sim.raycast import Circle, Polygon, Rings
from sim.robots.build import Build, Differential, SkidSteer
from sim.robots.drives import REST, Twist, aside, hull, ramped, reachable, unwound, wheels
from sim.robots.load import CLIMBING, PUSHING, Flippers, currents, lost
from sim.things.ground import Ground
from sim.things.thing import FRICTION, ROBOT

SLOW = 0.02  # [m/s] below which it stands
ALWAYS_FINE = 0.0045  # [m] that any hull may go in a sub-step without looking ahead
DEPTH = 0.002  # [m] that it may go into a thing at first touch
SAME = 1e-9


class Robot:
    """A robot in the space; what it says of itself is true, and as of the end of the last tick.

    speed [m/s] along x, turn_rate [rad/s], acceleration [m/s^2, robot frame], wheels: what wheels or tracks made of
    the tick, slip included; aside [m/s]: what they made to the left of it, in the middle of a steered robot; blocked:
    share of the wanted way that contacts took; load and flippers carry no stamp; asked [m/s, world]: the velocity
    before contacts had their say.
    """

    def __init__(self, space: pymunk.Space, start: Pose, build: Build, ground: Ground) -> None:
        self.build, self._space, self._ground = build, space, ground
        self.body = pymunk.Body(build.mass, _moment(build))
        self.body.velocity_func = self._drive
        self._flippers = Flippers()
        self.shapes: tuple[pymunk.Shape, ...] = (self._shape(),)
        space.add(self.body, *self.shapes)
        self._round = build.hull.radius if isinstance(build.hull, Circle) else 0.0
        self._spin = 0.0 if self._round else build.radius
        self._feeler = self._shape()  # not in the space
        self._x = self._y = self._angle = self._vx = self._vy = self._turn = 0.0
        self._mirrored, self._told = False, True
        self.put(start)

    def _shape(self) -> pymunk.Shape:
        match self.build.hull:
            case Circle(radius):
                shape: pymunk.Shape = pymunk.Circle(self.body, radius)
            case Polygon(vertices):
                shape = pymunk.Poly(self.body, vertices)
            case Rings():
                raise ValueError("the hull of a robot is a circle or a convex polygon")
        shape.friction, shape.collision_type, shape.filter = FRICTION, ROBOT, pymunk.ShapeFilter(group=ROBOT)
        return shape

    def put(self, pose: Pose) -> None:
        """To a place, at rest; what it was told is forgotten. The space is not told (`reindex_shapes_for_body`)."""
        self.body.position, self.body.angle = (pose.x, pose.y), pose.theta
        self.body.velocity, self.body.angular_velocity = (0.0, 0.0), 0.0
        self._motion, self._goal, self._twist, self._pitch = REST, REST, Twist(0.0, 0.0, 0.0), self._pitch_at(pose)
        self._meant_way = self._meant_turn = 0.0
        self._along, self.asked = (math.cos(pose.theta), math.sin(pose.theta)), (0.0, 0.0)
        self._mirror()
        self.pose, self._velocity = Pose(pose.x, pose.y, wrap(pose.theta)), (0.0, 0.0)
        self.speed = self.turn_rate = self.aside = self.blocked = 0.0
        self.acceleration, self.wheels, self.standing = (0.0, 0.0), Drive(0.0, 0.0), True
        self.load, self.flippers = Currents(0.0, True, 0.0, 0.0), self._flippers.state

    # --- what it is told --------------------------------------------------------------------------

    def command(self, command: Command) -> None:
        """What to do until the next command, clipped to what the drive can do; no drive: stop."""
        wanted = command.drive or Drive(0.0, 0.0)
        wanted = Drive(float(wanted.speed), float(wanted.turn_rate))  # numpy's numbers would spread, and are slow
        self._goal = reachable(self.build.drive, wanted, self._motion)
        if isinstance(self.build.drive, SkidSteer):
            self._flippers.command(command.flippers)

    def climbs(self) -> float:
        """Height [m] of the curb that it gets over now."""
        match self.build.drive:
            case SkidSteer() as drive:
                return drive.climbs_deployed if self._flippers.lifts else drive.climbs
            case _:
                return 0.0

    # --- one sub-step -----------------------------------------------------------------------------

    def glide(self, dt: float) -> None:
        """One sub-step [s] in free space: what a step of the space would make of it with nothing near."""
        if not self._mirrored:
            self._mirror()
        vx, vy, turn = self._vx, self._vy, self._turn
        self._x, self._y = self._x + vx * dt, self._y + vy * dt
        if turn:
            self._angle += turn * dt
        self._vx, self._vy, self._turn = self._next(self._angle, vx, vy, turn, dt)
        self._told = False

    def tell(self) -> None:
        """The body what gliding has made; before the space is asked or stepped."""
        if not self._told:
            body = self.body
            body.position, body.angle = (self._x, self._y), self._angle
            body.velocity, body.angular_velocity = (self._vx, self._vy), self._turn
            self._space.reindex_shapes_for_body(body)
            self._told = True

    def _drive(self, body: pymunk.Body, _gravity: Vec2, _damping: float, dt: float) -> None:
        (vx, vy), turn = body.velocity, body.angular_velocity
        vx, vy, turn = self._next(body.angle, vx, vy, turn, dt)
        way = (math.hypot(vx, vy) + abs(turn) * self._spin) * dt
        if way > ALWAYS_FINE:
            share = self._look_ahead(vx, vy, turn, dt, way)
            vx, vy, turn = vx * share, vy * share, turn * share
        body.velocity, body.angular_velocity = (vx, vy), turn
        self._mirrored = False

    def _next(self, angle: float, vx: float, vy: float, turn: float, dt: float) -> tuple[float, float, float]:
        """The velocity for the next sub-step, from the one that the last was made with."""
        twist = self._twist
        self._meant_way += twist.forward * dt
        self._meant_turn += twist.turn * dt
        if self._motion != self._goal:
            twist = self._twist = self._ramp(vx, vy, turn, dt)
        forward, aside, turn = twist
        middle = angle + turn * dt / 2  # the middle of the arc that the next sub-step will drive
        c, s = self._along = math.cos(middle), math.sin(middle)
        self.asked = velocity = forward * c - aside * s, forward * s + aside * c
        return (*velocity, turn)

    def _ramp(self, vx: float, vy: float, turn: float, dt: float) -> Twist:
        drive, (c, s), old = self.build.drive, self._along, self._twist
        made, turned = _share(old.forward, vx * c + vy * s), _share(old.turn, turn)
        motion = self._motion if made == turned == 1.0 else unwound(self._motion, self._goal, made, turned)
        self._motion = ramped(drive, motion, self._goal, dt)
        return hull(drive, self._motion, self._pitch)

    def _look_ahead(self, vx: float, vy: float, turn: float, dt: float, way: float) -> float:
        """Share of the motion after which the hull first goes `DEPTH` into a thing that it does not touch yet.

        way [m]: as far as any place on the hull goes; what is farther from it cannot be met. A hull that presses on
        one thing is thrown about by it, in whatever direction, so that all the others count then.
        """
        (x, y), share, nearest, presses = self.body.position, 1.0, way, False
        self._feeler.unsafe_set_radius(self._round + way)
        found = [info for info in self._space.shape_query(self._feeler) if not info.shape.sensor]
        for body, near in [(info.shape.body, info.contact_point_set) for info in found]:
            nx, ny = near.normal
            for (ax, ay), (bx, by) in [(point.point_a, point.point_b) for point in near.points]:
                gap = (bx - ax) * nx + (by - ay) * ny + way
                towards = (vx - turn * (by - y)) * nx + (vy + turn * (bx - x)) * ny
                presses, nearest = presses or (gap <= 0 < towards), min(nearest, gap) if gap > 0 else nearest
                if body is not None and gap > 0 and towards * dt > gap + DEPTH:
                    away = max(0.0, body.velocity_at_world_point((bx, by)).dot((nx, ny)))
                    share = min(share, ((gap + DEPTH) / dt + away) / towards)
        return min(share, (nearest + DEPTH) / way) if presses else share

    # --- the end of a tick ------------------------------------------------------------------------

    def settle(self, dt: float, climbing: bool = False) -> None:
        """After the sub-steps of a tick of dt [s]; climbing: the hull lies over a curb."""
        if not self._mirrored:
            self._mirror()
        old, (c, s) = self.pose, self._along
        self.pose = Pose(self._x, self._y, wrap(self._angle))
        self.speed, self.turn_rate = self._vx * c + self._vy * s, self._turn
        self.standing = math.hypot(self._vx, self._vy) < SLOW
        turn = wrap(self.pose.theta - old.theta)
        self._read_motion(old, old.theta + turn / 2, turn, dt)
        self._read_load(dt, climbing)
        self._tilt()

    def _read_motion(self, old: Pose, middle: float, turn: float, dt: float) -> None:
        c, s = math.cos(middle), math.sin(middle)
        forward = ((self.pose.x - old.x) * c + (self.pose.y - old.y) * s) / dt
        self.wheels, self.aside = wheels(self.build.drive, forward, turn / dt), aside(self.build.drive, turn / dt)
        ax, ay = (self._vx - self._velocity[0]) / dt, (self._vy - self._velocity[1]) / dt
        self.acceleration, self._velocity = (ax * c + ay * s, ay * c - ax * s), (self._vx, self._vy)

    def _read_load(self, dt: float, climbing: bool) -> None:
        drive = self.build.drive
        meant = wheels(drive, self._meant_way / dt, self._meant_turn / dt)
        self._meant_way = self._meant_turn = 0.0
        self.blocked = lost(meant.speed, self.wheels.speed)
        track = drive.track if isinstance(drive, Differential | SkidSteer) else 0.0
        left, right = currents(meant, self.wheels, track, isinstance(drive, SkidSteer))
        self.load = Currents(0.0, True, CLIMBING, CLIMBING) if climbing else Currents(0.0, True, left, right)
        self._flippers.move(dt, self.blocked > PUSHING, climbing)
        self.flippers = self._flippers.state

    def _tilt(self) -> None:
        pitch = self._pitch_at(self.pose)
        if pitch != self._pitch:
            self._pitch = pitch
            self._twist = hull(self.build.drive, self._motion, pitch)

    def _pitch_at(self, pose: Pose) -> float:
        return self._ground.tilt(pose)[0] if self._ground.slopes else 0.0

    def _mirror(self) -> None:
        """Take over from the body what `glide` goes on with."""
        body = self.body
        (self._x, self._y), self._angle = body.position, body.angle
        (self._vx, self._vy), self._turn, self._mirrored = body.velocity, body.angular_velocity, True
        self._told = True


def _moment(build: Build) -> float:
    if isinstance(build.hull, Polygon):
        return pymunk.moment_for_poly(build.mass, build.hull.vertices)
    return math.inf


def _share(meant: float, made: float) -> float:
    """Share in [0, 1] of a speed that was made; 1 but for rounding where nothing stood in the way."""
    return 1.0 if abs(made - meant) < SAME or abs(meant) < SAME else max(0.0, min(1.0, made / meant))
