"""The percepts of libraries for programs that are no plans.

Takes: names of libraries and, in order, every reading. Gives: percept name → its value now, as a plan would see it.
Leaves alone: competences and values; a program drives by itself.
"""

from __future__ import annotations

from collections.abc import Mapping

from behaviours.interface import Reading, Values, Workshop
from rplan.apps.libraries import Catalogue, catalogue
from rplan.lang.suggest import close

NOTHING: Values = {}


class Percepts:
    """Call it with each reading of a run, in order; `begin` before the first of the next run.

    settings: library → its parameters in SI, where they shall not be as they come. offered: the libraries there are,
    those that are installed where it is left out. Raises ValueError for a library that there is not, or that refuses
    its parameters.
    """

    def __init__(
        self, *libraries: str, settings: Mapping[str, Values] | None = None, offered: Catalogue | None = None
    ) -> None:
        self._offered = offered or catalogue()
        self._libraries, self._settings = libraries, settings or {}
        for name in (*libraries, *self._settings):
            if name not in self._offered:
                near = close(name, list(self._offered))
                hint = f"did you mean {near!r}?" if near else "known: " + ", ".join(self._offered)
                raise ValueError(f"there is no library {name!r}; {hint}")
        self.begin()

    def begin(self) -> None:
        """Forget what was before."""
        workshop = Workshop()
        offers = [self._offered[name].build(self._settings.get(name, NOTHING), workshop) for name in self._libraries]
        self._estimators = workshop.estimators
        self._percepts = {name: percept for offer in offers for name, percept in offer.percepts.items()}

    def __call__(self, reading: Reading) -> dict[str, bool | float]:
        """Every percept of the libraries after this reading."""
        for estimator in self._estimators:
            estimator.update(reading, {}, {})
        return {name: percept() for name, percept in self._percepts.items()}
