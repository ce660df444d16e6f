"""The library `mapping`: an occupancy grid of what the lidar sees, sent in patches.

Takes: the parameters of a plan, the localisation of the robot. Gives: its words and the view of the map. Leaves alone:
where the robot is (the library `localisation`).
"""

from __future__ import annotations

from dataclasses import replace

from behaviours.cores.occupancy import OccupancySettings
from behaviours.declaring import chosen, number, parameters, positive, settings_of
from behaviours.estimators.mapper import Mapper, MapperSettings
from behaviours.interface import Library, Offer, Parameter, Values, View, Workshop
from behaviours.libraries.sharing import localisation

SPARE = 2.0
"""Cells before the end of a beam that `modern` leaves as they are."""

_PRESET = Parameter(
    "preset",
    "symbol",
    "",
    "paper",
    "`paper`; or `modern`: beams that graze a wall do not wipe it out.",
)
_BY = Parameter(
    "by", "symbol", "", "hybrid", "Scans lie where `hybrid` localisation says, or `odometry` alone (paper: both)."
)
_SENDING = parameters(
    MapperSettings(),
    ("region", "m", "Side of the square round the robot that is sent (chosen here)."),
    ("every", "s", "What changed in it is sent this often (chosen here)."),
)
_GRID = parameters(
    OccupancySettings(),
    ("cell", "m", "Side of a cell (printed in the paper)."),
    ("hit", "", "Probability that the cell is occupied where a beam ends (chosen here)."),
    ("passed", "", "Probability that it is where a beam passes (chosen here)."),
    ("surest", "", "Probabilities stay between this and its complement (chosen here)."),
    ("reach", "m", "What lies farther off is left out of a scan (chosen here)."),
)


def _settings(values: Values) -> MapperSettings:
    grid = settings_of(OccupancySettings(), _GRID, values)
    if not 0.0 < grid.passed < 0.5 < grid.hit <= grid.surest < 1.0:
        raise ValueError("expected 0 < passed < 0.5 < hit <= surest < 1")
    if not (0.02 <= grid.cell <= 5.0 and grid.cell <= grid.reach <= 1000 * grid.cell):
        raise ValueError("cell must be from 0.02 to 5 m, reach from 1 to 1000 cells")
    settings = settings_of(MapperSettings(), _SENDING, values)
    positive("every", settings.every)
    if not grid.cell <= settings.region <= 2000 * grid.cell:
        raise ValueError("region must be from 1 to 2000 cells")
    modern = chosen(_PRESET, values, "paper", "modern") == "modern"
    grid = replace(grid, spare=SPARE if modern else 0.0)
    return replace(settings, by_odometry=chosen(_BY, values, "hybrid", "odometry") == "odometry", grid=grid)


def _build(values: Values, workshop: Workshop) -> Offer:
    settings, place = _settings(values), localisation(workshop)
    mapper = workshop.share(Mapper, lambda: Mapper(settings, place))
    return Offer(
        percepts={"the-mapped-area": lambda: mapper.grid.area, "the-map-rate": mapper.rate},
        views={"map": lambda: _view(mapper)},
    )


def _view(mapper: Mapper) -> View | None:
    patch = mapper.patch
    if patch is None:
        return None
    region = patch.region
    return {
        "kind": "grid",
        "frame": mapper.frame,
        "cell": patch.cell,
        "x": round(region.column * patch.cell, 6),
        "y": round(region.row * patch.cell, 6),
        "columns": region.columns,
        "rows": region.rows,
        "data": patch.data,
    }


LIBRARY = Library(
    "mapping",
    "An occupancy grid of what the lidar sees; what changes round the robot is sent every second.",
    (
        number("the-mapped-area", "", "In square metres: the cells of which scans have told."),
        number("the-map-rate", "", "In bytes a second: what the map has cost to send so far, compressed."),
    ),
    (_PRESET, _BY, *_SENDING, *_GRID),
    _build,
    works_unasked=True,
)
