"""Library `stasis`: noticing that the robot is stuck, and getting out.

Takes: the parameters of a plan, localisation and surroundings of the robot. Gives: percepts and a competence.
Leaves alone: flippers, which help over what can be climbed.
"""

from __future__ import annotations

from behaviours.competences.escape import Escape
from behaviours.cores.stasis import CycleSettings, EscapeSettings, LevelSettings, PatienceSettings
from behaviours.declaring import boolean, chosen, command, number, parameters, positive, settings_of
from behaviours.estimators.stasis import Stasis, StasisSettings
from behaviours.interface import Library, Offer, Parameter, Values, Workshop
from behaviours.libraries.recent_path import recent_path
from behaviours.libraries.sharing import localisation, surroundings

_LEVEL = parameters(
    LevelSettings(),
    ("up", "", "How the level rises, 1/s, while the robot is told to move and does not (chosen here)."),
    ("down", "", "How it falls, 1/s, while the robot moves (chosen here)."),
    ("threshold", "", "The robot is stuck from this level on (chosen here)."),
    ("cap", "", "The level rises no further; above the threshold, so that an escape lasts (chosen here)."),
    ("moving_speed", "m/s", "Faster is motion (chosen here)."),
    ("moving_turn_rate", "rad/s", "Faster is motion (chosen here)."),
    ("told_speed", "m/s", "More is a command to move (chosen here)."),
    ("told_turn_rate", "rad/s", "More is a command to move (chosen here)."),
)
_ESCAPE = parameters(
    EscapeSettings(),
    ("speed", "m/s", "Greatest of a random motion, ahead or back (printed in the paper)."),
    ("turn_rate", "rad/s", "Greatest of a random motion, either way (printed in the paper)."),
    ("each", "s", "A random motion is tried for so long (printed in the paper)."),
    ("least_speed", "m/s", "A motion slower than this and turning less than the next is drawn again (chosen here)."),
    ("least_turn_rate", "rad/s", "See `least-speed` (chosen here)."),
)
_PATIENCE = parameters(
    PatienceSettings(),
    ("episodes", "", "After so many escapes at one place an operator is needed; `modern` alone (chosen here)."),
    ("place", "m", "So far off another place begins (chosen here)."),
)
_CYCLE = parameters(
    CycleSettings(),
    ("window", "s", "Motion that repeats itself within this time is stasis; `modern` alone (chosen here)."),
    ("likeness", "", "Autocorrelation of poses from which a motion repeats itself (chosen here)."),
)
LONGEST_WINDOW = 600.0
"""[s] All poses of the window are compared with each sample."""
_RELEASE = Parameter(
    "release", "number", "", 1.0, "An escape ends below this level; with `modern` always at 0 (chosen here)."
)
_SLIPPING = Parameter(
    "slipping", "number", "m", 0.05, "So much better a scan must fit standing than moving; `modern` alone."
)
_MORE = parameters(
    StasisSettings(),
    ("lifting", "s", "For so long after flippers are sent out being held is no stasis (chosen here)."),
    ("reach", "m", "What held the robot is remembered so far from its middle; `modern` alone (chosen here)."),
)
_SEED = Parameter("seed", "number", "", 1.0, "Of the random motions.")
_PRESET = Parameter(
    "preset", "symbol", "", "paper",
    "`modern`: the way in backwards first, slipping tracks and cycles noticed, an operator called in the end.",
)  # fmt: skip
_RANGES = Parameter(
    "ranges", "symbol", "", "lidar", "`lidar`: `modern` sees by it whether tracks slip; `sonar`: they are believed."
)


def _level(values: Values, modern: bool) -> LevelSettings:
    level = settings_of(LevelSettings(), (*_LEVEL, _RELEASE), {**values, "release": 0.0} if modern else values)
    if level.cap < positive("threshold", level.threshold):
        raise ValueError(f"cap must be at least the threshold, {level.threshold}, or the robot is never stuck")
    return level


def _cycle(values: Values) -> CycleSettings:
    cycle = settings_of(CycleSettings(), _CYCLE, values)
    least = cycle.longest + 2.0 * cycle.sample
    if not least <= cycle.window <= LONGEST_WINDOW:
        raise ValueError(f"window must be from {least:g} to {LONGEST_WINDOW:g} s, not {cycle.window}")
    return cycle


def _settings(values: Values, modern: bool) -> StasisSettings:
    return StasisSettings(
        _level(values, modern),
        settings_of(EscapeSettings(), _ESCAPE, values),
        _cycle(values),
        settings_of(PatienceSettings(), _PATIENCE, values),
        modern,
        settings_of(StasisSettings(), (_SLIPPING,), values).slipping,
        settings_of(StasisSettings(), _MORE, values).lifting,
        settings_of(StasisSettings(), _MORE, values).reach,
        settings_of(StasisSettings(), (_SEED,), values).seed,
    )


def _build(values: Values, workshop: Workshop) -> Offer:
    modern = chosen(_PRESET, values, "paper", "modern") == "modern"
    looks = chosen(_RANGES, values, "lidar", "sonar") == "lidar" and modern
    settings, place = _settings(values, modern), localisation(workshop)
    around, path = surroundings(workshop) if looks else None, recent_path(workshop)
    stasis = workshop.share(Stasis, lambda: Stasis(settings, place, around, path))
    escape = Escape(stasis.way_back, stasis.draw, settings.escape.each, lambda: stasis.needs_operator)
    return Offer(
        percepts={
            "the-robot-is-stuck": lambda: stasis.is_stuck,
            "stasis-level": lambda: stasis.level.value,
            "an-operator-is-needed": lambda: stasis.needs_operator,
        },
        competences={"escape-from-stasis": escape},
    )


LIBRARY = Library(
    "stasis",
    "Behavioural stasis and the way out of it, after Yamauchi 2005.",
    (
        boolean("the-robot-is-stuck", "It was told to move and did not, for too long; until it has moved for a while."),
        number("stasis-level", "", "Rises while the robot is told to move and does not, falls while it moves."),
        boolean("an-operator-is-needed", "Escapes at one place have been in vain too often (`modern`)."),
        command("escape-from-stasis", "Random motions, and with `modern` the way in backwards first.", "drive"),
    ),
    (_PRESET, _RANGES, *_LEVEL, _RELEASE, *_ESCAPE, *_PATIENCE, *_CYCLE, _SLIPPING, *_MORE, _SEED),
    _build,
)
