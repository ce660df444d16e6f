"""What the drive motors draw, and the flippers of a tracked robot.

Takes: what tracks should have done and did. Gives: currents, and how the flippers stand and what they help over.
Leaves alone: when flippers are deployed (a behaviour decides) and whether there is a curb (the world knows).

Figures: 1.5 A at 0.5 m/s free, 8 A while climbing and 25 A when blocked are those of flipper deployment by current
(deploy above 15 A, retract below 2 A); between free and blocked the current follows the share of the motion that was
lost. Turning on the spot scrubs: 4 A per rad/s and 12 A at most, chosen here.
"""

from __future__ import annotations

import math

from behaviours.interface import Drive, FlipperState
from behaviours.interface import Flippers as Wanted
from sim.frames import approach

IDLE, PER_SPEED = 0.5, 2.0  # [A], [A s/m]
SCRUB, MAX_SCRUB = 4.0, 12.0  # [A s/rad], [A]
CLIMBING, BLOCKED = 8.0, 25.0  # [A]
STANDING = 0.01  # [m/s] below which nothing was wanted
DOWN = math.pi / 2  # [rad]
MOVES_IN = 0.5  # [s] from home to down and back
CHORD = 0.02  # share by which a way along an arc may look shorter than it was
PUSHING = 0.25  # share of the motion lost that counts as pushing against something
PUSH_TIME = 1.0  # [s] of pushing with flippers deployed until they lift the hull


def lost(meant: float, made: float) -> float:
    """Share in [0, 1] of a speed [m/s] that was meant and not made."""
    share = 0.0 if abs(meant) < STANDING else min(1.0, 1.0 - made / meant)
    return share if share > CHORD else 0.0


def currents(meant: Drive, made: Drive, track: float, scrubs: bool) -> tuple[float, float]:
    """What the left and the right motor draw [A]: `track` [m] apart, 0 where both do the same."""
    scrub = min(MAX_SCRUB, SCRUB * abs(made.turn_rate)) if scrubs else 0.0
    left = _current(_side(meant, -track), _side(made, -track), scrub)
    return left, _current(_side(meant, track), _side(made, track), scrub)


def _side(motion: Drive, track: float) -> float:
    return motion.speed + motion.turn_rate * track / 2


def _current(meant: float, made: float, scrub: float) -> float:
    free = min(BLOCKED, IDLE + PER_SPEED * abs(made) + scrub)
    return free + (BLOCKED - free) * lost(meant, made)


class Flippers:
    """They take half a second down or up; `lifts` once they have been down for a second of pushing."""

    def __init__(self) -> None:
        self._angle, self._wanted, self._pushed_for = 0.0, False, 0.0

    def command(self, wanted: Wanted | None) -> None:
        """Where to go from now on; None: as before."""
        if wanted is not None:
            self._wanted = wanted.deployed

    def move(self, dt: float, pushing: bool, climbing: bool) -> None:
        """One tick; a hull that is climbing stays lifted until it is over."""
        pushed = self.deployed and pushing
        self._pushed_for = self._pushed_for + dt if pushed else self._pushed_for if climbing else 0.0
        self._angle = approach(self._angle, DOWN if self._wanted else 0.0, DOWN / MOVES_IN * dt)

    @property
    def deployed(self) -> bool:
        """They bear on the ground."""
        return self._angle == DOWN

    @property
    def lifts(self) -> bool:
        """They hold the nose up."""
        return self._pushed_for > PUSH_TIME - 1e-9

    @property
    def state(self) -> FlipperState:
        """As the robot senses it."""
        return FlipperState(self._angle, self.deployed)
