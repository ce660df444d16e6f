"""Library `recent-path`: where the robot has been lately.

Takes: the parameters of a plan, the localisation of the robot. Gives: a percept, a view, and the estimator that others
share. Leaves alone: steering clear of the path (the library `svfh`).
"""

from __future__ import annotations

from behaviours.cores.recent_path import TraceSettings
from behaviours.declaring import boolean, chosen, parameters, positive, settings_of
from behaviours.estimators.recent_path import RecentPath
from behaviours.interface import Library, Offer, Parameter, Values, View, Workshop
from behaviours.libraries.sharing import localisation

_TRACE = parameters(
    TraceSettings(),
    ("sample", "s", "One point is remembered in this time (printed in the paper)."),
    ("points", "", "So many points are remembered (printed in the paper)."),
    ("ignored", "m", "Points nearer to the robot are not given (chosen here)."),
    ("here", "m", "A point so near is where the robot is (chosen here)."),
    ("spacing", "m", "With `:preset modern` one point in this distance, whatever the time (chosen here)."),
    ("progress", "m", "`modern`: a robot that stays within this radius makes no progress (chosen here)."),
    ("patience", "s", "`modern`: without progress for so long it is in a dead end, to be closed (chosen here)."),
)
MOST_POINTS = 10_000
"""All of them are looked at with every tick."""
_PRESET = Parameter(
    "preset", "symbol", "", "paper", "`paper`: forgets by time; `modern`: by distance, and remembers dead ends."
)


def recent_path(workshop: Workshop, settings: TraceSettings | None = None) -> RecentPath:
    """The recent path. Raises ValueError where it was made with other settings than those asked for, if any are."""
    place = localisation(workshop)
    path = workshop.share(RecentPath, lambda: RecentPath(settings or TraceSettings(), place))
    if settings is not None and path.settings != settings:
        raise ValueError("use recent-path before the libraries that build on it: they took it with other parameters")
    return path


def _build(values: Values, workshop: Workshop) -> Offer:
    modern = chosen(_PRESET, values, "paper", "modern") == "modern"
    settings = settings_of(TraceSettings(by_distance=modern), _TRACE, values)
    positive("spacing", settings.spacing)
    if settings.points > MOST_POINTS:
        raise ValueError(f"points must be at most {MOST_POINTS}, not {settings.points}")
    path, place = recent_path(workshop, settings), localisation(workshop)

    def view() -> View | None:
        return {"kind": "points", "frame": place.frame, "at": path.trace.places.round(2).tolist()}

    return Offer(percepts={"we-were-here-lately": lambda: path.is_back}, views={"recent-path": view})


LIBRARY = Library(
    "recent-path",
    "Where the robot has been lately, after Yamauchi 2005.",
    (boolean("we-were-here-lately", "The robot is where it was before, and was elsewhere in between."),),
    (_PRESET, *_TRACE),
    _build,
    works_unasked=True,
)
