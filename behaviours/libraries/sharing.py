"""Estimators that several libraries build on, made once.

Takes: the workshop of a robot. Gives: its localisation and its surroundings. Leaves alone: what is done with them.
"""

from __future__ import annotations

from behaviours.estimators.localisation import Localisation, LocalisationSettings
from behaviours.estimators.surroundings import Surroundings, SurroundingsSettings
from behaviours.interface import Workshop


def localisation(workshop: Workshop, settings: LocalisationSettings | None = None) -> Localisation:
    """Where the robot is. Raises ValueError where it was made with other settings than those asked for, if any are."""
    place = workshop.share(Localisation, lambda: Localisation(settings or LocalisationSettings()))
    if settings is not None and place.settings != settings:
        raise ValueError("use localisation before the libraries that build on it: they took it with other parameters")
    return place


def surroundings(workshop: Workshop, *, sonar: bool = False) -> Surroundings:
    """The points round the robot. Raises ValueError where they were asked for from the other kind of sensor before."""
    place, settings = localisation(workshop), SurroundingsSettings(sonar)
    around = workshop.share(Surroundings, lambda: Surroundings(settings, place))
    if around.settings != settings:
        raise ValueError("ranges must be the same in every library that looks around")
    return around
