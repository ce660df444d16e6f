"""A kinematic stand-in for a world, and one for a plan, so that behaviours are tested without either.

Takes: discs, walls, a robot pose, a seed. Gives: readings from the models that the behaviours are written for.
Leaves alone: contact and slip; a robot that would touch something is counted, not stopped.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
import pytest

from behaviours.catalogue import LIBRARIES
from behaviours.interface import (
    STOP,
    Command,
    Head,
    HeadState,
    IrReading,
    Odometry,
    Pose,
    Ranges,
    Reading,
    StereoReading,
    Workshop,
    wrap,
)

TICK = 0.1
HULL = 0.35
FOOT = 0.3048
WAIST = np.arange(24) * math.tau / 24
SKIRT = np.arange(6) * math.tau / 6
CONE = np.radians([-9.0, -4.5, 0.0, 4.5, 9.0])


@dataclass
class Disc:
    x: float
    y: float
    radius: float
    height: float = 1.0
    vx: float = 0.0
    vy: float = 0.0


@dataclass
class Wall:
    ax: float
    ay: float
    bx: float
    by: float
    vx: float = 0.0
    vy: float = 0.0


def box(x, y, length, width, angle, vx=0.0, vy=0.0):
    """Four walls of a rectangle."""
    c, s = math.cos(angle), math.sin(angle)
    corners = [(a * length / 2, b * width / 2) for a, b in ((1, 1), (-1, 1), (-1, -1), (1, -1))]
    points = [(x + c * u - s * v, y + s * u + c * v) for u, v in corners]
    return [Wall(*p, *q, vx, vy) for p, q in zip(points, points[1:] + points[:1], strict=True)]


def cast(x, y, angle, discs, walls, far):
    """Distance along each ray to the first thing."""
    ux, uy = np.cos(angle), np.sin(angle)
    best = np.full(np.shape(angle), far)
    for d in discs:
        dx, dy = d.x - x, d.y - y
        middle = dx * ux + dy * uy
        under = d.radius**2 - (dx**2 + dy**2 - middle**2)
        hit = middle - np.sqrt(np.maximum(under, 0.0))
        best = np.where((under >= 0) & (middle > 0), np.minimum(best, np.maximum(hit, 0.0)), best)
    for w in walls:
        ex, ey = w.bx - w.ax, w.by - w.ay
        det = ux * ey - uy * ex
        det = np.where(np.abs(det) < 1e-12, np.nan, det)
        fx, fy = w.ax - x, w.ay - y
        t, s = (fx * ey - fy * ex) / det, (fx * uy - fy * ux) / det
        best = np.where((t >= 0) & (s >= 0) & (s <= 1), np.fmin(best, t), best)
    return best


@dataclass
class World:
    """A robot among things. `donor`: a disc with a beacon, which also counts as a thing."""

    seed: int = 0
    pose: Pose = field(default_factory=lambda: Pose(0.0, 0.0, 0.0))
    discs: list[Disc] = field(default_factory=list)
    walls: list[Wall] = field(default_factory=list)
    donor: Disc | None = None
    sonar_sd: float = 0.01
    dropout: float = 0.0
    ir_period: float = 1.0
    stereo_period: float = 1.0
    sun: bool = False
    wind: float = 0.0
    stuck: bool = False
    far: float = 5.0

    def __post_init__(self):
        self.chance = np.random.default_rng(self.seed)
        self.tick = 0
        self.speed = self.turn_rate = 0.0
        self.head, self.wanted, self.still = (0.0, 0.0), (0.0, 0.0), 0.0
        self.stood = 0.0
        self.touched = 0
        self.on_board = False
        self.ir_used = self.stereo_used = 0.0
        self.rings = None
        self.start = self.pose

    @property
    def stamp(self):
        return round(self.tick * TICK, 9)

    def things(self):
        return self.discs + ([self.donor] if self.donor else [])

    def gap(self):
        """Between the hull and the nearest thing [m]."""
        gaps = [math.hypot(d.x - self.pose.x, d.y - self.pose.y) - d.radius - HULL for d in self.things()]
        angles = np.arange(180) * math.tau / 180
        if self.walls:
            gaps.append(float(cast(self.pose.x, self.pose.y, angles, [], self.walls, 99.0).min()) - HULL)
        return min(gaps, default=math.inf)

    def _sweep(self, bearings, fresh):
        axes = self.pose.theta + np.repeat(bearings, 5)
        x, y = self.pose.x + HULL * np.cos(axes), self.pose.y + HULL * np.sin(axes)
        reach = cast(x, y, axes + np.tile(CONE, len(bearings)), self.things(), self.walls, self.far)
        ranges = reach.reshape(-1, 5).min(axis=1)
        heard = (ranges < self.far) & (self.chance.random(len(ranges)) >= self.dropout)
        noisy = np.clip(ranges * (1 + self.sonar_sd * self.chance.standard_normal(len(ranges))), 0.05, self.far)
        return Ranges(self.stamp, fresh, bearings, np.where(heard, noisy, self.far), self.far, HULL)

    def _ir(self):
        fresh = self.still >= self.ir_period - 1e-6 and self.stamp - self.ir_used >= self.ir_period - 1e-6
        if self.donor is None or not fresh:
            return IrReading(self.stamp, False, self.head[0], False, math.nan, 0.0)
        self.ir_used = self.stamp
        dx, dy = self.donor.x - self.pose.x, self.donor.y - self.pose.y
        offset = wrap(math.atan2(dy, dx) - self.pose.theta - self.head[0])
        offset += self.wind * self.chance.standard_normal()
        seen = abs(offset) < math.radians(30)
        signal = 3.2 * (7.62 / math.hypot(dx, dy)) ** 2 * math.cos(offset) ** 2 if seen else 0.0
        strength = signal / (10.0 if self.sun else 1.0) + 0.2 * self.chance.standard_normal()
        heard = seen and strength > 3.0
        offset = offset + math.radians(0.3) * self.chance.standard_normal() if heard else math.nan
        return IrReading(self.stamp, True, self.head[0], heard, offset, strength)

    def _stereo(self):
        still = min(self.still, self.stood)
        fresh = still >= self.stereo_period - 1e-6 and self.stamp - self.stereo_used >= self.stereo_period - 1e-6
        pan, tilt = self.head
        slant = math.nan
        if fresh and tilt > 0:
            self.stereo_used = self.stamp
            ground = 1.2 / math.tan(tilt)
            hit = float(cast(self.pose.x, self.pose.y, np.array(self.pose.theta + pan), self.things(), [], ground))
            slant = hit / math.cos(tilt)
            slant += (0.003 * slant + 0.001 * slant**2) * self.chance.standard_normal()
        return StereoReading(self.stamp, fresh, pan, tilt, slant, 1.2)

    def read(self):
        fresh = self.tick % 3 == 0
        if fresh or self.rings is None:
            self.rings = (self._sweep(WAIST, True), self._sweep(SKIRT, True))
        else:
            self.rings = tuple(Ranges(r.stamp, False, r.bearings, r.ranges, r.max_range, HULL) for r in self.rings)
        here = Pose(self.pose.x - self.start.x, self.pose.y - self.start.y, self.pose.theta)
        c, s = math.cos(self.start.theta), math.sin(self.start.theta)
        odometry = Pose(c * here.x + s * here.y, c * here.y - s * here.x, wrap(here.theta - self.start.theta))
        return Reading(
            self.stamp,
            self.tick,
            Odometry(odometry, self.speed, self.turn_rate),
            *self.rings,
            HeadState(*self.head, self.head == self.wanted),
            self._ir(),
            self._stereo(),
            self.on_board,
        )

    def act(self, command: Command):
        drive = command.drive or STOP.drive
        if command.head is not None:
            self.wanted = (command.head.pan, command.head.tilt)
        slew = math.radians(60) * TICK
        before = self.head
        if not (self.stuck and before[1] > math.radians(30)):
            moves = [max(-slew, min(slew, w - h)) for w, h in zip(self.wanted, before, strict=True)]
            self.head = tuple(
                w if abs(w - h) <= slew else h + m for w, h, m in zip(self.wanted, before, moves, strict=True)
            )
        self.still = self.still + TICK if self.head == before else 0.0
        self.speed += max(-0.05, min(0.05, drive.speed - self.speed))
        self.turn_rate += max(-0.2, min(0.2, drive.turn_rate - self.turn_rate))
        theta = self.pose.theta + self.turn_rate * TICK / 2
        self.pose = Pose(
            self.pose.x + self.speed * TICK * math.cos(theta),
            self.pose.y + self.speed * TICK * math.sin(theta),
            wrap(self.pose.theta + self.turn_rate * TICK),
        )
        self.stood = self.stood + TICK if abs(self.speed) < 1e-9 and abs(self.turn_rate) < 1e-9 else 0.0
        for thing in self.things():
            thing.x, thing.y = thing.x + thing.vx * TICK, thing.y + thing.vy * TICK
        for w in self.walls:
            w.ax, w.bx, w.ay, w.by = w.ax + w.vx * TICK, w.bx + w.vx * TICK, w.ay + w.vy * TICK, w.by + w.vy * TICK
        self.touched += self.gap() < 0.0
        self.tick += 1


class Robot:
    """The libraries of a robot brought to life, driven by the names of what shall run."""

    def __init__(self, *names: str, **settings: dict[str, float]):
        self.workshop = Workshop()
        offers = [LIBRARIES[n].build(settings.get(n.replace("-", "_"), {}), self.workshop) for n in names]
        self.percepts = {k: v for o in offers for k, v in o.percepts.items()}
        self.values = {k: v for o in offers for k, v in o.values.items()}
        self.competences = {k: v for o in offers for k, v in o.competences.items()}
        self.reports, self.channels, self.running = {}, {}, None

    def estimator(self, kind):
        return next(e for e in self.workshop.estimators if isinstance(e, kind))

    def sense(self, reading):
        for estimator in self.workshop.estimators:
            estimator.update(reading, self.reports, self.channels)
        return {name: percept() for name, percept in self.percepts.items()}

    def act(self, reading, name, **channels):
        """Fill the channels and step one competence, as the controller of a plan does."""
        previous = dict(self.channels)
        self.channels = {}
        for channel, value in channels.items():
            made = self.values[value](previous) if isinstance(value, str) else value
            self.channels[channel] = made
        self.channels["action"] = name
        seen = {**previous, **self.channels}
        if self.running != name:
            if self.running is not None:
                self.competences[self.running].stop()
            self.competences[name].start(reading, seen)
            self.running = name
        command, report = self.competences[name].step(reading, seen)
        self.reports = {name: report}
        assert command.is_finite()
        return command


def figure_one(p):
    """What Figure 1 of the find-and-fetch paper, mended, does for these percepts: (goal, action, failures)."""
    failures = []
    goal = action = None
    if p["anything-is-too-close"]:
        return "remember-the-current-goal-if-any", "move-away-from-danger", failures
    if p["donor-has-been-located"]:
        goal = "set-goal-as-the-donors-location"
        if p["we-already-have-the-widget"]:
            goal = "the-robots-home-position"
    elif p["we-know-the-donor-direction"]:
        if not p["stereo-ranging-is-started"]:
            action = "start-stereo-ranging"
        elif not p["a-range-value-has-been-returned"]:
            action = "continue-stereo-search"
        elif p["the-range-value-is-no-good"]:
            action, failures = "start-stereo-ranging", ["prism"]
    elif p["the-ir-search-is-finished"]:
        if p["the-returned-angle-is-no-good"]:
            action, failures = "start-ir-search", ["ir"]
    else:
        action = "continue-ir-search" if p["ir-search-has-been-started"] else "start-ir-search"
    if action is None and p["there-is-a-goal"] and not p["we-are-at-the-goal"]:
        action = "move-according-to-NaT-plan"
    return goal, action or "stop", failures


ALL = ("robot", "runaway", "natigation", "ir-search", "stereo-search", "find-and-fetch")


class Fetcher(Robot):
    """The robot of Figure 1."""

    def __init__(self, **settings):
        super().__init__(*ALL, **settings)
        self.failures = []
        self.actions = []

    def tick(self, world):
        reading = world.read()
        goal, action, failures = figure_one(self.sense(reading))
        self.failures += failures
        if not self.actions or self.actions[-1][1] != action:
            self.actions.append((reading.stamp, action))
        command = self.act(reading, action, **({} if goal is None else {"goal": goal}))
        world.act(command)
        if world.donor is not None and world.stood >= 15.0:
            reach = math.hypot(world.donor.x - world.pose.x, world.donor.y - world.pose.y)
            world.on_board |= reach - HULL - world.donor.radius <= 0.92


class Standin:
    """What the fixture gives: the names above."""

    World, Disc, Wall, Robot, Fetcher, Head, Pose = World, Disc, Wall, Robot, Fetcher, Head, Pose
    box = staticmethod(box)
    FOOT, HULL, TICK = FOOT, HULL, TICK


@pytest.fixture(scope="session")
def standin():
    """The stand-ins."""
    return Standin
