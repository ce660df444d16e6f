"""Numbers, places and shapes as scenarios write them.

Takes: nothing. Gives: the `Spec`s that all parts of the format are made of, with their units and limits. Leaves alone:
what is measured.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar

import yaml

from behaviours.interface import Pose, Vec2
from sim.raycast import Circle, Outline, box
from sim.scenarios.scenario import Amount, Between, Box, Spot
from sim.scenarios.schema import Key, Report, Spec, Wrong, listed, mapping_or, quantity, record, row, scalar_or
from sim.scenarios.shapes import Ring, convex, from_text
from sim.things.thing import Waypoint

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

D = TypeVar("D", bound="DataclassInstance")

FARTHEST = 1e5  # [m]; also the longest
SHORTEST = 1e-3  # [m] of what has a size
LATEST = 1e7  # [s]

coordinate = quantity("length", least=-FARTHEST, most=FARTHEST)
positive = quantity("length", least=SHORTEST, most=FARTHEST)
length = quantity("length", least=0, most=FARTHEST)
moment = quantity("time", least=0, most=LATEST)
duration = quantity("time", least=1e-3, most=LATEST)
angle = quantity("angle", least=-100, most=100)
share = quantity("number", least=0, most=1)
spread = quantity("number", least=0, most=1e6)
positive_number = quantity("number", above=0, most=1e3)
mass = quantity("number", least=1e-3, most=1e6)
speed = quantity("speed", above=0, most=10)


def pair(x: float, y: float) -> Vec2:
    return x, y


point = row(pair, "a place [x, y]", coordinate, coordinate)
pose = row(Pose, "a pose [x, y] or [x, y, heading]", coordinate, coordinate, angle, optional=1)


def _region(xmin: float, ymin: float, xmax: float, ymax: float) -> Box:
    if xmin >= xmax or ymin >= ymax:
        raise ValueError("the region is empty: expected xmin < xmax and ymin < ymax")
    return xmin, ymin, xmax, ymax


region = row(_region, "a region [xmin, ymin, xmax, ymax]", *[coordinate] * 4)
size = row(pair, "a size [length, width]", positive, positive)


def _between(between: Between) -> Between:
    return between


between = record(_between, between=Key(row(Between, "two angles [from, to]", angle, angle)))
amount_of_angle: Spec[Amount] = mapping_or(between, angle)
metres_between = record(_between, between=Key(row(Between, "two lengths [from, to]", coordinate, coordinate)))
drawn_coordinate: Spec[Amount] = mapping_or(metres_between, coordinate)


def _spot(x: Amount, y: Amount) -> Spot:
    return x, y


spot = row(_spot, "a place [x, y]", drawn_coordinate, drawn_coordinate)
waypoint = row(Waypoint, "a waypoint [x, y] or [x, y, seconds to wait]", coordinate, coordinate, moment, optional=1)
track = listed(waypoint, 2, "a list of waypoints")
corners = listed(point, 3, "a list of corners [x, y]")


def fields_of(sample: D, specs: dict[str, Spec[Any]]) -> Spec[D]:
    """A mapping of fields of a dataclass; those that are not named are as in the sample."""
    return record(type(sample), **{name: Key(spec, getattr(sample, name)) for name, spec in specs.items()})


# --- what is shaped as the writer wishes --------------------------------------------------------------


def _shape(circle: float | None, box: Outline | None, polygon: Ring | None) -> Outline:
    if len([given for given in (circle, box, polygon) if given is not None]) != 1:
        raise ValueError("give one of circle, box and polygon")
    if polygon is not None:
        return convex(polygon)
    return Circle(circle) if circle is not None else box or Circle(1.0)


shape = record(
    _shape,
    circle=Key(positive, None, doc="radius"),
    box=Key(row(box, "a size [length, width]", positive, positive), None),
    polygon=Key(corners, None),
)


def _text_ring(report: Report, node: yaml.Node, path: str) -> Ring | Wrong:
    ring = from_text(str(node.value))
    return report.unexpected(node, path, "corners as text 'x y, x y, …', three or more") if ring is None else ring


text_ring: Spec[Ring] = Spec(_text_ring, {"type": "string", "description": "corners: x y, x y, …"})
rings = listed(scalar_or(text_ring, corners), 1, "a list of rings")
