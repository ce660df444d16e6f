"""Getting out of where it does not go on: noticing it, going back as the robot came, not trying again at once.

Takes: where the robot is, tick by tick. Gives: whether it is stalled, the next place of the way back, places to keep
off. Leaves alone: commands.
"""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass

import numpy as np

from behaviours.interface import Floats, Pose


@dataclass(frozen=True, slots=True)
class WayBackSettings:
    """stalled [s] without getting `moved` [m] away is stalled. back [m]: the first way back; again and again within
    `remembered` [s] it is longer, up to `most_back` [m]. spacing [m]: of the places of the way. ahead [m]: how far
    before the robot the place lies that is kept off afterwards.
    """

    stalled: float = 6.0
    moved: float = 0.3
    back: float = 0.6
    most_back: float = 4.0
    spacing: float = 0.1
    remembered: float = 30.0
    ahead: float = 0.4


class WayBack:
    """Everything in the map frame."""

    def __init__(self, settings: WayBackSettings) -> None:
        self.settings = settings
        self._way: list[tuple[float, float]] = []
        self._lately: deque[tuple[float, float, float]] = deque()
        self._dead_ends: list[tuple[float, float, float]] = []
        self._left = 0.0
        self._until = -math.inf

    @property
    def goes_back(self) -> bool:
        """It is on its way back."""
        return self._left > 0.0

    @property
    def is_known(self) -> bool:
        """There is a way back."""
        return len(self._way) > 1

    def rest(self) -> None:
        """The robot was not to move: standing still means nothing."""
        self._lately.clear()
        self._left = 0.0

    def advance(self, pose: Pose, stamp: float) -> None:
        """Take where the robot is while it goes forward."""
        if not self._way or math.dist(self._way[-1], (pose.x, pose.y)) >= self.settings.spacing:
            self._way = [*self._way[-200:], (pose.x, pose.y)]
        self._lately.append((stamp, pose.x, pose.y))
        while stamp - self._lately[0][0] > self.settings.stalled:
            self._lately.popleft()
        self._dead_ends = [end for end in self._dead_ends if stamp - end[0] < self.settings.remembered]

    def is_stalled(self, stamp: float) -> bool:
        """It has not got away from where it is for some time."""
        if not self._lately or stamp - self._lately[0][0] < self.settings.stalled * 0.9:
            return False
        _, x, y = self._lately[-1]
        return all(math.hypot(u - x, v - y) < self.settings.moved for _, u, v in self._lately)

    def turn_back(self, pose: Pose, direction: float, stamp: float) -> None:
        """Give the direction [rad] up: go back, and keep off the place ahead for a while."""
        settings = self.settings
        self._left = min(settings.most_back, settings.back * 1.6 ** len(self._dead_ends))
        x, y = pose.x + settings.ahead * math.cos(direction), pose.y + settings.ahead * math.sin(direction)
        self._dead_ends.append((stamp, x, y))
        self._lately.clear()
        self._until = stamp + 3.0 + 8.0 * self._left

    def next_place(self, pose: Pose, stamp: float, along: float = 0.35) -> tuple[float, float] | None:
        """The place of the way back to make for; None when it has come to its end."""
        while self._way and math.dist(self._way[-1], (pose.x, pose.y)) < along and self._left > 0.0:
            gone = self._way.pop()
            self._left -= math.dist(gone, self._way[-1]) if self._way else self._left
        if not self._way or self._left <= 0.0 or stamp > self._until:
            self._left = 0.0
            return None
        return self._way[-1]

    @property
    def dead_ends(self) -> Floats:
        """Places (n, 2) [m] that were given up lately."""
        return np.array([end[1:] for end in self._dead_ends], dtype=np.float64).reshape(-1, 2)
