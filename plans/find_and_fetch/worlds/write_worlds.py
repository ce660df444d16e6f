"""Writes the scenarios of this folder: a car that crosses the robot's way, and canyons with a goal behind them.

Takes: nothing. Gives: `crossing` and `canyon`, scenario texts for any speed, moment and size; run as a program it
writes car_*.yaml and canyon_*.yaml beside itself. Leaves alone: who drives (plans/go_to_goal suits: its goal is 7.55 m
ahead of the start).

The car is that of Figure 2 of Bonasso, Antonisse and Slack (1992): it drives to the left on a line that falls by 0.2,
and does not brake for anybody.
"""

from __future__ import annotations

import math
from pathlib import Path

GOAL = (-1.5, 7.4)
LENGTH, WIDTH = 4.4, 1.8
CROSSES = 3.2
"""y [m] at which the car crosses the straight way to the goal."""
RUN_UP = 14.0
"""[m] that the car drives before it crosses."""
BACK = 5.5
"""x [m] of the back wall of a canyon."""

CROSSING = """\
# A car of {length} x {width} m crosses the way to the goal at {time:g} s with {speed:g} m/s, whoever is in its lane.
name: car at {speed:g} m/s after {time:g} s
bounds: [-9, -3, 9, 10]
time_limit: 3 min

robot:
  start: [0, 0]
  heading: {heading:.6f} # towards the goal
  sensors:
    - {{kind: sonar}}
    - {{kind: odometry}}
    - {{kind: lidar, height: 0.6, beams: 360, max_range: 10, sd: 0.02, period: 0.1}} # for plans that use it

goal: {{at: [{goal[0]}, {goal[1]}], within: 0.5}}

things:
  - kind: box
    id: car
    size: [{length}, {width}]
    heading: {course:.6f}
    height: 1.5
    keyframes: {keyframes}
"""

CANYON = """\
# A canyon of {width:g} x {depth:g} m, open towards the robot; the goal is behind its back wall, 16 degrees to the left.
# The seed turns the robot, and with it the goal that it is given, by 4 degrees to either side.
name: canyon {width:g} x {depth:g}
bounds: [-4, -7, 10, 7]
time_limit: 10 min

robot:
  start: [0, 0]
  heading: {{between: [12 deg, 20 deg]}}

goal: {{at: [7.26, 2.08], within: 0.9}}

things:
  - {{kind: wall, from: [{back}, {low}], to: [{back}, {high}]}}
  - {{kind: wall, from: [{mouth}, {low}], to: [{back}, {low}]}}
  - {{kind: wall, from: [{mouth}, {high}], to: [{back}, {high}]}}
"""


def crossing(speed: float, time: float) -> str:
    """The scenario of a car at `speed` [m/s] whose middle crosses the straight way at `time` [s]."""
    course = math.atan2(0.2, -1.0)
    where = (GOAL[0] * CROSSES / GOAL[1], CROSSES)
    first = max(0.0, time - RUN_UP / speed)
    frames = []
    for t in ([0.0] if first > 0.0 else []) + [first, 3600.0]:
        way = (max(t, first) - time) * speed
        place = (where[0] + way * math.cos(course), where[1] + way * math.sin(course))
        frames.append([round(t, 3), *(round(number, 3) for number in place)])
    return CROSSING.format(
        speed=speed,
        time=time,
        length=LENGTH,
        width=WIDTH,
        goal=GOAL,
        heading=math.atan2(GOAL[1], GOAL[0]),
        course=course,
        keyframes=frames,
    )


def canyon(width: float, depth: float) -> str:
    """The scenario of a canyon of these inner measures [m]."""
    side = width / 2 + 0.1
    return CANYON.format(width=width, depth=depth, back=BACK + 0.1, low=-side, high=side, mouth=BACK - depth)


def main() -> None:
    """Write them."""
    here = Path(__file__).parent
    for speed in (0.6, 0.8, 1.0, 1.2, 1.4, 1.5, 1.6, 1.8, 2.0, 2.2):
        (here / f"car_{speed:.1f}.yaml").write_text(crossing(speed, 11.0), encoding="utf-8")
    (here / "car_1.4_late.yaml").write_text(crossing(1.4, 16.0), encoding="utf-8")
    for width, depth in ((3, 2), (4, 3), (5, 4), (6, 5)):
        (here / f"canyon_{width}x{depth}.yaml").write_text(canyon(width, depth), encoding="utf-8")


if __name__ == "__main__":
    main()
