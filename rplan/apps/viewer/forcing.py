"""Percepts that someone sets by hand while a plan runs.

Takes: libraries of behaviours. Gives: the same libraries, whose percepts answer what is forced, if anything is. Leaves
alone: everything else that they offer; competences and estimators see the world as it is.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

from behaviours.interface import Library, Offer, Values, Workshop
from rplan.apps.libraries import Catalogue

Sample = Callable[[], bool | float]
Forced = Mapping[str, bool | float]
"""Name of a percept's function -> the value that it has."""


def forcing(libraries: Catalogue, forced: Forced) -> Catalogue:
    """The libraries, obeying `forced` as it is at each sample."""
    return {name: _obeying(library, forced) for name, library in libraries.items()}


def _obeying(library: Library, forced: Forced) -> Library:
    def build(values: Values, workshop: Workshop) -> Offer:
        offer = library.build(values, workshop)
        return replace(offer, percepts={name: _sample(name, one, forced) for name, one in offer.percepts.items()})

    return replace(library, build=build)


def _sample(name: str, sample: Sample, forced: Forced) -> Sample:
    return lambda: forced[name] if name in forced else sample()
