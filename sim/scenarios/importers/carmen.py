"""CARMEN logs (also packed with gzip): what a laser saw and where odometry and a mapper thought it was.

Takes: the lines FLASER, ROBOTLASER1 and ODOM. Gives: one `Entry` for each scan: the reading, whose odometry is that of
the ODOM lines (between two of them linearly) or, without them, of the scan itself; and the pose in the map, which is
the corrected one in logs that a mapper has corrected. Leaves alone: rear lasers, sonars, GPS and other messages.
Source: the log format of the Carnegie Mellon Robot Navigation Toolkit.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import count
from pathlib import Path

import numpy as np

from behaviours.interface import Floats, Odometry, Pose, Reading, Scan, wrap
from sim.scenarios.importers.imported import WorldFileError, shown
from sim.scenarios.importers.sources import decoded, read_bytes, unpacked

LASERS = ("FLASER", "ROBOTLASER1")
MAX_RANGE = 80.0
MOST_BEAMS = 10_000
MOST_NUMBER = 1e12


@dataclass(frozen=True, slots=True)
class Entry:
    """One scan of a log. stamp [s] since the first; corrected: the pose of the robot in the map."""

    stamp: float
    corrected: Pose
    reading: Reading


@dataclass(frozen=True, slots=True)
class _Line:
    file: str
    number: int
    words: list[str]

    def fault(self, message: str) -> WorldFileError:
        return WorldFileError(self.file, self.number, f"{self.words[0]}: {message}")

    def floats(self, start: int, amount: int) -> list[float]:
        """So many numbers from the word at `start` on. Raises WorldFileError."""
        words = self.words[start : start + amount]
        try:
            numbers = [float(word) for word in words]
        except ValueError:
            numbers = [math.nan]
        if len(words) < amount:
            raise self.fault(f"the line ends too early: {amount} numbers from word {start + 1} on were expected")
        if not all(abs(number) <= MOST_NUMBER for number in numbers):
            wrong = next((word for word in words if not _is_number(word)), "a huge number")
            raise self.fault(f"expected numbers, got {shown(wrong)}")
        return numbers

    def whole(self, place: int, most: int) -> int:
        word = self.words[place] if place < len(self.words) else ""
        if not word.isascii() or not word.isdigit() or len(word) > 9 or int(word) > most:
            raise self.fault(f"expected a whole number up to {most}, got {shown(word)}")
        return int(word)


def _is_number(word: str) -> bool:
    try:
        return math.isfinite(float(word))
    except ValueError:
        return False


@dataclass(frozen=True, slots=True)
class _Seen:
    """What a line of a laser says; poses are of the robot."""

    bearings: Floats
    ranges: Floats
    max_range: float
    corrected: Pose
    odometry: Pose
    mount: Pose
    stamp: float


def entries(path: Path) -> Iterator[Entry]:
    """The scans of a log in their order. Raises WorldFileError, before the first where there is none at all."""
    text = decoded(unpacked(read_bytes(path), path.name), path.name)
    settings = _settings(path.name, text)
    poses = _Odometry(path.name, text)
    found = False
    first: _Seen | None = None
    ticks, latest = count(), -math.inf
    for line in _lines(path.name, text, LASERS):
        seen = _flaser(line, settings) if line.words[0] == "FLASER" else _robot_laser(line)
        first = first or seen
        if seen.stamp >= latest:  # what comes too late is passed over
            found, latest = True, seen.stamp
            yield _entry(seen, first, poses, next(ticks))
    if not found:
        raise WorldFileError(path.name, 0, "there is no scan (FLASER or ROBOTLASER1) in this log")


def _lines(file: str, text: str, kinds: tuple[str, ...]) -> Iterator[_Line]:
    for number, line in enumerate(text.split("\n"), 1):
        if line.startswith(kinds):
            words = line.split()
            if words[0] in kinds:
                yield _Line(file, number, words)


@dataclass(frozen=True, slots=True)
class _Settings:
    """offset [m] of the laser in front of the robot's middle; max_range [m]."""

    offset: float
    max_range: float


def _settings(file: str, text: str) -> _Settings:
    values = {"robot_frontlaser_offset": 0.0, "robot_front_laser_max": MAX_RANGE}
    for line in _lines(file, text, ("PARAM",)):
        if len(line.words) > 2 and line.words[1] in values:
            values[line.words[1]] = line.floats(2, 1)[0]
    most = values["robot_front_laser_max"]
    return _Settings(values["robot_frontlaser_offset"], most if most > 0 else MAX_RANGE)


class _Odometry:
    """The raw odometry of the ODOM lines."""

    def __init__(self, file: str, text: str) -> None:
        rows = [[*line.floats(1, 5), line.floats(7, 1)[0]] for line in _lines(file, text, ("ODOM",))]
        table = np.array(rows, dtype=np.float64).reshape(-1, 6)
        table = table[np.argsort(table[:, 5], kind="stable")]
        self._table = table
        if len(table) > 1:
            table[:, 2] = np.unwrap(table[:, 2])
            _add_speeds(table)

    def at(self, seen: _Seen) -> tuple[Pose, float, float]:
        """Pose, speed [m/s] and turn rate [rad/s] at the moment of the scan."""
        if not len(self._table):
            return seen.odometry, 0.0, 0.0
        stamps = self._table[:, 5]
        columns = [self._table[:, column] for column in range(5)]
        x, y, theta, speed, turn_rate = (float(np.interp(seen.stamp, stamps, column)) for column in columns)
        return Pose(x, y, wrap(theta)), speed, turn_rate


def _add_speeds(table: Floats) -> None:
    """Many logs have no speeds (all 0): then they are reckoned from one pose to the next."""
    if table[:, 3:5].any():
        return
    steps = np.diff(table[:, 5])
    moving = np.where(steps > 0, steps, np.inf)
    along = np.diff(table[:, 0]) * np.cos(table[:-1, 2]) + np.diff(table[:, 1]) * np.sin(table[:-1, 2])
    table[1:, 3], table[1:, 4] = along / moving, np.diff(table[:, 2]) / moving


def _entry(seen: _Seen, first: _Seen, poses: _Odometry, tick: int) -> Entry:
    stamp = seen.stamp - first.stamp
    start, _, _ = poses.at(first)
    pose, speed, turn_rate = poses.at(seen)
    odometry = Odometry(_from(start, pose), speed, turn_rate, stamp)
    scan = Scan(stamp, True, seen.mount, seen.bearings, seen.ranges, 0.0, seen.max_range)
    return Entry(stamp, seen.corrected, Reading(stamp, tick, odometry, lidar=scan))


def _from(base: Pose, pose: Pose) -> Pose:
    """The pose as seen from the base."""
    c, s = math.cos(base.theta), math.sin(base.theta)
    dx, dy = pose.x - base.x, pose.y - base.y
    return Pose(c * dx + s * dy, c * dy - s * dx, wrap(pose.theta - base.theta))


def _flaser(line: _Line, settings: _Settings) -> _Seen:
    """FLASER n ranges laser-pose robot-odometry stamp host logger-stamp; the n beams fill half a turn."""
    beams = _beams(line, 1)
    ranges = np.array(line.floats(2, beams))
    x, y, theta, ox, oy, otheta, stamp = line.floats(2 + beams, 7)
    step = math.pi / (beams - 1 if beams % 2 else beams) if beams > 1 else 0.0
    laser = Pose(x, y, theta)
    corrected = Pose(ox, oy, wrap(otheta)) if (x, y) == (ox, oy) else _behind(laser, settings.offset)
    mount = Pose(settings.offset, 0.0, 0.0)
    return _Seen(
        _fan(-math.pi / 2, step, beams),
        _heard(ranges, settings.max_range),
        settings.max_range,
        corrected,
        Pose(ox, oy, otheta),
        mount,
        stamp,
    )


def _behind(laser: Pose, offset: float) -> Pose:
    x, y = laser.x - offset * math.cos(laser.theta), laser.y - offset * math.sin(laser.theta)
    return Pose(x, y, wrap(laser.theta))


def _robot_laser(line: _Line) -> _Seen:
    """ROBOTLASER1 type start fov step max accuracy remission n ranges m remissions laser-pose robot-pose …"""
    start, _, step, most = line.floats(2, 4)
    beams = _beams(line, 8)
    ranges = np.array(line.floats(9, beams))
    rest = 9 + beams + 1 + line.whole(9 + beams, MOST_BEAMS)
    lx, ly, ltheta, x, y, theta = line.floats(rest, 6)
    stamp = line.floats(rest + 11, 1)[0]
    robot = Pose(x, y, wrap(theta))
    most = most if most > 0 else MAX_RANGE
    mount = _from(robot, Pose(lx, ly, ltheta))
    return _Seen(_fan(start, step, beams), _heard(ranges, most), most, robot, robot, mount, stamp)


def _fan(start: float, step: float, beams: int) -> Floats:
    return start + step * np.arange(beams, dtype=np.float64)


def _beams(line: _Line, place: int) -> int:
    beams = line.whole(place, MOST_BEAMS)
    if not beams:
        raise line.fault("a scan of no beams")
    return beams


def _heard(ranges: Floats, max_range: float) -> Floats:
    """Ranges as readings have them: `max_range` where nothing was met, NaN where the number makes no sense."""
    return np.asarray(np.where(ranges < 0, math.nan, np.minimum(ranges, max_range)))
