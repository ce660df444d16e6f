"""What competences that steer by a heading have in common.

Takes: channels; what estimators offer, by the shape of it. Gives: the wanted heading, the view of the open directions.
Leaves alone: how a direction is chosen.
"""

from __future__ import annotations

import math
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from behaviours.interface import Channels, Floats, Pose, View, wrap

KEEP_OFF = "keep-off-recent-path"
"""The channel that says whether the recent path counts as an obstacle."""


class Place(Protocol):
    """Where the robot is."""

    @property
    def pose(self) -> Pose:
        """In the map frame."""
        ...

    @property
    def heading(self) -> float:
        """[rad] in the map frame."""
        ...


class Around(Protocol):
    """What stands round the robot."""

    @property
    def points(self) -> Floats:
        """(n, 2) [m] robot frame."""
        ...

    @property
    def known(self) -> bool:
        """Something has been measured."""
        ...


class Near(Protocol):
    """What stands near to the robot, also where it does not look now."""

    @property
    def points(self) -> Floats:
        """(n, 2) [m] robot frame."""
        ...

    @property
    def sees_all(self) -> bool:
        """The sensor looks to every side."""
        ...


def wanted_heading(channels: Channels) -> float | None:
    """The heading [rad, map frame] on the channel `heading`; None where there is none."""
    heading = channels.get("heading")
    if isinstance(heading, bool) or not isinstance(heading, int | float) or not math.isfinite(heading):
        return None
    return float(heading)


def sectors_view(open_: NDArray[np.bool_], turned: float = 0.0) -> View:
    """Direction i is centred on i / n of a turn, so the first begins half a sector to its right.

    turned [rad]: the robot frame against the one of the directions.
    """
    text = "".join("1" if free else "0" for free in open_.tolist())
    return {"kind": "sectors", "frame": "robot", "first": round(wrap(-math.pi / len(open_) - turned), 6), "open": text}
