"""What is so at the end of a tick: all that a sensor may look at.

Takes: what the world fills in, tick by tick. Gives: `Truth`. Leaves alone: what sensors make of it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from behaviours.interface import Currents, Drive, FlipperState, HeadState, Pose, Vec2
from sim.raycast import Scene
from sim.sensors.weather import Weather
from sim.things.ground import Ground


@dataclass(frozen=True, slots=True)
class Beacon:
    """name of the donor; at: place [m]; thing: index of the thing that carries it."""

    name: str
    at: Vec2
    thing: int


@dataclass(slots=True)
class Truth:
    """The state of the world at `time` [s], `dt` [s] after the tick before.

    pose, speed [m/s] along x, turn_rate [rad/s], acceleration [m/s^2, robot frame]: of the hull. wheels: the motion
    that wheels or tracks made of it in this tick, slip included; aside [m/s]: what of it leads to the left, as the
    wheels know it. still_for, head_still_for [s]: how long base and head
    have not moved. load: what the motors draw. touched: bearings [rad, robot frame] of contacts. beacons: those of the
    donors. battery: its level and whether it is charged; None without one. scene: the outlines of
    things as they are now, brought up to date when it is asked for.
    """

    tick: int
    time: float
    dt: float
    pose: Pose
    speed: float
    turn_rate: float
    acceleration: Vec2
    wheels: Drive
    aside: float
    still_for: float
    head: HeadState
    head_still_for: float
    load: Currents
    flippers: FlipperState
    touched: tuple[float, ...]
    beacons: tuple[Beacon, ...]
    battery: tuple[float, bool] | None
    weather: Weather
    ground: Ground
    scene: Callable[[], Scene]
