"""The libraries of behaviours that plans may use.

Takes: nothing. Gives: for each library its words, its parameters with defaults, and how it comes to life.
Leaves alone: who uses them. To add a library, write a file like `behaviours/libraries/robot.py` and name it in
`LIBRARIES`.

The defaults are the settings of the papers that the docs of the libraries name, where these print them; the docs of the
others say that they are chosen here.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from behaviours.interface import Library
from behaviours.libraries.drive import LIBRARY as DRIVE
from behaviours.libraries.find_and_fetch import LIBRARY as FIND_AND_FETCH
from behaviours.libraries.flippers import LIBRARY as FLIPPERS
from behaviours.libraries.ir_search import LIBRARY as IR_SEARCH
from behaviours.libraries.localisation import LIBRARY as LOCALISATION
from behaviours.libraries.mapping import LIBRARY as MAPPING
from behaviours.libraries.natigation import LIBRARY as NATIGATION
from behaviours.libraries.patrol import LIBRARY as PATROL
from behaviours.libraries.perimeter import LIBRARY as PERIMETER
from behaviours.libraries.recent_path import LIBRARY as RECENT_PATH
from behaviours.libraries.robot import LIBRARY as ROBOT
from behaviours.libraries.runaway import LIBRARY as RUNAWAY
from behaviours.libraries.sensors import LIBRARY as SENSORS
from behaviours.libraries.stasis import LIBRARY as STASIS
from behaviours.libraries.stereo_search import LIBRARY as STEREO_SEARCH
from behaviours.libraries.svfh import LIBRARY as SVFH
from behaviours.libraries.wall_by_hough import LIBRARY as WALL_BY_HOUGH
from behaviours.libraries.wall_by_ransac import LIBRARY as WALL_BY_RANSAC

LIBRARIES: Mapping[str, Library] = MappingProxyType(
    {
        item.name: item
        for item in (
            ROBOT,
            RUNAWAY,
            NATIGATION,
            IR_SEARCH,
            STEREO_SEARCH,
            FIND_AND_FETCH,
            SENSORS,
            PATROL,
            DRIVE,
            LOCALISATION,
            MAPPING,
            PERIMETER,
            RECENT_PATH,
            SVFH,
            FLIPPERS,
            STASIS,
            WALL_BY_HOUGH,
            WALL_BY_RANSAC,
        )
    }
)
"""Every library, by name."""


def library(name: str) -> Library:
    """The library of this name. Raises KeyError where there is none."""
    return LIBRARIES[name]
