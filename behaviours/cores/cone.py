"""Where in its cone an echo lies.

Takes: one sweep of a ring. Gives: the points of its echoes. Leaves alone: what becomes of them.
A sonar tells the range of the nearest thing in its cone, not where in the cone it is. Where the neighbour hears
something nearer, the thing reaches into the cone from that side, so the echo is put on that edge; put on the axis, an
obstacle two metres away would grow by a third of a metre to either side and close the gap to the next one.
"""

from __future__ import annotations

import math

from behaviours.cores.geometry import echo
from behaviours.interface import Pose, Ranges, Vec2


def echoes_of(ring: Ranges, robot: Pose, half_cone: float, near: float) -> list[tuple[float, Vec2]]:
    """(range [m], point in the frame of the robot's pose) of every transducer that heard something.

    half_cone [rad]: 0 puts echoes on the axis; near [m]: neighbours that differ by more hear different things.
    The transducers stand in order of their bearings around the whole hull.
    """
    ranges, bearings = ring.ranges.tolist(), ring.bearings.tolist()
    count = len(ranges)
    points = []
    for i, (reach, bearing) in enumerate(zip(ranges, bearings, strict=True)):
        if reach < ring.max_range:
            side = _side(ranges[i - 1], reach, ranges[(i + 1) % count], near)
            points.append((reach, echo(robot, bearing + side * half_cone, ring.mount_radius + reach)))
    return points


def _side(before: float, reach: float, after: float, near: float) -> int:
    """-1 where the thing reaches in from the transducer before, 1 from the one after, 0 for neither."""
    low, high = reach - near, reach
    left = after if low <= after < high else math.inf
    right = before if low <= before < high else math.inf
    return 0 if left == right else (1 if left < right else -1)
